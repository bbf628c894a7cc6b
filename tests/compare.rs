//! Methods side by side on the courtyard: the counts hold together, threads decide nothing, files say what was measured.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;

use lixel::compare::{
    BiasChoice, CompareParams, Comparison, Question, Variant, compare, csv, json, random_hemisphere, scatter,
    summarise, table,
};
use lixel::job::LoadedJob;
use lixel::methods::{Method, SolverParams};
use lixel::plan::{PlanError, Watch};

const METHODS: [Method; 4] = [Method::SceneOptimal, Method::Lixel, Method::Normal, Method::Focused];

fn courtyard() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/courtyard/courtyard.glb")
}

/// The courtyard from frame 30, small, under lights of the sky.
fn job(lights: u32) -> LoadedJob {
    let flags: toml::Table =
        "frames.range = \"30\"\nimage.size = [150, 100]\ncamera.name = \"walk\"\n".parse().unwrap();
    let mut loaded = lixel::job::load(&courtyard(), &flags).unwrap();
    loaded.job.light = random_hemisphere(0..lights, 5);
    loaded
}

fn params(question: Question, bias: BiasChoice) -> CompareParams {
    let solver = SolverParams::default();
    let methods = METHODS.iter().map(|m| Variant::plain(*m, &solver)).collect();
    CompareParams { methods, question, bias, pictures: None }
}

fn run(job: &LoadedJob, params: &CompareParams, threads: usize) -> Comparison {
    let cancel = AtomicBool::new(false);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut found =
        pool.install(|| compare(job, params, &Watch { progress: &|_| {}, cancel: &cancel, notes: &|_| {} })).unwrap();
    // Times are the only thing that may differ.
    found.lights.iter_mut().for_each(|l| l.seconds = 0.0);
    for method in &mut found.methods {
        method.seconds = 0.0;
        for row in &mut method.per_light {
            (row.solve_seconds, row.seconds) = (0.0, 0.0);
        }
    }
    found
}

#[test]
fn counts_hold_together_and_threads_decide_nothing() {
    let job = job(3);
    let texels = params(Question::Texels(4000), BiasChoice::Plan);
    let found = run(&job, &texels, 1);
    assert_eq!(found, run(&job, &texels, 2), "two threads, two lights at a time");
    assert_eq!(found, run(&job, &texels, 7), "more threads than lights");
    assert_eq!((found.lights.len(), found.methods.len(), found.pixels), (3, 4, 15_000));
    for method in &found.methods {
        assert_eq!(method.inapplicable, 0, "{}", method.method);
        let rows: Vec<_> = method.per_light.iter().map(|r| r.measured.clone().unwrap()).collect();
        assert_eq!(method.misclassified, rows.iter().map(|m| m.misclassified).sum::<u64>());
        assert!(method.misclassified > 0);
        for (m, light) in rows.iter().zip(&found.lights) {
            assert_eq!(m.misclassified, m.false_lit + m.false_shadow);
            assert_eq!(m.misclassified, m.edge + m.self_shadow);
            assert!(m.misclassified + m.uncertain <= light.facing && light.shadowed <= light.facing);
            assert!(m.texels <= 4000 && m.texels > 3600, "{:?}", m.maps);
            assert!(m.predicted.unwrap() > 0.0 && m.predicted <= m.predicted_unsaturated);
        }
    }

    // Another bias of the same map may only help; lixel looks for another map with another bias.
    let best = run(&job, &params(Question::Texels(4000), BiasChoice::Best), 2);
    let pairs = best.methods.iter().zip(&found.methods).filter(|(best, _)| best.method != "lixel");
    assert_eq!(pairs.clone().count(), 3);
    for (best, plan) in pairs {
        for (best, plan) in best.per_light.iter().zip(&plan.per_light) {
            let count = |row: &lixel::compare::PerLight| row.measured.as_ref().unwrap().misclassified;
            assert!(count(best) <= count(plan));
        }
    }
}

#[test]
fn files_and_table_say_what_was_measured() {
    let found = run(&job(2), &params(Question::Resolution([80, 40]), BiasChoice::Plan), 2);
    let summary = summarise(&found);
    for method in &found.methods {
        for row in &method.per_light {
            assert_eq!(row.measured.as_ref().unwrap().maps, [[80, 40]]);
        }
    }
    let value: serde_json::Value = serde_json::from_str(&json(&found, &summary).unwrap()).unwrap();
    assert_eq!(value["schema"], "lixel.compare/1");
    assert_eq!(value["methods"][1]["method"], "lixel");
    assert_eq!(value["methods"][1]["misclassified"], found.methods[1].misclassified);
    assert_eq!(value["methods"][1]["inapplicable"], 0);
    assert_eq!(value["methods"][1]["per_light"][1]["light"], "h0001");
    assert!(value["methods"][1]["per_light"][1]["edge"].is_u64() && value["methods"][1]["seconds"].is_f64());
    assert_eq!(value["summary"]["reference"], "scene-optimal");

    let csv = csv(&found);
    let cells: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(cells.len(), 1 + 2 * 4);
    assert!(cells.iter().all(|row| row.len() == cells[0].len()), "{csv}");
    assert_eq!(cells[2][..3], ["30", "h0000", "lixel"]);

    let text = table(&found, &summary);
    assert!(text.contains("/ scene-optimal [95 %]") && text.contains("worst by"), "{text}");
    assert_eq!(summary.methods[0].ratio.of_sums, Some(1.0));
    assert_eq!(summary.worst[0].lights, 1);
    let svg = scatter(&found);
    assert_eq!(svg.matches("r=\"2.5\"").count(), 2 * 4, "{svg}");
}

#[test]
fn exact_visibility_takes_part_with_its_samples() {
    let with = CompareParams {
        methods: [Method::SceneOptimal, Method::Partitioned, Method::Irregular]
            .map(|m| Variant::plain(m, &SolverParams::default()))
            .to_vec(),
        ..params(Question::Texels(4000), BiasChoice::Plan)
    };
    let found = run(&job(2), &with, 2);
    let summary = summarise(&found);
    let exact = &summary.methods[2];
    assert_eq!((exact.misclassified, exact.ratio.of_sums), (0, Some(0.0)));
    assert_eq!(exact.samples, Some(found.lights.iter().map(|l| l.facing).sum::<u64>() as f64 / 2.0));
    // The best method with maps is the one that others are compared with.
    let least = summary.methods[..2].iter().map(|m| m.percent_more.unwrap()).fold(f64::INFINITY, f64::min);
    assert_eq!(least, 0.0);
    assert!(table(&found, &summary).contains("irregular: exact, at the cost of"));
    // Several maps share the texels, and are worth it.
    let partitioned = &found.methods[1];
    for row in partitioned.per_light.iter().map(|r| r.measured.as_ref().unwrap()) {
        assert!(row.maps.len() > 1 && row.maps.len() <= 4 && row.texels <= 4000, "{:?}", row.maps);
    }
    assert!(partitioned.misclassified < found.methods[0].misclassified);
}

#[test]
fn texels_are_searched_for_a_bound() {
    let mut job = job(1);
    job.job.quality.epsilon = Some(0.05);
    job.job.map.step = 1.5;
    let found = run(&job, &params(Question::Epsilon, BiasChoice::Plan), 1);
    assert_eq!((found.texels, found.epsilon), (None, Some(0.05)));
    for method in &found.methods {
        let measured = method.per_light[0].measured.clone().unwrap();
        let needed = measured.needed.unwrap();
        assert!(needed.met && measured.misclassified as f64 <= 0.05 * found.pixels as f64, "{}", method.method);
        assert_eq!(needed.texels, measured.texels);
    }
    let summary = summarise(&found);
    assert_eq!((summary.reference.as_str(), summary.methods[1].ratio.of_sums), ("lixel", Some(1.0)));
    assert!(table(&found, &summary).contains("texels / lixel [95 %]"));
    let needed = found.methods[1].per_light[0].measured.as_ref().unwrap().texels as f64;
    assert_eq!(summary.methods[1].texels, Some([needed; 3]), "one light is all quartiles");
}

/// `best` is the best of the rows with one map; `auto` is the row that it came to.
#[test]
fn methods_that_choose_are_rows_like_any_other() {
    let single =
        ["lixel", "scene-optimal", "focused", "lispsm", "tsm", "psm", "plane-optimal", "homography-area", "normal"];
    let names: Vec<&str> = single.iter().copied().chain(["best", "auto", "partitioned:2", "partitioned:3"]).collect();
    let mut job = job(2);
    job.job.solver = SolverParams { measured_rounds: 1, max_maps: 3, ..SolverParams::default() };
    job.job.quality.epsilon = Some(0.02);
    job.job.map.step = 1.2;
    let methods = names.iter().map(|name| Variant::parse(name, &job.job.solver).unwrap()).collect();
    let mut with = CompareParams { methods, ..params(Question::Texels(4000), BiasChoice::Plan) };
    for question in [Question::Texels(4000), Question::Epsilon] {
        with.question = question;
        let found = run(&job, &with, 2);
        let row =
            |method: &str, light: usize| &found.methods.iter().find(|m| m.method == method).unwrap().per_light[light];
        for light in 0..2 {
            let worth = |method: &str| {
                let measured = row(method, light).measured.as_ref()?;
                Some(measured.needed.map_or((false, measured.misclassified), |n| (!n.met, n.texels)))
            };
            let best = row("best", light);
            assert_eq!(worth("best"), single.iter().filter_map(|m| worth(m)).min());
            assert_eq!(best.measured, row(best.chosen.as_ref().unwrap(), light).measured);
            let auto = row("auto", light);
            assert_eq!(auto.measured, row(auto.chosen.as_ref().unwrap(), light).measured);
        }
        assert!(table(&found, &summarise(&found)).contains("\nbest came to "));
    }
}

/// Variants of one method side by side; all maps of a light together get its texels, the maps even shares.
#[test]
fn variants_of_several_maps_share_the_texels() {
    let names = ["cascades:log:warped:3", "cascades:samples:2", "separating-plane:lispsm:1", "faces", "tsm:0.6"];
    let job = job(2);
    let methods = names.map(|name| Variant::parse(name, &job.job.solver).unwrap()).to_vec();
    let found = run(&job, &CompareParams { methods, ..params(Question::Texels(4000), BiasChoice::Plan) }, 2);
    for (method, name) in found.methods.iter().zip(names) {
        assert_eq!(method.method, name);
        for row in &method.per_light {
            let m = row.measured.as_ref().unwrap_or_else(|| panic!("{name}: {:?}", row.reason));
            assert!(m.texels <= 4000 && m.texels > 3600, "{name}: {:?}", m.maps);
            let even = 4000 / m.maps.len() as u32;
            assert!(m.maps.iter().all(|[w, h]| w * h <= even && w * h * 10 > even * 8), "{name}: {:?}", m.maps);
        }
    }
    let maps = |k: usize| found.methods[k].per_light[0].measured.as_ref().unwrap().maps.len();
    assert!(maps(0) > 1 && maps(0) <= 3 && maps(1) == 2 && maps(2) <= 2 && maps(3) <= 5 && maps(4) == 1);
}

#[test]
fn a_wish_to_stop_is_heard() {
    let cancel = AtomicBool::new(true);
    let watch = Watch { progress: &|_| {}, cancel: &cancel, notes: &|_| {} };
    let stopped = compare(&job(1), &params(Question::Texels(100), BiasChoice::Plan), &watch);
    assert!(matches!(stopped, Err(PlanError::Cancelled)));
}

#[test]
fn the_command_prints_the_table_and_writes_pictures() {
    let dir = tempfile::tempdir().unwrap();
    let lixel = |args: &[&str]| {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("lixel"));
        let Output { status, stdout, stderr } =
            command.current_dir(dir.path()).arg("compare").arg(courtyard()).args(args).output().unwrap();
        (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
    };
    let small = ["--frames", "30", "--size", "60x40", "--texels", "900", "--methods", "lixel,normal"];
    let (code, stdout, stderr) =
        lixel(&[&small[..], &["--lights", "random-hemisphere:3-4:1", "-o", "out", "--json", "a.json"]].concat());
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    assert!(stdout.starts_with("2 lights (2 with every method, 0 without a visible shadow), 2400 pixels"), "{stdout}");
    let picture = std::fs::File::open(dir.path().join("out/frame0030-001-h0004.png")).unwrap();
    let reader = png::Decoder::new(std::io::BufReader::new(picture)).read_info().unwrap();
    assert_eq!(reader.info().size(), (2 * 60 + 4, 40 + 23));
    assert!(dir.path().join("out/predicted.svg").is_file() && dir.path().join("a.json").is_file());

    for bad in [
        &["--lights", "random-hemisphere:0:1"][..],
        &["--methods", "magic"],
        &["--methods", "cascades:fast"],
        &["--methods", "lixel,cascades:0"],
        &["--texels", "0"],
        &["--texels", "100", "--resolution", "10x10"],
        &["--texels", "100", "--epsilon", "0.1"],
        &["--resolution", "0x10"],
    ] {
        let (code, stdout, stderr) = lixel(bad);
        assert_eq!((code, stdout.as_str()), (Some(2), ""), "{bad:?}: {stderr}");
    }
    let (code, _, stderr) = lixel(&["--csv", "none/a.csv"]);
    assert_eq!(code, Some(1));
    assert!(stderr.starts_with("error: cannot write none/a.csv: "), "{stderr}");
}
