//! The bias a light's maps are drawn with: as the job says, or the best of a few slopes and clamps by measurement.

use super::judge::Judge;
use super::polish::TRIANGLES_MEASURED;
use super::{BiasParams, FilmQuestion, FittedLight, Sampled, SizeGrid};
use crate::depth::CONSTANT_F32;
use crate::raster::{Bias, RasterError};

/// Slope factors that are measured. 1 is exact for a plane (the receiver and the texel centre on one surface); finely
/// tessellated surfaces bend within a texel and want more (a scanned scene 35 % fewer wrong pixels at 2 than at 1), thin
/// casters want little. The first is used where nothing is measured.
const SLOPES: [f64; 4] = [1.5, 1.0, 2.0, 3.0];

/// The bias of a job, with a slope where it gives none.
fn bias_with(params: &BiasParams, slope: f64) -> Bias {
    Bias {
        constant: params.constant.unwrap_or(CONSTANT_F32),
        slope: params.slope.unwrap_or(slope),
        clamp: params.clamp.unwrap_or(f64::INFINITY),
    }
}

/// The bias where nothing is measured. Without a clamp: any fixed one costs more on deep scenes than it saves elsewhere. (Four
/// `partitioned` maps, 24 lights: one light of the courtyard loses 235,000 pixels without, none with 0.01, which costs the
/// floor 54 %; 0.04 saves neither.) It is measuring that tells.
pub fn default_bias(params: &BiasParams) -> Bias {
    bias_with(params, SLOPES[0])
}

/// Clamps of the slope term that are measured once the slope is chosen, window depth. Triangles nearly edge-on to the
/// light have slopes without bound and would be pushed through what lies behind them: a box lit along one of its sides
/// loses that side's shadow. Flat maps over a wide depth range want none.
const CLAMPS: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// The bias with fewest wrong pixels at the predicted size, ties go to the earlier one; and these pixels, if it was
/// measured. The best slope is found first, then with it the best clamp. Of scenes too large to be drawn often a sample of the
/// pixels decides, looked up by rays.
pub fn measured_bias(
    question: &FilmQuestion,
    fitted: &FittedLight,
    judge: &mut Judge,
    grid: &SizeGrid,
) -> Result<(Bias, Option<Vec<u32>>), RasterError> {
    let params = &question.map.bias;
    let sizes = grid.sizes(grid.at_least(fitted.texels)).to_vec();
    let open = params.slope.is_none() || params.clamp.is_none();
    if open
        && judge.triangles() > TRIANGLES_MEASURED
        && let Some(sampled) = Sampled::of_film(question, &judge.on_film())
    {
        judge.spent.rays += sampled.rays();
        return Ok((sampled.trial(&judge.maps, &sizes, None).0, None));
    }
    let mut best: Option<(Vec<u32>, Bias)> = None;
    let mut consider = |bias: Bias, best: &mut Option<(Vec<u32>, Bias)>| {
        let drawn = judge.draw(&sizes, bias)?;
        let wrong = judge.wrong(&drawn);
        if best.as_ref().is_none_or(|b| wrong.len() < b.0.len()) {
            *best = Some((wrong, bias));
        }
        Ok::<(), RasterError>(())
    };
    if params.slope.is_none() {
        for slope in SLOPES {
            consider(bias_with(params, slope), &mut best)?;
        }
    }
    if params.clamp.is_none() {
        let chosen = best.as_ref().map_or_else(|| default_bias(params), |b| b.1);
        if best.is_none() {
            consider(chosen, &mut best)?;
        }
        for clamp in CLAMPS {
            consider(Bias { clamp, ..chosen }, &mut best)?;
        }
    }
    Ok(best.map_or_else(|| (default_bias(params), None), |(wrong, bias)| (bias, Some(wrong))))
}

/// Every slope with every clamp that the job leaves open, the default first: for what can look at all of them at once.
pub(super) fn biases(params: &BiasParams) -> Vec<Bias> {
    let slopes = if params.slope.is_some() { &SLOPES[..1] } else { &SLOPES };
    let clamps = if params.clamp.is_some() { &[] } else { &CLAMPS[..] };
    let of_slope = |slope: &f64| {
        let free = bias_with(params, *slope);
        std::iter::once(free).chain(clamps.iter().map(move |&clamp| Bias { clamp, ..free }))
    };
    slopes.iter().flat_map(of_slope).collect()
}
