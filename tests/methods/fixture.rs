//! A camera over a floor with a wall behind, and shadow edges on both: inputs of the methods without a renderer.

use glam::{DMat3, DQuat, DVec2, DVec3};
use lixel::fit::{Aspect, Shape};
use lixel::math::Bounds;
use lixel::methods::{Inapplicable, Inputs, Method, Region, SolverParams, solve};
use lixel::samples::EdgePoint;
use lixel::scene::{Camera, Film, Light, LightKind, Projection};

/// Every method.
pub(crate) const ALL: [Method; 15] = [
    Method::Lixel,
    Method::Normal,
    Method::Focused,
    Method::SceneOptimal,
    Method::Psm,
    Method::Tsm,
    Method::Lispsm,
    Method::PlaneOptimal,
    Method::HomographyArea,
    Method::SeparatingPlane,
    Method::Cascades,
    Method::Faces,
    Method::Partitioned,
    Method::Adaptive,
    Method::Edges,
];

/// Owned inputs.
#[derive(Clone)]
pub(crate) struct Setup {
    pub(crate) camera: Camera,
    pub(crate) film: Film,
    pub(crate) light: Light,
    pub(crate) bounds: Bounds,
    pub(crate) edges: Vec<EdgePoint>,
    pub(crate) covered: Vec<DVec3>,
    pub(crate) aspect: Aspect,
    pub(crate) texels: f64,
    pub(crate) solver: SolverParams,
}

impl Setup {
    pub(crate) fn solve(&self, method: Method) -> Result<Vec<Region>, Inapplicable> {
        let inputs = Inputs {
            camera: &self.camera,
            film: self.film,
            light: &self.light,
            bounds: self.bounds,
            edges: &self.edges,
            covered: &self.covered,
            hull_only: false,
            clip: &[],
            texels: self.texels,
            aspect: self.aspect,
            shape: Shape::Projective,
            solver: &self.solver,
            sample_cap: 100_000,
        };
        solve(method, &inputs)
    }

    pub(crate) fn with_light(&self, kind: LightKind) -> Setup {
        Setup { light: Light { name: "l".into(), kind }, ..self.clone() }
    }

    pub(crate) fn with_direction(&self, direction: DVec3) -> Setup {
        self.with_light(LightKind::Directional { direction: direction.normalize() })
    }

    /// The same world turned by `rotation`, scaled, and moved. Its bounds are those of the turned corners.
    pub(crate) fn moved(&self, rotation: DQuat, scale: f64, translation: DVec3) -> Setup {
        let point = |p: DVec3| rotation * p * scale + translation;
        let mut moved = self.clone();
        moved.camera.position = point(self.camera.position);
        moved.camera.world_from_camera = DMat3::from_quat(rotation) * self.camera.world_from_camera;
        moved.camera.near *= scale;
        moved.camera.far = self.camera.far.map(|f| f * scale);
        if let Projection::Orthographic { half_height } = &mut moved.camera.projection {
            *half_height *= scale;
        }
        moved.light.kind = match self.light.kind {
            LightKind::Directional { direction } => LightKind::Directional { direction: rotation * direction },
            LightKind::Point { position, range } => {
                LightKind::Point { position: point(position), range: range.map(|r| r * scale) }
            }
            LightKind::Spot { position, direction, cone_rad, range } => LightKind::Spot {
                position: point(position),
                direction: rotation * direction,
                cone_rad,
                range: range.map(|r| r * scale),
            },
        };
        moved.bounds = Bounds::of(self.bounds.corners().map(point));
        for edge in &mut moved.edges {
            edge.position = point(edge.position);
            edge.derivatives = edge.derivatives.map(|d| rotation * d * scale);
        }
        moved.covered = self.covered.iter().map(|p| point(*p)).collect();
        if let Some([a, b, c, d]) = self.solver.plane {
            let n = rotation * DVec3::new(a, b, c);
            moved.solver.plane = Some([n.x, n.y, n.z, d * scale - n.dot(translation)]);
        }
        moved
    }
}

/// A plane n·X = d.
pub(crate) type Wall = (DVec3, f64);
pub(crate) const FLOOR: Wall = (DVec3::Y, 0.0);
const BACK: Wall = (DVec3::Z, -30.0);

/// A camera at `position` that looks along `forward`, upright.
pub(crate) fn camera(position: DVec3, forward: DVec3, projection: Projection) -> Camera {
    let back = -forward.normalize();
    let right = DVec3::Y.cross(back).normalize();
    Camera {
        name: "c".into(),
        position,
        world_from_camera: DMat3::from_cols(right, back.cross(right), back),
        projection,
        near: 0.1,
        far: Some(60.0),
    }
}

/// A camera 1.7 m over a floor that ends at a wall, shadow edges on both, a low sun from the side.
pub(crate) fn room() -> Setup {
    let camera =
        camera(DVec3::new(0.3, 1.7, 0.0), DVec3::new(0.1, -0.15, -1.0), Projection::Perspective { yfov_rad: 0.9 });
    let bounds = Bounds { min: DVec3::new(-80.0, -80.0, -80.0), max: DVec3::new(85.0, 90.0, 88.0) };
    setup(camera, bounds, DVec3::new(0.6, -0.8, -0.35))
}

/// Edges on floor and wall wherever the camera sees them.
pub(crate) fn setup(camera: Camera, bounds: Bounds, direction: DVec3) -> Setup {
    let film = Film { width: 160, height: 120 };
    let mut edges = Vec::new();
    for k in 0..240_u32 {
        // A plastic-number sequence over the film (Roberts 2018).
        let x = (f64::from(k) * 0.754_877_666).fract() * 160.0;
        let y = (f64::from(k) * 0.569_840_291).fract() * 120.0;
        if let Some(edge) = edge(&camera, film, x, y, DVec2::from_angle(f64::from(k))) {
            edges.push(edge);
        }
    }
    let covered = edges.iter().map(|e| e.position).collect();
    let light = Light { name: "l".into(), kind: LightKind::Directional { direction: direction.normalize() } };
    let solver = SolverParams::default();
    Setup { camera, film, light, bounds, edges, covered, aspect: Aspect::Fixed(1.0), texels: 160_000.0, solver }
}

/// The nearer of floor and wall at a film position.
pub(crate) fn edge(camera: &Camera, film: Film, x: f64, y: f64, normal: DVec2) -> Option<EdgePoint> {
    [FLOOR, BACK]
        .iter()
        .filter_map(|wall| edge_on(camera, film, *wall, x, y, normal))
        .min_by(|a, b| camera.forward().dot(a.position).total_cmp(&camera.forward().dot(b.position)))
}

/// An edge point of a given plane.
pub(crate) fn edge_on(camera: &Camera, film: Film, (n, d): Wall, x: f64, y: f64, normal: DVec2) -> Option<EdgePoint> {
    let (origin, direction) = camera.ray(film, x, y);
    let t = (d - n.dot(origin)) / n.dot(direction);
    if !(t > camera.near && camera.far.is_none_or(|far| t < far)) {
        return None;
    }
    let derivatives = camera.ray_derivatives(film).map(|(by_origin, by_direction)| {
        let v = by_origin + by_direction * t;
        v - direction * (n.dot(v) / n.dot(direction))
    });
    let position = origin + direction * t;
    let length_px = 1.0 + 0.01 * x;
    Some(EdgePoint { film: [x, y], position, derivatives, normal, length_px, room_px: 12.0, uncertain: false })
}

/// Map position and w of a point in its region; `None` where no domain holds it.
pub(crate) fn place(regions: &[Region], point: DVec3) -> Option<(usize, DVec2, f64)> {
    let index = regions.iter().position(|r| r.domain.holds(point))?;
    let region = &regions[index];
    let p = region.h * region.space.q(point);
    Some((index, p.truncate() / p.z, p.z))
}

/// Finite, det > 0, and every covered point inside the unit square in front of the light.
pub(crate) fn assert_covers(setup: &Setup, regions: &[Region], what: &str) {
    assert!(!regions.is_empty(), "{what}");
    for region in regions {
        assert!(region.h.is_finite() && region.h.determinant() > 0.0, "{what}: {:?}", region.h);
        assert!(region.aspect.is_finite() && region.aspect > 0.0, "{what}: {}", region.aspect);
    }
    for point in &setup.covered {
        let (_, uv, w) = place(regions, *point).unwrap_or_else(|| panic!("{what}: no domain holds {point}"));
        let inside = uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all();
        assert!(w > 0.0 && inside, "{what}: {point} at {uv}, w = {w}");
    }
}

/// ∂(u, v)/∂(scene vector) at a point: gradients of u and v.
pub(crate) fn gradients(region: &Region, point: DVec3) -> [DVec3; 2] {
    let rows = [region.h.row(0), region.h.row(1), region.h.row(2)].map(|r| region.space.row_from_q(r));
    let [u, v, w] = rows.map(|r| r.dot(point.extend(1.0)));
    [(u, rows[0]), (v, rows[1])].map(|(p, row)| (row.truncate() - rows[2].truncate() * (p / w)) / w)
}
