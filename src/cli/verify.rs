//! `lixel verify`.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use lixel::plan::{Outcome, Verification, Watch};

use super::exit::{FAILED, Failure, MET};
use super::progress::Bar;
use super::report;
use super::signals::Signals;

/// Check a plan against its scene: file hashes, witnesses, and every light measured again
#[derive(Args)]
#[command(after_help = "\
Examples:
  lixel verify shot.plan.json
  lixel verify shot.plan.toml --json > check.json

Exit codes: 0 everything holds, 1 something does not, 2 not a plan, 130/143 stopped.")]
pub(super) struct VerifyArgs {
    /// A plan (.json, .toml)
    plan: PathBuf,
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &VerifyArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    let plan = lixel::plan::read(&args.plan)?;
    let plan_dir = args.plan.parent().unwrap_or(Path::new(""));
    let found = {
        let bar = Bar::new(quiet);
        lixel::plan::verify(
            &plan,
            plan_dir,
            &Watch { progress: &|p| bar.show(p), cancel: signals.cancel(), notes: &|text| report::remark(quiet, text) },
        )?
    };
    let text = if args.json { json(&found)? } else { table(&found) };
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(Failure::Stdout)?;
    Ok(ExitCode::from(if found.passed { MET } else { FAILED }))
}

fn json(found: &Verification) -> Result<String, Failure> {
    match serde_json::to_string_pretty(found) {
        Ok(text) => Ok(text + "\n"),
        Err(error) => Err(Failure::Setup(format!("the result cannot be written as JSON: {error}"))),
    }
}

/// One row a light, then what does not hold.
fn table(found: &Verification) -> String {
    let mut text = String::new();
    let mut row = |cells: [&str; 10]| {
        let [frame, light, maps, size, planned, measured, uncertain, flicker, epsilon, verdict] = cells;
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "{frame:>6}  {light:<20} {maps:>4} {size:>11} {planned:>8} {measured:>8} {uncertain:>9} {flicker:>7} {epsilon:>8}  {verdict}"
        );
    };
    if !found.lights.is_empty() {
        row(["frame", "light", "maps", "size", "planned", "measured", "uncertain", "flicker", "epsilon", "verdict"]);
    }
    for light in &found.lights {
        row([
            &light.frame.to_string(),
            &light.light,
            &light.sizes.len().to_string(),
            // Several maps of a light scale together: the first one's size stands for all.
            &light.sizes.first().map_or("-".to_owned(), |[w, h]| format!("{w}x{h}")),
            &light.planned.map_or("-".to_owned(), |n| n.to_string()),
            &light.measured.map_or("-".to_owned(), |n| n.to_string()),
            &light.uncertain.map_or("-".to_owned(), |n| n.to_string()),
            &light.flicker.map_or("-".to_owned(), |n| n.to_string()),
            &light.epsilon.to_string(),
            match light.outcome {
                Outcome::Holds => "holds",
                Outcome::NotMet => "NOT MET",
                Outcome::Broken => "BROKEN",
            },
        ]);
    }
    let files = found.inputs.iter().filter_map(|i| Some(format!("{}: {}", i.path, i.reason.as_ref()?)));
    let lights = found
        .lights
        .iter()
        .flat_map(|l| l.reasons.iter().map(move |reason| format!("frame {}, {}: {reason}", l.frame, l.light)));
    for line in files.chain(found.problems.iter().cloned()).chain(lights) {
        text += &line;
        text.push('\n');
    }
    if found.lights.iter().any(|light| light.measured.is_none() && !light.sizes.is_empty()) {
        text +=
            "planned from images: cover, depth ranges and witnesses were held against them; nothing could be drawn\n";
    }
    text + if found.passed { "the plan holds\n" } else { "the plan does NOT hold\n" }
}
