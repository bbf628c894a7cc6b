//! Where, between two film positions, the shadow answer changes: bisection with exact rays.
//!
//! A change of answer is a *shadow edge* when both sides lie on one continuous surface, else a *discontinuity* of depth,
//! which no shadow map can misplace. The two are told apart by the surfaces: after bisection the two sides either share
//! a triangle, or their planes cross between the two rays (a crease), or they do not meet (a discontinuity).

use crate::scene::{Camera, Film, Light};
use crate::visibility::{Answer, RayOffset, Surface, Tracer, answer, surface_at};

/// What changes at a crossing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrossingKind {
    /// Lit and shadowed parts of one continuous surface meet.
    ShadowEdge,
    /// The surface ends here.
    Discontinuity,
}

/// A change of answer between two film positions.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Film position, pixels.
    pub film: [f64; 2],
    /// What changes.
    pub kind: CrossingKind,
    /// The last position on the shadowed side.
    pub shadowed: Surface,
    /// The last position on the other side; `None` for the background.
    pub other: Option<Surface>,
    /// The other side faces the light and is lit.
    pub other_lit: bool,
}

/// Rays and light of one search.
#[derive(Clone, Copy)]
pub(super) struct Seeker<'a> {
    pub(super) tracer: &'a Tracer<'a>,
    pub(super) camera: &'a Camera,
    pub(super) film: Film,
    pub(super) light: &'a Light,
    pub(super) offset: RayOffset,
}

/// Planes that differ by less than this part of the depth, on both rays, are one surface: f32 vertices place a plane no
/// better.
const SAME_PLANE: f64 = 1.0 / (1u32 << 20) as f64;

type Side = ([f64; 2], Option<Surface>, Answer);

impl Seeker<'_> {
    fn look(&self, [x, y]: [f64; 2]) -> Side {
        let surface = surface_at(self.tracer, self.camera, self.film, x, y);
        let answer = surface.map_or(Answer::Unlit, |s| answer(self.tracer, &s, self.light, self.offset));
        ([x, y], surface, answer)
    }

    /// Bisects between a shadowed side and one that is not, `steps` times.
    pub(super) fn bisect(&self, shadowed: Side, other: Side, steps: u32) -> Option<Crossing> {
        let (mut inside, mut outside) = (shadowed, other);
        for _ in 0..steps {
            let middle = self.look([(inside.0[0] + outside.0[0]) * 0.5, (inside.0[1] + outside.0[1]) * 0.5]);
            if middle.2 == Answer::Shadowed { inside = middle } else { outside = middle }
        }
        let surface = inside.1?;
        let edge =
            outside.2 == Answer::Lit && outside.1.is_some_and(|o| self.one_surface(&surface, inside.0, &o, outside.0));
        let kind = if edge { CrossingKind::ShadowEdge } else { CrossingKind::Discontinuity };
        let film = [(inside.0[0] + outside.0[0]) * 0.5, (inside.0[1] + outside.0[1]) * 0.5];
        let other_lit = outside.2 == Answer::Lit;
        Some(Crossing { film, kind, shadowed: surface, other: outside.1, other_lit })
    }

    /// Whether two neighbouring surfaces meet between their rays.
    fn one_surface(&self, a: &Surface, film_a: [f64; 2], b: &Surface, film_b: [f64; 2]) -> bool {
        if a.triangle == b.triangle {
            return true;
        }
        let behind_on_a = self.plane_depth(b, film_a) - a.depth_m;
        let behind_on_b = b.depth_m - self.plane_depth(a, film_b);
        let tolerance = SAME_PLANE * a.depth_m.max(b.depth_m);
        behind_on_a * behind_on_b <= 0.0 || (behind_on_a.abs() <= tolerance && behind_on_b.abs() <= tolerance)
    }

    /// Depth at which a film position's ray meets the plane of a surface.
    fn plane_depth(&self, surface: &Surface, [x, y]: [f64; 2]) -> f64 {
        let (origin, direction) = self.camera.ray(self.film, x, y);
        surface.normal.dot(surface.position - origin) / surface.normal.dot(direction)
    }
}
