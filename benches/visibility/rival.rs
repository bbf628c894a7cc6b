//! Another ray tracer as a process that makes a pass over the same rays whenever it is told to.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use lixel::scene::Triangle;

use crate::rays::Rays;

/// The protocol is told in `benches/embree/embree.c`.
pub(crate) struct Rival {
    process: Child,
    to: Option<ChildStdin>,
    from: BufReader<ChildStdout>,
    directory: tempfile::TempDir,
}

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

impl Rival {
    /// Hands over triangles and rays and waits for nothing.
    pub(crate) fn start(program: &Path, extra: &[&str], triangles: &[Triangle], rays: &Rays) -> Fallible<Rival> {
        let directory = tempfile::tempdir()?;
        let write = |name: &str, floats: Vec<f32>| {
            std::fs::write(
                directory.path().join(name),
                floats.iter().flat_map(|f| f.to_le_bytes()).collect::<Vec<u8>>(),
            )
        };
        write("triangles", triangles.iter().flatten().flat_map(|v| v.to_array()).collect())?;
        write("closest", rays.closest.iter().flat_map(|r| r.0).collect())?;
        write("any", rays.any.iter().flat_map(|r| r.0).collect())?;
        let mut process = Command::new(program)
            .arg(directory.path())
            .args(extra)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let to = process.stdin.take();
        let from = BufReader::new(process.stdout.take().ok_or("the rival has no stdout")?);
        Ok(Rival { process, to, from, directory })
    }

    /// One pass: the number the rival answers.
    pub(crate) fn pass(&mut self, what: &str) -> Fallible<f64> {
        writeln!(self.to.as_mut().ok_or("the rival has no stdin")?, "{what}")?;
        let mut line = String::new();
        self.from.read_line(&mut line)?;
        Ok(line.trim().parse()?)
    }

    /// In words: how many answers of the last passes differ from ours.
    pub(crate) fn differences(&self, closest: &[i32], any: &[i32]) -> Fallible<String> {
        let read = |name: &str| -> Fallible<Vec<i32>> {
            let path: PathBuf = self.directory.path().join(name);
            let bytes = std::fs::read(path)?;
            Ok(bytes.chunks_exact(4).map(|b| i32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
        };
        let (their_closest, their_any) = (read("closest.embree")?, read("any.embree")?);
        let pairs = || closest.iter().zip(&their_closest);
        let triangle = pairs().filter(|&(&a, &b)| a != b && a >= 0 && b >= 0).count();
        let only_ours = pairs().filter(|&(&a, &b)| a >= 0 && b < 0).count();
        let only_theirs = pairs().filter(|&(&a, &b)| a < 0 && b >= 0).count();
        let occlusion = any.iter().zip(&their_any).filter(|(a, b)| a != b).count();
        Ok(format!(
            "closest: another triangle {triangle}, hit only here {only_ours}, hit only there {only_theirs}; any: {occlusion}"
        ))
    }
}

impl Drop for Rival {
    fn drop(&mut self) {
        // Its stdin closed, the rival ends by itself.
        self.to = None;
        let _ = self.process.wait();
    }
}
