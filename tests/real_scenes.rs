//! Real scenes, which lie outside the repository: `LIXEL_SCENES=folder cargo test --release --test real_scenes`.
//! Every scene file of the folder is planned in draft, seen as a whole under one sun. A file may be refused by name; it may
//! not fail, crash or hang.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Scene files of a folder and its folders, in order.
fn scene_files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let open = |path: PathBuf| match path {
        path if path.is_dir() => scene_files(&path),
        path if lixel::job::is_scene_file(&path) => vec![path],
        _ => Vec::new(),
    };
    entries.into_iter().flat_map(open).collect()
}

#[test]
fn every_real_scene_is_planned_or_refused_by_name() {
    let Some(folder) = std::env::var_os("LIXEL_SCENES").map(PathBuf::from) else {
        println!("skipped: LIXEL_SCENES not set");
        return;
    };
    assert!(folder.is_dir(), "LIXEL_SCENES = {} is no folder", folder.display());
    let files = scene_files(&folder);
    assert!(!files.is_empty(), "{} holds no scene file", folder.display());
    let work = tempfile::tempdir().unwrap();
    let job = work.path().join("job.toml");
    let mut failed = Vec::new();
    for file in &files {
        let scene = toml::Value::String(fs::canonicalize(file).unwrap().to_str().unwrap().to_owned());
        let sun = "name = \"sun\"\nkind = \"directional\"\ndirection = [0.4, -1.0, 0.3]";
        fs::write(&job, format!("scene = {scene}\n[camera]\nframe_all = true\n[[light]]\n{sun}\n")).unwrap();
        let run = Command::new(assert_cmd::cargo::cargo_bin!("lixel"))
            .args(["plan", "job.toml", "-o", "plan.json", "--preset", "draft", "--frames", "1", "--size", "320x180"])
            .current_dir(work.path())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        let name = file.strip_prefix(&folder).unwrap_or(file).display();
        println!("{name}: {}", said.trim_end());
        let planned =
            matches!(run.status.code(), Some(0 | 3)) && lixel::plan::read(&work.path().join("plan.json")).is_ok();
        let refused = run.status.code() == Some(2) && said.starts_with("error: ");
        if !planned && !refused {
            failed.push(format!("{name} ({}): {said}", run.status));
        }
    }
    assert!(failed.is_empty(), "{} of {} scenes failed:\n{}", failed.len(), files.len(), failed.join("\n"));
}
