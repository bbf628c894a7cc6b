//! `lixel sample`, `solve`, `certify` and `merge`: a shot in pieces.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use lixel::plan::{Dest, Merged, PlanError, Watch};

use super::exit::{AGAIN, Failure, MET};
use super::flags::JobFlags;
use super::plan::{FormatFlag, written};
use super::progress::Bar;
use super::report;
use super::signals::Signals;

/// In pieces, 1: look at some frames of a shot
#[derive(Args)]
#[command(after_help = "\
Examples:
  lixel sample shot.toml --frames 1-30 -o a.part
  lixel sample scene.glb --shot 1-90 --size 1920x1080 --frames 31-60 -o b.part

--frames are those of this part; the shot's are in the job, or given with --shot. All parts of a shot need the same job
and flags. Next: lixel solve.

Exit codes: 0 written, 1 failure, 2 bad input, 130/143 stopped.")]
pub(super) struct SampleArgs {
    /// A job file (.toml), or a scene with its camera and lights (.gltf, .glb, .obj)
    input: PathBuf,
    /// Where the part goes
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// The frames of the whole shot, over the job's
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    shot: Option<String>,
    #[command(flatten)]
    job: JobFlags,
}

/// In pieces, 2: find segments and matrices from the samples of all frames
#[derive(Args)]
#[command(after_help = "\
Example:
  lixel solve a.part b.part c.part -o shot.draft

Opens the scene for the frames that decide a segment. Next: lixel certify.

Exit codes: 0 written, 1 failure, 2 bad input (a part missing, twice, damaged or of another job), 130/143 stopped.")]
pub(super) struct SolveArgs {
    /// Parts of `lixel sample`, in any order, with every frame of the shot once
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// Where the draft goes
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    place: Place,
}

/// In pieces, 3: measure some frames of a draft
#[derive(Args)]
#[command(after_help = "\
Examples:
  lixel certify shot.draft --frames 1-30 -o a.certified
  lixel certify shot.draft -o all.certified

Next: lixel merge.

Exit codes: 0 written, 1 failure, 2 bad input, 130/143 stopped.")]
pub(super) struct CertifyArgs {
    /// A draft of `lixel solve`, or of `lixel merge`
    draft: PathBuf,
    /// Frames [default: all, of another round those that the draft asks]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    frames: Option<String>,
    /// Where the part goes
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    place: Place,
}

/// In pieces, 4: put the plan together from the measured frames
#[derive(Args)]
#[command(after_help = "\
Examples:
  lixel merge a.certified b.certified c.certified -o shot.plan.json
  lixel merge again.draft d.certified -o shot.plan.json

The plan is that of `lixel plan`, to the byte, however the frames were split. Where a frame needs a larger map than its
segment's draft gives it, the draft of another round is written instead, and what to run is said; that draft, given as a
part, has the frames that are settled.

Exit codes: 0 every bound met, 1 failure, 2 bad input (a part missing, twice, damaged or of another job), 3 plan written
with a bound not met, 4 another round is needed, 130/143 stopped.")]
pub(super) struct MergeArgs {
    /// Parts of `lixel certify`, in any order
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// Where the plan goes; `-` is standard output
    #[arg(long, short, value_name = "FILE", default_value = "-")]
    output: PathBuf,
    #[command(flatten)]
    format: FormatFlag,
    /// Where the draft of another round goes, if one is needed
    #[arg(long, value_name = "FILE", default_value = "again.draft")]
    again: PathBuf,
    #[command(flatten)]
    place: Place,
}

/// Where a shot's files are.
#[derive(Args)]
struct Place {
    /// The folder that the job's paths are relative to [default: the same as seen from the parts as when they were written]
    #[arg(long, value_name = "DIR")]
    job_dir: Option<PathBuf>,
}

/// Does some work with a progress bar.
fn watched<T>(
    quiet: bool,
    signals: &Signals,
    work: impl FnOnce(&Watch) -> Result<T, PlanError>,
) -> Result<T, PlanError> {
    let bar = Bar::new(quiet);
    work(&Watch { progress: &|p| bar.show(p), cancel: signals.cancel(), notes: &|text| report::remark(quiet, text) })
}

fn done(quiet: bool, text: &str) -> Result<ExitCode, Failure> {
    if !quiet {
        report::note(text);
    }
    Ok(ExitCode::from(MET))
}

fn checked(path: &Path) -> Result<(), PlanError> {
    Dest::File(path.to_owned()).check()
}

pub(super) fn sample(args: &SampleArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    args.job.one_temporal()?;
    let (flags, frames) = args.job.of_shot(args.shot.as_deref());
    let job = lixel::job::load(&args.input, &flags.overrides()).map_err(|e| Failure::job(e, &flags))?;
    checked(&args.output)?;
    let count = watched(quiet, signals, |watch| lixel::plan::sample(&job, frames, &args.output, watch))?;
    done(quiet, &format!("wrote {}: {count} frames sampled", args.output.display()))
}

pub(super) fn solve(args: &SolveArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    checked(&args.output)?;
    let dir = args.place.job_dir.as_deref();
    watched(quiet, signals, |watch| lixel::plan::solve(&args.parts, dir, &args.output, watch))?;
    done(quiet, &format!("wrote {}", args.output.display()))
}

pub(super) fn certify(args: &CertifyArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    checked(&args.output)?;
    let (frames, dir) = (args.frames.as_deref(), args.place.job_dir.as_deref());
    let count = watched(quiet, signals, |watch| lixel::plan::certify(&args.draft, frames, dir, &args.output, watch))?;
    done(quiet, &format!("wrote {}: {count} frames certified", args.output.display()))
}

pub(super) fn merge(args: &MergeArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    let dest = args.format.dest(&args.output)?;
    let dir = args.place.job_dir.as_deref();
    let merged = watched(quiet, signals, |watch| lixel::plan::merge(&args.parts, dir, dest.dir(), &args.again, watch))?;
    match merged {
        Merged::Plan(plan) => written(&plan, &dest, &args.format, false, quiet),
        Merged::Again { frames } => {
            let again = args.again.display();
            report::note(&format!(
                "another round: a frame needs a larger map than the draft has; no plan was written, but {again}\n\
                 run: lixel certify {again} --frames {frames} -o PART    (in one part or several)\n\
                 then: lixel merge {again} PART… -o {}",
                args.output.display()
            ));
            Ok(ExitCode::from(AGAIN))
        }
    }
}
