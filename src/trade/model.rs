//! The table of operating points that a time budget chooses from: a front, fastest first.

use std::path::Path;

use serde::{Deserialize, Serialize};
use toml::Table;

use super::{Rank, Trade, TradeError};

/// Operating points with the time that they took where they were measured.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Threads that they had.
    pub threads: usize,
    /// Pixels of the image.
    pub pixels: u64,
    /// At least one, fastest first.
    pub point: Vec<ModelPoint>,
}

/// An operating point of a table.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ModelPoint {
    /// Its name.
    pub name: String,
    /// Seconds a frame and light.
    pub seconds: f64,
    /// Texels over the thorough preset's, as a part.
    pub excess_texels: f64,
    /// Keys of a job.
    pub settings: Table,
}

/// Where the shipped table lies in the sources.
const SHIPPED: &str = "configs/operating.toml";

/// What a written table says of itself.
const HEAD: &str = "\
# Operating points that `lixel plan --time-budget` chooses from, fastest first: the front of one run of
# `lixel trade INPUT --model FILE`. `seconds` are those of each light of a frame on the machine of that run;
# `excess_texels` is a part of the thorough preset's.

";

impl Model {
    /// The table that ships.
    ///
    /// # Errors
    /// [`TradeError::Model`], were it broken.
    pub fn shipped() -> Result<Model, TradeError> {
        Model::parse(include_str!("../../configs/operating.toml"), Path::new(SHIPPED))
    }

    /// Reads a table.
    ///
    /// # Errors
    /// [`TradeError::Model`].
    pub fn read(path: &Path) -> Result<Model, TradeError> {
        let text = std::fs::read_to_string(path)
            .map_err(|e| TradeError::Model { path: path.to_owned(), message: format!("cannot be read: {e}") })?;
        Model::parse(&text, path)
    }

    fn parse(text: &str, path: &Path) -> Result<Model, TradeError> {
        let fault = |message: String| TradeError::Model { path: path.to_owned(), message };
        let model: Model =
            toml::from_str(text).map_err(|e| fault(format!("not a table of operating points: {}", e.message())))?;
        if model.point.is_empty() {
            return Err(fault("it has no point".to_owned()));
        }
        if let Some(bad) = model.point.iter().find(|p| !(p.seconds > 0.0 && p.seconds.is_finite())) {
            return Err(fault(format!("point `{}` has seconds = {}, not a time", bad.name, bad.seconds)));
        }
        if let Some(pair) = model.point.windows(2).find(|pair| pair[0].seconds > pair[1].seconds) {
            return Err(fault(format!("point `{}` is slower than the next, `{}`", pair[0].name, pair[1].name)));
        }
        Ok(model)
    }

    /// The front of a trade, as a ladder: what is predicted, then what is measured, from where time allows it. The method is
    /// the user's choice, not a price: points that change it are left out.
    pub fn of(trade: &Trade) -> Model {
        let is_method = |settings: &Table| settings.get("solver").is_some_and(|s| s.get("method").is_some());
        let mut kept: Vec<_> = trade.points.iter().filter(|p| !is_method(&p.point.settings)).collect();
        let ranks: Vec<Rank> = kept.iter().map(|p| p.rank()).collect();
        kept = super::front(&ranks).into_iter().map(|k| kept[k]).collect();
        let measured_from = kept.iter().find(|p| p.measures).map_or(f64::INFINITY, |p| p.seconds);
        kept.retain(|p| p.measures || p.seconds < measured_from);
        let point = kept.into_iter().map(|p| ModelPoint {
            name: p.point.name.clone(),
            seconds: p.seconds,
            excess_texels: p.excess_texels,
            settings: p.point.settings.clone(),
        });
        Model { threads: trade.threads, pixels: trade.pixels, point: point.collect() }
    }

    /// The table as a file.
    ///
    /// # Errors
    /// [`TradeError::Model`] for numbers that TOML cannot carry.
    pub fn text(&self, path: &Path) -> Result<String, TradeError> {
        let fault = |e: toml::ser::Error| TradeError::Model { path: path.to_owned(), message: e.to_string() };
        Ok(HEAD.to_owned() + &toml::to_string(self).map_err(fault)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::{Job, LoadedJob};

    #[test]
    fn the_shipped_table_is_a_front_of_settings_that_jobs_may_have() {
        let model = Model::shipped().unwrap();
        assert!(model.point.len() > 3);
        let measures = |p: &ModelPoint| p.settings["quality"]["measure"].as_str() != Some("never");
        for pair in model.point.windows(2) {
            let cheaper = pair[0].excess_texels > pair[1].excess_texels;
            let begins_to_measure = measures(&pair[1]) && !measures(&pair[0]);
            assert!(begins_to_measure || measures(&pair[1]) == measures(&pair[0]) && cheaper, "{}", pair[1].name);
        }
        let job = Job { scene: vec!["a.gltf".into()], ..Job::default() };
        let base = LoadedJob { job, file: None, dir: "".into() };
        for point in &model.point {
            assert!(base.with(&point.settings).is_ok(), "{}", point.name);
        }
    }

    #[test]
    fn a_table_reads_back_and_what_is_wrong_in_one_is_named() {
        let model = Model::shipped().unwrap();
        let path = Path::new("a.toml");
        assert_eq!(Model::parse(&model.text(path).unwrap(), path).unwrap(), model);
        let refused = |text: &str| Model::parse(text, path).unwrap_err().to_string();
        let point = |name: &str, seconds: &str| {
            format!("[[point]]\nname = \"{name}\"\nseconds = {seconds}\nexcess_texels = 0.5\n[point.settings]\n")
        };
        let head = "threads = 1\npixels = 1\n";
        assert!(refused("pixels = 1").contains("a.toml: not a table of operating points"));
        assert!(refused(&format!("{head}point = []")).contains("no point"));
        assert!(refused(&format!("{head}{}", point("a", "nan"))).contains("`a` has seconds = NaN"));
        assert!(refused(&format!("{head}{}{}", point("a", "2.0"), point("b", "1.0"))).contains("`a` is slower"));
    }
}
