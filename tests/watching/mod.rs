//! Long work of the library, done for a test: nobody is told of its progress and nobody stops it.

use lixel::plan::Watch;
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

/// Does work that wants to be watched.
pub(crate) fn watched<T>(work: impl FnOnce(&Watch) -> T) -> T {
    work(&Watch { progress: &|_| (), cancel: &NEVER, notes: &|_| () })
}
