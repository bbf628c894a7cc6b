//! A shot in pieces: the same plan to the byte however it was split, shuffled or killed, and what is wrong with parts named.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod watching;

use lixel::job::{self, LoadedJob};
use lixel::plan::{self, Format, Merged, PlanError, to_text};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use watching::watched;

/// A few frames of the courtyard, small.
const COURTYARD: &str = "
[frames]
range = '1-81x16'
[image]
size = [160, 90]
[quality]
epsilon = 0.01
[map]
max = 4096
step = 1.2
[solver]
measured_rounds = 1
[[light]]
name = 'sun'
[[light]]
name = 'spot'
[[light]]
name = 'lamp'
";

/// Frames of [`COURTYARD`].
const FRAMES: [i64; 6] = [1, 17, 33, 49, 65, 81];

/// A folder with the courtyard as a job.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/courtyard/courtyard.glb");
    std::fs::copy(scene, folder.path().join("courtyard.glb")).unwrap();
    std::fs::write(folder.path().join("job.toml"), format!("scene = 'courtyard.glb'\n{COURTYARD}")).unwrap();
    folder
}

fn load(folder: &Path, overrides: &str) -> LoadedJob {
    job::load(&folder.join("job.toml"), &overrides.parse().unwrap()).unwrap()
}

fn text(plan: &plan::Plan) -> String {
    to_text(plan, Format::Json).unwrap()
}

fn planned(folder: &Path, overrides: &str) -> String {
    text(&watched(|watch| plan::make(&load(folder, overrides), folder, false, watch)).unwrap())
}

/// Numbers without pattern.
fn random(seed: &mut u64) -> u64 {
    *seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut x = *seed;
    x = (x ^ x >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ x >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ x >> 31
}

fn shuffled<T>(mut list: Vec<T>, seed: u64) -> Vec<T> {
    let mut seed = seed;
    for k in (1..list.len()).rev() {
        let other = random(&mut seed) as usize % (k + 1);
        list.swap(k, other);
    }
    list
}

/// A part for every range, under a name of its own.
fn each(
    folder: &Path,
    name: &str,
    ranges: &[&str],
    work: impl Fn(&str, &Path) -> Result<usize, PlanError>,
) -> Vec<PathBuf> {
    let one = |(k, range): (usize, &&str)| {
        let to = folder.join(format!("{name}-{k}.part"));
        assert!(work(range, &to).unwrap() > 0);
        to
    };
    ranges.iter().enumerate().map(one).collect()
}

/// The plan by way of files; frames split in `ranges`, parts shuffled. Returns the rounds too.
fn in_pieces(folder: &Path, overrides: &str, ranges: &[&str], seed: u64) -> (String, u32) {
    let job = load(folder, overrides);
    let files = folder.join(format!("pieces-{seed}"));
    std::fs::create_dir_all(&files).unwrap();
    let sampled =
        each(&files, "sampled", ranges, |range, to| watched(|watch| plan::sample(&job, Some(range), to, watch)));
    let mut draft = files.join("shot.draft");
    watched(|watch| plan::solve(&shuffled(sampled, seed), None, &draft, watch)).unwrap();
    let mut round = 0;
    loop {
        round += 1;
        assert!(round < 9, "the sizes do not settle");
        let mut parts = each(&files, &format!("certified-{round}"), ranges, |range, to| {
            watched(|watch| plan::certify(&draft, Some(range), None, to, watch))
        });
        if round > 1 {
            parts.push(draft);
        }
        let again = files.join(format!("again-{round}.draft"));
        let merged = watched(|watch| plan::merge(&shuffled(parts, seed + 1), None, folder, &again, watch)).unwrap();
        match merged {
            Merged::Plan(plan) => return (text(&plan), round),
            Merged::Again { frames } => assert!(!frames.is_empty()),
        }
        draft = again;
    }
}

#[test]
fn any_split_in_any_order_gives_the_same_bytes() {
    let folder = folder();
    let whole = planned(folder.path(), "");
    assert!(whole.contains("\"mode\": \"shot\""));
    let single: Vec<String> = FRAMES.iter().map(i64::to_string).collect();
    let single: Vec<&str> = single.iter().map(String::as_str).collect();
    for (seed, ranges) in [&["1-90"][..], &["40-90", "1-16", "17-39"], &single].into_iter().enumerate() {
        let (pieces, _) = in_pieces(folder.path(), "", ranges, seed as u64);
        assert!(pieces == whole, "split {ranges:?}");
    }
}

#[test]
fn every_mode_goes_in_pieces() {
    let folder = folder();
    let few = "frames.range = '1-61x20'\n";
    for (seed, overrides) in [
        "[shot]\ntemporal = 'per-frame'",
        "[shot]\ntemporal = 'hysteresis'\nhysteresis_border = 0.05",
        "light = [{ name = 'sun' }]\n[shot]\ntemporal = 'snapped'\n[map]\nshape = 'rectangle'",
        "light = [{ name = 'sun' }]\n[shot]\nminimise = 'sum'\nchange_cost = 0.0\none_size = true",
        "light = [{ name = 'sun' }]\n[solver]\nmethod = 'focused'",
        "light = [{ name = 'sun' }]\n[solver]\nmethod = 'auto'\nmin_saving = 0.0\nmax_maps = 2",
        "light = [{ name = 'lamp' }]\n[quality]\nmeasure = 'never'",
    ]
    .into_iter()
    .enumerate()
    {
        let overrides = format!("{few}{overrides}");
        let whole = planned(folder.path(), &overrides);
        let (pieces, rounds) = in_pieces(folder.path(), &overrides, &["21", "41-90", "1-20"], 10 + seed as u64);
        assert!(pieces == whole, "{overrides}");
        let grows = ["temporal = 's", "one_size", "'auto'", "'never'"].iter().any(|mode| overrides.contains(mode));
        if !grows {
            assert_eq!(rounds, 1, "{overrides}: nothing there to grow");
        }
    }
}

#[test]
fn a_budget_and_blending_over_time_are_settled_alike_in_pieces() {
    let folder = folder();
    for (seed, overrides) in [
        "frames.range = '40-42'\nlight = [{ name = 'lamp' }]\nbudget = { texels_total = 20000 }",
        "frames.range = '40-42'\nlight = [{ name = 'lamp' }]\nlookup = { temporal = 'reprojection' }\n\
         shot = { temporal = 'per-frame' }",
    ]
    .into_iter()
    .enumerate()
    {
        let whole = planned(folder.path(), overrides);
        let (pieces, _) = in_pieces(folder.path(), overrides, &["41", "40", "42"], 20 + seed as u64);
        assert!(pieces == whole, "{overrides}");
        assert!(whole.contains(if seed == 0 { "\"budget\"" } else { "\"reprojected\"" }), "{overrides}");
    }
}

#[test]
fn what_is_wrong_with_parts_is_named() {
    let folder = folder();
    let dir = folder.path();
    let overrides = "frames.range = '1-3'\nlight = [{ name = 'sun' }]\n[quality]\nmeasure = 'never'";
    let job = load(dir, overrides);
    let at = |name: &str| dir.join(name);
    let sample = |job: &LoadedJob, range: &str, name: &str| {
        watched(|watch| plan::sample(job, Some(range), &at(name), watch)).unwrap();
        at(name)
    };
    let (a, b, ab) = (sample(&job, "1-2", "a"), sample(&job, "3", "b"), sample(&job, "2-3", "ab"));
    let solve = |parts: &[&PathBuf]| {
        let parts: Vec<PathBuf> = parts.iter().map(|p| (*p).clone()).collect();
        watched(|watch| plan::solve(&parts, None, &at("draft"), watch)).map_err(|e| e.to_string())
    };
    let says = |found: Result<(), String>, words: &[&str]| {
        let found = found.unwrap_err();
        assert!(words.iter().all(|w| found.contains(w)), "{words:?}: {found}");
    };
    says(solve(&[&a]), &["frames 3", "lixel sample … --frames 3"]);
    says(solve(&[&a, &ab]), &["frames 2 ", "/a ", "/ab"]);
    let other = sample(&load(dir, &format!("{overrides}\nepsilon = 0.02")), "3", "other");
    says(solve(&[&a, &other]), &["/other", "/a", "job.quality.epsilon is 0.02 in it, not 0.01"]);
    let bytes = std::fs::read(&b).unwrap();
    for cut in [4, 14, 60, bytes.len() - 40, bytes.len() - 1] {
        std::fs::write(at("cut"), &bytes[..cut]).unwrap();
        says(solve(&[&a, &at("cut")]), &["/cut is damaged", "make it again"]);
    }
    let mut changed = bytes.clone();
    changed[bytes.len() / 2] ^= 1;
    std::fs::write(at("changed"), &changed).unwrap();
    says(solve(&[&a, &at("changed")]), &["/changed is damaged", "checksum"]);
    changed = bytes;
    changed[11] = 77;
    std::fs::write(at("version"), &changed).unwrap();
    says(solve(&[&a, &at("version")]), &["/version has version 77"]);
    says(solve(&[&a, &at("job.toml")]), &["job.toml is no part"]);
    says(solve(&[&at("gone")]), &["cannot read", "gone"]);
    says(solve(&[]), &["no part"]);
    let range = watched(|watch| plan::sample(&job, Some("7-9"), &at("none"), watch)).unwrap_err().to_string();
    assert!(range.contains("--frames 7-9") && range.contains("1-3"), "{range}");

    solve(&[&b, &a]).unwrap();
    let certify = |range: &str, draft: &str, name: &str| {
        watched(|watch| plan::certify(&at(draft), Some(range), None, &at(name), watch)).map_err(|e| e.to_string())
    };
    certify("1-2", "draft", "ca").unwrap();
    certify("3", "draft", "cb").unwrap();
    says(certify("1", "a", "c").map(|_| ()), &["/a is a part of `lixel sample`", "`lixel certify` takes a draft"]);
    let merge = |parts: &[&str]| {
        let parts: Vec<PathBuf> = parts.iter().map(|p| at(p)).collect();
        watched(|watch| plan::merge(&parts, None, dir, &at("again"), watch)).map(|_| ()).map_err(|e| e.to_string())
    };
    merge(&["cb", "ca"]).unwrap();
    says(merge(&["ca"]), &["frames 3", "lixel certify … --frames 3"]);
    says(merge(&["ca", "cb", "ca"]), &["frames 1-2", "/ca"]);
    says(merge(&["ca", "b"]), &["/b is a part of `lixel sample`"]);
    // The scene changes behind the parts' back.
    let scene = std::fs::read(at("courtyard.glb")).unwrap();
    std::fs::rename(at("courtyard.glb"), at("was.glb")).unwrap();
    std::fs::write(at("courtyard.glb"), [&scene[..], &[0; 4]].concat()).unwrap();
    let found = merge(&["ca", "cb"]).unwrap_err();
    assert!(found.contains("courtyard.glb"), "{found}");
}

#[test]
fn a_folder_of_finished_work_is_gone_on_from_and_belongs_to_one_job() {
    let folder = folder();
    let overrides = "frames.range = '1-61x20'\nlight = [{ name = 'sun' }]";
    let whole = planned(folder.path(), overrides);
    let work = folder.path().join("work");
    let go_on = |overrides: &str| {
        watched(|watch| plan::make_in(&load(folder.path(), overrides), folder.path(), false, Some(&work), watch))
    };
    assert!(text(&go_on(overrides).unwrap()) == whole);
    // From any part of what is there: nothing but files of finished frames matters.
    let mut names: Vec<PathBuf> = std::fs::read_dir(&work).unwrap().map(|f| f.unwrap().path()).collect();
    names.sort();
    assert!(names.len() > 9, "{names:?}");
    for (k, name) in names.iter().enumerate() {
        if k % 2 == 0 {
            std::fs::remove_file(name).unwrap();
        } else {
            let bytes = std::fs::read(name).unwrap();
            std::fs::write(name, &bytes[..bytes.len() * 2 / 3]).unwrap();
        }
        assert!(text(&go_on(overrides).unwrap()) == whole, "without {}", name.display());
    }
    let found = go_on(&format!("{overrides}\n[quality]\nepsilon = 0.03")).unwrap_err().to_string();
    assert!(found.contains("work of another job") && found.contains("job.quality.epsilon"), "{found}");
}

#[test]
fn a_killed_plan_goes_on_to_the_same_bytes() {
    let folder = folder();
    let lixel = |work: bool, to: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lixel"));
        command.args(["plan", "job.toml", "--quiet", "--frames", "1-61x20", "--epsilon", "0.02", "-o", to]);
        if work {
            command.args(["--work", "work"]);
        }
        command.current_dir(folder.path());
        command
    };
    let start = Instant::now();
    lixel(false, "whole.json").status().unwrap();
    let whole = start.elapsed();
    let (mut seed, mut killed) = (5, 0);
    let finished = loop {
        let mut child = lixel(true, "killed.json").spawn().unwrap();
        // Later and later, so that it ends on any machine.
        let part = (random(&mut seed) % 1000) as f64 / 1000.0 * 0.3 + f64::from(killed) * 0.05;
        std::thread::sleep(Duration::from_secs_f64(whole.as_secs_f64() * part));
        if killed < 5 {
            child.kill().unwrap();
            child.wait().unwrap();
            killed += 1;
        } else {
            break child.wait().unwrap();
        }
    };
    assert!(finished.code().is_some_and(|c| c == 0 || c == 3), "{finished}");
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(read("whole.json") == read("killed.json"));
}

#[test]
fn commands_find_the_scene_from_parts_in_another_folder() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    // A bound that the smallest map meets: nothing grows, one round does.
    let job = ["--frames", "1-3", "--measure", "never", "--size", "64x36", "--epsilon", "0.5"];
    let lixel = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lixel"));
        let found = command.args(arguments).arg("--quiet").current_dir(folder.path()).output().unwrap();
        assert!(found.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&found.stderr));
    };
    lixel(&[&["plan", "job.toml", "-o", "whole.json"], &job[..]].concat());
    for (range, part) in [("3", "parts/b"), ("1-2", "parts/a")] {
        let piece = ["sample", "job.toml", "--shot", "1-3", "--frames", range, "-o", part];
        lixel(&[&piece, &job[2..]].concat());
    }
    lixel(&["solve", "parts/a", "parts/b", "-o", "parts/draft"]);
    lixel(&["certify", "parts/draft", "-o", "certified"]);
    lixel(&["merge", "certified", "-o", "merged.json"]);
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(read("whole.json") == read("merged.json"));
}
