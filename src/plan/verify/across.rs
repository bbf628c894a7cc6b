//! What a plan says across frames: flicker, which maps are reused, and which frame needs a segment's size.

use super::super::remeasure::{Before, Remeasured};
use super::super::{Cost, LightPlan, Plan, Reprojected, Tried};
use super::LightCheck;
use crate::measure::{Drawn, Earlier, Verdict};
use crate::resolution::Bound;
use crate::scene::Shot;
use crate::visibility::Bvh;
use std::sync::Arc;

/// What is kept from frame to frame.
#[derive(Default)]
pub(super) struct Across {
    /// The frame before.
    pub(super) before: Option<Before>,
    /// The maps of each light drawn last, with the frame that the plan says they are drawn in.
    drawn: Vec<(String, i64, Arc<Vec<Drawn>>)>,
}

impl Across {
    /// Checks an entry against the frames before it.
    pub(super) fn check(
        &mut self,
        check: &mut LightCheck,
        plan: &Plan,
        entry: &LightPlan,
        measured: &Remeasured,
        of_shot: (&Shot, &Bvh),
        earlier: Option<&[Option<Earlier>]>,
    ) {
        let mut faults: Vec<String> = Vec::new();
        if let (Some(before), Some(earlier)) = (&self.before, earlier) {
            let found = before.flicker(of_shot, earlier, &entry.light, measured, plan.job.job.map.outside);
            check.flicker = found.map(|f| f.still);
            if let Some(planned) = entry.flicker
                && found != Some(planned)
            {
                faults.push(format!("flicker is {planned:?} in the plan, {found:?} measured again"));
            }
        }
        faults.extend(self.reuse_fault(check.frame, entry, measured));
        faults.extend(decider_fault(plan, entry));
        faults.extend(same_fault(plan, check.frame, entry));
        if !faults.is_empty() {
            check.outcome = super::Outcome::Broken;
            check.reasons.extend(faults);
        }
    }

    /// Maps that are said to be those of an earlier frame are drawn here: the depths have to be the same, to the bit.
    fn reuse_fault(&mut self, frame: i64, entry: &LightPlan, measured: &Remeasured) -> Option<String> {
        let temporal = entry.temporal.as_ref()?;
        if entry.maps.is_empty() {
            return None;
        }
        let last = self.drawn.iter().position(|(name, ..)| *name == entry.light).map(|i| self.drawn.remove(i));
        let origin = temporal.reused_from.unwrap_or(frame);
        let same = |a: &Drawn, b: &Drawn| a.clip_from_scene == b.clip_from_scene && a.map == b.map;
        let fault = match (temporal.reused_from, temporal.drawn_at, &last) {
            (None, Some(at), _) if at == frame => None,
            (Some(from), None, Some((_, origin, maps))) if *origin == from => {
                let equal = maps.len() == measured.drawn.len()
                    && maps.iter().zip(measured.drawn.iter()).all(|(a, b)| same(a, b));
                (!equal).then(|| format!("its maps are not those drawn in frame {from}"))
            }
            (Some(from), ..) => {
                Some(format!("its maps are said to be reused from frame {from}, which drew none before it"))
            }
            _ => Some("it has maps, and says neither that they are drawn nor that they are reused".to_owned()),
        };
        self.drawn.push((entry.light.clone(), origin, Arc::clone(&measured.drawn)));
        fault
    }
}

/// What a renderer that blends answers over time shows, against what the plan says of it.
pub(super) fn check_shown(check: &mut LightCheck, entry: &LightPlan, shown: Reprojected) {
    let expected = Some(shown).filter(|_| !entry.maps.is_empty());
    let mut faults = Vec::new();
    if entry.reprojected != expected {
        faults.push(format!("reprojected is {:?} in the plan, {expected:?} measured again", entry.reprojected));
    }
    if expected.is_some_and(|shown| entry.budget.is_none() && shown.met != entry.met()) {
        faults.push("the bound is not judged by what reprojection leaves".to_owned());
    }
    if !faults.is_empty() {
        check.outcome = super::Outcome::Broken;
        check.reasons.extend(faults);
    }
}

/// An entry that is said to be an earlier frame's is.
fn same_fault(plan: &Plan, frame: i64, entry: &LightPlan) -> Option<String> {
    let first = entry.temporal.as_ref()?.same_as?;
    let there = plan.frames.iter().take_while(|f| f.frame != frame).find(|f| f.frame == first);
    let there = there.and_then(|f| f.lights.iter().find(|l| l.light == entry.light));
    let bare = |l: &LightPlan| LightPlan { temporal: None, flicker: None, cost: Cost::default(), ..l.clone() };
    (there.map(bare) != Some(bare(entry))).then(|| format!("its entry is said to be that of frame {first}, and is not"))
}

/// In the frame that is said to need a segment's size, the next smaller size tried is over.
fn decider_fault(plan: &Plan, entry: &LightPlan) -> Option<String> {
    let decided_by = entry.temporal.as_ref()?.decided_by?;
    let first = entry.maps.first()?;
    let at = plan.frames.iter().find(|f| f.frame == decided_by);
    let Some(decider) = at.and_then(|f| f.lights.iter().find(|l| l.light == entry.light)) else {
        return Some(format!("frame {decided_by} is said to need the size, and is not in the plan"));
    };
    if plan.job.job.quality.bound != Bound::Misclassified || entry.maps.len() > 1 || !decider.met() {
        return None;
    }
    let measured = decider.error.as_ref()?.measured.as_ref()?;
    let limit = decider.epsilon * measured.of_pixels as f64;
    let texels = |t: &Tried| u64::from(t.width) * u64::from(t.height);
    let meets = |t: &Tried| {
        let certain = crate::measure::Counts { false_lit: t.misclassified, ..Default::default() };
        Verdict { certain, uncertain: t.uncertain }.meets(limit)
    };
    let smaller = decider.error.as_ref()?.tried.iter().filter(|t| texels(t) < first.texels());
    let next = smaller.max_by_key(|t| texels(t))?;
    let (width, height) = (next.width, next.height);
    meets(next).then(|| format!("frame {decided_by} is said to need the size, but meets {width}x{height} too"))
}
