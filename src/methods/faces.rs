//! Face partitioning: Lloyd, Tuft, Yoon and Manocha 2006, *Warping and Partitioning for Low Error Shadow Maps*; course
//! slides, "Face partitioning".
//!
//! Each light ray crosses the view frustum from one face to another. A map is laid over each face on one end of the rays:
//! over side faces with a warp along the view, over the near and the far face evenly, since a face across the view is
//! seen at one depth. The faces turned to the light lie nearer to the camera where it shines along the view, those turned
//! away where it shines against it; the nearer ones are taken, since the film asks most of a ray there. Those are the
//! "visible faces" of the earlier report for light from behind the camera, and what keeps texels near the camera for
//! light from ahead.
//!
//! A side face holds the camera, so that its depth z alone tells how large a pixel is on it. A perspective along z with
//! its centre z_n + √(z_n z_f) before the near end, z_n and z_f the ends of what the face has to show, makes the sampling
//! error along the view equal at both (as LiSPSM does under light from the side, but for light from anywhere):
//!
//! ```text
//! on the face:   p1 = e·X (e along the near edge),   p2 = z,   p4 = z + √(z_n z_f)
//! ```
//!
//! A map answers for the points whose rays cross its face: between the planes through the light and the edges that it
//! shares with its neighbours. All maps get the same texels; a face behind which nothing is to cover gets none.
//! At light across the view one end of the rays takes over from the other and the maps jump; both ends then lie at the
//! same depths.

use super::body::{Rectangle, covering_plane, light_plane, may_warp, refit};
use super::focused::view_body;
use super::on_plane::{OFF_PLANE, plane_rows};
use super::split::{parts, solve_parts};
use super::{Inapplicable, Inputs, Region};
use crate::math::Domain;
use crate::scene::Projection;
use glam::{DVec3, DVec4};

/// A face of the view frustum.
#[derive(Clone, Copy)]
struct Face {
    /// Numbers of its corners, in order: 0 to 3 around the near face, 4 to 7 around the far one.
    corners: [usize; 4],
    /// n, d with n·X + d ≥ 0 inside the frustum, n unit.
    plane: (DVec3, f64),
}

/// Solves all faces.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Vec<Region>, Inapplicable> {
    may_warp(inputs)?;
    let corners = frustum(inputs, &view_body(inputs, axis)?);
    let faces = nearer_faces(inputs, &corners);
    if faces.is_empty() {
        return Err(Inapplicable::LightAmongFaces);
    }
    let mut cells: Vec<(Domain, Vec<DVec4>)> = faces
        .iter()
        .map(|face| {
            let borders = borders(inputs, &corners, face, &faces);
            let domains = borders.iter().map(|plane| Domain::HalfSpace { plane: *plane }).collect();
            (Domain::Intersection(domains), borders)
        })
        .collect();
    if let Some(last) = cells.last_mut() {
        last.0 = Domain::All;
    }
    let cells = parts(inputs, cells);
    solve_parts(inputs, &cells, |k, given| on_face(given, axis, &corners, &faces[k]))
}

/// Corners of the view frustum between the least and the largest depth of the body.
fn frustum(inputs: &Inputs, body: &[DVec3]) -> [DVec3; 8] {
    let (w, h) = (f64::from(inputs.film.width), f64::from(inputs.film.height));
    let forward = inputs.camera.forward();
    let depth = |p: DVec3| forward.dot(p - inputs.camera.position);
    let (near, far) =
        body.iter().map(|p| depth(*p)).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), d| (lo.min(d), hi.max(d)));
    let film = [[0.0, 0.0], [0.0, h], [w, h], [w, 0.0]];
    std::array::from_fn(|k| {
        let [x, y] = film[k % 4];
        let (origin, ray) = inputs.camera.ray(inputs.film, x, y);
        let z = if k < 4 { near } else { far };
        origin + ray * ((z - depth(origin)) / forward.dot(ray))
    })
}

/// The faces at that end of the light's rays that is nearer to the camera; none for a lamp inside the frustum.
fn nearer_faces(inputs: &Inputs, corners: &[DVec3; 8]) -> Vec<Face> {
    let centre = corners.iter().sum::<DVec3>() / 8.0;
    let light = inputs.light.position();
    let along = -inputs.light.towards(centre).dot(inputs.camera.forward()) >= 0.0;
    let side = |i: usize| [i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i];
    let loops = [[0, 1, 2, 3], side(0), side(1), side(2), side(3), [4, 5, 6, 7]];
    let faces: Vec<Face> = loops
        .into_iter()
        .filter_map(|loop_| {
            let [a, b, c, d] = loop_.map(|k| corners[k]);
            // The diagonals span the plane even where the near edge shrinks to a point.
            let n = (c - a).cross(d - b).try_normalize()?;
            let n = if n.dot(centre - a) < 0.0 { -n } else { n };
            Some(Face { corners: loop_, plane: (n, -n.dot(a)) })
        })
        .collect();
    // How far the light stands outside of a face, in the unit of the least that counts.
    let outside = |face: &Face| {
        let (n, d) = face.plane;
        match light {
            None => -n.dot(inputs.light.towards(centre)) / OFF_PLANE,
            Some(position) => -(n.dot(position) + d) / (OFF_PLANE * inputs.bounds.diagonal()),
        }
    };
    if faces.iter().all(|face| outside(face) <= 1.0) {
        return Vec::new();
    }
    faces.into_iter().filter(|face| if along { outside(face) > 1.0 } else { outside(face) < -1.0 }).collect()
}

/// Planes through the light and the edges that a face shares with other faces of the list, the face on their inner sides.
fn borders(inputs: &Inputs, corners: &[DVec3; 8], face: &Face, all: &[Face]) -> Vec<DVec4> {
    let inner = face.corners.iter().map(|k| corners[*k]).sum::<DVec3>() / 4.0;
    let mut planes = Vec::new();
    for i in 0..4 {
        let (a, b) = (face.corners[i], face.corners[(i + 1) % 4]);
        let shared =
            |other: &&Face| other.corners != face.corners && other.corners.contains(&a) && other.corners.contains(&b);
        if !all.iter().any(|other| shared(&other)) {
            continue;
        }
        let (a, b) = (corners[a], corners[b]);
        let to_light = inputs.light.towards(a);
        if let Some(n) = (b - a).cross(to_light).try_normalize() {
            let n = if n.dot(inner - a) < 0.0 { -n } else { n };
            planes.push(n.extend(-n.dot(a)));
        }
    }
    planes
}

/// The map over a face.
fn on_face(inputs: &Inputs, axis: Option<DVec3>, corners: &[DVec3; 8], face: &Face) -> Result<Region, Inapplicable> {
    let body = view_body(inputs, axis)?;
    let space = light_plane(inputs, axis, &body)?;
    let held: Vec<DVec3> = body.iter().filter(|p| space.q(**p).z > 0.0).chain(inputs.covered).copied().collect();
    let plane = covering_plane(inputs, space, &held)?;
    let camera = inputs.camera;
    let depth = camera.forward().extend(0.0);
    let rows = |functionals: [DVec4; 3]| {
        plane_rows(inputs, &space, face.plane, functionals, inputs.covered[0])
            .map(|rows| rows.map(|row| plane.normalisation.row(row)))
    };
    let is_side = face.corners[0] < 4 && face.corners[2] >= 4;
    let base = match camera.projection {
        Projection::Perspective { .. } if is_side => {
            let [first, second, ..] = face.corners.map(|k| corners[k]);
            let [across, z, one] = rows([(second - first).normalize_or_zero().extend(0.0), depth, DVec4::W])?;
            let depths = plane.hull.iter().map(|v| z.dot(v.extend(1.0)) / one.dot(v.extend(1.0)));
            let (near, far) = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), d| (lo.min(d), hi.max(d)));
            let near = near.max(camera.near);
            [across, z, z + one * (near * far.max(near)).sqrt()]
        }
        Projection::Orthographic { .. } if is_side => {
            let [first, second, ..] = face.corners.map(|k| corners[k]);
            rows([(second - first).normalize_or_zero().extend(0.0), depth, DVec4::W])?
        }
        _ => {
            let m = camera.world_from_camera;
            rows([m.x_axis.extend(0.0), m.y_axis.extend(0.0), DVec4::W])?
        }
    };
    refit(inputs, plane, &base, Rectangle::Axes)
}
