//! The stage of a frame, set from the shot: its triangles sorted for rays, its film and its planning grid seen.

use super::seen::Seen;
use super::{PlanError, images};
use crate::aov::{Images, ImagesFrame};
use crate::depth::{Kept, Visible};
use crate::job::Job;
use crate::math::Bounds;
use crate::measure::{Outside, Receivers};
use crate::methods::Region;
use crate::resolution::{FilmQuestion, JudgedMap, OnFilm, Sampled};
use crate::samples::{Grid, GridView, LightSamples, LightView, sample_light};
use crate::scene::{Camera, Film, FrameTime, Light, SceneFrame, Shot};
use crate::shot::Temporal;
use crate::visibility::{Answer, Bvh, RayOffset, Tracer, View, classify, see};
use glam::DVec3;
use std::sync::Arc;

/// What a frame gives to each of its lights.
pub(crate) struct FrameStage<'a> {
    pub(crate) tracer: &'a Tracer<'a>,
    pub(crate) camera: &'a Camera,
    pub(crate) film: Film,
    pub(super) grid: &'a GridView<'a>,
    /// Absent when nothing is measured.
    pub(crate) view: Option<&'a View>,
    pub(super) bounds: Bounds,
    pub(crate) offset: RayOffset,
    /// Rays spent on the frame itself, shared out.
    pub(super) rays_share: u64,
    /// A renderer's images of the frame, asked instead of rays; there are no triangles then, no view and no grid.
    pub(super) images: Option<&'a ImagesFrame>,
}

/// What rays say of one light of a frame.
pub(crate) struct Lit {
    /// What the light does at each position of the planning grid.
    pub(super) answers: Vec<Answer>,
    /// The film's pixels that face the light; absent when nothing is measured.
    pub(crate) film: Option<Receivers>,
    /// Shadow edges and covered points.
    pub(crate) samples: LightSamples,
    /// Rays spent.
    pub(super) rays: u64,
}

impl FrameStage<'_> {
    /// What is asked of one light.
    pub(crate) fn question<'b>(&'b self, light: &'b Light, job: &'b Job) -> FilmQuestion<'b> {
        FilmQuestion {
            camera: self.camera,
            film: self.film,
            light,
            bounds: self.bounds,
            quality: &job.quality,
            map: &job.map,
            solver: &job.solver,
            sample_cap: job.sampling.cap as usize,
        }
    }

    /// What a light's maps are measured on; `None` when nothing is measured.
    pub(crate) fn on_film<'b>(&'b self, receivers: &'b Receivers) -> Option<OnFilm<'b>> {
        Some(OnFilm { tracer: self.tracer, view: self.view?, receivers, offset: self.offset })
    }

    /// What stands for the film where nothing is measured; `None` where no ray can be sent.
    pub(super) fn sampled<'b>(&'b self, question: &'b FilmQuestion, seen: &[Seen]) -> Option<Sampled<'b>> {
        if self.images.is_some() { None } else { Sampled::new(question, self.tracer, seen, self.grid.grid.len()) }
    }

    /// Asks the film for one light, of which the planning grid is a part, or that alone.
    pub(crate) fn look(&self, light: &Light, job: &Job) -> Lit {
        if let Some(images) = self.images {
            return images::look(images, light, job);
        }
        let FrameStage { tracer, camera, grid: view, offset, .. } = *self;
        let facing = |answers: &[Answer]| answers.iter().filter(|a| **a != Answer::Unlit).count() as u64;
        let classified = self.view.map(|film| classify(tracer, film, camera, light, offset));
        let film = self.view.zip(classified.as_ref()).map(|(film, answers)| Receivers::new(film, camera, answers));
        let film_rays = film.as_ref().map_or(0, |f| f.len() as u64);
        let (answers, grid_rays) = match classified {
            Some(answers) => (view.grid.of_film(&answers).into_owned(), 0),
            None => {
                let answers = view.answers(tracer, camera, light, offset);
                let rays = facing(&answers);
                (answers, rays)
            }
        };
        let lit = LightView { tracer, camera, view, light, offset, answers: &answers };
        let samples = sample_light(&lit, job.sampling.refine, job.map.outside == Outside::Shadowed);
        let rays = film_rays + grid_rays + samples.rays;
        Lit { answers, film, samples, rays }
    }

    /// What the depth range of a region's map has to hold, given the visible points that may look it up.
    pub(super) fn kept(&self, region: &Region, visible: &[DVec3], light: &Light, job: &Job) -> Kept<'_> {
        match self.images {
            None => JudgedMap::kept(region, self.tracer, &Visible::new(visible)),
            Some(_) => {
                let unseen = images::unseen(light, job, self.bounds);
                Kept::of_visible(&region.space, &region.h, visible, &region.domain, &unseen)
            }
        }
    }
}

/// A frame with its moving triangles sorted for rays.
pub(super) struct Posed {
    pub(super) frame: SceneFrame,
    moving: Option<Bvh>,
}

impl Posed {
    /// The scene at a time of the shot.
    ///
    /// # Errors
    /// When it has no pose then.
    pub(super) fn new(shot: &Shot, time_s: f64) -> Result<Posed, PlanError> {
        let frame = shot.scene.frame(time_s)?;
        let moving = Bvh::moving(&shot.scene, &frame);
        Ok(Posed { frame, moving })
    }

    /// Rays through it.
    pub(super) fn tracer<'a>(&'a self, shot: &'a Shot, still: &'a Bvh) -> Tracer<'a> {
        Tracer::new(shot.scene.geometry(&self.frame), still, self.moving.as_ref())
    }
}

/// What all frames of a shot share.
pub(crate) struct Stages<'a> {
    pub(crate) shot: &'a Shot,
    pub(crate) job: &'a Job,
    pub(super) still: Arc<Bvh>,
    /// Asked instead of rays, where the job says so.
    pub(super) images: Option<&'a Images>,
}

impl<'a> Stages<'a> {
    /// Sorts the still triangles.
    pub(crate) fn new(shot: &'a Shot, job: &'a Job, images: Option<&'a Images>) -> Stages<'a> {
        Stages { shot, job, still: Arc::new(Bvh::still(&shot.scene)), images }
    }

    /// The same shot under other settings; only those of what is planned may differ, not of what there is to see.
    pub(crate) fn with_job<'b>(&'b self, job: &'b Job) -> Stages<'b> {
        Stages { shot: self.shot, job, still: Arc::clone(&self.still), images: self.images }
    }

    /// Number of frames.
    pub(crate) fn len(&self) -> usize {
        self.shot.frames.len()
    }

    /// A frame of the shot, by place.
    pub(crate) fn time(&self, frame: usize) -> FrameTime {
        self.shot.frames[frame]
    }

    /// Sets the stage of a frame, by place, and hands it over.
    ///
    /// # Errors
    /// When the frame has no pose; and those of `work`.
    pub(crate) fn with<R>(
        &self,
        frame: usize,
        work: impl FnOnce(&FrameStage, &SceneFrame) -> Result<R, PlanError>,
    ) -> Result<R, PlanError> {
        Ok(self.set(frame, true, work)?.0)
    }

    /// The same for who asks the film alone: where it is measured, the planning grid is empty.
    ///
    /// # Errors
    /// When the frame has no pose; and those of `work`.
    pub(crate) fn film<R>(
        &self,
        frame: usize,
        work: impl FnOnce(&FrameStage, &SceneFrame) -> Result<R, PlanError>,
    ) -> Result<R, PlanError> {
        Ok(self.set(frame, !measures(self.job), work)?.0)
    }

    /// Sets the stage of a frame, with its planning grid seen or empty, and hands it over; gives back the posed frame.
    ///
    /// # Errors
    /// When the frame has no pose; and those of `work`.
    pub(super) fn set<R>(
        &self,
        place: usize,
        grid: bool,
        work: impl FnOnce(&FrameStage, &SceneFrame) -> Result<R, PlanError>,
    ) -> Result<(R, Posed), PlanError> {
        let (shot, job) = (self.shot, self.job);
        let time = self.time(place);
        let posed = Posed::new(shot, time.time_s)?;
        let (tracer, frame) = (posed.tracer(shot, &self.still), &posed.frame);
        let images = self.images.map(|images| images.frame(time.frame, &frame.camera, &frame.lights)).transpose()?;
        let bounds = match &images {
            Some(images) => Bounds::of((0..shot.film.pixels()).filter_map(|pixel| images.film.position(pixel))),
            None => tracer.bounds().map_or(Bounds::EMPTY, |[min, max]| Bounds { min, max }),
        };
        let grid = grid && images.is_none();
        let positions = Grid::new(shot.film, job.sampling.grid);
        let view = measures(job).then(|| see(&tracer, &frame.camera, shot.film));
        let primary = match &view {
            Some(view) => view.film.pixels(),
            None if grid => positions.len(),
            None => 0,
        };
        let grid = if grid {
            GridView::see(&tracer, &frame.camera, positions, view.as_ref())
        } else {
            GridView::unseen(positions)
        };
        let stage = FrameStage {
            tracer: &tracer,
            camera: &frame.camera,
            film: shot.film,
            grid: &grid,
            view: view.as_ref(),
            bounds,
            offset: RayOffset::for_scene(&tracer),
            rays_share: (primary / frame.lights.len().max(1)) as u64,
            images: images.as_ref(),
        };
        let done = work(&stage, frame)?;
        Ok((done, posed))
    }

    /// The mode by which the shot is planned: one frame has no other.
    pub(super) fn mode(&self) -> Temporal {
        if self.len() > 1 { self.job.shot.temporal } else { Temporal::PerFrame }
    }
}

/// Whether a job measures.
pub(super) fn measures(job: &Job) -> bool {
    job.quality.measure.measures()
}
