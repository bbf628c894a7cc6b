//! Frame by frame with the last frame's matrix kept while it serves (SOSM, step 5).
//!
//! "We consider a substantial improvement to be when the median value of Σ (dx/du)² taken over the screen is less than 80 %
//! from that measured using the previous frame's P. Of course the previous frame's P must include the necessary new scale
//! and shift to ensure that the shadow map includes all of the currently relevant samples." The early draft leaves a border
//! besides, and keeps the matrix as it is for as long as everything stays within: `shot.hysteresis_border`.
//!
//! The median is taken over shadow-edge samples, thinned as in a part. Matrices are not chosen by measurement here: that
//! would change them every frame. The frames are gone through in order, from what each was fitted to by itself.

use super::super::pieces::FrameLight;
use crate::math::RigidMotion;
use crate::methods::Region;
use crate::resolution::FittedLight;
use crate::samples::EdgePoint;
use crate::scene::Light;
use crate::shot::{TemporalParams, carry, in_frame, light_poses};
use glam::DVec3;

/// Least border, part of a map's side: rounding, and film pixels at the very border.
const BORDER_MIN: f64 = 1e-4;

/// The regions of the last frame of a light that had maps.
#[derive(Clone)]
struct Last {
    light: Light,
    regions: Vec<Region>,
    shares: Vec<f64>,
}

/// Chooses the regions of one light in its frames, in order: `fresh` becomes what is held.
pub(in crate::plan) fn choose<'a>(frames: impl Iterator<Item = &'a mut FrameLight>, params: &TemporalParams) {
    let mut last: Option<Last> = None;
    for frame in frames {
        let (Some(fresh), Some(part)) = (frame.fresh.take(), &frame.part) else { continue };
        let border = params.hysteresis_border;
        let kept = last.as_ref().and_then(|b| kept(b, &frame.light, &fresh, border, &part.edges));
        let chosen = match kept {
            Some(kept) if !much_better(&fresh, &kept, &part.edges, params.hysteresis) => kept,
            _ => bordered(fresh, border),
        };
        let (regions, shares) = (chosen.regions.clone(), chosen.shares.clone());
        last = Some(Last { light: frame.light.clone(), regions, shares });
        frame.fresh = Some(chosen);
    }
}

/// The last regions, made to hold what this frame has to cover; `None` when they cannot, or split the light otherwise.
fn kept(last: &Last, light: &Light, fresh: &FittedLight, border: f64, edges: &[EdgePoint]) -> Option<FittedLight> {
    let poses = light_poses([&last.light, light]);
    let motion: Option<RigidMotion> = carry(&poses[1], &poses[0]);
    let carried = |r: &Region| motion.as_ref().map_or_else(|| Some(r.clone()), |m| r.carried(m));
    let regions: Vec<Region> = last.regions.iter().map(carried).collect::<Option<_>>()?;
    let same =
        regions.len() == fresh.regions.len() && regions.iter().zip(&fresh.regions).all(|(a, b)| a.domain == b.domain);
    if !same {
        return None;
    }
    let held = (0..regions.len()).map(|i| holding(&regions, i, &fresh.covered, border, false));
    let regions = in_frame(&held.collect::<Option<Vec<_>>>()?, edges);
    Some(FittedLight { regions, shares: last.shares.clone(), ..fresh.clone() })
}

/// A region scaled and shifted to hold its share of some points; with a border it stays as it is while they lie inside.
fn holding(regions: &[Region], i: usize, covered: &[DVec3], border: f64, anew: bool) -> Option<Region> {
    let of_region = |p: &&DVec3| regions.iter().position(|r| r.domain.holds(**p)) == Some(i);
    let points: Vec<DVec3> = covered.iter().filter(of_region).copied().collect();
    let region = &regions[i];
    let stays = !anew && border > 0.0 && points.iter().all(|p| region.contains(*p));
    if stays || points.is_empty() { Some(region.clone()) } else { region.rescaled(&points, border.max(BORDER_MIN)) }
}

/// New regions with the border around what they have to hold.
fn bordered(fresh: FittedLight, border: f64) -> FittedLight {
    if border == 0.0 {
        return fresh;
    }
    let held = (0..fresh.regions.len()).map(|i| holding(&fresh.regions, i, &fresh.covered, border, true));
    match held.collect::<Option<Vec<_>>>() {
        Some(regions) => FittedLight { regions, ..fresh },
        None => fresh,
    }
}

/// Whether the median of Σ (dx/du)² under new regions is below `part` of that under the kept ones, at equal texels.
fn much_better(fresh: &FittedLight, kept: &FittedLight, edges: &[EdgePoint], part: f64) -> bool {
    let median = |fitted: &FittedLight| {
        let regions = in_frame(&fitted.regions, edges);
        let of = regions.iter().zip(&fitted.shares).flat_map(|(r, share)| r.footprints(fresh.texels * share));
        let mut squares: Vec<f64> = of.map(|(footprint, _)| footprint * footprint).collect();
        squares.sort_by(f64::total_cmp);
        squares.get(squares.len() / 2).copied()
    };
    match (median(fresh), median(kept)) {
        (Some(fresh), Some(kept)) => fresh < part * kept,
        _ => false,
    }
}
