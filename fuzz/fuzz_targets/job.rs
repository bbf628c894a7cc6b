//! `cargo +nightly fuzz run job tests/corpus/job`

#![no_main]

#[allow(dead_code, reason = "one of the targets")]
#[path = "../targets.rs"]
mod targets;

use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static FOLDER: LazyLock<Option<tempfile::TempDir>> = LazyLock::new(|| tempfile::tempdir().ok());

fuzz_target!(|bytes: &[u8]| {
    if let Some(folder) = FOLDER.as_ref() {
        let _ = targets::job(bytes, folder.path());
    }
});
