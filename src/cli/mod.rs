//! The command line: one file a command. Nothing outside this folder knows clap, progress bars or terminal colours.

mod budget;
mod compare;
mod exit;
mod flags;
mod pieces;
mod plan;
mod progress;
mod render;
mod report;
mod schema;
mod signals;
mod trade;
mod values;
mod verify;

use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use exit::Failure;
use signals::Signals;

/// Plans shadow maps offline: per frame and light the matrix that wastes fewest texels on what the camera sees, and the
/// smallest map that keeps the wrong pixels under epsilon.
#[derive(Parser)]
#[command(version, arg_required_else_help = true, after_help = HELP)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: Common,
}

const HELP: &str = "\
Examples:
  lixel plan shot.toml -o shot.plan.json
  lixel plan scene.glb --frames 1-90 --size 1920x1080 --epsilon 0.001 > plan.json
  lixel verify shot.plan.json
  lixel render shot.toml --frame 12 -o frame12
  lixel compare shot.toml --texels 160000
  lixel trade shot.toml --frames 30 --svg trade.svg
  lixel budget shot.toml --svg curve.svg

Exit codes:
  0    done, every bound met
  1    a run-time failure, or a plan that verify found broken
  2    bad input or usage
  3    the plan is written, but a light does not meet its bound or a budget is too small
  4    merge: another round of certify is needed
  130  stopped by SIGINT; 143 by SIGTERM";

/// Flags of every command.
#[derive(Args)]
struct Common {
    /// Print no progress and no summary, only errors
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Number of threads; the results are the same for any [default: one a core]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

#[derive(Subcommand)]
enum Command {
    Plan(plan::PlanArgs),
    Verify(verify::VerifyArgs),
    Render(render::RenderArgs),
    Compare(compare::CompareArgs),
    Sample(pieces::SampleArgs),
    Solve(pieces::SolveArgs),
    Certify(pieces::CertifyArgs),
    Merge(pieces::MergeArgs),
    Trade(trade::TradeArgs),
    Budget(budget::BudgetArgs),
    Schema(schema::SchemaArgs),
}

/// Runs a command; what goes wrong is said on standard error.
pub(crate) fn run(cli: Cli) -> ExitCode {
    let signals = match Signals::install() {
        Ok(signals) => signals,
        Err(error) => return report::failure(&Failure::Setup(format!("cannot watch for signals: {error}"))),
    };
    if let Some(threads) = cli.common.threads
        && let Err(error) = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global()
    {
        return report::failure(&Failure::Setup(format!("cannot start {threads} threads: {error}")));
    }
    let quiet = cli.common.quiet;
    let outcome = match &cli.command {
        Command::Plan(args) => plan::run(args, quiet, &signals),
        Command::Verify(args) => verify::run(args, quiet, &signals),
        Command::Render(args) => render::run(args, quiet, &signals),
        Command::Compare(args) => compare::run(args, quiet, &signals),
        Command::Sample(args) => pieces::sample(args, quiet, &signals),
        Command::Solve(args) => pieces::solve(args, quiet, &signals),
        Command::Certify(args) => pieces::certify(args, quiet, &signals),
        Command::Merge(args) => pieces::merge(args, quiet, &signals),
        Command::Trade(args) => trade::run(args, quiet, &signals),
        Command::Budget(args) => budget::run(args, quiet, &signals),
        Command::Schema(args) => schema::run(args),
    };
    match outcome {
        Ok(code) => code,
        Err(Failure::Plan(lixel::plan::PlanError::Cancelled)) => signals.exit_code(),
        Err(failure) => report::failure(&failure),
    }
}
