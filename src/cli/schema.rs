//! `lixel schema`.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use lixel::job::Job;
use lixel::plan::Plan;

use super::exit::{Failure, MET};

/// Print the JSON Schema of plans or jobs
#[derive(Args)]
#[command(after_help = "\
Example:
  lixel schema job > job.schema.json")]
pub(super) struct SchemaArgs {
    /// Which one
    of: Of,
}

#[derive(Clone, Copy, ValueEnum)]
enum Of {
    /// What `lixel plan` writes
    Plan,
    /// What `lixel plan` reads
    Job,
}

pub(super) fn run(args: &SchemaArgs) -> Result<ExitCode, Failure> {
    let schema = match args.of {
        Of::Plan => schemars::schema_for!(Plan),
        Of::Job => schemars::schema_for!(Job),
    };
    let mut out = io::stdout().lock();
    writeln!(out, "{:#}", schema.to_value()).and_then(|()| out.flush()).map_err(Failure::Stdout)?;
    Ok(ExitCode::from(MET))
}
