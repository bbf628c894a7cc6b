//! SIGINT and SIGTERM: the first asks the work to stop, a second one ends the process at once.

use std::io;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::exit::SIGNAL_BASE;

/// What the signal handlers set.
pub(super) struct Signals {
    cancel: Arc<AtomicBool>,
    number: Arc<AtomicUsize>,
}

impl Signals {
    /// Installs the handlers.
    pub(super) fn install() -> io::Result<Self> {
        let cancel = Arc::new(AtomicBool::new(false));
        let number = Arc::new(AtomicUsize::new(0));
        for (signal, value) in [(SIGINT, 2), (SIGTERM, 15)] {
            // Handlers run in this order: at the first signal the flag is still false, and nothing ends.
            flag::register_conditional_shutdown(signal, i32::from(SIGNAL_BASE) + signal, Arc::clone(&cancel))?;
            flag::register_usize(signal, Arc::clone(&number), value)?;
            flag::register(signal, Arc::clone(&cancel))?;
        }
        Ok(Self { cancel, number })
    }

    /// True once the work should stop.
    pub(super) fn cancel(&self) -> &AtomicBool {
        &self.cancel
    }

    /// 128 plus the signal, as shells report it.
    pub(super) fn exit_code(&self) -> ExitCode {
        let number = u8::try_from(self.number.load(Ordering::Relaxed)).unwrap_or(0);
        ExitCode::from(SIGNAL_BASE.saturating_add(number))
    }
}
