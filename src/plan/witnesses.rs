//! The points of a map's entry that an importer is checked with: at least [`WITNESSES_MIN`], not coplanar.
//!
//! First of what is seen: extremes in eight directions, one of each answer, and some lifted towards the light. A map that
//! few or flat receivers look up gets, besides, extremes of what it holds at all: a lattice in map coordinates and depth, or
//! points beside the receivers where the map's domain is a sliver, taken back through the matrix, as far as they belong to
//! the domain and the light reaches them.

use super::Witness;
use super::seen::{Seen, in_unit, uv_of};
use crate::math::Bounds;
use crate::scene::Light;
use crate::visibility::Tracer;
use glam::{DMat4, DVec3};

/// Fewest witnesses of a map: a projective matrix has 11 numbers, and each of 6 points gives two equations in map coordinates.
pub(super) const WITNESSES_MIN: usize = 6;

/// Witnesses are coplanar when, in the cube of map coordinates and depth, none lies farther than this from the plane of three
/// others. Matrices keep planes; an importer that computes in f32 tells 1e-4 from 0 by three digits.
const FLAT: f64 = 1e-4;

/// Steps of the lattice on each axis.
const LATTICE: u32 = 8;

/// Halvings of the map's side at which points beside a receiver are tried; the last is still twice [`FLAT`].
const BESIDE: std::ops::RangeInclusive<i32> = 3..=12;

/// Where witnesses may be.
pub(super) struct Place<'a, F> {
    /// Clip space of the map from the scene.
    pub(super) m: &'a DMat4,
    pub(super) light: &'a Light,
    /// Without one only points between lit ones and the light are known to be lit.
    pub(super) tracer: Option<&'a Tracer<'a>>,
    /// Whether this is the map that a point looks up.
    pub(super) answers: &'a F,
}

impl<F: Fn(DVec3) -> bool> Place<'_, F> {
    /// Map coordinates and depth of a point that looks the map up and lies in its depth range.
    fn window(&self, point: DVec3) -> Option<DVec3> {
        let (uv, depth) = uv_of(self.m, point).filter(|(uv, depth)| in_unit(*uv) && (0.0..=1.0).contains(depth))?;
        (point.is_finite() && (self.answers)(point)).then(|| uv.extend(depth))
    }

    /// The exact answer at a point in free space.
    fn is_shadowed(&self, point: DVec3) -> bool {
        let end = if self.light.position().is_some() { 1.0 } else { f64::INFINITY };
        self.tracer.is_some_and(|t| t.occluded(point, self.light.towards(point), 0.0, end))
    }

    /// Points of a lattice in what the map holds.
    fn lattice(&self) -> Vec<DVec3> {
        let at = |k: u32| (f64::from(k) + 0.5) / f64::from(LATTICE);
        let cells = (0..LATTICE).flat_map(|i| (0..LATTICE).flat_map(move |j| (0..LATTICE).map(move |k| [i, j, k])));
        self.back(cells.map(|cell| DVec3::from(cell.map(at))))
    }

    /// Points beside those receivers that lie farthest out, at several depths: in between, and as near to theirs as beside.
    fn beside(&self, inside: &[Seen]) -> Vec<DVec3> {
        let about = extremes(inside, |s| s.position).into_iter().filter_map(|s| self.window(s.position));
        let sides = [-1.0, 0.0, 1.0];
        let steps: Vec<f64> = BESIDE.map(|k| 0.5_f64.powi(k)).collect();
        let mut window = Vec::new();
        for at in about {
            let depths: Vec<f64> =
                [0.25, 0.5, 0.75, at.z].into_iter().chain(steps.iter().map(|step| at.z - step)).collect();
            for (step, u, v) in steps.iter().flat_map(|s| sides.into_iter().flat_map(move |u| sides.map(|v| (s, u, v))))
            {
                window.extend(depths.iter().map(|depth| DVec3::new(at.x + u * step, at.y + v * step, *depth)));
            }
        }
        self.back(window.into_iter())
    }

    /// Takes map coordinates and depth back to the scene, where a point there looks the map up.
    fn back(&self, window: impl Iterator<Item = DVec3>) -> Vec<DVec3> {
        let scene_from_clip = self.m.inverse();
        let points = window.map(|window| {
            let point = scene_from_clip * (2.0 * window - 1.0).extend(1.0);
            point.truncate() / point.w
        });
        points.filter(|p| self.light.reaches(*p) && self.window(*p).is_some()).collect()
    }
}

/// The witnesses of a map that the points `inside` look up; with the reason where they are too few or coplanar.
pub(super) fn witnesses<F: Fn(DVec3) -> bool>(place: &Place<'_, F>, inside: &[Seen]) -> (Vec<Witness>, Option<String>) {
    let mut chosen: Vec<(DVec3, bool)> = Vec::new();
    let mut add = |position: DVec3, shadowed: bool| {
        if !chosen.iter().any(|(p, _)| *p == position) {
            chosen.push((position, shadowed));
        }
    };
    for s in extremes(inside, |s| s.position) {
        add(s.position, s.shadowed);
    }
    for answer in [true, false] {
        if let Some(s) = inside.iter().find(|s| s.shadowed == answer) {
            add(s.position, s.shadowed);
        }
    }
    for point in lifted(place, inside) {
        add(point, place.is_shadowed(point));
    }
    let mut found = written(place, &chosen);
    for beside in [false, true] {
        if lacking(&found).is_none() || place.tracer.is_none() {
            break;
        }
        let points = if beside { place.beside(inside) } else { place.lattice() };
        let window: Vec<DVec3> = points.iter().map(|p| place.window(*p).unwrap_or_default()).collect();
        let numbers: Vec<usize> = (0..points.len()).collect();
        let farthest = extremes(&numbers, |k| window[*k]).into_iter().copied();
        let body = spanning(&window).into_iter().flat_map(|(of, _)| of);
        let answered: Vec<(DVec3, bool)> =
            farthest.chain(body).map(|k| (points[k], place.is_shadowed(points[k]))).collect();
        for witness in written(place, &answered) {
            if !found.contains(&witness) {
                found.push(witness);
            }
        }
    }
    let reason = lacking(&found).map(|lack| match place.tracer {
        Some(_) => {
            format!("{lack}: hardly any point that the map holds belongs to its domain and is reached by the light")
        }
        None => {
            format!("{lack}: planned from images, only what is seen lit and points between it and the light are known")
        }
    });
    (found, reason)
}

/// What witnesses lack; `None` when they are enough and not coplanar.
pub(super) fn lacking(witnesses: &[Witness]) -> Option<String> {
    let n = witnesses.len();
    if n < WITNESSES_MIN {
        return Some(format!("{n} witnesses of {WITNESSES_MIN}"));
    }
    let window: Vec<DVec3> = witnesses.iter().map(|w| DVec3::new(w.uv[0], w.uv[1], w.depth)).collect();
    (height(&window) <= FLAT).then(|| format!("{n} witnesses, all in one plane"))
}

/// Distance of the farthest point from a plane through three others.
fn height(points: &[DVec3]) -> f64 {
    spanning(points).map_or(0.0, |(_, height)| height)
}

/// Four points of a body, each chosen as far as can be from the point, line and plane of those before it, by number, with
/// the distance of the fourth from the plane of the others; `None` without points.
fn spanning(points: &[DVec3]) -> Option<([usize; 4], f64)> {
    let a = *points.first()?;
    let farthest = |distance: &dyn Fn(DVec3) -> f64| {
        (0..points.len()).max_by(|i, j| distance(points[*i] - a).total_cmp(&distance(points[*j] - a))).unwrap_or(0)
    };
    let b = farthest(&|d| d.length());
    let along = (points[b] - a).normalize_or_zero();
    let c = farthest(&|d| d.reject_from_normalized(along).length());
    let normal = along.cross(points[c] - a).normalize_or_zero();
    let d = farthest(&|d| d.dot(normal).abs());
    Some(([0, b, c, d], (points[d] - a).dot(normal).abs()))
}

/// The farthest items in eight directions; of equals the first.
fn extremes<T>(items: &[T], position: impl Fn(&T) -> DVec3) -> Vec<&T> {
    let Some(first) = items.first() else { return Vec::new() };
    let farthest = |k: usize| {
        let sign = |bit: usize| if k >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let direction = DVec3::new(sign(0), sign(1) * 0.7, sign(2) * 1.3);
        items.iter().fold(first, |b, s| if position(s).dot(direction) > position(b).dot(direction) { s } else { b })
    };
    (0..8).map(farthest).collect()
}

/// Up to three of the seen points, lifted towards the light so that the set is not flat even over a flat floor: by halving
/// steps until they still lie in the map's depth range and look the map up.
fn lifted<F: Fn(DVec3) -> bool>(place: &Place<'_, F>, inside: &[Seen]) -> Vec<DVec3> {
    let from: Vec<&Seen> = inside.iter().filter(|s| place.tracer.is_some() || !s.shadowed).collect();
    let spread = [0, from.len() / 2, from.len().saturating_sub(1)];
    let reach = match place.light.position() {
        Some(_) => 0.5,
        None => Bounds::of(inside.iter().map(|s| s.position)).diagonal(),
    };
    let lift = |s: &&Seen| {
        let towards = place.light.towards(s.position);
        let steps = (0..8).map(|halving| s.position + towards * (reach * 0.5_f64.powi(halving)));
        steps.into_iter().find(|p| place.window(*p).is_some())
    };
    spread.into_iter().filter_map(|k| from.get(k)).filter_map(lift).collect()
}

/// With what the matrix gives them.
fn written<F: Fn(DVec3) -> bool>(place: &Place<'_, F>, points: &[(DVec3, bool)]) -> Vec<Witness> {
    let written = |(world, shadowed): &(DVec3, bool)| {
        let (uv, depth) = uv_of(place.m, *world)?;
        Some(Witness { world: world.to_array(), uv: uv.to_array(), depth, shadowed: *shadowed })
    };
    points.iter().filter_map(written).collect()
}
