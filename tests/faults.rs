//! The command when the system fails it: inputs that are no files, outputs that cannot be written, readers that go away,
//! a run that is killed.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn lixel(folder: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("lixel"));
    command.current_dir(folder).env("NO_COLOR", "1");
    command
}

fn output(folder: &Path, args: &[&str]) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = lixel(folder).args(args).output().unwrap();
    (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

/// A folder with a small scene and a job that plans it: a board over a floor.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let board =
        "v -9 0 9\nv 9 0 9\nv 9 0 -9\nv -9 0 -9\nf 1 2 3 4\nv -1 1 1\nv 1 1 1\nv 1 1 -1\nv -1 1 -1\nf 5 6 7 8\n";
    fs::write(folder.path().join("a.obj"), board).unwrap();
    let job = "scene = \"a.obj\"\n[image]\nsize = [96, 54]\n[camera]\nposition = [0, 3, 6]\nlook_at = [0, 0, 0]\n\
               [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0.3, -1, 0.1]\n[quality]\nepsilon = 0.02\n";
    fs::write(folder.path().join("job.toml"), job).unwrap();
    folder
}

#[test]
fn folders_and_devices_are_no_inputs() {
    let folder = folder();
    for name in ["dir.toml", "dir.glb", "dir.json"] {
        fs::create_dir(folder.path().join(name)).unwrap();
    }
    for (name, target) in [("dev.toml", "/dev/null"), ("dev.glb", "/dev/zero"), ("dev.json", "/dev/zero")] {
        std::os::unix::fs::symlink(target, folder.path().join(name)).unwrap();
    }
    let cases = [
        (["plan", "dir.toml"], "is a directory"),
        (["plan", "dir.glb"], "is a directory"),
        (["verify", "dir.json"], "is a directory"),
        (["plan", "dev.glb"], "it is a device"),
        (["verify", "dev.json"], "it is a device"),
        (["plan", "dev.toml"], "no scene file is named"),
        (["plan", "/dev/zero"], "neither"),
    ];
    for (args, want) in cases {
        let (code, stdout, stderr) = output(folder.path(), &args);
        assert_eq!((code, stdout.as_str()), (Some(2), ""), "{args:?}: {stderr}");
        assert!(stderr.contains(want), "{args:?}: {stderr}");
    }
}

#[test]
fn files_outside_the_folder_are_read_only_when_allowed() {
    let folder = folder();
    fs::create_dir(folder.path().join("set")).unwrap();
    let bytes: Vec<u8> = [[-1.0_f32, 1.0, -1.0], [1.0, 1.0, -1.0], [0.0, 1.0, 1.0]]
        .as_flattened()
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    fs::write(folder.path().join("triangle.bin"), bytes).unwrap();
    let scene = r#"{ "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [{ "uri": "../triangle.bin", "byteLength": 36 }] }"#;
    fs::write(folder.path().join("set/a.gltf"), scene).unwrap();
    let job = fs::read_to_string(folder.path().join("job.toml")).unwrap();
    fs::write(folder.path().join("outside.toml"), job.replace("\"a.obj\"", "[\"a.obj\", \"set/a.gltf\"]")).unwrap();
    let (code, _, stderr) = output(folder.path(), &["plan", "outside.toml"]);
    assert_eq!(code, Some(2), "{stderr}");
    assert!(stderr.contains("URI \"../triangle.bin\" leaves the scene's folder"), "{stderr}");
    assert!(stderr.contains("or say --allow-outside"), "{stderr}");
    let (code, _, stderr) = output(folder.path(), &["plan", "outside.toml", "--allow-outside", "-o", "plan.json"]);
    assert_eq!(code, Some(0), "{stderr}");
    // The plan remembers, so that it can be checked.
    let (code, _, stderr) = output(folder.path(), &["verify", "plan.json"]);
    assert_eq!(code, Some(0), "{stderr}");
    let plan = fs::read_to_string(folder.path().join("plan.json")).unwrap();
    assert!(plan.contains("\"allow_outside\": true") && plan.contains("\"triangle.bin\""), "{plan}");
}

#[test]
fn sizes_of_a_job_are_checked_before_anything_is_read() {
    let folder = folder();
    fs::remove_file(folder.path().join("a.obj")).unwrap();
    let plan = |extra: &str| {
        let job = fs::read_to_string(folder.path().join("job.toml")).unwrap();
        let job = job.replace("size = [96, 54]", if extra.starts_with("size") { extra } else { "size = [96, 54]" });
        let tables = if extra.starts_with('[') { extra } else { "" };
        fs::write(folder.path().join("large.toml"), format!("{job}{tables}\n")).unwrap();
        output(folder.path(), &["plan", "large.toml"])
    };
    let (code, _, stderr) = plan("size = [16384, 16384]");
    assert_eq!(code, Some(2));
    assert!(stderr.contains("16384 x 16384 is out of range") && stderr.contains("67108864"), "{stderr}");
    let (code, _, stderr) = plan("size = [16384, 4096]");
    assert!(code == Some(2) && stderr.contains("a.obj: cannot be read"), "{stderr}");
    let (code, _, stderr) = plan("[map]\nmin = 8192\nmax = 8192\n[solver]\nmethod = \"cascades\"");
    assert_eq!(code, Some(2));
    assert!(stderr.contains("24 maps of 8192 x 8192 texels are more than 268435456"), "{stderr}");
}

#[test]
fn a_folder_that_cannot_be_written_is_found_before_the_work() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let closed = folder.path().join("closed");
    fs::create_dir(&closed).unwrap();
    fs::write(closed.join("plan.json"), "old").unwrap();
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(closed.join("probe"), "").is_ok() {
        println!("skipped: this user writes to folders that are closed to writing");
        return;
    }
    let (code, _, stderr) = output(folder.path(), &["plan", "job.toml", "-o", "closed/plan.json"]);
    assert_eq!(code, Some(1));
    assert!(stderr.contains("cannot write closed/plan.json: Permission denied"), "{stderr}");
    assert_eq!(fs::read_to_string(closed.join("plan.json")).unwrap(), "old");
}

#[test]
fn a_full_disk_leaves_the_old_plan() {
    let folder = folder();
    if Path::new("/dev/full").exists() {
        let (code, stdout, stderr) = output(folder.path(), &["plan", "job.toml", "-o", "/dev/full"]);
        assert_eq!((code, stdout.as_str()), (Some(1), ""), "{stderr}");
        assert!(stderr.contains("cannot write /dev/full: No space left on device"), "{stderr}");
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let run = lixel(folder.path()).args(["plan", "job.toml", "-q"]).stdout(full).output().unwrap();
        let stderr = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(1), "{stderr}");
        assert!(stderr.contains("cannot write standard output: No space left on device"), "{stderr}");
    }
    let disk = folder.path().join("disk");
    fs::create_dir(&disk).unwrap();
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=16k", "lixel"]).arg(&disk).output();
    if !mount.is_ok_and(|run| run.status.success()) {
        println!("skipped: this user may not mount a small file system");
        return;
    }
    let unmount = || Command::new("umount").arg(&disk).status().unwrap();
    fs::write(disk.join("plan.json"), "old").unwrap();
    let filled = (0..64).take_while(|k| fs::write(disk.join(format!("filler {k}")), [0; 4096]).is_ok()).count();
    let (code, _, stderr) = output(folder.path(), &["plan", "job.toml", "-o", "disk/plan.json"]);
    let (old, left) = (fs::read_to_string(disk.join("plan.json")).unwrap(), fs::read_dir(&disk).unwrap().count());
    unmount();
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.contains("cannot write disk/plan.json: No space left on device"), "{stderr}");
    assert_eq!(old, "old");
    // The old plan, the fillers with the one that did not fit: nothing of ours.
    assert!(left <= filled + 2, "{left} files, {filled} fillers");
}

#[test]
fn a_reader_that_goes_away_is_no_error_for_a_plan() {
    let folder = folder();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let run = lixel(folder.path()).args(["plan", "job.toml", "-q"]).stdout(writer).stderr(Stdio::piped()).output();
    let run = run.unwrap();
    assert_eq!((run.status.code(), String::from_utf8(run.stderr).unwrap().as_str()), (Some(0), ""));
}

/// Kills at moments spread over a run, by SIGTERM and SIGKILL in turn: the output is the old plan or the new one. Twenty
/// moments with `LIXEL_KILLS=20`.
#[test]
fn a_killed_run_leaves_the_old_plan_or_the_new_one() {
    let folder = folder();
    let plan = folder.path().join("plan.json");
    let args = ["plan", "job.toml", "-o", "plan.json", "-q"];
    let start = std::time::Instant::now();
    assert_eq!(output(folder.path(), &args).0, Some(0));
    let whole = start.elapsed();
    let new = fs::read_to_string(&plan).unwrap();
    let old = new.replace("\"sun\"", "\"old\"");
    let kills: u32 = std::env::var("LIXEL_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(4);
    let (mut kept, mut replaced) = (0, 0);
    for k in 0..kills {
        fs::write(&plan, &old).unwrap();
        let mut run = lixel(folder.path()).args(args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // Golden-ratio steps: moments that a run of any length is spread over.
        let part = (f64::from(k) * 0.618_033_988_749_895).fract() * 1.1;
        std::thread::sleep(Duration::from_secs_f64(whole.as_secs_f64() * part));
        let signal = if k % 2 == 0 { "KILL" } else { "TERM" };
        // A run that has ended is no process any more.
        let _ = Command::new("kill").args(["-s", signal, &run.id().to_string()]).stderr(Stdio::null()).status();
        run.wait().unwrap();
        let found = fs::read_to_string(&plan).unwrap();
        assert!(found == old || found == new, "{signal} at {part:.2} of a run: {} bytes", found.len());
        kept += u32::from(found == old);
        replaced += u32::from(found == new);
    }
    println!("{kept} old plans, {replaced} new ones");
    assert_eq!(kept + replaced, kills);
}
