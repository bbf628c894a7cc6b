//! The shadow edges of one light on the film: marching squares over the bisected grid.

use super::crossing::{Crossing, CrossingKind, Seeker};
use super::grid::GridView;
use crate::scene::{Camera, Light};
use crate::visibility::{Answer, RayOffset, Surface, Tracer, answer, surface_at};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// A piece of shadow edge.
#[derive(Clone, Copy, Debug)]
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

/// Samples one light. `refine` halvings locate each change to a grid step / 2^refine. With `cover_lit` the covered set is
/// what is lit (for renderers that take points outside a map for shadowed), else what is in shadow.
pub fn sample_light(
    tracer: &Tracer,
    camera: &Camera,
    view: &GridView,
    light: &Light,
    offset: RayOffset,
    refine: u32,
    cover_lit: bool,
) -> LightSamples {
    let grid = view.grid;
    let answers: Vec<Answer> =
        view.surfaces.par_iter().map(|s| s.map_or(Answer::Unlit, |s| answer(tracer, &s, light, offset))).collect();
    let seeker = Seeker { tracer, camera, film: grid.film, light, offset };
    let cross = |a: (u32, u32), b: (u32, u32)| -> Option<Crossing> {
        let side = |(c, r): (u32, u32)| {
            let i = view.index(c, r);
            (grid.position(c, r), view.surfaces[i], answers[i])
        };
        let (a, b) = (side(a), side(b));
        match (a.2 == Answer::Shadowed, b.2 == Answer::Shadowed) {
            (true, false) => seeker.bisect(a, b, refine),
            (false, true) => seeker.bisect(b, a, refine),
            _ => None,
        }
    };
    let across: Vec<Option<Crossing>> = (0..grid.rows)
        .into_par_iter()
        .flat_map_iter(|r| (0..grid.columns).map(move |c| (c, r)))
        .map(|(c, r)| if c + 1 < grid.columns { cross((c, r), (c + 1, r)) } else { None })
        .collect();
    let down: Vec<Option<Crossing>> = (0..grid.rows)
        .into_par_iter()
        .flat_map_iter(|r| (0..grid.columns).map(move |c| (c, r)))
        .map(|(c, r)| if r + 1 < grid.rows { cross((c, r), (c, r + 1)) } else { None })
        .collect();

    let cells: Vec<(u32, u32)> = (0..grid.rows.saturating_sub(1))
        .flat_map(|r| (0..grid.columns.saturating_sub(1)).map(move |c| (c, r)))
        .collect();
    let edges: Vec<EdgePoint> = cells
        .par_iter()
        .flat_map_iter(|&(c, r)| {
            let i = view.index(c, r);
            let sides = [across[i], down[view.index(c + 1, r)], across[view.index(c, r + 1)], down[i]];
            segments(sides)
                .into_iter()
                .flatten()
                .filter_map(|(a, b)| edge_point(&seeker, view, &answers, &a, &b))
                .collect::<Vec<_>>()
        })
        .collect();

    let crossings = || across.iter().chain(&down).flatten();
    let mut edges = edges;
    edges.extend(crossings().flat_map(|c| ends_of_surfaces(&seeker, view, &answers, c)));
    let wanted = if cover_lit { Answer::Lit } else { Answer::Shadowed };
    let mut covered: Vec<DVec3> = view
        .surfaces
        .iter()
        .zip(&answers)
        .filter_map(|(s, a)| s.filter(|_| *a == wanted).map(|s| s.position))
        .collect();
    covered.extend(crossings().filter_map(|c| if cover_lit { c.other } else { Some(c.shadowed) }).map(|s| s.position));
    let count = |f: &dyn Fn(&Answer) -> bool| answers.iter().filter(|a| f(a)).count() as u64;
    let found = crossings().count() as u64;
    let facing = count(&|a| *a != Answer::Unlit);
    LightSamples {
        facing,
        shadowed: count(&|a| *a == Answer::Shadowed),
        discontinuities: crossings().filter(|c| c.kind == CrossingKind::Discontinuity).count() as u64,
        rays: facing + found * 2 * u64::from(refine) + 2 * edges.len() as u64,
        edges,
        covered,
    }
}

type Pair = (Crossing, Crossing);

/// The segments of a cell from the crossings on its sides (top, right, bottom, left). Two crossings make one segment; in
/// a saddle with four, neighbouring sides are paired so that the two segments are short.
fn segments(sides: [Option<Crossing>; 4]) -> [Option<Pair>; 2] {
    let edge = |c: Option<Crossing>| c.filter(|c| c.kind == CrossingKind::ShadowEdge);
    let found: Vec<Crossing> = sides.into_iter().filter_map(edge).collect();
    match found[..] {
        [a, b] => [Some((a, b)), None],
        [top, right, bottom, left] => {
            let distance = |a: &Crossing, b: &Crossing| (film(a) - film(b)).length();
            if distance(&top, &right) + distance(&bottom, &left) <= distance(&right, &bottom) + distance(&left, &top) {
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

fn edge_point(seeker: &Seeker, view: &GridView, answers: &[Answer], a: &Crossing, b: &Crossing) -> Option<EdgePoint> {
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
    let probe = |direction: DVec2| room(view, answers, middle, direction);
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
fn ends_of_surfaces(seeker: &Seeker, view: &GridView, answers: &[Answer], end: &Crossing) -> Vec<EdgePoint> {
    if end.kind != CrossingKind::Discontinuity || !end.other_lit {
        return Vec::new();
    }
    let grid = view.grid;
    let step = f64::from(grid.film.width.max(grid.film.height)) / f64::from(grid.columns.max(grid.rows));
    // A line crosses 4/π grid sides per grid step of its length.
    let length_px = step * std::f64::consts::FRAC_PI_4 * END_AS_EDGE * 0.5;
    let mut points = Vec::with_capacity(4);
    for surface in [Some(end.shadowed), end.other].into_iter().flatten() {
        let derivatives = surface.film_derivatives(seeker.camera, seeker.film, end.film[0], end.film[1]);
        if !derivatives.iter().all(|d| d.is_finite()) {
            continue;
        }
        for normal in [DVec2::X, DVec2::Y] {
            let probe = |d: DVec2| room(view, answers, film(end), d).0;
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
fn room(view: &GridView, answers: &[Answer], from: DVec2, direction: DVec2) -> (f64, bool) {
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
