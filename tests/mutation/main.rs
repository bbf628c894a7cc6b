//! Damaged jobs, scenes and plans, from a fixed seed: an error or a result, never a panic.
//!
//! The cases of `tests/corpus` are read as they are; then each is damaged and read again. Damage that leads to a message
//! not met before joins the cases of the run. `LIXEL_FUZZ_RUNS=1000000 cargo test --release --test mutation` runs longer
//! than the default, `LIXEL_FUZZ_SEED` elsewhere, and `LIXEL_FUZZ_KEEP=DIR` writes the smallest case of each new message.
//! `fuzz/` has the same targets for cargo-fuzz.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod damage;
#[path = "../scene/fixture.rs"]
#[allow(dead_code, reason = "this test uses a part of the builder")]
mod fixture;
#[path = "../plan_sample/mod.rs"]
mod plan_sample;
mod seeds;
#[path = "../../fuzz/targets.rs"]
mod targets;

use damage::{Damage, skeleton};
use std::collections::BTreeMap;
use std::path::Path;

/// Damaged cases of each target by default: a few seconds.
const RUNS: u64 = 3000;

/// Cases that a run goes on from: messages of parsers that quote the input would let them grow without end.
const CASES: usize = 512;

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

/// The cases that ship, in the order of their names.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(target);
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.into_iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// Runs a target over the corpus, the seeds and damage to both.
fn run(target: &str, seeds: Vec<Vec<u8>>, likely: &[&str], read: fn(&[u8], &Path) -> Result<(), String>) {
    let folder = tempfile::tempdir().unwrap();
    let mut cases = corpus(target);
    assert!(!cases.is_empty(), "tests/corpus/{target} is empty");
    for seed in &seeds {
        assert_eq!(read(seed, folder.path()), Ok(()), "{}", String::from_utf8_lossy(seed));
    }
    cases.extend(seeds);
    let mut met: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    for case in &cases {
        let outcome = skeleton(&read(case, folder.path()));
        met.entry(outcome).or_insert_with(|| case.clone());
    }
    let known = met.clone();
    let mut damage = Damage(number("LIXEL_FUZZ_SEED", 1));
    let mut refused = 0_u64;
    let runs = number("LIXEL_FUZZ_RUNS", RUNS);
    for _ in 0..runs {
        let case = damage.apply(&cases, likely);
        let found = read(&case, folder.path());
        refused += u64::from(found.is_err());
        let outcome = skeleton(&found);
        match met.get(&outcome) {
            None => {
                if cases.len() < CASES {
                    cases.push(case.clone());
                }
                met.insert(outcome, case);
            }
            Some(smallest) if case.len() < smallest.len() => {
                met.insert(outcome, case);
            }
            Some(_) => {}
        }
    }
    println!("{target}: {runs} runs, {refused} refused, {} outcomes", met.len());
    assert!(refused * 10 > runs, "{refused} of {runs} refused: the damage does none");
    if let Some(keep) = std::env::var_os("LIXEL_FUZZ_KEEP") {
        let folder = Path::new(&keep).join(target);
        std::fs::create_dir_all(&folder).unwrap();
        for (k, (_, case)) in met.iter().filter(|(outcome, _)| !known.contains_key(*outcome)).enumerate() {
            std::fs::write(folder.join(format!("{k:03}")), case).unwrap();
        }
    }
}

#[test]
fn damaged_jobs() {
    let likely = [
        "nan",
        "inf",
        "-1",
        "1e400",
        "[[light]]\n",
        "[camera]\n",
        "\"",
        "'''",
        "= [[",
        "= {",
        "\u{0}",
        "99999999999999999999",
    ];
    run("job", seeds::jobs(), &likely, targets::job);
}

#[test]
fn damaged_gltf_files() {
    let likely = [
        "4294967295",
        "4294967296",
        "-1",
        "1e400",
        "null",
        "[]",
        "{}",
        "0",
        "5126",
        "\"VEC4\"",
        "\"../a\"",
        "\"data:,\"",
    ];
    run("gltf", seeds::gltf(), &likely, targets::gltf);
}

#[test]
fn damaged_obj_files() {
    let likely = [
        "f 1 2 3 4 5 6\n",
        "v 1e39 0 0\n",
        "nan",
        "-1",
        "1/1/1",
        "//",
        "\\\n",
        "usemtl m\n",
        "mtllib ../a\n",
        "2147483648",
        "4294967297",
    ];
    run("obj", seeds::obj(), &likely, targets::obj);
}

#[test]
fn damaged_plans() {
    let likely = ["null", "-1", "1e400", "1e308", "[]", "{}", "\"all\"", "\"lixel.plan/1\"", "nan", "4294967296"];
    run("plan", seeds::plans(), &likely, targets::plan);
}
