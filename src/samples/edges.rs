//! The samples of one light by rays: the grid's changes of answer bisected, and put together by [`Changes`].

use super::changes::{Changes, EdgeLook};
use super::crossing::Seeker;
use super::grid::GridView;
use crate::scene::{Camera, Light};
use crate::visibility::{Answer, RayOffset, Tracer, surface_at};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// A piece of shadow edge.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub struct EdgePoint {
    /// Film position of its middle, pixels.
    pub film: [f64; 2],
    /// Scene point seen there.
    pub position: DVec3,
    /// ∂position/∂x and ∂position/∂y, metres per pixel.
    pub derivatives: [DVec3; 2],
    /// Unit normal of the edge on the film, towards the lit side.
    pub normal: DVec2,
    /// Its length, pixels.
    pub length_px: f64,
    /// Distance to the next change of answer across the edge, the nearer side, pixels.
    pub room_px: f64,
    /// Its surface is [`edge_on`](crate::visibility::edge_on) to the light: the exact answers beside it are uncertain.
    pub uncertain: bool,
}

/// What the fit of one light gets of a frame.
#[derive(Clone, Debug, Default)]
pub struct LightSamples {
    /// Pieces of shadow edge.
    pub edges: Vec<EdgePoint>,
    /// Scene points that the map has to hold.
    pub covered: Vec<DVec3>,
    /// They are but the vertices of their hull as seen from the light: all that lies between them is to be held too.
    pub hull_only: bool,
    /// Grid positions by answer: facing the light, and of those in shadow.
    pub facing: u64,
    /// Grid positions in shadow.
    pub shadowed: u64,
    /// Changes of answer that are ends of a surface, not shadow edges.
    pub discontinuities: u64,
    /// Rays spent.
    pub rays: u64,
}

/// What one light's samples are taken from.
#[derive(Clone, Copy)]
pub struct LightView<'a> {
    /// Rays.
    pub tracer: &'a Tracer<'a>,
    /// Camera of the frame.
    pub camera: &'a Camera,
    /// What the grid sees.
    pub view: &'a GridView<'a>,
    /// The light.
    pub light: &'a Light,
    /// How shadow rays leave a surface.
    pub offset: RayOffset,
    /// What the light does at each position of the grid.
    pub answers: &'a [Answer],
}

/// Samples one light. `refine` halvings locate each change to a grid step / 2^refine. With `cover_lit` the covered set is
/// what is lit (for renderers that take points outside a map for shadowed), else what is in shadow.
pub fn sample_light(of: &LightView, refine: u32, cover_lit: bool) -> LightSamples {
    let LightView { tracer, camera, view, light, offset, answers } = *of;
    let film = view.grid.film;
    let seeker = Seeker { tracer, camera, film, light, offset };
    let side = |i: usize| (view.grid.position_of(i), view.surface(tracer, camera, i), answers[i]);
    let changes =
        Changes::find(view.grid, answers, |shadowed, other| seeker.bisect(side(shadowed), side(other), refine));
    let seen_at = |p: DVec2| surface_at(tracer, camera, film, p.x, p.y);
    let corner = |i: usize| {
        let surface = (!between_its_like(view, answers, i)).then(|| view.surface(tracer, camera, i)).flatten();
        surface.map(|s| s.position)
    };
    let mut samples = changes.samples(camera, light, &EdgeLook { seen_at, normal_at: |_| None }, corner, cover_lit);
    samples.rays = changes.len() as u64 * 2 * u64::from(refine) + 2 * samples.edges.len() as u64;
    samples
}

/// Whether a position's neighbours to the left and right have its answer on its triangle. Its point then lies on the
/// straight line between theirs and is no corner of any hull.
fn between_its_like(view: &GridView, answers: &[Answer], index: usize) -> bool {
    let column = index % view.grid.columns as usize;
    let like = |other: usize| answers[other] == answers[index] && view.triangle(other) == view.triangle(index);
    column > 0 && column + 1 < view.grid.columns as usize && like(index - 1) && like(index + 1)
}
