//! `auto`: a ladder of methods, each rung with more to draw and look up than the one before, climbed for as long as a step
//! saves its share of the texels.
//!
//! No map at all comes before the ladder: a light without a visible shadow is not asked here. The rungs are `focused`, one
//! map of `lixel`, and `partitioned` with two maps and more. A step from need a to need b saves 1 - b/a; the first one that
//! saves less than `solver.min_saving` ends the climb, and later ones are not tried, so that a plan costs what it takes to
//! see that more would not pay. Below the bound there is no saving to speak of: until a rung meets, the climb goes on, and
//! where none does the one nearest to the bound is taken.

use crate::methods::{Method, SolverParams};

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
    /// The share of the texels of the rung below that it saves; absent where one of the two has no figure.
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

/// Climbs. `need` finds what a rung needs, with whatever else is to be kept of the one that is taken; it is told what the
/// rung below needs. Its errors pass through.
pub fn climb<T, E>(
    rungs: &[Rung],
    min_saving: f64,
    mut need: impl FnMut(&Rung, Option<&Need>) -> Result<Result<(Need, T), String>, E>,
) -> Result<(Ladder, Option<T>), E> {
    let mut tried: Vec<TriedRung> = Vec::new();
    let mut best: Option<(usize, Need, T)> = None;
    let mut stop = Stop::Top;
    for rung in rungs {
        let found = need(rung, best.as_ref().map(|(_, below, _)| below))?;
        let several = rung.method == Method::Partitioned;
        let (here, kept) = match found {
            Ok(found) => found,
            Err(reason) => {
                tried.push(TriedRung { rung: *rung, need: Err(reason), saving: None });
                if several {
                    stop = Stop::NoMoreMaps;
                    break;
                }
                continue;
            }
        };
        let Some((_, below, _)) = &best else {
            tried.push(TriedRung { rung: *rung, need: Ok(here), saving: None });
            best = Some((tried.len() - 1, here, kept));
            continue;
        };
        let saving = (below.met && here.met).then(|| 1.0 - here.texels / below.texels);
        tried.push(TriedRung { rung: *rung, need: Ok(here), saving });
        if several && here.maps <= below.maps {
            stop = Stop::NoMoreMaps;
            break;
        }
        if below.met && !here.met {
            stop = Stop::Missed;
            break;
        }
        if saving.is_some_and(|saving| saving < min_saving) {
            stop = Stop::Saving;
            break;
        }
        if here.met || here.error < below.error {
            best = Some((tried.len() - 1, here, kept));
        }
    }
    let chosen = best.as_ref().map(|b| b.0);
    Ok((Ladder { tried, chosen, stop }, best.map(|b| b.2)))
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

    /// Climbs over given needs; the rung that was kept.
    fn run(needs: &[Result<Need, String>], min_saving: f64) -> (Ladder, Option<usize>) {
        let rungs = rungs(&SolverParams { max_maps: 4, ..SolverParams::default() });
        assert_eq!(rungs.iter().map(|r| r.maps).collect::<Vec<_>>(), [1, 1, 2, 3, 4]);
        let mut at = 0;
        climb(&rungs, min_saving, |_, _| {
            at += 1;
            Ok::<_, ()>(needs[at - 1].clone().map(|need| (need, at - 1)))
        })
        .unwrap()
    }

    #[test]
    fn the_first_step_that_does_not_pay_ends_the_climb() {
        let needs = [met(100.0, 1), met(70.0, 1), met(50.0, 2), met(45.0, 3), met(10.0, 4)];
        let (ladder, kept) = run(&needs, 0.15);
        assert_eq!((ladder.chosen, kept, ladder.stop, ladder.tried.len()), (Some(2), Some(2), Stop::Saving, 4));
        assert!((ladder.tried[3].saving.unwrap() - 0.1).abs() < 1e-12);
        let (ladder, kept) = run(&needs, 0.05);
        assert_eq!((kept, ladder.stop, ladder.tried.len()), (Some(4), Stop::Top, 5));
        let (ladder, kept) = run(&needs, 0.5);
        assert_eq!((kept, ladder.tried.len()), (Some(0), 2), "the greedy climb does not look past a poor step");
        assert_eq!(run(&needs, 0.3).1, Some(1), "a saving of just the share is worth it");
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
        let (ladder, kept) = run(&[met(100.0, 1), missed(1.5, 1)], 0.15);
        assert_eq!((kept, ladder.stop), (Some(0), Stop::Missed));
        let all = [missed(3.0, 1), missed(2.0, 1), missed(2.5, 2), missed(1.5, 3), missed(1.5, 4)];
        assert_eq!(run(&all, 0.15).1, Some(3), "the nearest to the bound, of equals the simplest");
    }
}
