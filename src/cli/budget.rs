//! `lixel budget`.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use lixel::compare::write_file;
use lixel::plan::{BudgetCurves, Dest, LightPoint, Watch, budget_curves};
use serde::Serialize;

use super::exit::{Failure, MET};
use super::flags::JobFlags;
use super::progress::Bar;
use super::report;
use super::signals::Signals;

/// Measure wrong pixels against texels: the curve of which --epsilon and --budget are two ends
#[derive(Args)]
#[command(after_help = "\
The job is planned by its epsilon, and its maps are measured at other sizes. The table has, for texels drawn over the shot, the
wrong pixels that equal marginal gains come to by the lights' measured curves. Below it stand measured plans: by epsilon (or
within --budget), the same texels shared out by gains, and half of them by gains and with every map halved alike.

Examples:
  lixel budget shot.toml --svg curve.svg
  lixel budget shot.toml --budget 8M --json curve.json

Exit codes: 0 done, 1 failure, 2 bad input, 130/143 stopped.")]
pub(super) struct BudgetArgs {
    /// A job file (.toml), or a scene with its camera and lights (.gltf, .glb, .obj)
    input: PathBuf,
    /// The curves as a picture
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// All figures as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    job: JobFlags,
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    lixel: &'static str,
    #[serde(flatten)]
    curves: &'a BudgetCurves,
}

pub(super) fn run(args: &BudgetArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    args.job.one_temporal()?;
    let job = lixel::job::load(&args.input, &args.job.overrides()).map_err(|e| Failure::job(e, &args.job))?;
    for file in [&args.svg, &args.json].into_iter().flatten() {
        Dest::File(file.clone()).check()?;
    }
    let curves = {
        let bar = Bar::new(quiet);
        let watch =
            Watch { progress: &|p| bar.show(p), cancel: signals.cancel(), notes: &|text| report::remark(quiet, text) };
        budget_curves(&job, &watch)?
    };
    if let Some(file) = &args.json {
        let document = Document { schema: "lixel.budget/1", lixel: env!("CARGO_PKG_VERSION"), curves: &curves };
        let text = serde_json::to_string_pretty(&document)
            .map_err(|e| Failure::Setup(format!("the curves cannot be written as JSON: {e}")))?;
        write_file(file, (text + "\n").as_bytes())?;
    }
    if let Some(file) = &args.svg {
        write_file(file, curves.svg().as_bytes())?;
    }
    let mut out = std::io::stdout().lock();
    out.write_all(table(&curves).as_bytes()).and_then(|()| out.flush()).map_err(Failure::Stdout)?;
    Ok(ExitCode::from(MET))
}

/// The curve, then the measured plans; a column for each light, its texels and wrong pixels.
fn table(curves: &BudgetCurves) -> String {
    let mut text = String::new();
    let cells = |lights: &[LightPoint]| -> String {
        let cell = |l: &LightPoint| format!(" {:>12.0} {:>9.0}", l.texels_drawn, l.misclassified);
        lights.iter().map(cell).collect()
    };
    let names: String = curves.lights.iter().map(|l| format!(" {:>22}", l.light)).collect();
    // Writing to a String does not fail.
    let _ = writeln!(text, "{:>13} {:>9} {:>9} {:>11} {names}", "texels drawn", "wrong", "epsilon", "gain/1e6");
    for p in &curves.all {
        let _ = writeln!(
            text,
            "{:>13.0} {:>9.0} {:>9.5} {:>11.1} {}",
            p.texels_drawn,
            p.misclassified,
            p.epsilon,
            p.gain,
            cells(&p.lights)
        );
    }
    let _ = writeln!(
        text,
        "\nmeasured plans\n{:>13} {:>9} {:>9} {:>11} {names}",
        "texels drawn", "wrong", "weighted", "resident"
    );
    for p in &curves.plans {
        let _ = writeln!(
            text,
            "{:>13} {:>9} {:>9.0} {:>11} {}  {}",
            p.texels_drawn,
            p.misclassified,
            p.weighted,
            p.texels_resident,
            cells(&p.lights),
            p.name
        );
    }
    text
}
