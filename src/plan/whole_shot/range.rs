//! What a segment's depth row has to hold: receivers and casters of all its frames.

use super::super::stage::{FrameStage, Stages};
use super::super::{PlanError, Watch};
use super::held::Held;
use crate::depth::{Kept, Visible};
use crate::measure::Receivers;
use crate::resolution::JudgedMap;
use crate::scene::Light;
use crate::shot::{Content, LightParts, carry};
use crate::visibility::Answer;
use glam::{DVec3, DVec4};

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
                let receivers = visible(stage, here);
                let receivers = Visible::new(&receivers);
                for (kept, region) in kept.iter_mut().zip(&regions) {
                    kept.extend(JudgedMap::kept(region, stage.tracer, &receivers).extremes());
                }
                held.contents.insert(frame, Content::in_maps(stage.tracer.geometry(), &regions));
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

/// The points that look a light's maps up: pixels, or planning-grid positions where nothing is measured.
fn visible(stage: &FrameStage, light: &Light) -> Vec<DVec3> {
    match stage.view {
        Some(view) => Receivers::classify(stage.tracer, view, stage.camera, light, stage.offset).positions,
        None => {
            let (tracer, camera) = (stage.tracer, stage.camera);
            let answers = stage.grid.answers(tracer, camera, light, stage.offset);
            let facing = (0..answers.len()).filter(|i| answers[*i] != Answer::Unlit);
            facing.filter_map(|i| stage.grid.surface(tracer, camera, i)).map(|s| s.position).collect()
        }
    }
}
