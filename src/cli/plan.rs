//! `lixel plan`.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use lixel::job::LoadedJob;
use lixel::plan::{Dest, Format, Operating, Plan, Watch};
use lixel::trade::{Budget, Model};
use serde::Deserialize;
use serde::de::value::StrDeserializer;

use super::exit::{Failure, MET, NOT_MET};
use super::flags::JobFlags;
use super::progress::Bar;
use super::report;
use super::signals::Signals;
use super::values::{seconds, values};

/// Plan the shadow maps of a shot
#[derive(Args)]
#[command(after_help = "\
Examples:
  lixel plan shot.toml -o shot.plan.json
  lixel plan scene.glb --camera Main --frames 1-240x2 --preset draft
  lixel plan shot.toml --budget 8M -o shot.plan.json
  lixel plan shot.toml --format toml | less
  lixel plan shot.toml --work shot.work -o shot.plan.json     (again after an interruption: goes on)
  lixel plan shot.toml -o shot.plan.json --explain
  lixel plan shot.toml -o shot.plan.json --time-budget 50ms

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
    #[arg(long, value_name = "DIR", conflicts_with = "time_budget")]
    work: Option<PathBuf>,
    /// Put wall times into the plan, which then differs from run to run
    #[arg(long)]
    timings: bool,
    /// Say for each light in one sentence why it got what it got; on standard output when the plan goes to a file, else on
    /// standard error
    #[arg(long)]
    explain: bool,
    /// Choose the settings that cost time by a time for each light of each frame, as in 50ms
    ///
    /// The settings are those of a point of a measured table, its times corrected by timing a few points on the first frame
    /// with shadows; they lie over the job's [sampling], [solver], quality.measure and map.step. The plan says which point
    /// it is. Another run may choose another one, unless --time-model is given. Segments of a shot cost besides.
    #[arg(long, value_name = "TIME", value_parser = seconds, conflicts_with = "preset")]
    time_budget: Option<f64>,
    /// The table of operating points for --time-budget, written by `lixel trade --model`; taken as it stands, so that the plan
    /// is the same on every run
    #[arg(long, value_name = "FILE", requires = "time_budget")]
    time_model: Option<PathBuf>,
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
        let plan = match budget(args, &job)? {
            Some(budget) => lixel::trade::plan_within(&job, &budget, dest.dir(), args.timings, &watch)?,
            None => lixel::plan::make_in(&job, dest.dir(), args.timings, args.work.as_deref(), &watch)?,
        };
        watch.check()?;
        plan
    };
    written(&plan, &dest, &args.format, args.explain, quiet)
}

/// The time that planning may take, and what it may be spent by.
fn budget(args: &PlanArgs, job: &LoadedJob) -> Result<Option<Budget>, Failure> {
    let Some(seconds) = args.time_budget else { return Ok(None) };
    let model = args.time_model.as_deref().map(Model::read).transpose()?;
    let asked = args.job.given().iter().any(|(_, key)| *key == "quality.measure");
    Ok(Some(Budget { seconds, model, measure: asked.then_some(job.job.quality.measure) }))
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
pub(super) fn written(
    plan: &Plan,
    dest: &Dest,
    format: &FormatFlag,
    explain: bool,
    quiet: bool,
) -> Result<ExitCode, Failure> {
    lixel::plan::write(plan, dest, format.of(dest))?;
    if explain {
        let text = lixel::plan::explain(plan);
        if *dest == Dest::Stdout {
            report::note(text.trim_end());
        } else {
            let mut out = std::io::stdout().lock();
            out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(Failure::Stdout)?;
        }
    }
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
    let count = |n: u64, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let (frames, maps) = (count(s.frames, "frame"), count(s.maps, "map"));
    let mut text = format!("{frames}, {maps}, {} texels, {largest}", s.texels);
    let lights = || plan.frames.iter().flat_map(|f| f.lights.iter().map(move |l| (f.frame, l)));
    let failed: Vec<_> = lights().filter(|(_, l)| !l.met()).collect();
    if s.frames > 1 {
        text += &format!(", {} drawn, {}", s.texels_drawn, count(s.changes, "change"));
        text += &s.flicker.map(|f| format!(", {f} pixels flicker")).unwrap_or_default();
    }
    if let Some(budget) = &plan.budget {
        text += &format!(", {} resident, {} pixels wrong", budget.texels_resident, budget.misclassified);
    }
    let predicted = lights().any(|(_, l)| l.error.as_ref().is_some_and(|e| e.measured.is_none()));
    let by = if predicted { " by prediction; nothing was measured" } else { "" };
    text += &match failed.len() {
        0 if plan.budget.is_some() => ": within the budget".to_owned(),
        0 => format!(": every light meets its bound{by}"),
        n => format!(": {n} of {} lights do not meet their bound{by}", lights().count()),
    };
    if let Some(t) = &plan.timings {
        text += &format!(
            "\nloading {:.2} s and sorting {:.2} s of {:.2} s ({:.0} % loading)",
            t.load_s,
            t.sort_s,
            t.total_s,
            100.0 * t.load_share
        );
    }
    for (frame, light) in failed.iter().take(LISTED) {
        let reason = light.reason.as_deref().unwrap_or("no reason given");
        text += &format!("\n  frame {frame}, {}: {reason}", light.light);
    }
    if failed.len() > LISTED {
        text += &format!("\n  and {} more", failed.len() - LISTED);
    }
    if let Some(operating) = &plan.operating {
        text += &format!("\n{}", chosen(operating));
    }
    text
}

/// What a time budget bought.
fn chosen(o: &Operating) -> String {
    let expected = format!("{:.3} ms expected of {} ms a frame and light", o.expected_ms, o.budget_ms);
    let over = if o.within { "" } else { ", the fastest there is" };
    let clock =
        if o.deterministic { "" } else { "; chosen by the clock, another run may choose another: see `operating`" };
    format!("operating point `{}`: {expected}{over}{clock}", o.point)
}
