//! Progress bars on standard error; indicatif hides them when that is no terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lixel::plan::{Progress, Stage};
use std::time::Duration;

/// How often the bar's clock is drawn.
const TICK: Duration = Duration::from_millis(200);

/// The bar of one command.
pub(super) struct Bar {
    bar: ProgressBar,
}

impl Bar {
    pub(super) fn new(quiet: bool) -> Self {
        let bar = ProgressBar::new(0);
        bar.set_draw_target(if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() });
        // The template is a constant; should it ever be wrong, indicatif's own style serves.
        let style = ProgressStyle::with_template("{msg:9} {wide_bar} {pos}/{len} {elapsed} (left {eta})")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style);
        // Loading has two steps only: the clock shows that it goes on.
        bar.enable_steady_tick(TICK);
        Self { bar }
    }

    /// Shows how far the work is.
    pub(super) fn show(&self, progress: Progress) {
        self.bar.set_message(match progress.stage {
            Stage::Load => "loading",
            Stage::Samples => "frames",
            Stage::Solve => "solving",
            Stage::Lights => "measuring",
            Stage::Flicker => "flicker",
            Stage::Budget => "budget",
            Stage::Points => "points",
        });
        self.bar.set_length(progress.total);
        self.bar.set_position(progress.done);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
