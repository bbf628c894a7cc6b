//! The stages one by one, from files to files.

use super::super::make::{Loaded, finished};
use super::super::{Plan, PlanError, Stage, Watch};
use super::certify::certify_frame;
use super::file::{Body, Header, Kind, Part, PartError, draft_bytes, job_folder, read, write};
use super::identity::{Identity, ranges};
use super::same::SameFrames;
use super::sample::sample_frame;
use super::settle::{assembled, pending, settle};
use super::solve as solving;
use super::{Draft, FrameState, Way};
use crate::job::{Job, LoadedJob};
use crate::scene::parse_range;
use std::path::{Path, PathBuf};

/// What parts come to.
#[derive(Debug)]
pub enum Merged {
    /// The plan.
    Plan(Box<Plan>),
    /// A frame asked for a larger size: a new draft was written, and these frames, as a range, have to be certified for it.
    Again {
        /// As `--frames` takes them.
        frames: String,
    },
}

/// Samples the frames of a shot that lie in `range`, or all, into a file. Returns their number.
///
/// # Errors
/// As [`super::super::make`], and [`PlanError::Part`].
pub fn sample(job: &LoadedJob, range: Option<&str>, to: &Path, watch: &Watch) -> Result<usize, PlanError> {
    let loaded = Loaded::new(job, watch)?;
    let identity = Identity::of(&loaded, false)?;
    let places = places(&identity.frames, range)?;
    let (stages, _) = loaded.stages(watch)?;
    let total = places.len() as u64;
    let mut frames = Vec::with_capacity(places.len());
    let mut same = SameFrames::default();
    for (done, place) in places.into_iter().enumerate() {
        watch.step(Stage::Samples, done as u64, total)?;
        frames.push(sample_frame(&stages, place, &mut same, false, watch)?);
    }
    watch.step(Stage::Samples, total, total)?;
    let count = frames.len();
    put(to, Kind::Sampled, identity, &job.dir, (None, frames))?;
    Ok(count)
}

/// Solves a shot from the samples of all its frames into a draft. `job_dir` is the job's folder, where it is not where the
/// parts say.
///
/// # Errors
/// As [`super::super::make`], and [`PlanError::Part`].
pub fn solve(parts: &[PathBuf], job_dir: Option<&Path>, to: &Path, watch: &Watch) -> Result<(), PlanError> {
    let parts = together(parts, &[Kind::Sampled], "solve")?;
    let job = job(first(&parts)?, job_dir)?;
    let loaded = reload(&job, first(&parts)?, watch)?;
    let (stages, _) = loaded.stages(watch)?;
    let identity = first(&parts)?.header.identity.clone();
    let mut frames = gathered(parts, Vec::new(), &identity.frames, "sample")?;
    let draft = solving::solve(&stages, &mut frames, false, watch)?;
    put(to, Kind::Draft, identity, &job.dir, (Some(draft), frames))
}

/// Certifies the frames that lie in `range`, by default all of a first draft and those that a later one asks, into a file.
/// Returns their number.
///
/// # Errors
/// As [`super::super::make`], and [`PlanError::Part`].
pub fn certify(
    draft: &Path,
    range: Option<&str>,
    job_dir: Option<&Path>,
    to: &Path,
    watch: &Watch,
) -> Result<usize, PlanError> {
    let part = read(draft)?;
    part.expect(&[Kind::Draft], "certify")?;
    let job = job(&part, job_dir)?;
    let loaded = reload(&job, &part, watch)?;
    let (stages, _) = loaded.stages(watch)?;
    let (identity, (draft, mut frames)) = (part.header.identity.clone(), drafted(part)?);
    let chosen = match range {
        Some(range) => places(&identity.frames, Some(range))?,
        // Frames that solving has answered are copied: so the parts are all that is to be merged.
        None if draft.round == 1 => (0..frames.len()).collect(),
        None => pending(&stages, &draft, &frames),
    };
    let mut carried = None;
    let total = chosen.len() as u64;
    let mut answered: Vec<FrameState> = Vec::with_capacity(chosen.len());
    for (done, place) in chosen.into_iter().enumerate() {
        watch.step(Stage::Lights, done as u64, total)?;
        let unknown =
            |f: &FrameState| f.lights.iter().any(|l| l.answer.is_none() && !in_segments(&draft, &l.light.name));
        if place > 0 && unknown(&frames[place - 1]) {
            // Whose maps are not in the draft are asked here too, for flicker since then.
            frames[place - 1] = certify_frame(&stages, &draft, &frames, place - 1, &mut carried, false, watch)?;
        }
        frames[place] = certify_frame(&stages, &draft, &frames, place, &mut carried, false, watch)?;
        answered.push(frames[place].clone());
    }
    watch.step(Stage::Lights, total, total)?;
    let count = answered.len();
    put(to, Kind::Certified, identity, &job.dir, (Some(draft), answered))?;
    Ok(count)
}

/// Merges certified parts of all frames into a plan with paths relative to `plan_dir`; where a frame asks for a larger size,
/// writes the draft of another round to `again`. A draft among the parts has the frames that it does not ask.
///
/// # Errors
/// As [`super::super::make`], and [`PlanError::Part`].
pub fn merge(
    parts: &[PathBuf],
    job_dir: Option<&Path>,
    plan_dir: &Path,
    again: &Path,
    watch: &Watch,
) -> Result<Merged, PlanError> {
    let mut parts = together(parts, &[Kind::Certified, Kind::Draft], "merge")?;
    let job = job(first(&parts)?, job_dir)?;
    let loaded = reload(&job, first(&parts)?, watch)?;
    let (stages, _) = loaded.stages(watch)?;
    let identity = first(&parts)?.header.identity.clone();
    let base = parts.iter().position(|p| p.header.kind == Kind::Draft).map(|at| parts.remove(at));
    let (mut draft, settled) = match base {
        Some(base) => {
            let (draft, frames) = drafted(base)?;
            let asked = pending(&stages, &draft, &frames);
            (draft, frames.into_iter().filter(|f| !asked.contains(&f.place)).collect())
        }
        None => (drafted_in(first(&parts)?)?, Vec::new()),
    };
    let frames = gathered(parts, settled, &identity.frames, "certify")?;
    if settle(&stages, &mut draft, &frames) {
        let plan = finished(&job, &stages, assembled(&stages, &draft, &frames), plan_dir, None, watch)?;
        return Ok(Merged::Plan(Box::new(plan)));
    }
    let asked: Vec<i64> = pending(&stages, &draft, &frames).into_iter().map(|p| identity.frames[p]).collect();
    put(again, Kind::Draft, identity, &job.dir, (Some(draft), frames))?;
    Ok(Merged::Again { frames: ranges(&asked) })
}

/// The places of the frames that lie in a range.
fn places(shot: &[i64], range: Option<&str>) -> Result<Vec<usize>, PlanError> {
    let Some(range) = range else { return Ok((0..shot.len()).collect()) };
    let wanted = parse_range(range)?;
    let found: Vec<usize> = (0..shot.len()).filter(|k| wanted.contains(&shot[*k])).collect();
    if found.is_empty() {
        return Err(PartError::NoFrame { range: range.to_owned(), shot: ranges(shot) }.into());
    }
    Ok(found)
}

/// Reads parts of one job and, where they answer one, of one draft.
fn together(paths: &[PathBuf], kinds: &[Kind], command: &'static str) -> Result<Vec<Part>, PartError> {
    let mut parts: Vec<Part> = Vec::with_capacity(paths.len());
    for path in paths {
        let part = read(path)?;
        part.expect(kinds, command)?;
        if let Some(other) = parts.first() {
            let other_path = || other.path.clone();
            if let Some(difference) = part.header.identity.difference(&other.header.identity) {
                return Err(PartError::Foreign { path: path.clone(), other: other_path(), difference });
            }
            if part.header.draft != other.header.draft {
                return Err(PartError::OtherDraft { path: path.clone(), other: other_path() });
            }
        }
        parts.push(part);
    }
    Ok(parts)
}

fn first(parts: &[Part]) -> Result<&Part, PartError> {
    parts.first().ok_or(PartError::None)
}

/// The job that a part is of.
fn job(part: &Part, dir: Option<&Path>) -> Result<LoadedJob, PartError> {
    let job: Job = serde_json::from_str(&part.header.identity.job)
        .map_err(|e| PartError::Damaged { path: part.path.clone(), problem: format!("its job cannot be read, {e}") })?;
    Ok(LoadedJob { job, file: None, dir: dir.map_or_else(|| part.dir(), Path::to_owned) })
}

/// Reads the job's files, which have to be those that a part was made from.
fn reload<'a>(job: &'a LoadedJob, part: &Part, watch: &Watch) -> Result<Loaded<'a>, PlanError> {
    let loaded = Loaded::new(job, watch)?;
    let here = Identity::of(&loaded, part.header.identity.timings)?;
    match part.header.identity.difference(&here) {
        None => Ok(loaded),
        Some(difference) => Err(PartError::Changed { path: part.path.clone(), difference }.into()),
    }
}

/// The frames of parts and those settled already, in order: each of the shot's once.
fn gathered(
    parts: Vec<Part>,
    settled: Vec<FrameState>,
    shot: &[i64],
    command: &'static str,
) -> Result<Vec<FrameState>, PartError> {
    let mut found: Vec<Option<FrameState>> = (0..shot.len()).map(|_| None).collect();
    let mut from: Vec<Option<usize>> = vec![None; shot.len()];
    let paths: Vec<PathBuf> = parts.iter().map(|p| p.path.clone()).collect();
    for (k, part) in parts.into_iter().enumerate() {
        let twice: Vec<(usize, usize)> =
            part.body.frames.iter().filter_map(|f| Some((f.place, from.get(f.place).copied().flatten()?))).collect();
        if let Some((_, other)) = twice.first() {
            let frames: Vec<i64> =
                twice.iter().filter(|t| t.1 == *other).filter_map(|t| shot.get(t.0).copied()).collect();
            let (first, second) = (paths[*other].clone(), paths[k].clone());
            return Err(PartError::Duplicate { frames: ranges(&frames), first, second });
        }
        for frame in part.body.frames {
            let place = frame.place;
            if place < shot.len() {
                (found[place], from[place]) = (Some(frame), Some(k));
            }
        }
    }
    for frame in settled {
        let place = frame.place;
        if place < shot.len() && found[place].is_none() {
            found[place] = Some(frame);
        }
    }
    let missing: Vec<i64> = shot.iter().zip(&found).filter(|(_, f)| f.is_none()).map(|(number, _)| *number).collect();
    if !missing.is_empty() {
        return Err(PartError::Missing { frames: ranges(&missing), command });
    }
    Ok(found.into_iter().flatten().collect())
}

/// The draft that a part is, with the frames of all the shot.
fn drafted(part: Part) -> Result<(Draft, Vec<FrameState>), PartError> {
    let draft = drafted_in(&part)?;
    let in_order = part.body.frames.iter().map(|f| f.place).eq(0..part.header.identity.frames.len());
    if !in_order {
        return Err(PartError::Damaged { path: part.path, problem: "it lacks frames of its shot".into() });
    }
    Ok((draft, part.body.frames))
}

fn drafted_in(part: &Part) -> Result<Draft, PartError> {
    let damaged = || PartError::Damaged { path: part.path.clone(), problem: "it holds no draft".into() };
    part.body.draft.clone().ok_or_else(damaged)
}

fn in_segments(draft: &Draft, light: &str) -> bool {
    draft.light(light).is_some_and(|l| matches!(l.way, Way::Segments(_)))
}

/// Writes a file.
fn put(
    to: &Path,
    kind: Kind,
    identity: Identity,
    job_dir: &Path,
    (draft, frames): (Option<Draft>, Vec<FrameState>),
) -> Result<(), PlanError> {
    let fingerprint = match &draft {
        Some(draft) => identity.fingerprint(&draft_bytes(draft)?),
        None => [0; 32],
    };
    let dir = job_folder(job_dir, to.parent().unwrap_or(Path::new("")));
    write(to, &Header { kind, identity, draft: fingerprint, dir }, &Body { draft, frames })
}
