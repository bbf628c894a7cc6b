//! The shadow edges of one light on the film: marching squares over the bisected grid.

use super::crossing::{Crossing, CrossingKind, Seeker};
use super::grid::GridView;
use crate::scene::{Camera, Light};
use crate::visibility::{Answer, RayOffset, Surface, Tracer, surface_at};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
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
}

/// What the fit of one light gets of a frame.
#[derive(Clone, Debug, Default)]
pub struct LightSamples {
    /// Pieces of shadow edge.
    pub edges: Vec<EdgePoint>,
    /// Scene points that the map has to hold.
    pub covered: Vec<DVec3>,
    /// Grid positions by answer: facing the light, and of those in shadow.
    pub facing: u64,
    /// Grid positions in shadow.
    pub shadowed: u64,
    /// Changes of answer that are ends of a surface, not shadow edges.
    pub discontinuities: u64,
    /// Rays spent.
    pub rays: u64,
}

/// Farthest look across an edge for the next change of answer, in grid steps.
const ROOM_STEPS: u32 = 48;

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
    let grid = view.grid;
    let seeker = Seeker { tracer, camera, film: grid.film, light, offset };
    let across = Crossings::find(of, &seeker, [1, 0], refine);
    let down = Crossings::find(of, &seeker, [0, 1], refine);
    let mut edges: Vec<EdgePoint> = (0..grid.rows.saturating_sub(1))
        .into_par_iter()
        .flat_map_iter(|r| (0..grid.columns.saturating_sub(1)).map(move |c| (c, r)))
        .flat_map_iter(|(c, r)| {
            let at = |c, r| view.index(c, r);
            let sides = [across.at(at(c, r)), down.at(at(c + 1, r)), across.at(at(c, r + 1)), down.at(at(c, r))];
            segments(sides).into_iter().flatten().filter_map(|(a, b)| edge_point(of, &seeker, a, b)).collect::<Vec<_>>()
        })
        .collect();
    let crossings = || across.found.iter().chain(&down.found);
    edges.extend(crossings().flat_map(|c| ends_of_surfaces(of, c)));
    let wanted = if cover_lit { Answer::Lit } else { Answer::Shadowed };
    let mut covered: Vec<DVec3> = (0..answers.len())
        .into_par_iter()
        .filter(|i| answers[*i] == wanted && !between_its_like(view, answers, *i))
        .filter_map(|i| view.surface(tracer, camera, i).map(|s| s.position))
        .collect();
    covered.extend(crossings().filter_map(|c| if cover_lit { c.other } else { Some(c.shadowed) }).map(|s| s.position));
    let count = |f: &dyn Fn(&Answer) -> bool| answers.iter().filter(|a| f(a)).count() as u64;
    let found = crossings().count() as u64;
    LightSamples {
        facing: count(&|a| *a != Answer::Unlit),
        shadowed: count(&|a| *a == Answer::Shadowed),
        discontinuities: crossings().filter(|c| c.kind == CrossingKind::Discontinuity).count() as u64,
        rays: found * 2 * u64::from(refine) + 2 * edges.len() as u64,
        edges,
        covered,
    }
}

/// Whether a position's neighbours to the left and right have its answer on its triangle. Its point then lies on the
/// straight line between theirs and is no corner of any hull.
fn between_its_like(view: &GridView, answers: &[Answer], index: usize) -> bool {
    let column = index % view.grid.columns as usize;
    let like = |other: usize| answers[other] == answers[index] && view.triangle(other) == view.triangle(index);
    column > 0 && column + 1 < view.grid.columns as usize && like(index - 1) && like(index + 1)
}

/// Changes of answer between neighbours of the grid, one way across it.
struct Crossings {
    /// In the order of the grid.
    found: Vec<Crossing>,
    /// For each position the number of its crossing to the next one, or [`NO_CROSSING`].
    numbers: Vec<u32>,
}

/// In [`Crossings::numbers`].
const NO_CROSSING: u32 = u32::MAX;

impl Crossings {
    /// Between each position and the one `step` (columns, rows) on.
    fn find(of: &LightView, seeker: &Seeker, step: [u32; 2], refine: u32) -> Crossings {
        let LightView { view, answers, .. } = *of;
        let grid = view.grid;
        let side = |i: usize| (grid.position_of(i), view.surface(of.tracer, of.camera, i), answers[i]);
        let found: Vec<(usize, Crossing)> = (0..grid.rows.saturating_sub(step[1]))
            .into_par_iter()
            .flat_map_iter(|r| (0..grid.columns.saturating_sub(step[0])).map(move |c| (c, r)))
            .filter_map(|(c, r)| {
                let (a, b) = (view.index(c, r), view.index(c + step[0], r + step[1]));
                let crossing = match (answers[a] == Answer::Shadowed, answers[b] == Answer::Shadowed) {
                    (true, false) => seeker.bisect(side(a), side(b), refine),
                    (false, true) => seeker.bisect(side(b), side(a), refine),
                    _ => None,
                };
                crossing.map(|crossing| (a, crossing))
            })
            .collect();
        let mut numbers = vec![NO_CROSSING; grid.len()];
        for (number, (index, _)) in found.iter().enumerate() {
            numbers[*index] = number as u32;
        }
        Crossings { found: found.into_iter().map(|(_, crossing)| crossing).collect(), numbers }
    }

    fn at(&self, index: usize) -> Option<&Crossing> {
        self.found.get(self.numbers[index] as usize)
    }
}

type Pair<'a> = (&'a Crossing, &'a Crossing);

/// The segments of a cell from the crossings on its sides (top, right, bottom, left). Two crossings make one segment; in
/// a saddle with four, neighbouring sides are paired so that the two segments are short.
fn segments(sides: [Option<&Crossing>; 4]) -> [Option<Pair<'_>>; 2] {
    let found: Vec<&Crossing> = sides.into_iter().flatten().filter(|c| c.kind == CrossingKind::ShadowEdge).collect();
    match found[..] {
        [a, b] => [Some((a, b)), None],
        [top, right, bottom, left] => {
            let distance = |a: &Crossing, b: &Crossing| (film(a) - film(b)).length();
            if distance(top, right) + distance(bottom, left) <= distance(right, bottom) + distance(left, top) {
                [Some((top, right)), Some((bottom, left))]
            } else {
                [Some((right, bottom)), Some((left, top))]
            }
        }
        _ => [None, None],
    }
}

fn film(c: &Crossing) -> DVec2 {
    DVec2::from_array(c.film)
}

fn edge_point(of: &LightView, seeker: &Seeker, a: &Crossing, b: &Crossing) -> Option<EdgePoint> {
    let (pa, pb) = (film(a), film(b));
    let length_px = (pb - pa).length();
    if length_px <= 0.0 {
        return None;
    }
    let middle = (pa + pb) * 0.5;
    let surface: Surface = surface_at(seeker.tracer, seeker.camera, seeker.film, middle.x, middle.y)?;
    if !(surface.normal.dot(seeker.light.towards(surface.position)) > 0.0 && seeker.light.reaches(surface.position)) {
        return None;
    }
    let derivatives = surface.film_derivatives(seeker.camera, seeker.film, middle.x, middle.y);
    if !derivatives.iter().all(|d| d.is_finite()) {
        return None;
    }
    let mut normal = (pb - pa).perp() / length_px;
    let probe = |direction: DVec2| room(of, middle, direction);
    let (forward, backward) = (probe(normal), probe(-normal));
    if forward.1 {
        normal = -normal;
    }
    Some(EdgePoint {
        film: middle.to_array(),
        position: surface.position,
        derivatives,
        normal,
        length_px,
        room_px: forward.0.min(backward.0),
    })
}

/// Part of the film length of a surface's end, with light on one side and shadow on the other, that counts as shadow edge
/// on each of the two surfaces. Where small things hide one another (foliage), the edges that fall on them cross the film
/// between grid positions. Chosen by measurement over 30 lights on the courtyard and 20 on a scanned scene, among 0, ¼, ½
/// and 1: none loses 7 % of misclassified pixels on the first, one loses 4 % on the second.
const END_AS_EDGE: f64 = 0.25;

/// The samples of a surface's end: the direction of the edge is not known there, so two perpendicular halves stand for
/// the mean over all directions.
fn ends_of_surfaces(of: &LightView, end: &Crossing) -> Vec<EdgePoint> {
    if end.kind != CrossingKind::Discontinuity || !end.other_lit {
        return Vec::new();
    }
    let grid = of.view.grid;
    let step = f64::from(grid.film.width.max(grid.film.height)) / f64::from(grid.columns.max(grid.rows));
    // A line crosses 4/π grid sides per grid step of its length.
    let length_px = step * std::f64::consts::FRAC_PI_4 * END_AS_EDGE * 0.5;
    let mut points = Vec::with_capacity(4);
    for surface in [Some(end.shadowed), end.other].into_iter().flatten() {
        let derivatives = surface.film_derivatives(of.camera, grid.film, end.film[0], end.film[1]);
        if !derivatives.iter().all(|d| d.is_finite()) {
            continue;
        }
        for normal in [DVec2::X, DVec2::Y] {
            let probe = |d: DVec2| room(of, film(end), d).0;
            let room_px = probe(normal).min(probe(-normal));
            points.push(EdgePoint {
                film: end.film,
                position: surface.position,
                derivatives,
                normal,
                length_px,
                room_px,
            });
        }
    }
    points
}

/// Walks from an edge over the grid's answers: how far the first answer met goes on, pixels, and whether it is shadow.
fn room(of: &LightView, from: DVec2, direction: DVec2) -> (f64, bool) {
    let LightView { view, answers, .. } = *of;
    let grid = view.grid;
    let step = f64::from(grid.film.width.max(grid.film.height)) / f64::from(grid.columns.max(grid.rows));
    let at = |p: DVec2| {
        let place = |x: f64, count: u32, pixels: u32| {
            let k = (x - 0.5) / f64::from(pixels.max(2) - 1) * f64::from(count.max(2) - 1);
            (k >= -0.5 && k < f64::from(count) - 0.5).then(|| k.round().max(0.0) as u32)
        };
        let c = place(p.x, grid.columns, grid.film.width)?;
        let r = place(p.y, grid.rows, grid.film.height)?;
        Some(answers[view.index(c, r)])
    };
    let first = at(from + direction * step).unwrap_or(Answer::Unlit);
    for k in 2..=ROOM_STEPS {
        let distance = f64::from(k) * step;
        if at(from + direction * distance) != Some(first) {
            return (distance - 0.5 * step, first == Answer::Shadowed);
        }
    }
    (f64::from(ROOM_STEPS) * step, first == Answer::Shadowed)
}
