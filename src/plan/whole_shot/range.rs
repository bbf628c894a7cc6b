//! What a segment's depth row has to hold: receivers and casters of all its frames.

use super::super::stage::Stages;
use super::super::{PlanError, Watch};
use super::held::Held;
use crate::depth::Kept;
use crate::resolution::JudgedMap;
use crate::shot::{LightParts, carry};
use glam::DVec4;

/// Finds the depth rows of segments, and what moves in their maps. The inner error is the reason why there is no row.
pub(super) fn find(
    stages: &Stages,
    light: &LightParts,
    held: &mut [Held],
    watch: &Watch,
) -> Result<Result<(), String>, PlanError> {
    for held in held.iter_mut() {
        let mut kept: Vec<Vec<DVec4>> = vec![Vec::new(); held.fitted.regions.len()];
        for &frame in &held.segment.needing {
            watch.check()?;
            let found = stages.film(frame, |stage, scene| {
                let Some(here) = scene.lights.iter().find(|l| l.name == light.light.name) else { return Ok(false) };
                let motion = carry(&light.poses[frame], &light.poses[0]);
                let mut regions = Vec::with_capacity(held.fitted.regions.len());
                for region in &held.fitted.regions {
                    let carried = motion.as_ref().map_or_else(|| Some(region.clone()), |m| region.carried(m));
                    let Some(carried) = carried else { return Ok(false) };
                    regions.push(carried);
                }
                let visible = stage.visible(here);
                for (kept, region) in kept.iter_mut().zip(&regions) {
                    kept.extend(stage.kept(region, &visible, here, stages.job).extremes());
                }
                held.contents.insert(frame, stage.content(&regions));
                Ok(true)
            })?;
            if !found {
                return Ok(Err("the domain of one of its maps does not move with the light".to_owned()));
            }
        }
        held.maps.clear();
        for (region, kept) in held.fitted.regions.iter().zip(kept) {
            let kept = Kept::of_points(&region.space, &region.h, kept);
            match JudgedMap::holding(region.clone(), &kept) {
                Ok(map) => held.maps.push(map),
                Err(reason) => return Ok(Err(reason.to_string())),
            }
        }
    }
    Ok(Ok(()))
}
