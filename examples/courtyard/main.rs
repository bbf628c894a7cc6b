//! Writes the courtyard, the scene that ships with lixel, as one binary glTF:
//! `cargo run --release --example courtyard -- examples/courtyard/courtyard.glb`

mod yard;

use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(path) = std::env::args_os().nth(1) else {
        eprintln!("usage: courtyard OUTPUT.glb");
        return ExitCode::from(2);
    };
    match yard::build().and_then(|bytes| std::fs::write(&path, bytes)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}: {error}", path.display());
            ExitCode::FAILURE
        }
    }
}
