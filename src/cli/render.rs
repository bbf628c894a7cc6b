//! `lixel render`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use lixel::plan::Watch;

use super::exit::{Failure, MET};
use super::flags::JobFlags;
use super::progress::Bar;
use super::report;
use super::signals::Signals;

/// Write what was seen in one frame: layered EXR, and PNGs to look at
#[derive(Args)]
#[command(after_help = "\
Example:
  lixel render shot.toml --frame 12 -o frame12

NAME below is a light's name; maps of a light with several are numbered.
  shaded.png        all lights with exact shadows
  NAME.shadow.png   exact shadow (brown), edge samples as dots, hue = the way to their lit side
  NAME.error.png    red: wrongly lit, blue: wrongly in shadow, yellow: uncertain
  NAME.map.png      nearer is brighter; orange and green: looked up by pixels in shadow and lit
  NAME.map.exr      Z, window depth as stored, top row first
  seen.exr          Z, N, and per light faces, shadow, edge, false_lit, false_shadow, uncertain

Exit codes: 0 done, 1 failure, 2 bad input, 130/143 stopped.")]
pub(super) struct RenderArgs {
    /// A job file (.toml), or a scene with its camera and lights (.gltf, .glb, .obj)
    input: PathBuf,
    /// Frame number
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    frame: i64,
    /// Folder for the pictures, made if it is not there
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// Plan and show only this light
    #[arg(long, value_name = "NAME")]
    light: Option<String>,
    #[command(flatten)]
    job: JobFlags,
}

pub(super) fn run(args: &RenderArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    args.job.one_temporal()?;
    let job = lixel::job::load(&args.input, &args.job.overrides()).map_err(|e| Failure::job(e, &args.job))?;
    let files = {
        let bar = Bar::new(quiet);
        let watch =
            Watch { progress: &|p| bar.show(p), cancel: signals.cancel(), notes: &|text| report::remark(quiet, text) };
        lixel::plan::render(&job, args.frame, args.light.as_deref(), &args.output, &watch)?
    };
    if !quiet {
        for file in files {
            report::note(&format!("wrote {}", file.display()));
        }
    }
    Ok(ExitCode::from(MET))
}
