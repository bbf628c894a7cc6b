//! The maps that a light of a frame is looked up in, as far as a draft names them.

use super::super::remeasure::draw;
use super::super::whole_shot::Ready;
use super::super::{MapPlan, domain};
use super::{FrameLight, LightDraft, Way};
use crate::math::{Domain, matrix_from_rows};
use crate::raster::{Bias, RasterError};
use crate::resolution::{SingleSided, Spent, texels};
use crate::scene::Light;
use crate::visibility::Tracer;
use glam::DMat4;
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Maps, before they are drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LookedUp {
    maps: Vec<(Domain, DMat4, [u32; 2])>,
    bias: Bias,
}

impl LookedUp {
    /// The maps of a light in a frame; `None` while they are not known.
    pub(super) fn of(draft: &LightDraft, frame: usize, state: &FrameLight) -> Option<LookedUp> {
        let none = LookedUp { maps: Vec::new(), bias: Bias::NONE };
        match &draft.way {
            Way::Segments(_) if !state.needs_map() => Some(none),
            Way::Segments(_) => {
                let held = draft.held(frame)?;
                let maps = held.maps_at(frame, held.size, state.motion.as_ref())?;
                let sizes = held.grid.sizes(held.size);
                let map =
                    |(m, size): (crate::resolution::JudgedMap, &[u32; 2])| (m.region.domain, m.clip_from_scene, *size);
                Some(LookedUp { maps: maps.into_iter().zip(sizes).map(map).collect(), bias: held.bias? })
            }
            Way::Each { .. } | Way::Chosen => {
                let maps = &state.answer.as_ref()?.entry.maps;
                let map =
                    |m: &MapPlan| (domain::read(&m.domain), matrix_from_rows(&m.clip_from_world), [m.width, m.height]);
                // All maps of a light share its bias.
                let bias = maps.first().map_or(Bias::NONE, |m| m.bias.drawn());
                Some(LookedUp { maps: maps.iter().map(map).collect(), bias })
            }
        }
    }

    /// Draws them.
    pub(super) fn draw(&self, tracer: &Tracer, light: &Light, sides: SingleSided) -> Result<Ready, RasterError> {
        let (mut drawn, mut spent) = (Vec::with_capacity(self.maps.len()), Spent::default());
        for (domain, clip_from_scene, size) in &self.maps {
            let (map, triangles) = draw(tracer, light, (domain.clone(), *clip_from_scene), *size, self.bias, sides)?;
            spent.texels_drawn += texels(&[*size]);
            spent.triangles_drawn += triangles;
            drawn.push(map);
        }
        Ok(Ready { drawn: Arc::new(drawn), spent })
    }

    /// What is hashed of them: everything that decides an answer but the scene.
    pub(super) fn fingerprint(then: &LookedUp, now: &LookedUp) -> [u8; 32] {
        let mut hasher = Sha256::new();
        for one in [then, now] {
            // Debug prints f64 so that it reads back the same, and never fails.
            hasher.update(format!("{one:?}").as_bytes());
            hasher.update([0]);
        }
        hasher.finalize().into()
    }
}
