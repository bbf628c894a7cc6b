//! The matrix of a region: its map, ready to be drawn at any size.

use crate::depth::{DepthError, DepthRow, Kept, RowKind, Visible, fit_row};
use crate::fit::Shape;
use crate::math::first_holding;
use crate::measure::Undrawn;
use crate::methods::Region;
use crate::visibility::Tracer;
use glam::{DMat4, DVec3, DVec4};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A region's matrix.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct JudgedMap {
    /// The region.
    pub region: Region,
    /// OpenGL clip space from scene space.
    pub clip_from_scene: DMat4,
    /// Its depth row and range.
    pub depth: DepthRow,
}

impl JudgedMap {
    /// The matrices of all regions of a light; each receiver counts for the region that answers for it.
    ///
    /// # Errors
    /// [`DepthError`]: nothing visible looks a map up, or it has no finite depth row.
    pub fn of_all(regions: &[Region], tracer: &Tracer, receivers: &[DVec3]) -> Result<Vec<JudgedMap>, DepthError> {
        JudgedMap::of_all_by(regions, receivers, |region, own| JudgedMap::kept(region, tracer, &Visible::new(own)))
    }

    /// The same, with what a region keeps, given the receivers it answers for, found by the caller.
    ///
    /// # Errors
    /// As [`JudgedMap::of_all`].
    pub fn of_all_by<'a>(
        regions: &[Region],
        receivers: &[DVec3],
        kept: impl Fn(&Region, &[DVec3]) -> Kept<'a> + Sync,
    ) -> Result<Vec<JudgedMap>, DepthError> {
        if let [region] = regions {
            return Ok(vec![JudgedMap::holding(region.clone(), &kept(region, receivers))?]);
        }
        let mut own = vec![Vec::new(); regions.len()];
        let answering = |point: &DVec3| first_holding(regions.iter().map(|r| &r.domain), *point);
        let answering: Vec<Option<usize>> = receivers.par_iter().map(answering).collect();
        for (point, region) in receivers.iter().zip(answering) {
            if let Some(k) = region {
                own[k].push(*point);
            }
        }
        let map = |(region, own): (&Region, Vec<DVec3>)| JudgedMap::holding(region.clone(), &kept(region, &own));
        let maps: Vec<Result<JudgedMap, DepthError>> = regions.par_iter().zip(own).map(map).collect();
        // The first reason, whichever came first.
        maps.into_iter().collect()
    }

    /// The matrix of a region with the depth row that holds what is visible and its casters.
    ///
    /// # Errors
    /// [`DepthError`]: nothing visible looks the map up, or it has no finite depth row.
    pub fn new(region: Region, tracer: &Tracer, visible: &Visible) -> Result<JudgedMap, DepthError> {
        let kept = JudgedMap::kept(&region, tracer, visible);
        JudgedMap::holding(region, &kept)
    }

    /// What a region's depth range has to hold: those of the visible points that look it up, and their casters.
    pub fn kept<'a>(region: &Region, tracer: &'a Tracer<'a>, visible: &Visible) -> Kept<'a> {
        Kept::new(tracer, &region.space, &region.h, visible, &region.domain)
    }

    /// The matrix of a region with the depth row that holds what is kept.
    ///
    /// # Errors
    /// [`DepthError`]: nothing is kept, or it has no finite row.
    pub fn holding(region: Region, kept: &Kept) -> Result<JudgedMap, DepthError> {
        let depth = fit_row(kept, row_kind(&region))?;
        Ok(JudgedMap { clip_from_scene: clip_from_scene(&region, depth.row), region, depth })
    }
}

/// Maps at sizes, to be looked up by rays.
pub(super) fn undrawn<'a>(maps: &'a [JudgedMap], sizes: &[[u32; 2]]) -> Vec<Undrawn<'a>> {
    let at = |(map, &size): (&'a JudgedMap, &[u32; 2])| Undrawn {
        domain: &map.region.domain,
        clip_from_scene: &map.clip_from_scene,
        size,
    };
    maps.iter().zip(sizes).map(at).collect()
}

/// Which depth rows a region may have. A camera's: for directional lights when p4 is constant, that is without a warp; for
/// point and spot lights wherever the job asks for cameras, and else unless that costs depth.
fn row_kind(region: &Region) -> RowKind {
    let p4 = region.h.row(2);
    match (region.space.directional, region.shape()) {
        (true, _) if p4.x == 0.0 && p4.y == 0.0 => RowKind::Plain,
        (true, _) => RowKind::Free,
        (false, Shape::Projective) => RowKind::PlainIfFine,
        (false, Shape::Affine | Shape::Rectangle) => RowKind::Plain,
    }
}

/// The light matrix of a region: its unit square becomes clip space [-1, 1]².
fn clip_from_scene(region: &Region, depth_row: DVec4) -> DMat4 {
    let unit = region.space.clip_from_scene(&region.h, depth_row);
    let clip_from_unit = DMat4::from_cols(
        DVec4::new(2.0, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 2.0, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0, 0.0),
        DVec4::new(-1.0, -1.0, 0.0, 1.0),
    );
    clip_from_unit * unit
}
