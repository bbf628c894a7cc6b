//! The depth rows of a segment: over the reach and the cover of all its frames.

use super::held::Held;
use crate::depth::Kept;
use crate::math::first_holding;
use crate::resolution::JudgedMap;
use crate::shot::LightParts;
use glam::DVec3;

/// Finds the depth rows of a segment.
///
/// # Errors
/// The reason why there is none.
pub(super) fn find(light: &LightParts, held: &mut Held) -> Result<(), String> {
    let regions = &held.fitted.regions;
    let of_frame = |frame: &usize| {
        let part = &light.parts[*frame];
        part.reach.iter().chain(&part.cover).copied()
    };
    let mut own: Vec<Vec<DVec3>> = vec![Vec::new(); regions.len()];
    for point in held.segment.needing.iter().flat_map(of_frame) {
        // A corner of a tile may lie outside every domain: it then stands for what is beside it in any of them.
        match first_holding(regions.iter().map(|r| &r.domain), point) {
            Some(k) => own[k].push(point),
            None => own.iter_mut().for_each(|points| points.push(point)),
        }
    }
    let row = |(region, points): (&crate::methods::Region, Vec<DVec3>)| {
        let kept = Kept::of_reach(&region.space, &region.h, points);
        JudgedMap::holding(region.clone(), &kept).map_err(|reason| reason.to_string())
    };
    held.maps = regions.iter().zip(own).map(row).collect::<Result<_, _>>()?;
    Ok(())
}
