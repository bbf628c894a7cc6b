//! `lixel plan`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use lixel::plan::{Dest, Format, Plan, Watch};
use serde::Deserialize;
use serde::de::value::StrDeserializer;

use super::exit::{Failure, MET, NOT_MET};
use super::flags::JobFlags;
use super::progress::Bar;
use super::report;
use super::signals::Signals;
use super::values::values;

/// Plan the shadow maps of a shot
#[derive(Args)]
#[command(after_help = "\
Examples:
  lixel plan shot.toml -o shot.plan.json
  lixel plan scene.glb --camera Main --frames 1-240x2 --preset draft
  lixel plan shot.toml --format toml | less
  lixel plan shot.toml --work shot.work -o shot.plan.json     (again after an interruption: goes on)

Exit codes: 0 every bound met, 1 failure, 2 bad input, 3 plan written with a bound not met, 130/143 stopped.")]
pub(super) struct PlanArgs {
    /// A job file (.toml), or a scene with its camera and lights (.gltf, .glb, .obj)
    input: PathBuf,
    /// Where the plan goes; `-` is standard output
    #[arg(long, short, value_name = "FILE", default_value = "-")]
    output: PathBuf,
    #[command(flatten)]
    format: FormatFlag,
    /// Keep finished frames in this folder, and go on from there after an interruption
    #[arg(long, value_name = "DIR")]
    work: Option<PathBuf>,
    /// Put wall times into the plan, which then differs from run to run
    #[arg(long)]
    timings: bool,
    #[command(flatten)]
    job: JobFlags,
}

pub(super) fn run(args: &PlanArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    args.job.one_temporal()?;
    let job = lixel::job::load(&args.input, &args.job.overrides()).map_err(|e| Failure::job(e, &args.job))?;
    let dest = args.format.dest(&args.output)?;
    let plan = {
        let bar = Bar::new(quiet);
        let watch =
            Watch { progress: &|p| bar.show(p), cancel: signals.cancel(), notes: &|text| report::remark(quiet, text) };
        let plan = lixel::plan::make_in(&job, dest.dir(), args.timings, args.work.as_deref(), &watch)?;
        watch.check()?;
        plan
    };
    written(&plan, &dest, &args.format, quiet)
}

/// How a plan is written.
#[derive(Args)]
pub(super) struct FormatFlag {
    /// Format of the plan [default: by the extension of FILE, else json]
    #[arg(long, value_parser = values::<Format>())]
    format: Option<String>,
}

impl FormatFlag {
    /// Where a plan goes, once that could be written to.
    pub(super) fn dest(&self, output: &Path) -> Result<Dest, Failure> {
        let dest = if output == Path::new("-") { Dest::Stdout } else { Dest::File(output.to_owned()) };
        dest.check()?;
        Ok(dest)
    }

    fn of(&self, dest: &Dest) -> Format {
        let name = match (&self.format, dest) {
            (Some(name), _) => name.clone(),
            (None, Dest::File(path)) => path.extension().unwrap_or_default().to_string_lossy().to_lowercase(),
            (None, Dest::Stdout) => String::new(),
        };
        let parsed: Result<Format, serde::de::value::Error> = Format::deserialize(StrDeserializer::new(&name));
        parsed.unwrap_or_default()
    }
}

/// Writes a plan and says what it came to.
pub(super) fn written(plan: &Plan, dest: &Dest, format: &FormatFlag, quiet: bool) -> Result<ExitCode, Failure> {
    lixel::plan::write(plan, dest, format.of(dest))?;
    if !quiet {
        report::note(&summary(plan));
    }
    Ok(ExitCode::from(if plan.summary.met { MET } else { NOT_MET }))
}

/// The outcome in a few lines: what was planned, and what does not meet its bound.
fn summary(plan: &Plan) -> String {
    /// Lights listed by name; the plan has them all.
    const LISTED: usize = 5;
    let s = &plan.summary;
    let largest = s.largest.map_or("no map".to_owned(), |[w, h]| format!("largest {w}x{h}"));
    let mut text = format!("{} frames, {} maps, {} texels, {largest}", s.frames, s.maps, s.texels);
    let lights = || plan.frames.iter().flat_map(|f| f.lights.iter().map(move |l| (f.frame, l)));
    let failed: Vec<_> = lights().filter(|(_, l)| !l.met()).collect();
    if s.frames > 1 {
        text += &format!(", {} drawn, {} changes", s.texels_drawn, s.changes);
        text += &s.flicker.map(|f| format!(", {f} pixels flicker")).unwrap_or_default();
    }
    text += &match failed.len() {
        0 => ": every light meets its bound".to_owned(),
        n => format!(": {n} of {} lights do not meet their bound", lights().count()),
    };
    for (frame, light) in failed.iter().take(LISTED) {
        let reason = light.reason.as_deref().unwrap_or("no reason given");
        text += &format!("\n  frame {frame}, {}: {reason}", light.light);
    }
    if failed.len() > LISTED {
        text += &format!("\n  and {} more", failed.len() - LISTED);
    }
    text
}
