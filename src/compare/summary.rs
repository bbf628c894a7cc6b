//! A comparison in figures.
//!
//! Sums and worst lights are over the lights to which *every* method applies, so that none gains by refusing; ratios to
//! the reference are over the lights of both.

use super::statistics::{interval, pearson, quantile, ratio_of_sums, slope};
use super::{Comparison, Measured, MethodRows};
use serde::Serialize;

/// Part of the lights in a row of worst ones (SOSM §3).
const WORST: f64 = 0.1;
/// The method that ratios are to, where it takes part; else the first.
const REFERENCE: &str = "scene-optimal";
/// The method that searched texels are compared with, where it takes part; else the reference.
const REFERENCE_OF_TEXELS: &str = "lixel";

/// A comparison in figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Lights to which every method applies.
    pub common: u64,
    /// Lights without a visible shadow.
    pub skipped: u64,
    /// The method that ratios are to.
    pub reference: String,
    /// One for each method.
    pub methods: Vec<MethodSummary>,
    /// The worst lights by each method in turn.
    pub worst: Vec<Worst>,
}

/// A ratio of sums to the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// Sum over sum.
    pub of_sums: Option<f64>,
    /// Its 95 % interval, bootstrapped over lights.
    pub interval: Option<[f64; 2]>,
    /// Quartiles and median of the lights' own ratios.
    pub quartiles: Option<[f64; 3]>,
}

/// Measured against predicted wrong pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Correlation {
    /// Measured per predicted: least squares through the origin.
    pub slope: Option<f64>,
    /// Pearson's r.
    pub r: Option<f64>,
    /// Pearson's r of the logarithms, over lights where both are above zero.
    pub r_log: Option<f64>,
}

/// One method in figures. Sums are over the common lights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MethodSummary {
    /// Its name.
    pub method: String,
    /// Certainly wrong pixels.
    pub misclassified: u64,
    /// Of them misplaced shadow edges.
    pub edge: u64,
    /// Of them owed to bias.
    pub self_shadow: u64,
    /// Further wrong pixels whose exact answer is uncertain.
    pub uncertain: u64,
    /// Misclassified more than the best method with maps, percent.
    pub percent_more: Option<f64>,
    /// Wrong pixels (or searched texels) to the reference's.
    pub ratio: Ratio,
    /// Edge pixels to the reference's.
    pub edge_ratio: Ratio,
    /// Lights to which the method does not apply.
    pub inapplicable: u64,
    /// Lights on which the bound was not met, when texels were searched.
    pub not_met: u64,
    /// Mean samples a light, of a method that answers exactly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<f64>,
    /// Quartiles and median over lights of the texels searched; a light on which the bound is not met needs more than any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texels: Option<[f64; 3]>,
    /// Mean seconds a light for the fit alone.
    pub solve_seconds: f64,
    /// Mean seconds a light for fit, drawing and counting.
    pub seconds: f64,
    /// The saturating prediction.
    pub predicted: Correlation,
    /// The prediction without saturation.
    pub unsaturated: Correlation,
}

/// The worst lights by one method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// The method that ranks.
    pub by: String,
    /// Number of lights.
    pub lights: u64,
    /// Mean of misclassified pixels over them, one for each method.
    pub misclassified: Vec<f64>,
}

/// Figures of a comparison.
pub fn summarise(comparison: &Comparison) -> Summary {
    let methods = &comparison.methods;
    let all = 0..comparison.lights.len();
    let at = |method: &'_ MethodRows, i: usize| method.per_light[i].measured.clone();
    let common: Vec<usize> =
        all.filter(|i| !methods.is_empty() && methods.iter().all(|m| m.per_light[*i].measured.is_some())).collect();
    let wanted = if comparison.epsilon.is_some() { REFERENCE_OF_TEXELS } else { REFERENCE };
    let find = |name: &str| methods.iter().position(|m| m.method == name);
    let reference = find(wanted).or(find(REFERENCE)).unwrap_or(0);
    let skipped = comparison.lights.iter().filter(|l| l.skipped.is_some()).count();
    let compared = (comparison.lights.len() - skipped).max(1) as f64;
    let sum = |method: &MethodRows, of: &dyn Fn(&Measured) -> u64| -> u64 {
        common.iter().filter_map(|i| method.per_light[*i].measured.as_ref()).map(of).sum()
    };
    let exact = |m: &&MethodRows| m.per_light.iter().filter_map(|r| r.measured.as_ref()).any(|r| r.samples.is_some());
    let best = methods.iter().filter(|m| !exact(m)).map(|m| sum(m, &|r| r.misclassified)).min().unwrap_or(0);
    let summary_of = |method: &MethodRows| {
        let misclassified = sum(method, &|r| r.misclassified);
        let pairs = |of: &dyn Fn(&Measured) -> Option<f64>| -> Vec<(f64, f64)> {
            (0..comparison.lights.len())
                .filter_map(|i| Some((of(&at(method, i)?)?, of(&at(&methods[reference], i)?)?)))
                .collect()
        };
        let counted: &dyn Fn(&Measured) -> Option<f64> = if comparison.epsilon.is_some() {
            &|r| r.needed.filter(|n| n.met).map(|n| n.texels as f64)
        } else {
            &|r| Some(r.misclassified as f64)
        };
        let rows = || method.per_light.iter().filter_map(|r| r.measured.as_ref());
        MethodSummary {
            method: method.method.clone(),
            misclassified,
            edge: sum(method, &|r| r.edge),
            self_shadow: sum(method, &|r| r.self_shadow),
            uncertain: sum(method, &|r| r.uncertain),
            percent_more: (best > 0 && !exact(&method)).then(|| (misclassified as f64 / best as f64 - 1.0) * 100.0),
            ratio: ratio(&pairs(counted)),
            edge_ratio: ratio(&pairs(&|r| Some(r.edge as f64))),
            inapplicable: method.inapplicable,
            not_met: rows().filter(|r| r.needed.is_some_and(|n| !n.met)).count() as u64,
            samples: exact(&method)
                .then(|| sum(method, &|r| r.samples.unwrap_or(0)) as f64 / common.len().max(1) as f64),
            texels: quartiles(
                rows().filter_map(|r| r.needed).map(|n| if n.met { n.texels as f64 } else { f64::INFINITY }),
            ),
            solve_seconds: method.per_light.iter().map(|r| r.solve_seconds).sum::<f64>() / compared,
            seconds: method.seconds,
            predicted: correlation(rows(), |r| r.predicted),
            unsaturated: correlation(rows(), |r| r.predicted_unsaturated),
        }
    };
    Summary {
        common: common.len() as u64,
        skipped: skipped as u64,
        reference: methods.get(reference).map(|m| m.method.clone()).unwrap_or_default(),
        methods: methods.iter().map(summary_of).collect(),
        worst: methods.iter().map(|m| worst(m, methods, &common)).collect(),
    }
}

fn ratio(pairs: &[(f64, f64)]) -> Ratio {
    // A light without a wrong pixel by either method says nothing of their ratio; one without by the reference alone is
    // infinitely worse.
    let own = pairs.iter().filter(|(a, b)| *a > 0.0 || *b > 0.0).map(|(a, b)| a / b);
    Ratio { of_sums: ratio_of_sums(pairs), interval: interval(pairs), quartiles: quartiles(own) }
}

/// Quartiles with the median between them; `None` where one is not finite.
fn quartiles(values: impl Iterator<Item = f64>) -> Option<[f64; 3]> {
    let mut values: Vec<f64> = values.collect();
    let mut at = |q: f64| quantile(&mut values, q).filter(|v| v.is_finite());
    Some([at(0.25)?, at(0.5)?, at(0.75)?])
}

fn correlation<'a>(
    rows: impl Iterator<Item = &'a Measured>,
    predicted: impl Fn(&Measured) -> Option<f64>,
) -> Correlation {
    let pairs: Vec<(f64, f64)> = rows.filter_map(|r| Some((predicted(r)?, r.misclassified as f64))).collect();
    let logs: Vec<(f64, f64)> =
        pairs.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
    Correlation { slope: slope(&pairs), r: pearson(&pairs), r_log: pearson(&logs) }
}

/// The worst tenth of the common lights by one method; ties by order.
fn worst(by: &MethodRows, methods: &[MethodRows], common: &[usize]) -> Worst {
    let count = |m: &MethodRows, i: usize| m.per_light[i].measured.as_ref().map_or(0, |r| r.misclassified);
    let mut ranked = common.to_vec();
    ranked.sort_by_key(|i| std::cmp::Reverse(count(by, *i)));
    ranked.truncate((common.len() as f64 * WORST).ceil() as usize);
    let mean = |m: &MethodRows| ranked.iter().map(|i| count(m, *i)).sum::<u64>() as f64 / ranked.len().max(1) as f64;
    Worst { by: by.method.clone(), lights: ranked.len() as u64, misclassified: methods.iter().map(mean).collect() }
}
