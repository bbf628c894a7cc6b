//! Triangles and the few shapes the examples are made of. Counter-clockwise is outside, as glTF has it. No normals are
//! kept: glTF viewers then shade flat, and a shadow planner looks at the triangles themselves.

use glam::{DMat4, DVec2, DVec3, dvec3};
use std::f64::consts::TAU;

/// Vertices in metres, three indices a triangle.
#[derive(Default)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[usize; 3]>,
}

impl Mesh {
    /// Adds another mesh, moved by a transform that keeps handedness.
    pub(crate) fn add(&mut self, other: &Mesh, transform: DMat4) {
        let base = self.positions.len();
        self.positions.extend(other.positions.iter().map(|&p| transform.transform_point3(p)));
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + base)));
    }

    /// Adds a quadrilateral with vertices of its own; two triangles, counter-clockwise.
    pub(crate) fn add_quad(&mut self, corners: [DVec3; 4]) {
        let base = self.positions.len();
        self.positions.extend(corners);
        self.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }

    /// Adds an axis-parallel box between two corners.
    pub(crate) fn add_box(&mut self, min: DVec3, max: DVec3) {
        let base = self.positions.len();
        for corner in 0..8_usize {
            let pick = |bit: usize, low: f64, high: f64| if corner & bit == 0 { low } else { high };
            self.positions.push(dvec3(pick(1, min.x, max.x), pick(2, min.y, max.y), pick(4, min.z, max.z)));
        }
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        for [a, b, c, d] in faces.map(|face| face.map(|i| i + base)) {
            self.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }

    /// Adds a box given its middle and its full size.
    pub(crate) fn add_block(&mut self, middle: DVec3, size: DVec3) {
        self.add_box(middle - 0.5 * size, middle + 0.5 * size);
    }

    /// Joins rings of equally many vertices, `closed` ones around, each ring above the one before (a closed one counter-clockwise
    /// seen from above). A ring whose vertices
    /// coincide gives no degenerate triangles.
    pub(crate) fn add_rings(&mut self, rings: &[Vec<DVec3>], closed: bool) {
        let mut below: Option<Vec<usize>> = None;
        for ring in rings {
            let pole = ring.iter().all(|p| *p == ring[0]);
            let base = self.positions.len();
            self.positions.extend(&ring[..if pole { 1 } else { ring.len() }]);
            let here: Vec<usize> = (0..ring.len()).map(|j| if pole { base } else { base + j }).collect();
            if let Some(below) = below {
                for j in 0..if closed { ring.len() } else { ring.len() - 1 } {
                    let k = (j + 1) % ring.len();
                    let (a, b, c, d) = (below[j], below[k], here[k], here[j]);
                    if a != b {
                        self.triangles.push([a, b, c]);
                    }
                    if c != d {
                        self.triangles.push([a, c, d]);
                    }
                }
            }
            below = Some(here);
        }
    }
}

/// A box between two corners.
pub(crate) fn cuboid(min: DVec3, max: DVec3) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.add_box(min, max);
    mesh
}

/// A body of revolution about y. The profile runs upwards along the outside as (radius, height); one that comes back
/// down inside makes a vessel.
pub(crate) fn lathe(profile: &[DVec2], sides: usize) -> Mesh {
    let ring = |p: &DVec2| {
        let side = |j: usize| {
            let (sin, cos) = (TAU * (j as f64 + 0.5) / sides as f64).sin_cos();
            dvec3(p.x * cos, p.y, -p.x * sin)
        };
        (0..sides).map(side).collect()
    };
    let mut mesh = Mesh::default();
    mesh.add_rings(&profile.iter().map(ring).collect::<Vec<_>>(), true);
    mesh
}

/// A smooth profile through the given points, `steps` pieces between two of them (Catmull-Rom).
pub(crate) fn rounded(points: &[DVec2], steps: usize) -> Vec<DVec2> {
    let last = points.len() - 1;
    let mut profile = Vec::new();
    for i in 0..last {
        let [p, a, b, q] = [points[i.saturating_sub(1)], points[i], points[i + 1], points[(i + 2).min(last)]];
        for step in 0..steps {
            let t = step as f64 / steps as f64;
            let bend = (2.0 * p - 5.0 * a + 4.0 * b - q) * t + (3.0 * (a - b) + q - p) * t * t;
            profile.push((a + 0.5 * t * (b - p + bend)).max(DVec2::new(0.0, f64::NEG_INFINITY)));
        }
    }
    profile.push(points[last]);
    profile
}

/// A round rod along a path of (point, radius); its ends are open unless their radius is zero.
pub(crate) fn tube(path: &[(DVec3, f64)], sides: usize) -> Mesh {
    let tangent = |i: usize| (path[(i + 1).min(path.len() - 1)].0 - path[i.saturating_sub(1)].0).normalize();
    let mut across = tangent(0).any_orthonormal_vector();
    let mut rings = Vec::new();
    for (i, &(middle, radius)) in path.iter().enumerate() {
        let along = tangent(i);
        across = across.reject_from(along).normalize();
        let beside = along.cross(across);
        let around = |j: usize| {
            let (sin, cos) = (TAU * j as f64 / sides as f64).sin_cos();
            middle + radius * (cos * across + sin * beside)
        };
        rings.push((0..sides).map(around).collect());
    }
    let mut mesh = Mesh::default();
    mesh.add_rings(&rings, true);
    mesh
}

/// A sheet between lines of equally many points; it faces along (points of a line) × (line to next line).
pub(crate) fn sheet(lines: &[Vec<DVec3>]) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.add_rings(lines, false);
    mesh
}
