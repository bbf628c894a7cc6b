//! `auto`: a ladder of methods, each rung with more to draw and look up than the one before, climbed for as long as a step
//! saves its share of the texels.
//!
//! No map at all comes before the ladder: a light without a visible shadow is not asked here. The rungs are `focused`, one
//! map of `lixel`, and `partitioned` with two maps and more. A step from need a to need b saves 1 - b/a; the first step to
//! more maps that saves less than `solver.min_saving` ends the climb, and later ones are not tried, so that a plan costs what
//! it takes to see that more would not pay. A warp that does not pay is passed over and two maps are tried all the same:
//! they gain by something else, and it was met that one map needs 13 % more with a warp and two need 85 % less. Below the
//! bound there is no saving to speak of: until a rung meets, the climb goes on, and where none does the one nearest to the
//! bound is taken.
//!
//! Rungs are compared as their methods fit them. Looking for better maps near them, by measurement, takes most of the time of
//! a plan with one map, and is left to the rung that is taken. But where a step does not pay and lies within [`REACH`] of it,
//! better maps are looked for near both ends first: what they gain differs. Like is compared with like, as fitted or improved.

use crate::methods::{Method, SolverParams};

/// What a saving may gain when better maps are looked for near both ends of a step. Up to 35 % of the texels were met at one
/// end and nothing at the other; most gains differ by less than this.
const REACH: f64 = 0.3;

/// A method with its number of maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rung {
    /// `focused`, `lixel` or `partitioned`.
    pub method: Method,
    /// Most maps, of each cube face for a light among the geometry.
    pub maps: u32,
}

impl Rung {
    /// The settings that plan it.
    pub fn solver(&self, solver: &SolverParams) -> SolverParams {
        SolverParams { method: self.method, maps: self.maps, ..solver.clone() }
    }
}

/// What the maps of a rung need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Need {
    /// Texels of all maps together at which the bound is met; the most that the job allows where it is not.
    pub texels: f64,
    /// The bound is met.
    pub met: bool,
    /// The error at these texels over what the bound allows.
    pub error: f64,
    /// Number of maps.
    pub maps: usize,
}

/// A rung that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct TriedRung {
    /// Which.
    pub rung: Rung,
    /// What it needs, or the reason why it has no maps.
    pub need: Result<Need, String>,
    /// The texels that the better maps near it need, where they were looked for.
    pub improved: Option<f64>,
    /// The share that it saves of the texels of the rung held before it, of the improved ones where it has these; absent
    /// where one of the two has no figure.
    pub saving: Option<f64>,
}

/// Why a climb ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// The last rung tried saves less than the share asked for.
    Saving,
    /// The last rung tried misses the bound, which the one below meets.
    Missed,
    /// The last rung tried has no more maps than the one below, or none.
    NoMoreMaps,
    /// There is no further rung.
    Top,
}

/// A climb.
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    /// In order.
    pub tried: Vec<TriedRung>,
    /// Place among these of the rung that is taken; `None` where none has maps.
    pub chosen: Option<usize>,
    /// Why the climb ended.
    pub stop: Stop,
}

/// The rungs of a job, in order.
pub fn rungs(solver: &SolverParams) -> Vec<Rung> {
    let single = [Method::Focused, Method::Lixel].map(|method| Rung { method, maps: 1 });
    let several = (2..=solver.max_maps).map(|maps| Rung { method: Method::Partitioned, maps });
    single.into_iter().chain(several).collect()
}

/// A rung with what was found of it.
struct Held<T> {
    /// Among those tried.
    place: usize,
    /// As fitted.
    fitted: Need,
    /// Improved, where it is.
    need: Need,
    kept: T,
    improved: bool,
}

/// Climbs. `need` finds what a rung needs, or why it has no maps, with whatever else is to be kept of the one that is taken;
/// `improve` looks for better maps near a rung's. Errors of both pass through. What is given back is improved.
pub fn climb<T, E>(
    rungs: &[Rung],
    min_saving: f64,
    mut need: impl FnMut(&Rung) -> Result<Result<(Need, T), String>, E>,
    mut improve: impl FnMut(&Rung, (Need, T)) -> Result<(Need, T), E>,
) -> Result<(Ladder, Option<T>), E> {
    let mut tried: Vec<TriedRung> = Vec::new();
    let mut best: Option<Held<T>> = None;
    let mut stop = Stop::Top;
    let mut improved = |held: Held<T>, tried: &mut [TriedRung]| {
        if held.improved {
            return Ok(held);
        }
        let (need, kept) = improve(&tried[held.place].rung, (held.need, held.kept))?;
        tried[held.place].improved = Some(need.texels);
        Ok::<_, E>(Held { need, kept, improved: true, ..held })
    };
    for rung in rungs {
        let several = rung.method == Method::Partitioned;
        let place = tried.len();
        let (need, kept) = match need(rung)? {
            Ok(found) => found,
            Err(reason) => {
                tried.push(TriedRung { rung: *rung, need: Err(reason), improved: None, saving: None });
                if several {
                    stop = Stop::NoMoreMaps;
                    break;
                }
                continue;
            }
        };
        tried.push(TriedRung { rung: *rung, need: Ok(need), improved: None, saving: None });
        let mut here = Held { place, fitted: need, need, kept, improved: false };
        let Some(mut below) = best.take() else {
            best = Some(here);
            continue;
        };
        if several && here.need.maps <= below.need.maps {
            stop = Stop::NoMoreMaps;
            best = Some(below);
            break;
        }
        let mut saving = step(&below.fitted, &here.fitted);
        let in_reach = saving.is_some_and(|saving| saving >= min_saving - REACH);
        if in_reach && (below.improved || saving.is_some_and(|saving| saving < min_saving)) {
            below = improved(below, &mut tried)?;
            here = improved(here, &mut tried)?;
            saving = step(&below.need, &here.need);
        }
        tried[place].saving = saving;
        let pays = match (below.need.met, here.need.met) {
            (true, _) => saving.is_some_and(|saving| saving >= min_saving),
            (false, true) => true,
            (false, false) => here.need.error < below.need.error,
        };
        stop = match (pays || !below.need.met, here.need.met) {
            (true, _) => Stop::Top,
            (false, true) => Stop::Saving,
            (false, false) => Stop::Missed,
        };
        best = Some(if pays { here } else { below });
        if several && stop != Stop::Top {
            break;
        }
    }
    let chosen = best.as_ref().map(|b| b.place);
    let kept = best.map(|held| improved(held, &mut tried)).transpose()?.map(|held| held.kept);
    Ok((Ladder { tried, chosen, stop }, kept))
}

/// What a step saves.
fn step(below: &Need, here: &Need) -> Option<f64> {
    (below.met && here.met).then(|| 1.0 - here.texels / below.texels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn met(texels: f64, maps: usize) -> Result<Need, String> {
        Ok(Need { texels, met: true, error: 1.0, maps })
    }

    fn missed(error: f64, maps: usize) -> Result<Need, String> {
        Ok(Need { texels: 1e6, met: false, error, maps })
    }

    /// Climbs over given needs, which improving multiplies; the rung that was kept.
    fn improving(needs: &[Result<Need, String>], min_saving: f64, by: &[f64]) -> (Ladder, Option<usize>) {
        let rungs = rungs(&SolverParams { max_maps: 4, ..SolverParams::default() });
        assert_eq!(rungs.iter().map(|r| r.maps).collect::<Vec<_>>(), [1, 1, 2, 3, 4]);
        let mut at = 0;
        let need = |_: &Rung| {
            at += 1;
            Ok::<_, ()>(needs[at - 1].clone().map(|need| (need, at - 1)))
        };
        let improve = |_: &Rung, (need, k): (Need, usize)| Ok((Need { texels: need.texels * by[k], ..need }, k));
        climb(&rungs, min_saving, need, improve).unwrap()
    }

    fn run(needs: &[Result<Need, String>], min_saving: f64) -> (Ladder, Option<usize>) {
        improving(needs, min_saving, &[1.0; 5])
    }

    #[test]
    fn the_first_step_that_does_not_pay_ends_the_climb() {
        let needs = [met(100.0, 1), met(70.0, 1), met(50.0, 2), met(45.0, 3), met(10.0, 4)];
        let (ladder, kept) = run(&needs, 0.15);
        assert_eq!((ladder.chosen, kept, ladder.stop, ladder.tried.len()), (Some(2), Some(2), Stop::Saving, 4));
        assert!((ladder.tried[3].saving.unwrap() - 0.1).abs() < 1e-12);
        let (ladder, kept) = run(&needs, 0.05);
        assert_eq!((kept, ladder.stop, ladder.tried.len()), (Some(4), Stop::Top, 5));
        let (ladder, kept) = run(&needs, 0.35);
        assert_eq!((kept, ladder.tried.len()), (Some(2), 4), "two maps are tried without a warp that pays");
        assert_eq!((ladder.tried[2].saving, ladder.stop), (Some(0.5), Stop::Saving), "of the rung held");
        let (ladder, kept) = run(&needs, 0.6);
        assert_eq!((kept, ladder.tried.len()), (Some(0), 3), "a poor step to more maps is not looked past");
        let (ladder, kept) = run(&[met(100.0, 1), met(110.0, 1), met(20.0, 2), met(20.0, 3)], 0.15);
        assert_eq!((kept, ladder.stop), (Some(2), Stop::Saving));
        assert_eq!(run(&[met(100.0, 1), met(50.0, 1), met(50.0, 2)], 0.5).1, Some(1), "just the share is worth it");
    }

    #[test]
    fn a_step_that_nearly_pays_is_looked_at_again() {
        let needs = [met(100.0, 1), met(50.0, 1), met(45.0, 2), met(5.0, 2)];
        let (ladder, kept) = improving(&needs, 0.15, &[1.0, 1.0, 0.9, 1.0]);
        assert_eq!((kept, ladder.stop), (Some(2), Stop::NoMoreMaps));
        assert_eq!(ladder.tried.iter().map(|t| t.improved).collect::<Vec<_>>(), [None, Some(50.0), Some(40.5), None]);
        assert!((ladder.tried[2].saving.unwrap() - 0.19).abs() < 1e-12);
        let (ladder, kept) = improving(&needs, 0.15, &[1.0, 0.9, 0.9, 1.0]);
        assert_eq!((kept, ladder.tried.len()), (Some(1), 3), "both ends gain alike");
        let (ladder, kept) = improving(&needs, 0.45, &[1.0; 5]);
        assert_eq!((kept, ladder.tried[2].improved), (Some(1), None), "out of reach");
        assert_eq!(ladder.tried[1].improved, Some(50.0), "what is taken is improved in the end");
    }

    #[test]
    fn what_has_no_maps_is_passed_and_what_splits_no_more_ends() {
        let no = || Err("no common volume".to_owned());
        let (ladder, kept) = run(&[no(), met(70.0, 1), met(50.0, 2), met(49.0, 2)], 0.0);
        assert_eq!((kept, ladder.stop), (Some(2), Stop::NoMoreMaps));
        assert_eq!((ladder.tried[0].need.clone(), ladder.tried[1].saving), (Err("no common volume".to_owned()), None));
        let (ladder, kept) = run(&[met(9.0, 1), met(5.0, 1), no()], 0.1);
        assert_eq!((kept, ladder.stop, ladder.chosen), (Some(1), Stop::NoMoreMaps, Some(1)));
        let (ladder, kept) = run(&[no(), no(), no()], 0.1);
        assert_eq!((ladder.chosen, kept), (None, None));
    }

    #[test]
    fn a_missed_bound_is_climbed_out_of_and_never_climbed_into() {
        let (ladder, kept) = run(&[missed(3.0, 1), missed(2.0, 1), met(900.0, 2), met(800.0, 3)], 0.15);
        assert_eq!((kept, ladder.tried[2].saving, ladder.stop), (Some(2), None, Stop::Saving));
        let (ladder, kept) = run(&[met(100.0, 1), missed(1.5, 1), missed(1.4, 2)], 0.15);
        assert_eq!((kept, ladder.stop), (Some(0), Stop::Missed));
        let all = [missed(3.0, 1), missed(2.0, 1), missed(2.5, 2), missed(1.5, 3), missed(1.5, 4)];
        assert_eq!(run(&all, 0.15).1, Some(3), "the nearest to the bound, of equals the simplest");
    }
}
