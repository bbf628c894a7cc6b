//! Several maps: what is covered is split by planes where that lowers the error at equal texels the most (math note §6).
//!
//! A part whose own fit costs c at a budget of one texel errs by c / √B with B texels; the best split of a budget then
//! has the error (Σ c_k^(2/3))^(3/2) / √B. So of all parts and all candidate planes the split that lowers Σ c^(2/3)
//! most is made, until there are `solver.maps` parts or no split gains. Candidates are screened on few edges and few
//! covered points; the best few are fitted on all. The two halves of a plane are closed half-spaces with negated
//! coefficients, so no point falls between them, and each map also covers a strip across the plane.
//!
//! Of a whole shot only the hull of the cover is known, seen from the light (`Inputs::hull_only`). What a plane leaves of a
//! hull is known for planes through the light alone, so that only these are candidates then.

mod candidates;
mod halves;

use super::region::Region;
use super::{Inapplicable, Inputs, SolverParams, lixel};
use crate::fit::Effort;
use crate::math::Domain;
use crate::samples::EdgePoint;
use candidates::{Candidate, Frame};
use glam::{DVec3, DVec4};
use halves::{held_edges, held_points};
use rayon::prelude::*;

/// Edges and covered points that candidates are screened on: what a fit of a split costs then differs by a few percent
/// from that on all of them, less than from one candidate to the next.
const SCREENED_EDGES: usize = 1000;
const SCREENED_COVER: usize = 1500;
/// Candidates that are fitted on everything.
const FINALISTS: usize = 3;
/// Steps by which the best candidate is moved and turned, relative to the part's extent.
const STEPS: [f64; 2] = [0.06, 0.025];
/// Least relative gain in Σ c^(2/3) that is worth a map.
const GAIN_MIN: f64 = 0.01;
/// Width of the strip across a plane that both maps cover, relative to the scene: f32 lookups of its points differ by
/// less, and a texel is wider.
const STRIP: f64 = 1e-6;

/// A part of what is covered.
struct Part {
    /// Half-spaces plane·(point, 1) ≥ 0, normals of unit length.
    planes: Vec<DVec4>,
    edges: Vec<EdgePoint>,
    covered: Vec<DVec3>,
    region: Region,
    /// c^(2/3).
    worth: f64,
}

/// Solves one cover that fits a half-space: of a light among the geometry, each cube face gets so many maps.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Vec<Region>, Inapplicable> {
    let region = lixel::solve(inputs, axis)?;
    let most = inputs.solver.maps as usize;
    let (edges, covered) = (inputs.edges.to_vec(), inputs.covered.to_vec());
    let mut parts = vec![Part { planes: Vec::new(), edges, covered, worth: worth(inputs, &region), region }];
    let mut splits: Vec<Option<[Part; 2]>> = Vec::new();
    while parts.len() < most {
        for part in &parts[splits.len()..] {
            splits.push(best_split(inputs, part));
        }
        let total: f64 = parts.iter().map(|p| p.worth).sum();
        let gain = |k: usize| {
            splits[k].as_ref().map_or(0.0, |halves| parts[k].worth - halves.iter().map(|h| h.worth).sum::<f64>())
        };
        let best = (0..parts.len()).fold(0, |best, k| if gain(k) > gain(best) { k } else { best });
        if gain(best) <= GAIN_MIN * total {
            break;
        }
        let Some(halves) = splits.remove(best) else { break };
        parts.remove(best);
        parts.extend(halves);
    }
    Ok(parts.into_iter().map(Part::finished).collect())
}

impl Part {
    fn finished(self) -> Region {
        let mut all: Vec<Domain> = self.planes.into_iter().map(|plane| Domain::HalfSpace { plane }).collect();
        let domain = match all.len() {
            0 => Domain::All,
            1 => all.swap_remove(0),
            _ => Domain::Intersection(all),
        };
        Region { domain, ..self.region }
    }
}

/// c^(2/3) of a region, c measured where it will work: at an even share of the texels, saturation included.
fn worth(inputs: &Inputs, region: &Region) -> f64 {
    let texels = inputs.texels / f64::from(inputs.solver.maps.max(1));
    (region.predict(texels).misclassified * texels.sqrt()).powf(2.0 / 3.0)
}

/// The split of a part with the least Σ c^(2/3); `None` when no plane separates it.
fn best_split(inputs: &Inputs, part: &Part) -> Option<[Part; 2]> {
    let frame = Frame::new(inputs, &part.region);
    let edges = thinned(&part.edges, SCREENED_EDGES, |e, scale| EdgePoint { length_px: e.length_px * scale, ..*e });
    let covered = match inputs.hull_only {
        true => part.covered.clone(),
        false => thinned(&part.covered, SCREENED_COVER, |p, _| *p),
    };
    let rough = SolverParams { effort: Effort::Local, rounds: inputs.solver.rounds.min(2), ..inputs.solver.clone() };
    let screen = Inputs { edges: &edges, covered: &covered, solver: &rough, ..*inputs };
    let score = |candidate: Candidate| {
        let plane = frame.plane(candidate)?;
        let halves = [plane, -plane].map(|side| {
            let edges = held_edges(&edges, side);
            let covered = held_points(&screen, &part.region.space, &covered, side, 0.0);
            let half = Inputs { edges: &edges, covered: &covered, ..screen };
            (!covered.is_empty()).then(|| lixel::solve(&half, None).ok()).flatten()
        });
        let [Some(a), Some(b)] = halves else { return None };
        let sum = worth(&screen, &a) + worth(&screen, &b);
        sum.is_finite().then_some(sum)
    };
    let ranked = |candidates: Vec<Candidate>| {
        let mut scored: Vec<(f64, Candidate)> =
            candidates.into_par_iter().filter_map(|c| Some((score(c)?, c))).collect();
        scored.sort_by(|a, b| a.0.total_cmp(&b.0));
        scored
    };
    let texels = inputs.texels / f64::from(inputs.solver.maps.max(1));
    let costs = part.region.costs_at(&edges, texels);
    let mut best = ranked(frame.candidates(&edges, &costs));
    for step in STEPS {
        let near = best.iter().take(FINALISTS).flat_map(|(_, c)| frame.around(*c, &edges, step)).collect();
        best.extend(ranked(near));
        best.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    let mut found: Option<[Part; 2]> = None;
    for (_, candidate) in best.into_iter().take(FINALISTS) {
        let Some(plane) = frame.plane(candidate) else { continue };
        let halves = [half(inputs, part, plane), half(inputs, part, -plane)];
        let [Some(a), Some(b)] = halves else { continue };
        let sum = |h: &[Part; 2]| h[0].worth + h[1].worth;
        let halves = [a, b];
        if found.as_ref().is_none_or(|f| sum(&halves) < sum(f)) {
            found = Some(halves);
        }
    }
    found
}

/// One half of a part, fitted on all of its own. `None` also where rounding drops a covered point: seen through a strong warp
/// the border that is left free may be thinner than what a hull is simplified by.
fn half(inputs: &Inputs, part: &Part, plane: DVec4) -> Option<Part> {
    let edges = held_edges(&part.edges, plane);
    let strip_m = STRIP * inputs.bounds.diagonal();
    let covered = held_points(inputs, &part.region.space, &part.covered, plane, strip_m);
    if covered.is_empty() {
        return None;
    }
    let texels = inputs.texels / f64::from(inputs.solver.maps.max(1));
    let own = Inputs { edges: &edges, covered: &covered, texels, ..*inputs };
    let region = lixel::solve(&own, None).ok().filter(|region| covered.iter().all(|p| region.contains(*p)))?;
    let planes = part.planes.iter().copied().chain([plane]).collect();
    Some(Part { planes, worth: worth(inputs, &region), edges, covered, region })
}

/// At most `count` evenly spread items; `keep` gets the number of items that each stands for.
fn thinned<T>(items: &[T], count: usize, keep: impl Fn(&T, f64) -> T) -> Vec<T> {
    let count = items.len().min(count);
    let scale = items.len() as f64 / count.max(1) as f64;
    (0..count).map(|k| keep(&items[k * items.len() / count], scale)).collect()
}
