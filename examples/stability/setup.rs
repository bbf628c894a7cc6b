//! What is planned: triangles, a camera, lights, an image; and the same in another world.

use glam::{DMat3, DQuat, DVec3, dvec3};
use lixel::scene::{CameraParams, LightKindName, LightParams};

/// World metres, f64: they reach the planner through OBJ, which keeps every digit.
pub(crate) type Soup = Vec<[DVec3; 3]>;

/// A scene with everything a job says of a shot.
#[derive(Clone, Debug)]
pub(crate) struct Setup {
    pub(crate) triangles: Soup,
    pub(crate) camera: CameraParams,
    pub(crate) lights: Vec<LightParams>,
    /// Width and height, pixels.
    pub(crate) image: [u32; 2],
}

/// A world that differs from the authored one by a similarity: X' = scale * turn * X + shift.
#[derive(Clone, Copy, Debug)]
pub(crate) struct World {
    pub(crate) scale: f64,
    pub(crate) turn: DMat3,
    pub(crate) shift: DVec3,
}

impl World {
    pub(crate) const AUTHORED: World = World { scale: 1.0, turn: DMat3::IDENTITY, shift: DVec3::ZERO };

    pub(crate) fn point(&self, p: DVec3) -> DVec3 {
        self.vector(p) + self.shift
    }

    fn vector(&self, v: DVec3) -> DVec3 {
        self.turn * v * self.scale
    }
}

impl Setup {
    /// The same in another world.
    pub(crate) fn placed(&self, world: &World) -> Setup {
        let point = |p: [f64; 3]| world.point(DVec3::from_array(p)).to_array();
        let turned = |v: [f64; 3]| (world.turn * DVec3::from_array(v)).to_array();
        let rotation = |q: [f64; 4]| {
            let turned = world.turn * DMat3::from_quat(DQuat::from_array(q));
            DQuat::from_mat3(&turned).normalize().to_array()
        };
        let camera = CameraParams {
            position: self.camera.position.map(point),
            rotation: self.camera.rotation.map(rotation),
            near: self.camera.near.map(|m| m * world.scale),
            far: self.camera.far.map(|m| m * world.scale),
            ..self.camera.clone()
        };
        let light = |light: &LightParams| LightParams {
            position: light.position.map(point),
            direction: light.direction.map(turned),
            range: light.range.map(|m| m * world.scale),
            ..light.clone()
        };
        Setup {
            triangles: self.triangles.iter().map(|t| t.map(|p| world.point(p))).collect(),
            camera,
            lights: self.lights.iter().map(light).collect(),
            image: self.image,
        }
    }

    pub(crate) fn with_lights(&self, lights: Vec<LightParams>) -> Setup {
        Setup { lights, ..self.clone() }
    }

    pub(crate) fn with_camera(&self, camera: CameraParams) -> Setup {
        Setup { camera, ..self.clone() }
    }

    pub(crate) fn with_image(&self, image: [u32; 2]) -> Setup {
        Setup { image, ..self.clone() }
    }

    /// With further triangles.
    pub(crate) fn with(&self, more: impl IntoIterator<Item = [DVec3; 3]>) -> Setup {
        let mut setup = self.clone();
        setup.triangles.extend(more);
        setup
    }
}

/// Two triangles, counter-clockwise.
pub(crate) fn quad([a, b, c, d]: [DVec3; 4]) -> Soup {
    vec![[a, b, c], [a, c, d]]
}

/// A floor of half side `half` at a height.
pub(crate) fn floor(half: f64, height: f64) -> Soup {
    let at = |x: f64, z: f64| dvec3(half * x, height, half * z);
    quad([at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)])
}

/// An axis-parallel box between two corners.
pub(crate) fn block(low: DVec3, high: DVec3) -> Soup {
    let corner = |k: usize| {
        let pick = |bit: usize, low: f64, high: f64| if k & bit == 0 { low } else { high };
        dvec3(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, low.z, high.z))
    };
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    faces.iter().flat_map(|face| quad(face.map(corner))).collect()
}

/// A camera at a point that looks at another one; y is up.
pub(crate) fn camera(at: DVec3, target: DVec3, fov: f64) -> CameraParams {
    let back = (at - target).normalize();
    let across = DVec3::Y.cross(back);
    let right = if across.length() > 1e-6 { across.normalize() } else { DVec3::X };
    let turn = DMat3::from_cols(right, back.cross(right), back);
    CameraParams {
        position: Some(at.to_array()),
        rotation: Some(DQuat::from_mat3(&turn).normalize().to_array()),
        fov: Some(fov),
        near: Some(1.0 / 16.0),
        ..CameraParams::default()
    }
}

/// Parallel light that travels along a direction.
pub(crate) fn sun(direction: DVec3) -> LightParams {
    LightParams {
        name: "sun".into(),
        kind: Some(LightKindName::Directional),
        direction: Some(direction.to_array()),
        ..LightParams::default()
    }
}

/// A point light.
pub(crate) fn lamp(position: DVec3) -> LightParams {
    LightParams {
        name: "lamp".into(),
        kind: Some(LightKindName::Point),
        position: Some(position.to_array()),
        ..LightParams::default()
    }
}

/// Where the light of [`yard`] travels to; no axis is special.
pub(crate) const SUN: DVec3 = dvec3(0.5, -0.75, -0.3125);

/// A floor with posts, a table and a wall: some forty shadow edges near and far. Coordinates are multiples of 5/16, so
/// that the turn of 3-4-5 keeps them exact in f32. The camera stands where no pixel looks along a face or at a vertex.
pub(crate) fn yard() -> Setup {
    let mut triangles = floor(20.0, 0.0);
    for k in 0..6 {
        let k = f64::from(k);
        let (x, z) = (-6.25 + 2.5 * k, -2.5 - 1.25 * ((k * 2.0) % 5.0));
        triangles.extend(block(dvec3(x, -0.3125, z), dvec3(x + 0.3125, 1.25 + 0.3125 * k, z + 0.3125)));
    }
    triangles.extend(block(dvec3(-1.875, 0.625, 0.625), dvec3(0.9375, 0.9375, 2.1875)));
    triangles.extend(block(dvec3(-10.0, -0.3125, -11.25), dvec3(3.75, 3.125, -10.625)));
    Setup {
        triangles,
        camera: camera(dvec3(1.23, 2.47, 7.39), dvec3(-0.61, 0.67, -2.53), 50.0),
        lights: vec![sun(SUN)],
        image: [640, 360],
    }
}
