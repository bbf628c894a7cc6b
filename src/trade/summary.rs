//! From single runs to what a point costs and buys.

use super::price::Price;
use super::sweep::{PRESETS, Point};
use super::{CaseResult, PointResult, PresetResult, Rank, Trade, TradeCase, front, place};
use crate::compare::quantile;
use crate::job::Preset;

/// What was timed and judged, as it comes in.
pub(super) struct Runs {
    /// Lights of frames.
    pub(super) cases: Vec<TradeCase>,
    /// By point, then by case.
    points: Vec<Vec<OfCase>>,
}

/// One point on one case.
struct OfCase {
    seconds: Vec<f64>,
    judged: Option<(Price, u64)>,
}

impl Runs {
    /// Nothing yet, for so many points.
    pub(super) fn new(points: usize) -> Runs {
        Runs { cases: Vec::new(), points: (0..points).map(|_| Vec::new()).collect() }
    }

    /// A run of a point on a case; the first one of the two is judged.
    pub(super) fn add(&mut self, point: usize, case: usize, seconds: f64, judged: Option<(Price, u64)>) {
        let cases = &mut self.points[point];
        while cases.len() <= case {
            cases.push(OfCase { seconds: Vec::new(), judged: None });
        }
        cases[case].seconds.push(seconds);
        cases[case].judged = cases[case].judged.take().or(judged);
    }
}

/// Figures of all points, the front and the places of the presets. `least` is what the smallest map has, texels.
pub(super) fn summarise(
    points: Vec<Point>,
    runs: Runs,
    (pixels, epsilon): (u64, f64),
    (threads, repeat): (usize, u32),
    least: u64,
) -> Trade {
    let Runs { cases, points: rows } = runs;
    let mut results: Vec<PointResult> =
        points.into_iter().zip(rows).map(|(point, rows)| result(point, rows, &cases, least)).collect();
    let wrong = results.iter().find(|r| r.point.preset == Some(Preset::Thorough)).map_or(0, |r| r.misclassified);
    for result in &mut results {
        result.excess_misclassified = (result.misclassified.max(1) as f64 / wrong.max(1) as f64) - 1.0;
    }
    let ranks: Vec<Rank> = results.iter().map(PointResult::rank).collect();
    let presets = PRESETS.iter().filter_map(|preset| {
        let k = results.iter().position(|r| r.point.preset == Some(*preset))?;
        let at = place(&ranks, k)?;
        Some(PresetResult {
            preset: *preset,
            seconds: results[k].seconds,
            excess_texels: results[k].excess_texels,
            excess_over_front: at.excess,
            time_over_front: at.slower,
            front_point: results[at.below].point.name.clone(),
        })
    });
    Trade {
        pixels,
        epsilon,
        threads,
        repeat,
        front: front(&ranks).into_iter().map(|k| results[k].point.name.clone()).collect(),
        presets: presets.collect(),
        cases,
        points: results,
    }
}

/// Figures of one point, but for the excess of wrong pixels.
fn result(point: Point, rows: Vec<OfCase>, cases: &[TradeCase], least: u64) -> PointResult {
    let measure = point.settings.get("quality").and_then(|q| q.get("measure"));
    let measures = measure.is_none_or(|m| m.as_str() != Some("never"));
    let mut found = PointResult {
        point,
        seconds: 0.0,
        misclassified: 0,
        excess_misclassified: 0.0,
        texels_planned: 0,
        texels_needed: 0,
        excess_texels: 0.0,
        never_met: 0,
        said_met: 0,
        truly_met: 0,
        measures,
        cases: Vec::with_capacity(rows.len()),
    };
    let (mut logs, mut compared) = (0.0, 0.0);
    for (mut row, case) in rows.into_iter().zip(cases) {
        let Some((price, misclassified)) = row.judged else { continue };
        let seconds = quantile(&mut row.seconds, 0.5).unwrap_or(0.0);
        let paid = price.planned.max(price.asks_for()).max(least);
        if case.thorough_met {
            logs += (paid as f64 / case.thorough_texels.max(least) as f64).ln();
            compared += 1.0;
            found.never_met += u64::from(price.needed.is_none());
        }
        found.seconds += seconds / cases.len() as f64;
        found.misclassified += misclassified;
        found.texels_planned += price.planned;
        found.texels_needed += price.asks_for();
        found.said_met += u64::from(price.said_met);
        found.truly_met += u64::from(price.said_met && price.truly_met);
        let Price { planned, needed, said_met, truly_met, .. } = price;
        found.cases.push(CaseResult { seconds, planned, needed, price: paid, misclassified, said_met, truly_met });
    }
    if compared > 0.0 {
        found.excess_texels = (logs / compared).exp() - 1.0;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trade::points;

    fn case(texels: u64, met: bool) -> TradeCase {
        TradeCase { frame: 1, light: "sun".into(), facing: 10, thorough_texels: texels, thorough_met: met }
    }

    fn price(planned: u64, needed: Option<u64>) -> Price {
        let truly_met = needed.is_some_and(|n| n <= planned);
        Price { planned, needed, largest: 90_000, said_met: true, truly_met }
    }

    /// Three presets on three cases: the draft plans too little on one and too much on the next; of the third the thorough
    /// preset does not meet its bound.
    fn runs() -> Trade {
        let mut runs = Runs::new(3);
        runs.cases = vec![case(10_000, true), case(40_000, true), case(90_000, false)];
        type Row = (f64, [(u64, Option<u64>); 3]);
        let rows: [Row; 3] = [
            (0.01, [(10_000, Some(20_000)), (80_000, Some(50_000)), (90_000, None)]),
            (0.5, [(10_000, Some(10_000)), (40_000, Some(40_000)), (90_000, None)]),
            (1.0, [(10_000, Some(10_000)), (40_000, Some(40_000)), (90_000, None)]),
        ];
        for (k, (seconds, cases)) in rows.iter().enumerate() {
            for (i, (planned, needed)) in cases.iter().enumerate() {
                runs.add(k, i, *seconds, Some((price(*planned, *needed), 100 * (3 - k as u64))));
                runs.add(k, i, seconds * 5.0, None);
                runs.add(k, i, seconds * 0.5, None);
            }
        }
        summarise(points()[..3].to_vec(), runs, (1000, 0.1), (1, 3), 256)
    }

    #[test]
    fn a_point_pays_for_what_it_plans_too_much_and_what_it_plans_too_little() {
        let trade = runs();
        let [draft, standard, thorough] = &trade.points[..] else { unreachable!() };
        assert!((draft.excess_texels - 1.0).abs() < 1e-12, "twice on each of two lights: {}", draft.excess_texels);
        assert_eq!((standard.excess_texels, thorough.excess_texels), (0.0, 0.0));
        assert_eq!((draft.said_met, draft.truly_met, draft.never_met), (3, 1, 0));
        assert_eq!((draft.seconds, draft.texels_planned, draft.texels_needed), (0.01, 180_000, 160_000));
        assert!((draft.excess_misclassified - 2.0).abs() < 1e-12);
        assert!(!draft.measures && standard.measures);
    }

    #[test]
    fn presets_are_placed_by_texels_and_by_time() {
        let trade = runs();
        assert_eq!(trade.front, ["draft", "standard"]);
        let [draft, standard, thorough] = &trade.presets[..] else { unreachable!() };
        assert_eq!((draft.excess_over_front, draft.time_over_front), (0.0, 0.0));
        assert_eq!((standard.excess_over_front, standard.time_over_front), (0.0, 0.0));
        assert_eq!((thorough.excess_over_front, thorough.time_over_front), (0.0, 1.0));
        assert_eq!(thorough.front_point, "standard");
    }
}
