//! The depth rows of a segment: over the reach and the cover of all its frames.

use super::held::Held;
use crate::depth::Kept;
use crate::math::first_holding;
use crate::methods::Region;
use crate::resolution::JudgedMap;
use crate::shot::LightParts;
use glam::DVec3;

/// Finds the depth rows of a segment.
///
/// # Errors
/// The reason why there is none.
pub(super) fn find(light: &LightParts, held: &mut Held) -> Result<(), String> {
    let regions = &held.fitted.regions;
    let parts = || held.segment.needing.iter().map(|frame| &light.parts[*frame]);
    let ends: Vec<DVec3> = parts().flat_map(|p| p.reach.iter().copied()).collect();
    let cover: Vec<DVec3> = parts().flat_map(|p| p.cover.iter().copied()).collect();
    let row = |(k, region): (usize, &Region)| {
        let own: Vec<DVec3> =
            cover.iter().copied().filter(|p| first_holding(regions.iter().map(|r| &r.domain), *p) == Some(k)).collect();
        // The ends of tiles are cut at the square, which is about what the domain holds.
        let kept = Kept::of_reach(&region.space, &region.h, &ends, &own);
        JudgedMap::holding(region.clone(), &kept).map_err(|reason| reason.to_string())
    };
    held.maps = regions.iter().enumerate().map(row).collect::<Result<_, _>>()?;
    Ok(())
}
