//! Planning from images: from what lixel itself writes as a renderer would, the maps are those of the geometry; and images
//! that cannot be planned from are told why.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod watching;

use lixel::aov::AovError;
use lixel::job::{self, LoadedJob};
use lixel::picture::{Channel, write_exr};
use lixel::plan::{self, LightPlan, Outcome, Plan, PlanError, RangeEnd, Status, Summary, Verification};
use lixel::resolution::SingleSided;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use watching::watched;

fn courtyard_folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/courtyard"))
}

/// What both sides are planned with: predictions, on a grid of sizes 5 % apart.
const SETTINGS: &str = "[map]\nstep = 1.05\n[quality]\nepsilon = 0.02\n";

fn geometry(rest: &str, epsilon: f64) -> LoadedJob {
    let over = format!(
        "shot.temporal = 'per-frame'\n{rest}\n[map]\nstep = 1.05\n[quality]\nepsilon = {epsilon}\nmeasure = 'never'\n"
    );
    job::load(&courtyard_folder().join("courtyard.toml"), &over.parse().unwrap()).unwrap()
}

/// The images of two frames, in a folder that stays until the tests end.
static IMAGES: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let dir = tempfile::tempdir().unwrap();
    let job = geometry("[frames]\nrange = '30,60'\n[image]\nsize = [320, 180]", 0.02);
    let files = watched(|w| plan::render_images(&job, &dir.path().join("yard.####.exr"), w)).unwrap();
    assert_eq!(files, ["yard.0030.exr", "yard.0060.exr"].map(|name| dir.path().join(name)));
    dir
});

/// A job over those images; lights, and nothing else, from the courtyard.
fn images_job(aov: &str, rest: &str) -> LoadedJob {
    images_job_under(aov, rest, "").unwrap()
}

/// The same, with flags laid over it.
fn images_job_under(aov: &str, rest: &str, over: &str) -> Result<LoadedJob, job::JobError> {
    images_job_in(IMAGES.path(), aov, rest, over)
}

fn images_job_in(dir: &Path, aov: &str, rest: &str, over: &str) -> Result<LoadedJob, job::JobError> {
    let scene = courtyard_folder().join("courtyard.glb");
    let text = format!(
        "scene = {:?}\n{rest}\n[visibility]\nsource = 'aov'\n[aov]\nfile = 'yard.####.exr'\n{aov}\n{SETTINGS}",
        scene.display().to_string()
    );
    let file = tempfile::Builder::new().suffix(".toml").tempfile_in(dir).unwrap();
    fs::write(file.path(), text).unwrap();
    job::load(file.path(), &over.parse().unwrap())
}

const PLANAR: &str = "depth = { kind = 'planar' }";
const PER_FRAME: &str = "shot.temporal = 'per-frame'";

fn made(job: &LoadedJob) -> Result<Plan, PlanError> {
    watched(|w| plan::make(job, IMAGES.path(), false, w))
}

static FROM_IMAGES: LazyLock<Plan> = LazyLock::new(|| made(&images_job(PLANAR, PER_FRAME)).unwrap());
fn verify(plan: &Plan, dir: &Path) -> Verification {
    watched(|w| plan::verify(plan, dir, w)).unwrap()
}

fn lights(plan: &Plan) -> impl Iterator<Item = &LightPlan> {
    plan.frames.iter().flat_map(|f| &f.lights)
}

fn texels(light: &LightPlan) -> f64 {
    light.maps.iter().map(|m| m.texels() as f64).sum()
}

/// A plan with the maps of each light scaled to the texels of another's.
fn at_texels_of(plan: &Plan, other: &Plan) -> Plan {
    let mut scaled = plan.clone();
    for (light, other) in scaled.frames.iter_mut().flat_map(|f| &mut f.lights).zip(lights(other)) {
        let factor = (texels(other) / texels(light)).sqrt();
        for map in &mut light.maps {
            (map.width, map.height) =
                ((f64::from(map.width) * factor).round() as u32, (f64::from(map.height) * factor).round() as u32);
        }
    }
    scaled
}

#[test]
fn images_give_the_maps_that_geometry_gives() {
    let job = geometry("light = [{ name = 'sun' }]\n[frames]\nrange = '30'", 0.005);
    let counted = watched(|w| plan::make(&job, courtyard_folder(), false, w)).unwrap().job;
    // Predictions on both sides: images cannot be looked up by rays, and geometry is not where sides are left out.
    let mut predicted = job.clone();
    predicted.job.map.single_sided = SingleSided::CullBack;
    let geometry = watched(|w| plan::make(&predicted, courtyard_folder(), false, w)).unwrap();
    let dir = tempfile::tempdir().unwrap();
    watched(|w| plan::render_images(&job, &dir.path().join("yard.####.exr"), w)).unwrap();
    let rest = format!("{PER_FRAME}\nlight = [{{ name = 'sun' }}]");
    let images = watched(|w| {
        plan::make(&images_job_in(dir.path(), PLANAR, &rest, "quality.epsilon = 0.005").unwrap(), dir.path(), false, w)
    });
    let images = images.unwrap();
    // Drawn and counted on the courtyard, whatever they were planned from.
    let wrong = |plan: Plan| -> Vec<u64> {
        let on_geometry = Plan { job: counted.clone(), ..plan };
        let lights = verify(&on_geometry, courtyard_folder()).lights;
        lights.iter().map(|l| l.measured.unwrap() + l.uncertain.unwrap()).collect()
    };
    let counts = wrong(at_texels_of(&images, &geometry)).into_iter().zip(wrong(geometry.clone()));
    for ((a, b), (from_images, from_geometry)) in lights(&images).zip(lights(&geometry)).zip(counts) {
        assert_eq!((&a.light, a.status, a.maps.len()), (&b.light, b.status, b.maps.len()));
        let steps = (texels(a) / texels(b)).ln() / 2.0 / job.job.map.step.ln();
        // A twentieth of a step is the rounding of sides to whole texels.
        assert!(steps.abs() <= 1.05, "{}: {steps} steps of the grid", a.light);
        let ratio = from_images as f64 / from_geometry as f64;
        assert!(ratio <= 1.05, "{}: {from_images} wrong pixels, {from_geometry} from geometry", a.light);
    }
}

#[test]
fn plans_say_that_casters_were_not_seen_and_hold_against_their_images() {
    let plan = &*FROM_IMAGES;
    for light in lights(plan) {
        let images = light.images.as_ref().unwrap();
        assert_eq!((images.near, images.far), (RangeEnd::Receivers, RangeEnd::Receivers));
        assert!(images.note.contains("casters were not seen") && images.note.contains("predicted"), "{}", images.note);
        let error = light.error.as_ref().unwrap();
        assert!(error.measured.is_none() && error.tried.is_empty());
        assert!(light.maps.iter().all(|m| m.witnesses.len() >= 6), "{}", light.light);
    }
    let found = verify(plan, IMAGES.path());
    assert!(found.passed, "{found:?}");
    assert!(found.lights.iter().all(|l| l.measured.is_none() && l.outcome == Outcome::Holds));
    assert!(found.lights.iter().all(|l| l.witnesses_held == l.witnesses && l.witnesses >= 6));
    let broken = |change: &dyn Fn(&mut LightPlan), expected: &str| {
        let mut plan = plan.clone();
        change(&mut plan.frames[0].lights[0]);
        plan.summary = Summary::of(&plan.frames);
        let found = verify(&plan, IMAGES.path());
        let text = format!("{:?} {:?}", found.problems, found.lights[0].reasons);
        assert!(!found.passed && text.contains(expected), "`{expected}` is not in {text}");
    };
    broken(&|l| l.maps[0].clip_from_world[0][3] += 0.05, "witness");
    broken(&|l| l.maps[0].clip_from_world[0][0] *= 1.5, "lie outside it");
    broken(&|l| l.maps[0].clip_from_world[2][3] += 3.0, "out of its clip depth");
    broken(&|l| l.images = None, "does not say so");
    broken(&|l| l.maps[0].witnesses[0].shadowed ^= true, "exactly");
    broken(&|l| (l.status, l.maps, l.error) = (Status::Unlit, Vec::new(), None), "a map is needed");
}

#[test]
fn the_same_surfaces_come_out_of_every_layer_that_tells_them() {
    let plan = made(&images_job("position = { layer = 'P' }", PER_FRAME)).unwrap();
    for (a, b) in lights(&plan).zip(lights(&FROM_IMAGES)) {
        let steps = (texels(a) / texels(b)).ln() / 2.0 / plan.job.job.map.step.ln();
        assert!(steps.abs() <= 1.05, "{}: {steps} steps of the grid", a.light);
    }
    let by_normals = "depth = { layer = 'z', kind = 'planar' }\nnormal = {}\nshadow = { layer = 'SHADOW_{light}' }";
    let plan = made(&images_job(by_normals, PER_FRAME)).unwrap();
    for (a, b) in lights(&plan).zip(lights(&FROM_IMAGES)) {
        assert_eq!((&a.light, a.status), (&b.light, b.status));
        assert_ne!(a.cost.samples, b.cost.samples, "{}: normals say which pixels face the light", a.light);
    }
    assert!(verify(&plan, IMAGES.path()).passed);
}

#[test]
fn the_frames_of_a_shot_stand_alone_and_say_why() {
    let plan = made(&images_job(PLANAR, "shot.hold = 'shot'\n[[light]]\nname = 'sun'\nnear = -80.0")).unwrap();
    let suns: Vec<_> = lights(&plan).collect();
    for (sun, frame) in suns.iter().zip([30, 60]) {
        let temporal = sun.temporal.as_ref().unwrap();
        assert_eq!((temporal.segment, temporal.reused_from), (None, None));
        assert_eq!(temporal.drawn_at, Some(frame), "what moved is not known");
        assert!(temporal.reason.as_ref().unwrap().contains("planned from images"));
        assert_eq!(sun.images.as_ref().unwrap().near, RangeEnd::Job);
        assert!(sun.maps[0].near <= -79.0, "{}", sun.maps[0].near);
    }
    assert!(verify(&plan, IMAGES.path()).passed);
}

/// A 32 x 18 image of a floor with a shadow, in a folder of its own, and a job over it.
struct Small {
    dir: tempfile::TempDir,
}

impl Small {
    fn new(change: impl Fn(&mut Vec<Channel>)) -> Small {
        let dir = tempfile::tempdir().unwrap();
        let values = |f: &dyn Fn(usize, usize) -> f32| (0..32 * 18).map(|k| f(k % 32, k / 32)).collect();
        let channel =
            |name: &str, f: &dyn Fn(usize, usize) -> f32| Channel { name: name.to_owned(), values: values(f) };
        // A floor two metres below a camera that looks along -z, 45 degrees high.
        let tangent = (22.5_f32).to_radians().tan();
        let depth = |_: usize, y: usize| {
            let below = (y as f32 + 0.5) / 9.0 - 1.0;
            if below > 0.1 { 2.0 / (below * tangent) } else { f32::INFINITY }
        };
        let shadow = |x: usize, y: usize| f32::from(u8::from((10..20).contains(&x) && y > 12));
        let mut channels = vec![channel("Z", &depth), channel("shadow_key.Y", &shadow)];
        change(&mut channels);
        fs::write(dir.path().join("a.exr"), write_exr(32, 18, channels).unwrap()).unwrap();
        Small { dir }
    }

    fn plan(&self, text: &str) -> Result<Plan, PlanError> {
        let camera = "[camera]\nposition = [0, 2, 0]\nlook_at = [0, 2, -1]\n";
        self.plan_seen_by(camera, text)
    }

    fn plan_seen_by(&self, camera: &str, text: &str) -> Result<Plan, PlanError> {
        let light = "[[light]]\nname = 'key'\nkind = 'point'\nposition = [0.5, 6, -6]\n";
        let base = format!("{camera}{light}[visibility]\nsource = 'aov'\n[quality]\nepsilon = 0.02\n[aov]\n{text}\n");
        let file: PathBuf = self.dir.path().join("job.toml");
        fs::write(&file, base).unwrap();
        let job = job::load(&file, &toml::Table::new()).unwrap();
        watched(|w| plan::make(&job, self.dir.path(), false, w))
    }
}

const FILE: &str = "file = 'a.exr'\ndepth = { kind = 'planar' }";

#[test]
fn a_job_without_any_scene_is_planned_from_one_image() {
    let small = Small::new(|_| ());
    let plan = small.plan(FILE).unwrap();
    let light = &plan.frames[0].lights[0];
    assert_eq!((light.status, plan.frames[0].frame), (Status::Planned, 1));
    assert_eq!((plan.frames[0].camera.width, plan.frames[0].camera.height), (32, 18));
    assert!(plan.job.job.scene.is_empty());
    assert_eq!(plan.job.inputs.iter().map(|i| i.path.as_str()).collect::<Vec<_>>(), ["a.exr"]);
    assert!(verify(&plan, small.dir.path()).passed);
    let distance = small.plan("file = 'a.exr'\ndepth = { kind = 'distance' }").unwrap();
    assert_ne!(distance.frames[0].lights[0].maps, light.maps, "the kind of depth is heeded");
    let inverted = small.plan(&format!("{FILE}\nshadow = {{ one = 'lit' }}")).unwrap();
    assert_ne!(inverted.frames[0].lights[0].maps, light.maps, "the meaning of 1 is heeded");
    fs::write(small.dir.path().join("a.exr"), "changed").unwrap();
    let found = verify(&plan, small.dir.path());
    assert!(!found.passed && found.inputs[0].reason.is_some());
}

#[test]
fn what_is_wrong_with_images_is_said_with_the_remedy() {
    let nan = |name: &'static str, value: f32| {
        Small::new(move |c| c.iter_mut().filter(|c| c.name == name).for_each(|c| c.values[5 * 32 + 3] = value))
    };
    let told = |small: &Small, text: &str, parts: &[&str]| {
        let error = small.plan(text).unwrap_err();
        assert!(matches!(error, PlanError::Aov(_)), "{error}");
        let text = error.to_string();
        for part in parts {
            assert!(text.contains(part), "`{part}` is not in `{text}`");
        }
    };
    let sound = Small::new(|_| ());
    told(&sound, "file = 'b.exr'\ndepth = { kind = 'planar' }", &["b.exr", "cannot be read"]);
    told(&sound, "file = 'b.####.exr'\ndepth = { kind = 'planar' }", &["b.####.exr", "no file of this pattern"]);
    told(&sound, "file = 'a.exr'\nposition = {}", &["aov.position.layer", "\"P\"", "layers there: Z, shadow_key.Y"]);
    told(&sound, &format!("{FILE}\nshadow = {{ layer = 'sh_{{light}}' }}"), &["sh_key", "shadow_key.Y"]);
    told(&nan("Z", f32::NAN), FILE, &["a.exr", "\"Z\"", "1 pixels are NaN", "x = 3, y = 5"]);
    told(&nan("shadow_key.Y", f32::INFINITY), FILE, &["shadow_key", "NaN or infinite"]);
    told(&nan("shadow_key.Y", 255.0), FILE, &["outside 0 to 1"]);
    let error = sound.plan_seen_by("", FILE).unwrap_err().to_string();
    assert!(error.contains("neither worldToNDC nor worldToCamera") && error.contains("[camera]"), "{error}");
    let wide =
        sound.plan_seen_by("image.size = [64, 36]\n[camera]\nposition = [0, 2, 0]\nlook_at = [0, 2, -1]\n", FILE);
    let text = wide.unwrap_err().to_string();
    assert!(text.contains("32x18") && text.contains("64x36") && text.contains("[image] size"), "{text}");
    fs::write(sound.dir.path().join("c.exr"), "not an image").unwrap();
    told(&sound, "file = 'c.exr'\ndepth = { kind = 'planar' }", &["c.exr", "OpenEXR"]);
    let elsewhere = Small::new(|channels| {
        for name in ["P.x", "P.y", "P.z"] {
            channels.push(Channel { name: name.to_owned(), values: vec![-7.0; 32 * 18] });
        }
    });
    let error = elsewhere.plan("file = 'a.exr'\nposition = {}").unwrap_err();
    assert!(matches!(error, PlanError::Aov(AovError::Elsewhere { .. })), "{error}");
}

#[test]
fn commands_that_draw_refuse_a_job_of_images() {
    let job = images_job(PLANAR, PER_FRAME);
    let error = watched(|w| plan::render(&job, 30, None, IMAGES.path(), w)).unwrap_err();
    assert!(matches!(error, PlanError::NoGeometry), "{error}");
    let error = images_job_under(PLANAR, PER_FRAME, "quality.measure = 'always'").unwrap_err().to_string();
    assert!(error.contains("quality.measure"), "{error}");
}
