//! Frames of a planned shot as a renderer would show them, with what flickers.

use super::super::make::load_shot;
use super::super::remeasure::{Before, Remeasured, Seeing, remeasure};
use super::super::stage::Posed;
use super::super::{Plan, PlanError, Stage, Watch};
use super::film::Film;
use crate::job::LoadedJob;
use crate::measure::{LightThenNow, Receivers, flickering};
use crate::picture::{Colour, Picture};
use crate::visibility::{Bvh, RayOffset, see};

/// A pixel whose answer changes since the frame before although the exact answer does not.
const FLICKERS: Colour = [255, 32, 32];

/// The first frames of a plan, at most `most`: all lights with the shadows that their maps answer, and in red the pixels that
/// flicker in any of them since the frame before.
///
/// # Errors
/// As [`super::super::make`].
pub fn strip(loaded: &LoadedJob, plan: &Plan, most: usize, watch: &Watch) -> Result<Vec<Picture>, PlanError> {
    let shot = load_shot(loaded)?;
    let still = Bvh::still(&shot.scene);
    let params = &loaded.job.map;
    let mut before: Option<Before> = None;
    let mut pictures = Vec::new();
    let frames = &plan.frames[..plan.frames.len().min(most)];
    for planned in frames {
        watch.step(Stage::Flicker, pictures.len() as u64, frames.len() as u64)?;
        let posed = Posed::new(&shot, planned.time_s)?;
        let (tracer, frame) = (posed.tracer(&shot, &still), &posed.frame);
        let view = see(&tracer, &frame.camera, shot.film);
        let offset = RayOffset::for_scene(&tracer);
        let seeing = Seeing { tracer: &tracer, camera: &frame.camera, view: &view, offset };
        let earlier = before.as_ref().map(|b| b.earlier((&shot, &still), &seeing));
        let mut film = Film::new(&seeing);
        let mut marked: Vec<u32> = Vec::new();
        let mut maps = Vec::with_capacity(planned.lights.len());
        for entry in &planned.lights {
            let Some(light) = frame.lights.iter().find(|l| l.name == entry.light) else { continue };
            let measured = remeasure(&seeing, light, &entry.maps, params, None)?;
            if let (Some(before), Some(earlier)) = (&before, &earlier)
                && let Some(maps_then) = before.maps_of(&entry.light)
                && let Some(then) = before.posed.frame.lights.iter().find(|l| l.name == entry.light)
            {
                let tracer = before.posed.tracer(&shot, &still);
                let pair = LightThenNow { then, maps_then, maps_now: &measured.drawn };
                let moment = before.moment(&tracer, shot.film);
                let found = flickering(&moment, earlier, &measured.receivers, &pair, params.outside);
                marked.extend(found.into_iter().map(|i| measured.receivers.pixels[i as usize]));
            }
            let drawn = std::sync::Arc::clone(&measured.drawn);
            film.add(&seeing, light, &entry.light, &as_answered(measured), &[]);
            maps.push((entry.light.clone(), drawn));
        }
        let mut picture = film.shaded();
        for pixel in marked {
            picture.pixels[pixel as usize] = FLICKERS;
        }
        pictures.push(picture);
        before = Some(Before { number: planned.frame, posed, offset, maps, left: None });
    }
    Ok(pictures)
}

/// A light with the answers of its maps in place of the exact ones.
fn as_answered(measured: Remeasured) -> Remeasured {
    let mut shadowed = measured.receivers.shadowed;
    for i in &measured.wrong {
        shadowed[*i as usize] = !shadowed[*i as usize];
    }
    let receivers = Receivers { shadowed, ..measured.receivers };
    Remeasured { receivers, wrong: Vec::new(), uncertain: Vec::new(), ..measured }
}
