//! `lixel trade`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use lixel::compare::{random_hemisphere, write_file};
use lixel::plan::{Dest, Watch};
use lixel::trade::{Model, Point, TradeParams, json, plot, points, table, trade};

use super::exit::{Failure, MET};
use super::flags::JobFlags;
use super::progress::Bar;
use super::report;
use super::signals::Signals;
use super::values::{Hemisphere, hemisphere};

/// Time the settings that cost time, and show what they buy: the front of time against texels, and where the presets lie
#[derive(Args)]
#[command(after_help = "\
About ninety operating points plan each light of each frame by itself, one point at a time on all threads: the presets,
each of their costly settings changed alone, and a few combinations. Nothing else should run on the machine.

Examples:
  lixel trade shot.toml --frames 30 --svg trade.svg
  lixel trade scene.glb --size 480x270 --lights random-hemisphere:4:1 --repeat 5 --json trade.json
  lixel trade shot.toml --frames 1,45 --lights 1 --model here.toml
  lixel plan shot.toml --time-budget 50ms --time-model here.toml -o shot.plan.json

Exit codes: 0 done, 1 failure, 2 bad input, 130/143 stopped.")]
pub(super) struct TradeArgs {
    /// A job file (.toml), or a scene with its camera and lights (.gltf, .glb, .obj)
    input: PathBuf,
    /// Only the first N lights of each frame, or lights spread evenly over the sky instead of the scene's:
    /// random-hemisphere:N:SEED
    #[arg(long, value_name = "LIGHTS", value_parser = lights)]
    lights: Option<Lights>,
    /// Only the presets and the points whose names begin so, as in "draft" or "standard grid=" [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAME,…")]
    points: Vec<String>,
    /// Times each point is run; the median counts
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeat: u32,
    /// All points, the front and the places of the presets as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// A plot of time against excess texels
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// The front as a table for `lixel plan --time-model`
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    #[command(flatten)]
    job: JobFlags,
}

/// Which lights of a frame take part.
#[derive(Clone, Debug)]
enum Lights {
    /// So many, from the first.
    First(usize),
    /// Others than the scene's.
    Sky(Hemisphere),
}

/// `N`, or as [`hemisphere`].
fn lights(text: &str) -> Result<Lights, String> {
    match text.parse() {
        Ok(0) => Err("there is no light in this: give at least 1".to_owned()),
        Ok(count) => Ok(Lights::First(count)),
        Err(_) => hemisphere(text).map(Lights::Sky),
    }
}

/// The presets, and the points whose names begin as wanted; all where nothing is.
fn chosen(wanted: &[String]) -> Result<Vec<Point>, Failure> {
    let mut all = points();
    if let Some(none) = wanted.iter().find(|start| !all.iter().any(|p| p.name.starts_with(start.as_str()))) {
        return Err(Failure::Input(format!(
            "--points: no point's name begins with `{none}`; they begin with draft, standard or thorough, and go on as in \
             `draft grid=64`"
        )));
    }
    let begins = |p: &Point| wanted.iter().any(|start| p.name.starts_with(start.as_str()));
    all.retain(|p| wanted.is_empty() || p.preset.is_some() || begins(p));
    Ok(all)
}

pub(super) fn run(args: &TradeArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    args.job.one_temporal()?;
    let mut job = lixel::job::load(&args.input, &args.job.overrides()).map_err(|e| Failure::job(e, &args.job))?;
    if let Some(Lights::Sky(sky)) = &args.lights {
        job.job.light = random_hemisphere(sky.lights.clone(), sky.seed);
    }
    for file in [&args.json, &args.svg, &args.model].into_iter().flatten() {
        Dest::File(file.clone()).check()?;
    }
    let lights = match args.lights {
        Some(Lights::First(count)) => Some(count),
        _ => None,
    };
    let params = TradeParams { points: chosen(&args.points)?, repeat: args.repeat, lights };
    let found = {
        let bar = Bar::new(quiet);
        let watch =
            Watch { progress: &|p| bar.show(p), cancel: signals.cancel(), notes: &|text| report::remark(quiet, text) };
        trade(&job, &params, &watch)?
    };
    if let Some(file) = &args.json {
        write_file(file, json(&found)?.as_bytes())?;
    }
    if let Some(file) = &args.svg {
        write_file(file, plot(&found).as_bytes())?;
    }
    if let Some(file) = &args.model {
        write_file(file, Model::of(&found).text(file)?.as_bytes())?;
    }
    let mut out = std::io::stdout().lock();
    out.write_all(table(&found).as_bytes()).and_then(|()| out.flush()).map_err(Failure::Stdout)?;
    Ok(ExitCode::from(MET))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_a_count_or_a_sky() {
        assert!(matches!(lights("3"), Ok(Lights::First(3))));
        assert!(matches!(lights("random-hemisphere:3:1"), Ok(Lights::Sky(_))));
        for bad in ["0", "-1", "", "sun", "random-hemisphere:0:1"] {
            assert!(lights(bad).is_err(), "{bad}");
        }
    }
}
