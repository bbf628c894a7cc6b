//! What is compared, at what cost, under which bias.

use super::Variant;
use crate::depth::CONSTANT_F32;
use crate::methods::Method;
use crate::raster::Bias;
use std::path::PathBuf;

/// What is held equal, and so what is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// Wrong pixels at this number of texels, all maps of a light together; the aspect is the method's own where the job
    /// leaves it free.
    Texels(u32),
    /// Wrong pixels at this width and height. Several maps share its texels at its aspect.
    Resolution([u32; 2]),
    /// Texels for the job's bound.
    Epsilon,
}

/// The depth bias of each map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BiasChoice {
    /// That of the job.
    #[default]
    Plan,
    /// For each method and light the entry of [`BIAS_GRID`] (or the job's own) with the fewest wrong pixels.
    Best,
}

/// The biases that [`BiasChoice::Best`] tries: constants of 4 and 256 steps of f32 depth, slope factors around 1, and
/// clamps that keep steep casters from swallowing what lies behind them.
pub const BIAS_GRID: [Bias; 18] = grid();

const CONSTANTS: [f64; 2] = [CONSTANT_F32, 64.0 * CONSTANT_F32];
const SLOPES: [f64; 3] = [0.5, 1.0, 2.0];
const CLAMPS: [f64; 3] = [f64::INFINITY, 1.0 / 256.0, 1.0 / 1024.0];

const fn grid() -> [Bias; 18] {
    let mut all = [Bias::NONE; 18];
    let mut i = 0;
    while i < all.len() {
        all[i] = Bias { constant: CONSTANTS[i % 2], slope: SLOPES[i / 2 % 3], clamp: CLAMPS[i / 6] };
        i += 1;
    }
    all
}

/// A comparison to make.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareParams {
    /// In the order of the table's rows; at least one.
    pub methods: Vec<Variant>,
    /// What is held equal.
    pub question: Question,
    /// The depth bias of each map.
    pub bias: BiasChoice,
    /// Where a picture of each light goes.
    pub pictures: Option<PathBuf>,
}

/// Every method, in the order of its declaration.
pub fn all_methods() -> Vec<Method> {
    let schema = schemars::schema_for!(Method).to_value();
    let variants = schema["oneOf"].as_array().cloned().unwrap_or_default();
    variants.into_iter().filter_map(|v| serde_json::from_value(v["const"].clone()).ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_has_a_name_that_reads_back() {
        let all = all_methods();
        assert!(all.contains(&Method::Lixel) && all.contains(&Method::SceneOptimal));
        for method in all {
            let read: Method = serde_json::from_value(method.name().into()).unwrap();
            assert_eq!(read, method);
        }
    }

    #[test]
    fn the_grid_holds_every_combination_once() {
        for (i, a) in BIAS_GRID.iter().enumerate() {
            assert!(BIAS_GRID[..i].iter().all(|b| a != b));
        }
        assert!(BIAS_GRID.contains(&Bias { constant: CONSTANT_F32, slope: 1.0, clamp: f64::INFINITY }));
    }
}
