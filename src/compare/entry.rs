//! One method on one light: solved, drawn, counted.

use super::{BIAS_GRID, BiasChoice, CompareParams, Measured, PerLight, Question, TexelsFor, Variant, budget, chosen};
use crate::job::Job;
use crate::measure::Receivers;
use crate::methods::{Inapplicable, Method, SolverParams};
use crate::plan::{FrameStage, PlanError};
use crate::raster::{Bias, RasterError};
use crate::resolution::{
    Drawing, FilmQuestion, FittedLight, Judge, OnFilm, Turn, choose, default_bias, fit_light, fit_texels, polish,
    polishes, predict, texels,
};
use crate::samples::LightSamples;
use crate::scene::Light;
use crate::visibility::View;
use std::time::Instant;

/// What all methods are given for one light of a frame.
pub(super) struct Case<'a> {
    pub(super) stage: &'a FrameStage<'a>,
    pub(super) view: &'a View,
    pub(super) frame: i64,
    pub(super) light: &'a Light,
    pub(super) samples: &'a LightSamples,
    pub(super) receivers: &'a Receivers,
}

/// The wrong pixels of one method, for pictures.
#[derive(Clone, Debug, Default)]
pub(super) struct Mask {
    /// Certainly wrong receivers, ascending.
    pub(super) certain: Vec<u32>,
    /// Those of them with a misplaced edge, ascending.
    pub(super) edge: Vec<u32>,
}

impl Case<'_> {
    /// What is asked under some settings.
    pub(super) fn question<'b>(&'b self, solver: &'b SolverParams, job: &'b Job) -> FilmQuestion<'b> {
        FilmQuestion { solver, ..self.stage.question(self.light, job) }
    }

    /// What maps are measured on.
    pub(super) fn on_film(&self) -> OnFilm<'_> {
        let FrameStage { tracer, offset, .. } = *self.stage;
        OnFilm { tracer, view: self.view, receivers: self.receivers, offset }
    }
}

/// The row of a variant.
pub(super) fn entry(
    case: &Case,
    variant: &Variant,
    job: &Job,
    params: &CompareParams,
) -> Result<(PerLight, Mask), PlanError> {
    match variant.solver.method {
        Method::Auto => chosen::by_ladder(case, variant, job, params),
        Method::Best => chosen::best(case, variant, job, params),
        _ => alone(case, &variant.solver, job, params),
    }
}

/// Solves, draws and counts.
pub(super) fn alone(
    case: &Case,
    solver: &SolverParams,
    job: &Job,
    params: &CompareParams,
) -> Result<(PerLight, Mask), PlanError> {
    let start = Instant::now();
    let question = case.question(solver, job);
    let mut row = PerLight {
        frame: case.frame,
        light: case.light.name.clone(),
        chosen: None,
        reason: None,
        measured: None,
        solve_seconds: 0.0,
        seconds: 0.0,
    };
    if solver.method == Method::Irregular {
        row.measured = Some(exact(case, params));
        return Ok((row, Mask::default()));
    }
    let fitted = fit(case, &question, params);
    row.solve_seconds = start.elapsed().as_secs_f64();
    let mut mask = Mask::default();
    match fitted {
        Ok(mut fitted) => match Judge::new(case.on_film(), &question, &fitted) {
            Ok(mut judge) => {
                let (measured, found) = measure(&question, case.samples, &mut fitted, &mut judge, params)?;
                (row.measured, mask) = (Some(measured), found);
            }
            Err(reason) => row.reason = Some(reason.to_string()),
        },
        Err(reason) => row.reason = Some(reason.to_string()),
    }
    row.seconds = start.elapsed().as_secs_f64();
    Ok((row, mask))
}

/// The method's regions, for the texels that are given or for those that the bound asks for.
fn fit(case: &Case, question: &FilmQuestion, params: &CompareParams) -> Result<FittedLight, Inapplicable> {
    let Some(texels) = budget::texels(params.question) else {
        return fit_light(question, case.samples, Some(case.receivers));
    };
    fit_texels(question, case.samples, case.receivers, texels, budget::aspect(params.question, question.map))
}

fn measure(
    question: &FilmQuestion,
    samples: &LightSamples,
    fitted: &mut FittedLight,
    judge: &mut Judge,
    params: &CompareParams,
) -> Result<(Measured, Mask), RasterError> {
    let (sizes, needed) = match budget::texels(params.question) {
        Some(texels) => {
            // Choosing by measuring knows the job's aspects only.
            let same = budget::aspect(params.question, question.map) == budget::aspect(Question::Epsilon, question.map);
            if same && polishes(question.solver) {
                // Which map is best hangs on the bias, and the reverse.
                let turns: Vec<Turn> = match params.bias {
                    BiasChoice::Plan => vec![Turn::ONLY],
                    BiasChoice::Best => Turn::all(question.solver, fitted.texels).collect(),
                };
                for turn in turns {
                    let sizes = budget::sizes(&fitted.regions, &fitted.shares, texels);
                    let (bias, _) = answers(question, &sizes, judge, params.bias)?;
                    polish(question, samples, fitted, judge, &Drawing { size: &budget::size, bias }, turn)?;
                }
            }
            (budget::sizes(&fitted.regions, &fitted.shares, texels), None)
        }
        None => {
            let certified = choose(question, samples, fitted, judge)?;
            let needed = TexelsFor { met: certified.met, texels: texels(&certified.sizes) };
            (certified.sizes, Some(needed))
        }
    };
    let (bias, wrong) = answers(question, &sizes, judge, params.bias)?;
    let certain = judge.certain(&wrong);
    let edge = judge.misplaced(&sizes, bias, &certain)?;
    let texels = texels(&sizes);
    let prediction = predict(&fitted.regions, &fitted.shares, texels as f64);
    let false_lit = certain.iter().filter(|i| judge.receivers().shadowed[**i as usize]).count() as u64;
    let measured = Measured {
        misclassified: certain.len() as u64,
        false_lit,
        false_shadow: certain.len() as u64 - false_lit,
        self_shadow: (certain.len() - edge.len()) as u64,
        edge: edge.len() as u64,
        uncertain: (wrong.len() - certain.len()) as u64,
        predicted: Some(prediction.misclassified).filter(|p| p.is_finite()),
        predicted_unsaturated: Some(prediction.unsaturated).filter(|p| p.is_finite()),
        texels,
        maps: sizes,
        samples: None,
        bias_constant: bias.constant,
        bias_slope: bias.slope,
        bias_clamp: bias.clamp.is_finite().then_some(bias.clamp),
        needed,
    };
    Ok((measured, Mask { certain, edge }))
}

/// Exact visibility per sample: an irregular z-buffer keeps every pixel that faces the light as a sample of the light's
/// image (Johnson, Lee, Burns and Mark 2005; Aila and Laine 2004), answers all of them rightly, and that is its cost.
fn exact(case: &Case, params: &CompareParams) -> Measured {
    let samples = case.receivers.len() as u64;
    Measured {
        misclassified: 0,
        false_lit: 0,
        false_shadow: 0,
        self_shadow: 0,
        edge: 0,
        uncertain: 0,
        predicted: None,
        predicted_unsaturated: None,
        texels: 0,
        maps: Vec::new(),
        samples: Some(samples),
        bias_constant: 0.0,
        bias_slope: 0.0,
        bias_clamp: None,
        needed: (params.question == Question::Epsilon).then_some(TexelsFor { met: true, texels: samples }),
    }
}

/// The bias, and the receivers that are answered wrongly with it.
fn answers(
    question: &FilmQuestion,
    sizes: &[[u32; 2]],
    judge: &mut Judge,
    choice: BiasChoice,
) -> Result<(Bias, Vec<u32>), RasterError> {
    let plan = default_bias(&question.map.bias);
    let grid: &[Bias] = match choice {
        BiasChoice::Plan => &[],
        BiasChoice::Best => &BIAS_GRID,
    };
    let drawn = judge.draw(sizes, plan)?;
    let wrong = judge.wrong(&drawn);
    let mut best = (judge.certain(&wrong).len(), plan, wrong);
    for bias in grid {
        let drawn = judge.draw(sizes, *bias)?;
        let wrong = judge.wrong(&drawn);
        let certain = judge.certain(&wrong).len();
        if certain < best.0 {
            best = (certain, *bias, wrong);
        }
    }
    Ok((best.1, best.2))
}
