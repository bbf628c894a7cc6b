//! A draft plan: the planning grid, the shadow edges, the fit, lookups by rays, a second fit, the size, the depth rows, with
//! the settings of `configs/draft.toml`; what `lixel plan` does, but for writing the entry.

use crate::{Case, lap};
use glam::DVec3;
use lixel::depth::Visible;
use lixel::measure::Seen;
use lixel::methods::Region;
use lixel::resolution::{FittedLight, JudgedMap, Sampled, Unmeasured};
use lixel::samples::{Grid, GridView, LightView, sample_light};
use lixel::visibility::Answer;
use std::cell::Cell;
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

pub(crate) struct Draft {
    /// Rays; fits, lookups and size; depth rows.
    pub(crate) parts_ms: [f64; 3],
    pub(crate) edges: usize,
    /// Sizes of the maps; none when the light casts no visible shadow.
    pub(crate) sizes: Vec<[u32; 2]>,
}

impl Case<'_> {
    pub(crate) fn draft(&self) -> Result<Draft, Box<dyn Error>> {
        let start = Instant::now();
        let Case { tracer, light, offset, job, .. } = *self;
        let camera = &self.frame.camera;
        let grid = GridView::see(tracer, camera, Grid::new(self.film, job.sampling.grid), None);
        let answers = grid.answers(tracer, camera, light, offset);
        let lit = LightView { tracer, camera, view: &grid, light, offset, answers: &answers };
        let samples = sample_light(&lit, job.sampling.refine, false);
        // The visible points that depth rows, lookups and witnesses are made from.
        let seen: Vec<Seen> = (0..answers.len())
            .filter(|i| answers[*i] != Answer::Unlit)
            .filter_map(|i| {
                let surface = grid.surface(tracer, camera, i)?;
                let shadowed = answers[i] == Answer::Shadowed;
                Some(Seen { position: surface.position, normal: surface.normal, shadowed })
            })
            .collect();
        let receivers: Vec<DVec3> = seen.iter().map(|s| s.position).collect();
        let mut draft = Draft { parts_ms: [lap(start), 0.0, 0.0], edges: samples.edges.len(), sizes: Vec::new() };
        if samples.shadowed == 0 {
            return Ok(draft);
        }
        let start = Instant::now();
        let question = self.question(job);
        let rows_ms = Cell::new(0.0);
        let maps_of = |fitted: &FittedLight, receivers: &[DVec3]| {
            let start = Instant::now();
            let kept = |region: &Region, own: &[DVec3]| JudgedMap::kept(region, tracer, &Visible::new(own));
            let maps = JudgedMap::of_all_by(&fitted.regions, receivers, kept);
            rows_ms.set(rows_ms.get() + lap(start));
            maps
        };
        let sampled = Sampled::new(&question, tracer, &seen, grid.grid.len());
        let unmeasured =
            Unmeasured { question: &question, receivers: &receivers, sampled: sampled.as_ref(), maps_of: &maps_of };
        draft.sizes = black_box(unmeasured.planned(&samples, None)?).certified.sizes;
        draft.parts_ms[1] = lap(start) - rows_ms.get();
        draft.parts_ms[2] = rows_ms.get();
        Ok(draft)
    }
}
