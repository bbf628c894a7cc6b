//! `lixel compare`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use lixel::compare::{
    BiasChoice, CompareParams, Question, Variant, all_methods, compare_temporal, csv, json, random_hemisphere, scatter,
    summarise, table, temporal_json, temporal_table, write_file,
};
use lixel::job::{Job, JobError, check};
use lixel::methods::{Method, SolverParams};
use lixel::plan::{Dest, PlanError, Watch};
use lixel::raster::SIZE_MAX;
use lixel::shot::{Temporal, TemporalParams};
use serde::Deserialize;
use serde::de::value::StrDeserializer;

use super::exit::{Failure, MET};
use super::flags::JobFlags;
use super::progress::Bar;
use super::report;
use super::signals::Signals;
use super::values::{Hemisphere, hemisphere, size};

/// Compare methods on the same frames, lights and texels by their wrong pixels
#[derive(Args)]
#[command(after_help = "\
With --epsilon the texels are searched that each method needs for that bound; else every method gets the same texels.

Examples:
  lixel compare shot.toml --texels 160000
  lixel compare scene.glb --frames 1 --size 750x750 --lights random-hemisphere:500:1 --methods lixel,scene-optimal
  lixel compare shot.toml --methods lixel,cascades:log:warped:4,cascades:samples,separating-plane:psm:1
  lixel compare shot.toml --epsilon 0.001 --csv texels.csv
  lixel compare shot.toml --temporal per-frame,shot --json temporal.json

Exit codes: 0 done, 1 failure, 2 bad input, 130/143 stopped.")]
pub(super) struct CompareArgs {
    /// A job file (.toml), or a scene with its camera and lights (.gltf, .glb, .obj)
    input: PathBuf,
    /// Methods, in the order of the rows [default: all but auto and best, with the job's settings]
    ///
    /// A name as in the job's solver.method, which may have settings after colons: values of the method's own keys of
    /// [solver] in any order, as in cascades:log:warped:4, tsm:0.7, separating-plane:psm:1, homography-area:alpha,
    /// lixel:l2; or KEY=VALUE for any key of [solver], as in lixel:rounds=0. `lixel schema` has the keys.
    #[arg(long, value_delimiter = ',', value_parser = variant, conflicts_with = "method", value_name = "A,B,…")]
    methods: Vec<String>,
    /// Texels of each light, all its maps together [default: 160000]
    #[arg(long, value_name = "N", conflicts_with_all = ["resolution", "epsilon", "temporal"], value_parser = clap::value_parser!(u32).range(1..=1 << 28))]
    texels: Option<u32>,
    /// Width and height of each light's map, instead of texels
    #[arg(long, value_name = "WxH", value_parser = resolution, conflicts_with_all = ["epsilon", "temporal"])]
    resolution: Option<[u32; 2]>,
    /// Distant lights spread evenly over the sky instead of the scene's: random-hemisphere:N:SEED
    ///
    /// A light depends on the seed and its own number alone: random-hemisphere:200-299:SEED are the lights 200 to 299 of a
    /// longer run.
    #[arg(long, value_name = "LIGHTS", value_parser = hemisphere, conflicts_with = "temporal")]
    lights: Option<Hemisphere>,
    /// The depth bias of each map
    #[arg(long, value_enum, default_value_t = BiasName::Plan)]
    bias: BiasName,
    /// All rows and figures as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// One row a light and method as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Folder for a picture of each light and a plot of measured against predicted, made if it is not there
    ///
    /// The pictures have a column for each method; wrong pixels are red (lit instead of in shadow) or blue (in shadow
    /// instead of lit) at misplaced shadow edges, orange or cyan where the bias is to blame. With --temporal it is swimming.png:
    /// a row for each mode and a column for each frame, at most 12, with the shadows that the maps answer; pixels that flicker
    /// are red.
    #[arg(long, short, value_name = "DIR")]
    output: Option<PathBuf>,
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

/// `WxH`, texels.
fn resolution(text: &str) -> Result<[u32; 2], String> {
    let sides = size(text)?;
    match sides.iter().find(|side| !(1..=SIZE_MAX).contains(side)) {
        Some(side) => Err(format!("{side} texels are out of range: give 1 to {SIZE_MAX}")),
        None => Ok(sides),
    }
}

pub(super) fn run(args: &CompareArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    if !args.job.temporal.is_empty() {
        return temporal(args, quiet, signals);
    }
    let overrides = args.job.overrides();
    let mut job = lixel::job::load(&args.input, &overrides).map_err(|e| Failure::job(e, &args.job))?;
    if let Some(hemisphere) = &args.lights {
        job.job.light = random_hemisphere(hemisphere.lights.clone(), hemisphere.seed);
    }
    let searched = overrides.get("quality").is_some_and(|q| q.get("epsilon").is_some());
    let params = CompareParams {
        methods: methods(&args.methods, &job.job.solver)?,
        question: match args.resolution {
            Some(resolution) => Question::Resolution(resolution),
            None if searched => Question::Epsilon,
            None => Question::Texels(args.texels.unwrap_or(TEXELS)),
        },
        bias: match args.bias {
            BiasName::Plan => BiasChoice::Plan,
            BiasName::Best => BiasChoice::Best,
        },
        pictures: args.output.clone(),
    };
    for file in [&args.json, &args.csv].into_iter().flatten() {
        Dest::File(file.clone()).check()?;
    }
    if let Some(dir) = &args.output {
        std::fs::create_dir_all(dir).map_err(|source| PlanError::Write { dest: dir.display().to_string(), source })?;
    }
    let comparison = {
        let bar = Bar::new(quiet);
        let watch =
            Watch { progress: &|p| bar.show(p), cancel: signals.cancel(), notes: &|text| report::remark(quiet, text) };
        lixel::compare::compare(&job, &params, &watch)?
    };
    let summary = summarise(&comparison);
    if let Some(file) = &args.json {
        write_file(file, json(&comparison, &summary)?.as_bytes())?;
    }
    if let Some(file) = &args.csv {
        write_file(file, csv(&comparison).as_bytes())?;
    }
    if let Some(dir) = &args.output {
        write_file(&dir.join("predicted.svg"), scatter(&comparison).as_bytes())?;
    }
    let text = table(&comparison, &summary);
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(Failure::Stdout)?;
    Ok(ExitCode::from(MET))
}

/// A method by name, with settings; read again over the job's own.
fn variant(text: &str) -> Result<String, String> {
    Variant::parse(text, &SolverParams::default()).map(|variant| variant.name)
}

/// The shot planned by each temporal mode.
fn temporal(args: &CompareArgs, quiet: bool, signals: &Signals) -> Result<ExitCode, Failure> {
    let job = lixel::job::load(&args.input, &args.job.overrides()).map_err(|e| Failure::job(e, &args.job))?;
    let mut modes: Vec<Temporal> = Vec::new();
    for name in &args.job.temporal {
        let parsed: Result<Temporal, serde::de::value::Error> = Temporal::deserialize(StrDeserializer::new(name));
        let Ok(mode) = parsed else { continue };
        let shot = TemporalParams { temporal: mode, ..job.job.shot.clone() };
        let of_mode = Job { shot, ..job.job.clone() };
        check(&of_mode).map_err(|problem| Failure::job(JobError::Override(problem), &args.job))?;
        if !modes.contains(&mode) {
            modes.push(mode);
        }
    }
    if let Some(file) = &args.json {
        Dest::File(file.clone()).check()?;
    }
    if let Some(dir) = &args.output {
        std::fs::create_dir_all(dir).map_err(|source| PlanError::Write { dest: dir.display().to_string(), source })?;
    }
    let rows = {
        let bar = Bar::new(quiet);
        let watch =
            Watch { progress: &|p| bar.show(p), cancel: signals.cancel(), notes: &|text| report::remark(quiet, text) };
        compare_temporal(&job, &modes, args.output.as_deref(), &watch)?
    };
    if let Some(file) = &args.json {
        write_file(file, temporal_json(&rows)?.as_bytes())?;
    }
    let mut out = std::io::stdout().lock();
    out.write_all(temporal_table(&rows).as_bytes()).and_then(|()| out.flush()).map_err(Failure::Stdout)?;
    Ok(ExitCode::from(MET))
}

/// Methods by name, each once; all that do not choose among others when none is named.
fn methods(names: &[String], job: &SolverParams) -> Result<Vec<Variant>, Failure> {
    let mut chosen: Vec<Variant> = Vec::new();
    for name in names {
        let found = Variant::parse(name, job).map_err(|e| Failure::Setup(format!("--methods {name}: {e}")))?;
        if chosen.iter().all(|c| c.name != found.name) {
            chosen.push(found);
        }
    }
    // Those that choose among the others would plan each of them once more.
    let own = |method: &Method| !matches!(method, Method::Auto | Method::Best);
    let all = || all_methods().into_iter().filter(own).map(|m| Variant::plain(m, job)).collect();
    Ok(if chosen.is_empty() { all() } else { chosen })
}
