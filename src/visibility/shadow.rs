//! Does a light reach a surface?

use glam::DVec3;

use super::surface::Surface;
use super::trace::Tracer;
use crate::scene::{Light, LightKind};

/// What a light does to a surface point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Answer {
    /// No question for a shadow map: background, facing away, outside the cone or the range.
    #[default]
    Unlit = 0,
    /// Facing the light, nothing in between.
    Lit = 1,
    /// Facing the light, something in between.
    Shadowed = 2,
}

/// How far along its normal a surface point is lifted before a shadow ray leaves it, so that rounding does not let the
/// surface shadow itself.
///
/// With u = 2⁻²⁴ and M the largest coordinate of the scene rounded up to a power of two, the errors across a plane, in
/// units of u M: the lifted origin as f32 1, and in the watertight test vertex minus origin 2, shear 8, weighted depth 12
/// (worked out in the kernel); 23 in all. Lifted by 32, a point has its own triangle, and every other one in the same
/// plane, behind it. The position itself is found in f64 and adds nothing. M is a power of two so that the offset stays
/// put when a moving thing stretches the scene a little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayOffset {
    /// Metres along the normal.
    pub metres: f64,
}

/// 32 u = 2⁻¹⁹ of the largest coordinate; derived at [`RayOffset`].
const OFFSET_PER_COORDINATE: f64 = 1.0 / (1u32 << 19) as f64;

/// Multiple of the offset under which an answer must stay the same to be certain.
pub const UNCERTAIN_MULTIPLE: f64 = 16.0;

impl RayOffset {
    /// The offset for a frame; zero without triangles.
    pub fn for_scene(tracer: &Tracer) -> RayOffset {
        let largest = tracer.bounds().map_or(0.0, |[low, high]| low.abs().max(high.abs()).max_element());
        let metres = if largest > 0.0 { largest.log2().ceil().exp2() * OFFSET_PER_COORDINATE } else { 0.0 };
        RayOffset { metres }
    }

    /// The larger offset of the test for certainty.
    pub fn uncertain(self) -> RayOffset {
        RayOffset { metres: self.metres * UNCERTAIN_MULTIPLE }
    }
}

/// A surface within this angle of edge-on to the light has no certain answer, degrees: normals of a scanned or tessellated
/// surface are no truer.
pub const EDGE_ON_DEGREES: f64 = 1.0;

/// Whether a surface lies within [`EDGE_ON_DEGREES`] of edge-on to a light, or faces away.
pub fn edge_on(surface: &Surface, light: &Light) -> bool {
    edge_on_at(surface.position, surface.normal, light)
}

/// The same for a plane through a position with a unit normal.
pub fn edge_on_at(position: DVec3, normal: DVec3, light: &Light) -> bool {
    normal.dot(light.towards(position).normalize()) < EDGE_ON_DEGREES.to_radians().sin()
}

/// Whether a light reaches a surface. Both sides of triangles shadow. The ray runs to the light's position less the
/// offset, so that a surface that carries the light does not shadow it; for a directional light it has no end.
pub fn answer(tracer: &Tracer, surface: &Surface, light: &Light, offset: RayOffset) -> Answer {
    let towards = light.towards(surface.position);
    if !(surface.normal.dot(towards) > 0.0 && light.reaches(surface.position)) {
        return Answer::Unlit;
    }
    let origin: DVec3 = surface.position + surface.normal * offset.metres;
    let towards = light.towards(origin);
    let distance = towards.length();
    let t_max = match light.kind {
        LightKind::Directional { .. } => f64::INFINITY,
        LightKind::Point { .. } | LightKind::Spot { .. } => 1.0 - offset.metres / distance,
    };
    if tracer.occluded(origin, towards, 0.0, t_max) { Answer::Shadowed } else { Answer::Lit }
}
