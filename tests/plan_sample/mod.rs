//! A plan with something in every key, for the tests of plan files and of the commands that read them.

use lixel::fit::Termination;
use lixel::job::Job;
use lixel::methods::Method;
use lixel::plan::*;
use lixel::scene::{LightKindName, LightParams};

/// A job with a value of every kind.
pub(crate) fn job() -> Job {
    let mut job = Job { scene: vec!["a.glb".into(), "sets/b.obj".into()], ..Job::default() };
    job.frames.range = Some("1-240x2".to_owned());
    job.image.size = Some([1920, 1080]);
    job.camera.name = Some("Main \"wide\" – 35 mm".to_owned());
    job.light.push(LightParams {
        name: "sun".to_owned(),
        kind: Some(LightKindName::Directional),
        direction: Some([0.1, -1.0, 1e-300]),
        ..LightParams::default()
    });
    job.quality.epsilon = Some(0.001);
    job.map.bias.clamp = Some(0.01);
    job
}

/// A map whose matrix is full of numbers that are hard to write.
pub(crate) fn map(domain: Domain, light_camera: Option<LightCamera>) -> MapPlan {
    let light_camera_reason = light_camera.is_none().then(|| "the matrix warps".to_owned());
    MapPlan {
        method: Method::SceneOptimal,
        domain,
        clip_from_world: [
            [0.1, -1.0 / 3.0, 1e-308, 5e-324],
            [1.0, 0.0, f64::MAX, f64::EPSILON],
            [0.0, 0.0, std::f64::consts::PI, 6.4e6],
            [0.0, 0.0, -0.0, 1.0],
        ],
        width: 512,
        height: 384,
        near: -3.5,
        far: 120.25,
        bias: MapBias { constant: 6e-8, slope: 1.0, clamp: None, texels: 0.7, world: 0.004 },
        light_camera,
        light_camera_reason,
        witnesses: vec![Witness { world: [1.0, 2.0, 3.0], uv: [0.25, 0.75], depth: 0.5, shadowed: true }; 6],
        witnesses_reason: None,
        f32_roundtrip_texels: 1.5e-4,
    }
}

fn light(name: &str, kind: LightKindName, status: Status) -> LightPlan {
    LightPlan {
        light: name.to_owned(),
        kind,
        direction: None,
        position: None,
        cone_degrees: None,
        range: None,
        status,
        reason: None,
        epsilon: 0.001,
        maps: Vec::new(),
        error: None,
        solver: None,
        temporal: None,
        flicker: None,
        reprojected: None,
        budget: None,
        images: None,
        cost: Cost::default(),
    }
}

/// The bound a light met, or not.
pub(crate) fn error(misclassified: u64, met: bool) -> LightError {
    let measured = Measured {
        misclassified,
        of_pixels: 2_073_600,
        false_lit: misclassified / 2,
        false_shadow: misclassified - misclassified / 2,
        uncertain: 40,
        edge: misclassified,
        self_shadow: 0,
        ray_offset_m: 1e-5,
        larger_ray_offset_m: 1e-4,
        edge_on_degrees: 0.5,
        displacement: None,
        footprint: None,
    };
    let tried = Tried {
        width: 512,
        height: 384,
        texels: None,
        misclassified,
        uncertain: 40,
        displacement: None,
        footprint: None,
    };
    LightError {
        predicted: Some(Predicted {
            misclassified: 1900.5,
            uncertain: 0.5,
            unsaturated: 2500.25,
            sampled: None,
            displacement: Some(0.5),
            footprint: None,
        }),
        measured: Some(measured),
        tried: vec![tried],
        met,
    }
}

/// Two frames: a sun with one map and a bulb with two, then a light without a map.
pub(crate) fn plan(inputs: Vec<Input>) -> Plan {
    let frustum = Frustum { left: -1.0, right: 1.5, bottom: -0.5, top: 0.5, near: 0.1, far: 50.0 };
    let camera = LightCamera {
        projection: LightProjection::Perspective,
        position: [0.0, 4.0, 0.0],
        rotation: [0.0, 0.0, 0.0, 1.0],
        frustum,
        skew: 0.125,
    };
    let face = |face| Domain::CubeFace {
        position: [0.0, 4.0, 0.0],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        face,
    };
    let sun = LightPlan {
        direction: Some([0.0, -1.0, 0.0]),
        maps: vec![map(Domain::All, None)],
        error: Some(error(2000, true)),
        solver: Some(SolverReport {
            choice: None,
            tolerance: 0.001,
            spread: 0.0004,
            gap: Some(0.0001),
            evaluations: 812,
            rounds: 4,
            grazing: 3,
            joined: 17,
            termination: Termination::SimplexWithinTolerance,
        }),
        ..light("sun", LightKindName::Directional, Status::Planned)
    };
    let bulb = LightPlan {
        position: Some([0.0, 4.0, 0.0]),
        range: Some(12.0),
        reason: Some("over epsilon at the largest size".to_owned()),
        maps: vec![map(face(CubeFace::NegativeY), Some(camera.clone())), map(face(CubeFace::PositiveX), Some(camera))],
        error: Some(error(9000, false)),
        cost: Cost { samples: 5000, milliseconds: Some(12.5), ..Cost::default() },
        ..light("bulb", LightKindName::Point, Status::NotMet)
    };
    let spot = LightPlan {
        direction: Some([0.0, -1.0, 0.0]),
        position: Some([0.0, 4.0, 0.0]),
        cone_degrees: Some(30.0),
        reason: Some("no shadow of it is seen".to_owned()),
        ..light("spot", LightKindName::Spot, Status::NoVisibleShadow)
    };
    let film = PlanCamera {
        name: "Main".to_owned(),
        clip_from_world: [[1.0, 0.0, 0.0, 0.0]; 4],
        position: [0.0, 1.7, 5.0],
        width: 1920,
        height: 1080,
    };
    let frames = vec![
        FramePlan { frame: 1, time_s: 0.0, camera: film.clone(), lights: vec![sun, bulb] },
        FramePlan { frame: 3, time_s: 2.0 / 24.0, camera: film, lights: vec![spot] },
    ];
    Plan::new(PlannedJob { job: job(), inputs }, [0.0, 0.0, 6.4e6], frames)
}
