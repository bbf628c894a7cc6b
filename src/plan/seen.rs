//! The visible points of a light that its maps' entries speak of: bias in other units, witnesses, rounding.

use crate::measure::Receivers;
pub(super) use crate::measure::Seen;
use crate::scene::Camera;
use crate::visibility::{Surface, Tracer, View};
use glam::{DMat4, DVec2, DVec3};

/// Most visible points kept of a light in a frame: enough for extremes, and a small part of what planning a light takes.
const SEEN_MAX: usize = 4096;

/// The pixels of a light, evenly thinned.
pub(super) fn seen_on_film(tracer: &Tracer, view: &View, camera: &Camera, film: &Receivers) -> Vec<Seen> {
    seen_by(film, |pixel| view.surface(tracer, camera, pixel))
}

/// The same with the surface of a pixel from elsewhere.
pub(super) fn seen_by(film: &Receivers, surface_of: impl Fn(usize) -> Option<Surface>) -> Vec<Seen> {
    let stride = film.len().div_ceil(SEEN_MAX).max(1);
    let point = |i: usize| {
        let surface = surface_of(film.pixels[i] as usize)?;
        Some(film.seen(i, surface.normal))
    };
    (0..film.len()).step_by(stride).filter_map(point).collect()
}

/// Those that look a map up. `answers` says whether this is the map that a point looks up.
pub(super) fn looking_up(clip_from_scene: &DMat4, seen: &[Seen], answers: impl Fn(DVec3) -> bool) -> Vec<Seen> {
    let looks_up =
        |s: &&Seen| answers(s.position) && uv_of(clip_from_scene, s.position).is_some_and(|(uv, _)| in_unit(uv));
    seen.iter().filter(looks_up).copied().collect()
}

/// Map coordinates in [0, 1] and window depth; `None` behind the light.
pub(super) fn uv_of(clip_from_scene: &DMat4, point: DVec3) -> Option<(DVec2, f64)> {
    let clip = *clip_from_scene * point.extend(1.0);
    (clip.w > 0.0).then(|| {
        let ndc = clip.truncate() / clip.w * 0.5 + 0.5;
        (ndc.truncate(), ndc.z)
    })
}

/// Whether map coordinates lie in a map, as renderers test it.
pub(super) fn in_unit(uv: DVec2) -> bool {
    uv.cmpge(DVec2::ZERO).all() && uv.cmplt(DVec2::ONE).all()
}
