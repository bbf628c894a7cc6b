//! The command: exit codes, what goes to which stream, signals, closed pipes.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod plan_sample;

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use lixel::plan::{Dest, Format, hash_inputs, write};

fn lixel(dir: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("lixel"));
    command.current_dir(dir).env("NO_COLOR", "1");
    command
}

fn output(dir: &Path, args: &[&str]) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = lixel(dir).args(args).output().unwrap();
    (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

/// A folder with a scene and a plan of it.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let scene = dir.path().join("a.glb");
    fs::write(&scene, "not a scene").unwrap();
    let plan = plan_sample::plan(hash_inputs(&[scene], dir.path()).unwrap());
    write(&plan, &Dest::File(dir.path().join("plan.json")), Format::Json).unwrap();
    write(&plan, &Dest::File(dir.path().join("plan.toml")), Format::Toml).unwrap();
    dir
}

#[test]
fn help_shows_examples_and_exit_codes() {
    let dir = folder();
    let (code, stdout, stderr) = output(dir.path(), &["--help"]);
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    for part in ["Examples:\n  lixel plan shot.toml", "Exit codes:\n  0 ", "  130  stopped by SIGINT; 143 by SIGTERM"] {
        assert!(stdout.contains(part), "{part} is not in\n{stdout}");
    }
    for command in ["plan", "verify", "render", "trade", "schema"] {
        let (code, stdout, _) = output(dir.path(), &[command, "--help"]);
        assert_eq!(code, Some(0));
        assert!(stdout.contains(&format!("\n  lixel {command} ")), "{command} has no example:\n{stdout}");
    }
}

#[test]
fn schemas_go_to_standard_output() {
    let dir = folder();
    for of in ["plan", "job"] {
        let (code, stdout, stderr) = output(dir.path(), &["schema", of]);
        assert_eq!((code, stderr.as_str()), (Some(0), ""));
        let schema: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        assert!(jsonschema::meta::is_valid(&schema), "{of}");
    }
}

#[test]
fn bad_usage_and_bad_input_exit_with_2_and_leave_standard_output_empty() {
    let dir = folder();
    fs::write(dir.path().join("job.toml"), "scene = \"a.glb\"\n").unwrap();
    fs::write(dir.path().join("bad.toml"), "scene = \"a.glb\"\nlights = []\n").unwrap();
    let cases: [&[&str]; 11] = [
        &[],
        &["plam"],
        &["plan"],
        &["plan", "missing.toml"],
        &["plan", "picture.png"],
        &["plan", "bad.toml"],
        &["plan", "job.toml", "--size", "1920"],
        &["plan", "job.toml", "--method", "magic"],
        &["plan", "job.toml", "--epsilon", "nan"],
        &["render", "job.toml", "-o", "out"],
        &["verify", "missing.json"],
    ];
    for args in cases {
        let (code, stdout, stderr) = output(dir.path(), args);
        assert_eq!((code, stdout.as_str()), (Some(2), ""), "{args:?}: {stderr}");
        assert!(!stderr.is_empty(), "{args:?}");
    }
}

#[test]
fn flags_are_named_by_their_own_name() {
    let dir = folder();
    let plan = |flag: &str, value: &str| output(dir.path(), &["plan", "a.glb", flag, value]).2;
    assert_eq!(
        plan("--epsilon", "1.5"),
        "error: --epsilon: 1.5 is out of range\nhelp: allowed is a share of the image above 0 and at most 1\n"
    );
    assert_eq!(plan("--size", "0x1080"), "error: --size: 0 is out of range\nhelp: allowed is 1 to 16384 pixels\n");
    assert_eq!(
        plan("--max-resolution", "8"),
        "error: --max-resolution: max = 8 is below min = 16\nhelp: raise max or lower min\n"
    );
    assert_eq!(plan("--camera", ""), "error: --camera: the name is empty\nhelp: name a camera of the scene's files\n");
}

#[test]
fn an_output_that_cannot_be_written_is_found_before_the_work() {
    let dir = folder();
    let (code, stdout, stderr) = output(dir.path(), &["plan", "a.glb", "-o", "none/plan.json"]);
    assert_eq!((code, stdout.as_str()), (Some(1), ""));
    assert!(stderr.starts_with("error: cannot write none/plan.json: "), "{stderr}");
}

#[test]
fn verify_reads_both_formats_and_finds_changed_files() {
    let dir = folder();
    fs::write(dir.path().join("a.glb"), "something else").unwrap();
    for plan in ["plan.json", "plan.toml"] {
        let (code, stdout, _) = output(dir.path(), &["verify", plan]);
        assert_eq!(code, Some(1));
        assert_eq!(
            stdout,
            "a.glb: its content is not what the plan was made from; plan the job again\nthe plan does NOT hold\n"
        );
    }
    let (code, stdout, _) = output(dir.path(), &["verify", "plan.json", "--json"]);
    let found: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((code, &found["passed"], &found["inputs"][0]["passed"]), (Some(1), &false.into(), &false.into()));
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let dir = folder();
    fs::write(dir.path().join("a.glb"), "something else").unwrap();
    for args in [&["schema", "plan"][..], &["verify", "plan.json"], &["--help"]] {
        // A pipe whose reading end is closed before the command starts.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let run = lixel(dir.path()).args(args).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        assert_eq!(String::from_utf8(run.stderr).unwrap(), "", "{args:?}");
        assert_eq!(run.status.code(), Some(0), "{args:?}");
    }
}

/// A job behind a named pipe keeps the command waiting until it is written, so the signal surely comes before the work.
#[cfg(unix)]
#[test]
fn signals_end_the_work_with_their_code_and_leave_no_file() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let dir = folder();
        let before = fs::read_dir(dir.path()).unwrap().count();
        let job = dir.path().join("job.toml");
        assert!(Command::new("mkfifo").arg(&job).status().unwrap().success());
        let mut run = lixel(dir.path())
            .args(["plan", "job.toml", "-o", "new.json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // Opens as soon as the command has the other end open: its handlers are installed by then.
        let mut pipe = fs::File::options().write(true).open(&job).unwrap();
        let killed = Command::new("kill").args(["-s", signal, &run.id().to_string()]).status().unwrap();
        assert!(killed.success());
        std::io::Write::write_all(&mut pipe, b"scene = \"a.glb\"\n").unwrap();
        drop(pipe);
        assert_eq!(run.wait().unwrap().code(), Some(code));
        let Output { stdout, stderr, .. } = run.wait_with_output().unwrap();
        assert_eq!((stdout.as_slice(), String::from_utf8(stderr).unwrap().as_str()), (&b""[..], ""));
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), before + 1, "only the pipe is new");
    }
}
