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
Examples:
  lixel render shot.toml --frame 12 -o frame12
  lixel render shot.toml --frames 1-90 --aov images/shot.####.exr

NAME below is a light's name; maps of a light with several are numbered.
  shaded.png        all lights with exact shadows
  NAME.shadow.png   exact shadow (brown), edge samples as dots, hue = the way to their lit side
  NAME.error.png    red: wrongly lit, blue: wrongly in shadow, yellow: uncertain
  NAME.map.png      nearer is brighter; orange and green: looked up by pixels in shadow and lit
  NAME.map.exr      Z, window depth as stored, top row first
  seen.exr          Z, N, and per light faces, shadow, edge, false_lit, false_shadow, uncertain

With --aov nothing is planned: each frame becomes one EXR with the layers that a renderer writes, Z (along the view axis),
P, N and shadow_NAME (1 in shadow), and the camera in its header, to be planned from with visibility.source = \"aov\".

Exit codes: 0 done, 1 failure, 2 bad input, 130/143 stopped.")]
pub(super) struct RenderArgs {
    /// A job file (.toml), or a scene with its camera and lights (.gltf, .glb, .obj)
    input: PathBuf,
    /// Frame number
    #[arg(long, value_name = "N", allow_negative_numbers = true, required_unless_present = "aov")]
    frame: Option<i64>,
    /// Folder for the pictures, made if it is not there
    #[arg(long, short, value_name = "DIR", required_unless_present = "aov")]
    output: Option<PathBuf>,
    /// Plan and show only this light
    #[arg(long, value_name = "NAME")]
    light: Option<String>,
    /// Write the layers that a renderer would, for all frames of the job; #### stands for the frame number
    #[arg(long, value_name = "FILE", conflicts_with_all = ["frame", "output", "light"])]
    aov: Option<PathBuf>,
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
        match (&args.aov, args.frame, &args.output) {
            (Some(pattern), ..) => lixel::plan::render_images(&job, pattern, &watch)?,
            (None, Some(frame), Some(output)) => {
                lixel::plan::render(&job, frame, args.light.as_deref(), output, &watch)?
            }
            _ => return Err(Failure::Setup("give --frame and --output, or --aov".to_owned())),
        }
    };
    if !quiet {
        for file in files {
            report::note(&format!("wrote {}", file.display()));
        }
    }
    Ok(ExitCode::from(MET))
}
