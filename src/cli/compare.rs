//! `lixel compare`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use lixel::compare::{BiasChoice, CompareParams, Question, all_methods, random_hemisphere, summarise, table};
use lixel::methods::Method;
use lixel::plan::Watch;
use serde::Deserialize;
use serde::de::value::StrDeserializer;

use super::exit::{Failure, MET};
use super::flags::JobFlags;
use super::progress::Bar;
use super::report;
use super::signals::Signals;
use super::values::{size, values};

/// Compare methods on the same frames, lights and texels by their wrong pixels
#[derive(Args)]
#[command(after_help = "\
With --epsilon the texels are searched that each method needs for that bound; else every method gets the same texels.

Examples:
  lixel compare shot.toml --texels 160000
  lixel compare scene.glb --frames 1 --size 750x750 --lights random-hemisphere:500:1 --methods lixel,scene-optimal
  lixel compare shot.toml --epsilon 0.001 --csv texels.csv

Exit codes: 0 done, 1 failure, 2 bad input, 130/143 stopped.")]
pub(super) struct CompareArgs {
    /// A job file (.toml), or a scene with its camera and lights (.gltf, .glb, .obj)
    input: PathBuf,
    /// Methods, in the order of the rows [default: all]
    #[arg(long, value_delimiter = ',', value_parser = values::<Method>(), conflicts_with = "method", value_name = "A,B,…")]
    methods: Vec<String>,
    /// Texels of each light, all its maps together [default: 160000]
    #[arg(long, value_name = "N", conflicts_with_all = ["resolution", "epsilon"], value_parser = clap::value_parser!(u32).range(1..))]
    texels: Option<u32>,
    /// Width and height of each light's map, instead of texels
    #[arg(long, value_name = "WxH", value_parser = size, conflicts_with = "epsilon")]
    resolution: Option<[u32; 2]>,
    /// Distant lights spread evenly over the sky instead of the scene's: random-hemisphere:N:SEED
    #[arg(long, value_name = "LIGHTS", value_parser = hemisphere)]
    lights: Option<(u32, u64)>,
    /// The depth bias of each map
    #[arg(long, value_enum, default_value_t = BiasName::Plan)]
    bias: BiasName,
    #[command(flatten)]
    job: JobFlags,
}

#[derive(Clone, Copy, ValueEnum)]
enum BiasName {
    /// That of the job
    Plan,
    /// For each method and light the one of a fixed grid with the fewest wrong pixels
    Best,
}

/// Texels of each light where no flag says.
const TEXELS: u32 = 160_000;
/// Most lights of a hemisphere.
const LIGHTS_MAX: u32 = 10_000;

/// `random-hemisphere:N:SEED`.
fn hemisphere(text: &str) -> Result<(u32, u64), String> {
    let parsed = text
        .strip_prefix("random-hemisphere:")
        .and_then(|rest| rest.split_once(':'))
        .and_then(|(count, seed)| Some((count.parse().ok()?, seed.parse().ok()?)));
    match parsed {
        Some((count, seed)) if (1..=LIGHTS_MAX).contains(&count) => Ok((count, seed)),
        Some((count, _)) => Err(format!("{count} lights are out of range: give 1 to {LIGHTS_MAX}")),
        None => Err("give the number of lights and a seed, as in random-hemisphere:500:1".to_owned()),
    }
}

pub(super) fn run(args: &CompareArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    let overrides = args.job.overrides();
    let mut job = lixel::job::load(&args.input, &overrides).map_err(|e| Failure::job(e, &args.job))?;
    if let Some((count, seed)) = args.lights {
        job.job.light = random_hemisphere(count, seed);
    }
    let searched = overrides.get("quality").is_some_and(|q| q.get("epsilon").is_some());
    let params = CompareParams {
        methods: methods(&args.methods),
        question: match args.resolution {
            Some(resolution) => Question::Resolution(resolution),
            None if searched => Question::Epsilon,
            None => Question::Texels(args.texels.unwrap_or(TEXELS)),
        },
        bias: match args.bias {
            BiasName::Plan => BiasChoice::Plan,
            BiasName::Best => BiasChoice::Best,
        },
        pictures: None,
    };
    let comparison = {
        let bar = Bar::new(quiet);
        let watch =
            Watch { progress: &|p| bar.show(p), cancel: signals.cancel(), notes: &|text| report::remark(quiet, text) };
        lixel::compare::compare(&job, &params, &watch)?
    };
    let text = table(&comparison, &summarise(&comparison));
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(Failure::Stdout)?;
    Ok(ExitCode::from(MET))
}

/// Methods by name, each once; all when none is named. The names are those that clap let through.
fn methods(names: &[String]) -> Vec<Method> {
    let mut chosen: Vec<Method> = Vec::new();
    for name in names {
        let parsed: Result<Method, serde::de::value::Error> = Method::deserialize(StrDeserializer::new(name));
        if let Ok(method) = parsed
            && !chosen.contains(&method)
        {
            chosen.push(method);
        }
    }
    if chosen.is_empty() { all_methods() } else { chosen }
}
