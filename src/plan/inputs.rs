//! The files a plan was made from: relative paths and content hashes.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::PlanError;

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub struct Input {
    /// Relative to the folder of the plan (of the working folder, for a plan on standard output), with `/`.
    pub path: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
}

/// SHA-256 of a file's bytes, lower-case hexadecimal.
///
/// # Errors
/// [`PlanError::Read`].
pub fn sha256_hex(path: &Path) -> Result<String, PlanError> {
    let failed = |source: io::Error| PlanError::Read { path: path.to_owned(), source };
    let mut file = File::open(path).map_err(failed)?;
    let mut hasher = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let n = file.read(&mut buffer).map_err(failed)?;
        if n == 0 {
            return Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect());
        }
        hasher.update(&buffer[..n]);
    }
}

/// Paths relative to `plan_dir`, and hashes, in the order given.
///
/// # Errors
/// [`PlanError::Read`] for the first file that cannot be read.
pub fn hash_inputs(paths: &[PathBuf], plan_dir: &Path) -> Result<Vec<Input>, PlanError> {
    paths.iter().map(|path| Ok(Input { path: relative_path(path, plan_dir), sha256: sha256_hex(path)? })).collect()
}

/// A file as seen from a folder, with `/` between the parts. Links are resolved where the paths exist, so that `..`
/// means the same to the system as here. Absolute only where no relative path exists (another drive).
pub fn relative_path(file: &Path, from_dir: &Path) -> String {
    let from_dir = if from_dir.as_os_str().is_empty() { Path::new(".") } else { from_dir };
    let real = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or(path.to_owned());
    let (file, dir) = (real(file), real(from_dir));
    let (to, from): (Vec<Component>, Vec<Component>) = (file.components().collect(), dir.components().collect());
    let shared = to.iter().zip(&from).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return file.to_string_lossy().into_owned();
    }
    let up = std::iter::repeat_n("..".into(), from.len() - shared);
    let down = to[shared..].iter().map(|part| part.as_os_str().to_string_lossy());
    up.chain(down).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_paths_lead_back_to_the_file() {
        let root = tempfile::tempdir().unwrap();
        let dir = root.path().join("shots/a");
        std::fs::create_dir_all(&dir).unwrap();
        std::fs::write(root.path().join("scene.glb"), "abc").unwrap();
        std::fs::write(dir.join("near.glb"), "abc").unwrap();
        assert_eq!(relative_path(&root.path().join("scene.glb"), &dir), "../../scene.glb");
        assert_eq!(relative_path(&dir.join("near.glb"), &dir), "near.glb");
        assert_eq!(relative_path(&dir.join("../../scene.glb"), root.path()), "scene.glb");
    }

    #[test]
    fn hashes_are_those_of_the_standard() {
        // FIPS 180-2, appendix B.1: the message "abc".
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("abc");
        std::fs::write(&file, "abc").unwrap();
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(hash_inputs(std::slice::from_ref(&file), root.path()).unwrap()[0].sha256, expected);
    }
}
