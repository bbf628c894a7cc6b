//! Triangles that cross the near or far plane or leave the guard band: clipped in homogeneous window space.
//!
//! Sutherland and Hodgman, *Reentrant polygon clipping*, 1974. A cut is always computed from the end inside to the end
//! outside, so two triangles that share an edge cut it at the same point: no cracks. 0 ≤ Z ≤ w leaves w ≥ 0, and
//! w = 0 only at the homogeneous origin, which has no position and is dropped.

use super::setup::{Lanes, Setup};
use super::view::{View, divided};
use glam::Vec3;

/// Three vertices and one more for each of the six planes.
const VERTICES_MAX: usize = 9;

/// A convex polygon of at most [`VERTICES_MAX`] vertices.
struct Polygon {
    vertices: [[f64; 4]; VERTICES_MAX],
    len: usize,
}

impl Polygon {
    fn push(&mut self, vertex: [f64; 4]) {
        // Rounding can make a polygon cross a plane more than twice; what does not fit is without extent.
        if self.len < VERTICES_MAX {
            self.vertices[self.len] = vertex;
            self.len += 1;
        }
    }
}

/// Clips a triangle given in homogeneous window space and sets the pieces up; returns how many there were.
pub(super) fn clip(view: &View, triangle: &[[f64; 4]; 3], setups: &mut Vec<Setup>) -> usize {
    if outside_map(view, triangle) {
        return 0;
    }
    let mut polygon = Polygon { vertices: [[0.0; 4]; VERTICES_MAX], len: 3 };
    polygon.vertices[..3].copy_from_slice(triangle);
    for plane in 0..6 {
        polygon = cut(view, &polygon, plane);
    }
    let mut window = [[0.0; 3]; VERTICES_MAX];
    let mut len = 0;
    for &vertex in &polygon.vertices[..polygon.len] {
        let vertex = divided(vertex);
        if vertex.iter().all(|t| t.is_finite()) {
            window[len] = vertex;
            len += 1;
        }
    }
    let mut pieces = Lanes::<VERTICES_MAX>::new();
    for i in 2..len {
        for (corner, vertex) in [window[0], window[i - 1], window[i]].into_iter().enumerate() {
            [pieces.x[corner][i], pieces.y[corner][i], pieces.z[corner][i]] = vertex;
        }
        pieces.live[i] = true;
    }
    [pieces.z_u, pieces.z_v] = homogeneous_slope(triangle).map(|slope| [slope; VERTICES_MAX]);
    pieces.set_up(view, setups)
}

/// True when all vertices lie beyond the same side of the map, or one is not a number.
fn outside_map(view: &View, triangle: &[[f64; 4]; 3]) -> bool {
    beyond_a_side(view, triangle, 0.0) || triangle.iter().flatten().any(|t| !t.is_finite())
}

/// True when all points lie beyond the same side of the map by more than `margin` of its size.
fn beyond_a_side(view: &View, points: &[[f64; 4]], margin: f64) -> bool {
    let (width, height) = (f64::from(view.width), f64::from(view.height));
    let all = |outside: &dyn Fn(&[f64; 4]) -> bool| points.iter().all(outside);
    let (low, high) = (-margin, 1.0 + margin);
    all(&|p| p[0] < low * width * p[3])
        || all(&|p| p[0] > high * width * p[3])
        || all(&|p| p[1] < low * height * p[3])
        || all(&|p| p[1] > high * height * p[3])
        || all(&|p| p[2] < low * p[3])
        || all(&|p| p[2] > high * p[3])
}

/// Part of the map's size that a box must lie beside it to be passed over: triangles within are snapped to texels, and
/// rounding must not decide.
const BESIDE: f64 = 1e-3;

/// True when nothing in a box of scene space is drawn.
pub(super) fn box_is_outside(view: &View, corners: [Vec3; 2]) -> bool {
    let at = |k: usize, axis: usize| f64::from(corners[k >> axis & 1][axis]);
    let points: [_; 8] = std::array::from_fn(|k| view.project(at(k, 0), at(k, 1), at(k, 2)));
    beyond_a_side(view, &points, BESIDE)
}

/// The part of a polygon on the inner side of one plane of [`View::distances`].
fn cut(view: &View, polygon: &Polygon, plane: usize) -> Polygon {
    let mut inner = Polygon { vertices: [[0.0; 4]; VERTICES_MAX], len: 0 };
    let vertices = &polygon.vertices[..polygon.len];
    for (i, &vertex) in vertices.iter().enumerate() {
        let next = vertices[(i + 1) % vertices.len()];
        let (d, d_next) = (view.distances(vertex)[plane], view.distances(next)[plane]);
        if d >= 0.0 {
            inner.push(vertex);
        }
        if d >= 0.0 && d_next < 0.0 {
            inner.push(crossing(vertex, next, d / (d - d_next)));
        } else if d < 0.0 && d_next >= 0.0 {
            inner.push(crossing(next, vertex, d_next / (d_next - d)));
        }
    }
    inner
}

/// The point at `t` from `inside` to `outside`.
fn crossing(inside: [f64; 4], outside: [f64; 4], t: f64) -> [f64; 4] {
    std::array::from_fn(|i| inside[i] + t * (outside[i] - inside[i]))
}

/// Slope of the depth plane, per texel, from the whole triangle wherever its vertices lie: with Z = u X + v Y + c w at
/// all three, Cramer's rule gives u and v.
fn homogeneous_slope([a, b, c]: &[[f64; 4]; 3]) -> [f64; 2] {
    let det = |i: usize, j: usize, k: usize| {
        a[i] * (b[j] * c[k] - b[k] * c[j]) - a[j] * (b[i] * c[k] - b[k] * c[i]) + a[k] * (b[i] * c[j] - b[j] * c[i])
    };
    let whole = det(0, 1, 3);
    [det(2, 1, 3) / whole, det(0, 2, 3) / whole]
}
