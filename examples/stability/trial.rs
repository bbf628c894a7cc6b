//! Plans a setup as a user would, from a scene file and a job, and asks of any answer that it is one.

use super::setup::Setup;
use glam::{DMat4, DVec3};
use lixel::job::{Job, LoadedJob, check};
use lixel::math::{Bounds, matrix_from_rows};
use lixel::measure::{Drawn, Receivers, Verdict};
use lixel::plan::{Domain, FramePlan, LightPlan, MapPlan, Plan, Status, Watch, make, to_text};
use lixel::raster::{Bias, Canvas};
use lixel::resolution::{FilmQuestion, fit_light, grid_of};
use lixel::samples::{Grid, GridView, LightSamples, LightView, sample_light};
use lixel::scene::{Light, SceneFrame, Shot};
use lixel::visibility::{Answer, Bvh, RayOffset, Tracer, View, classify, see};
use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// The bound of the suite, a share of the image: 230 pixels of 640 x 360, of which 2 % can be told from one.
pub(crate) const EPSILON: f64 = 0.001;

/// A job for a setup, and the file it plans.
fn job_of(setup: &Setup, dir: &Path) -> Result<LoadedJob, String> {
    let mut text = String::new();
    let mut known: HashMap<[u64; 3], usize> = HashMap::new();
    for triangle in &setup.triangles {
        let mut face = [0; 3];
        for (corner, p) in face.iter_mut().zip(triangle) {
            let next = known.len() + 1;
            *corner = *known.entry(p.to_array().map(f64::to_bits)).or_insert(next);
            if *corner == next {
                // `{:e}` writes the shortest text that reads back to the same f64, at any magnitude.
                writeln!(text, "v {:e} {:e} {:e}", p.x, p.y, p.z).map_err(|e| e.to_string())?;
            }
        }
        writeln!(text, "f {} {} {}", face[0], face[1], face[2]).map_err(|e| e.to_string())?;
    }
    std::fs::write(dir.join("scene.obj"), text).map_err(|e| e.to_string())?;
    let mut job = Job { scene: vec!["scene.obj".into()], light: setup.lights.clone(), ..Job::default() };
    job.camera = setup.camera.clone();
    job.image.size = Some(setup.image);
    job.quality.epsilon = Some(EPSILON);
    Ok(LoadedJob { job, file: None, dir: dir.to_owned() })
}

/// A planned setup, and everything needed to measure another matrix in it.
pub(crate) struct Trial {
    pub(crate) plan: Plan,
    pub(crate) shot: Shot,
    pub(crate) frame: SceneFrame,
    still: Bvh,
}

/// Plans a setup; `tune` has the last word on the job.
///
/// # Errors
/// What the planner says, or what [`faults`] finds.
pub(crate) fn plan(setup: &Setup, tune: impl Fn(&mut Job)) -> Result<Trial, String> {
    let dir = tempfile::tempdir().map_err(|e| e.to_string())?;
    let mut loaded = job_of(setup, dir.path())?;
    tune(&mut loaded.job);
    check(&loaded.job).map_err(|p| format!("{}: {}", p.key, p.message))?;
    let cancel = AtomicBool::new(false);
    let watch = Watch { progress: &|_| {}, cancel: &cancel, notes: &|_| {} };
    let plan = make(&loaded, dir.path(), false, &watch).map_err(|e| e.to_string())?;
    to_text(&plan, lixel::plan::Format::Json).map_err(|e| e.to_string())?;
    let shot = loaded.shot().map_err(|e| e.to_string())?;
    let frame = shot.scene.frame(0.0).map_err(|e| e.to_string())?;
    let still = Bvh::build(&shot.scene.still);
    let trial = Trial { plan, shot, frame, still };
    let fault = trial.lights().flat_map(|(frame, light)| faults(frame, light)).next();
    fault.map_or(Ok(trial), Err)
}

/// What is wrong with the entry of a light, whatever the scene: no reason, no map, a matrix that is an identity, that puts
/// its witnesses elsewhere or does not hold what it has to. Numbers that are not finite do not get through writing.
fn faults(frame: &FramePlan, light: &LightPlan) -> Vec<String> {
    let mut faults = Vec::new();
    let mapped = matches!(light.status, Status::Planned | Status::NotMet);
    if mapped == light.maps.is_empty() {
        faults.push(format!("{:?} with {} maps", light.status, light.maps.len()));
    }
    if (light.status == Status::Planned) == light.reason.is_some() {
        faults.push(format!("{:?} with reason {:?}", light.status, light.reason));
    }
    for map in &light.maps {
        let m = matrix_from_rows(&map.clip_from_world);
        let diagonal = m.transpose().to_cols_array_2d();
        let is_diagonal = (0..4).all(|r| (0..4).all(|c| r == c || diagonal[r][c] == 0.0));
        if m == DMat4::IDENTITY || m.determinant() == 0.0 || is_diagonal && m.x_axis.x == m.y_axis.y {
            faults.push(format!("matrix {m}"));
        }
        if map.width == 0 || map.height == 0 || map.near > map.far {
            faults.push(format!("map {}x{}, near {}, far {}", map.width, map.height, map.near, map.far));
        }
        for witness in &map.witnesses {
            let clip = m * DVec3::from_array(witness.world).extend(1.0);
            let uv = clip.truncate() / clip.w * 0.5 + 0.5;
            let off = (uv.x - witness.uv[0]).abs().max((uv.y - witness.uv[1]).abs()).max((uv.z - witness.depth).abs());
            // A matrix in f64 and a division: far below the 1/16384 of a texel's side that could matter.
            let placed = clip.w > 0.0 && off <= 1e-9 && witness.uv.iter().all(|v| (0.0..=1.0).contains(v));
            if !placed {
                faults.push(format!("witness {witness:?} is at {uv}, w = {}", clip.w));
            }
        }
    }
    if let Some(measured) = light.error.as_ref().and_then(|e| e.measured.as_ref()) {
        let limit = light.epsilon * f64::from(frame.camera.width) * f64::from(frame.camera.height);
        if light.met() && measured.misclassified as f64 > limit {
            faults.push(format!("{} wrong of {limit} allowed is no bound met", measured.misclassified));
        }
    }
    faults
}

impl Trial {
    /// Every light of every frame.
    pub(crate) fn lights(&self) -> impl Iterator<Item = (&FramePlan, &LightPlan)> {
        self.plan.frames.iter().flat_map(|frame| frame.lights.iter().map(move |light| (frame, light)))
    }

    /// The first light of the first frame.
    ///
    /// # Errors
    /// When there is none.
    pub(crate) fn first(&self) -> Result<&LightPlan, String> {
        self.lights().next().map(|(_, light)| light).ok_or_else(|| "no light".to_owned())
    }

    /// The first light as the scene has it.
    pub(crate) fn light(&self) -> &Light {
        &self.frame.lights[0]
    }

    fn tracer(&self) -> Tracer<'_> {
        Tracer::new(self.shot.scene.geometry(&self.frame), &self.still, None)
    }

    fn looked(&self, tracer: &Tracer) -> (View, RayOffset, Vec<Answer>) {
        let (view, offset) = (see(tracer, &self.frame.camera, self.shot.film), RayOffset::for_scene(tracer));
        let answers = classify(tracer, &view, &self.frame.camera, self.light(), offset);
        (view, offset, answers)
    }

    /// The size of the first light's map by the fit and its prediction, with the settings of the plan.
    ///
    /// # Errors
    /// When there is no fit, or not one map.
    pub(crate) fn fitted_size(&self) -> Result<[u32; 2], String> {
        let (job, samples) = (&self.plan.job.job, self.samples_of(self.plan.job.job.sampling.refine));
        let question = FilmQuestion {
            camera: &self.frame.camera,
            film: self.shot.film,
            light: self.light(),
            bounds: Bounds::of(self.tracer().bounds().into_iter().flatten()),
            quality: &job.quality,
            map: &job.map,
            solver: &job.solver,
            sample_cap: job.sampling.cap as usize,
        };
        let fitted = fit_light(&question, &samples, None).map_err(|e| e.to_string())?;
        let grid = grid_of(&question, &fitted);
        match grid.sizes(grid.at_least(fitted.texels)) {
            [size] => Ok(*size),
            sizes => Err(format!("{} maps where one was expected", sizes.len())),
        }
    }

    /// The shadow edges and the cover of the first light, at the resolution of the film.
    pub(crate) fn samples(&self) -> LightSamples {
        self.samples_of(3)
    }

    /// The same with so many halvings to locate an edge.
    fn samples_of(&self, refine: u32) -> LightSamples {
        let tracer = self.tracer();
        let (film, offset, answers) = self.looked(&tracer);
        let grid = Grid::new(self.shot.film, 4096);
        let view = GridView::see(&tracer, &self.frame.camera, grid, Some(&film));
        let camera = &self.frame.camera;
        let of = LightView { tracer: &tracer, camera, view: &view, light: self.light(), offset, answers: &answers };
        sample_light(&of, refine, false)
    }

    /// What one map with a given matrix, and otherwise as planned, answers wrongly for the first light.
    ///
    /// # Errors
    /// When it cannot be drawn.
    pub(crate) fn measured(&self, clip_from_scene: &DMat4, map: &MapPlan) -> Result<Verdict, String> {
        let tracer = self.tracer();
        let (view, offset, answers) = self.looked(&tracer);
        let camera = &self.frame.camera;
        let receivers = Receivers::new(&view, camera, &answers);
        let bias =
            Bias { constant: map.bias.constant, slope: map.bias.slope, clamp: map.bias.clamp.unwrap_or(f64::INFINITY) };
        let mut canvas = Canvas::default();
        canvas
            .draw(tracer.geometry(), clip_from_scene, map.width, map.height, bias, |_| true)
            .map_err(|e| e.to_string())?;
        let drawn = Drawn { domain: lixel::math::Domain::All, clip_from_scene: *clip_from_scene, map: canvas.map };
        let wrong = lixel::measure::wrong(&receivers, &[drawn], lixel::measure::Outside::Lit);
        let certainty = lixel::measure::Certainty::new(&tracer, &view, camera, self.light(), &receivers, offset);
        Ok(certainty.verdict(&wrong))
    }
}

/// The only map of a light, where it answers for every point.
///
/// # Errors
/// When there are several, or none.
pub(crate) fn only_map(light: &LightPlan) -> Result<&MapPlan, String> {
    match light.maps.as_slice() {
        [map] if map.domain == Domain::All => Ok(map),
        maps => Err(format!("{} maps where one was expected: {:?}", maps.len(), light.reason)),
    }
}
