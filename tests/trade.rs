//! Time against texels on the courtyard: what is counted is the same on any number of threads, files say what was
//! measured, and a budget chooses settings that the plan names. No time is asserted.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;

use lixel::compare::random_hemisphere;
use lixel::job::{LoadedJob, Preset};
use lixel::plan::{Format, TimeModel, Watch, explain, parse};
use lixel::resolution::Measure;
use lixel::trade::{
    Budget, Model, Point, Trade, TradeError, TradeParams, json, plan_within, plot, points, table, trade,
};

fn courtyard() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/courtyard/courtyard.glb")
}

/// The courtyard from frame 30, small, under a light of the sky.
fn job() -> LoadedJob {
    let flags: toml::Table =
        "frames.range = \"30\"\nimage.size = [90, 60]\ncamera.name = \"walk\"\nquality.epsilon = 0.02\n"
            .parse()
            .unwrap();
    let mut loaded = lixel::job::load(&courtyard(), &flags).unwrap();
    loaded.job.light = random_hemisphere(0..2, 5);
    loaded
}

fn some_points() -> Vec<Point> {
    let wanted =
        ["draft", "standard", "thorough", "draft grid=64", "standard measure=check", "draft method=scene-optimal"];
    let found: Vec<Point> = points().into_iter().filter(|p| wanted.contains(&p.name.as_str())).collect();
    assert_eq!(found.len(), wanted.len());
    found
}

fn run(threads: usize) -> Trade {
    let cancel = AtomicBool::new(false);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let params = TradeParams { points: some_points(), repeat: 1, lights: None };
    let watch = Watch { progress: &|_| {}, cancel: &cancel, notes: &|_| {} };
    pool.install(|| trade(&job(), &params, &watch)).unwrap()
}

#[test]
fn counts_hold_together_and_only_times_depend_on_the_run() {
    let (one, two) = (run(1), run(2));
    assert_eq!((one.threads, two.threads, one.cases.len()), (1, 2, 2));
    for (a, b) in one.points.iter().zip(&two.points) {
        let counts = |p: &lixel::trade::PointResult| {
            let cases =
                p.cases.iter().map(|c| (c.planned, c.needed, c.price, c.misclassified, c.said_met, c.truly_met));
            (p.misclassified, p.texels_planned, p.texels_needed, p.excess_texels, cases.collect::<Vec<_>>())
        };
        assert_eq!(counts(a), counts(b), "{}", a.point.name);
        assert!(a.seconds > 0.0 && a.cases.len() == 2);
        for case in &a.cases {
            assert!(case.price >= case.planned.max(case.needed.unwrap_or(0)), "{}", a.point.name);
            assert!(!a.measures || case.said_met == case.truly_met, "{}: a measured plan says what is", a.point.name);
        }
    }
    let point = |name: &str| one.points.iter().find(|p| p.point.name == name).unwrap();
    assert_eq!(point("thorough").excess_texels, 0.0);
    assert!(!point("draft").measures && point("standard measure=check").measures);
    for (check, always) in point("standard measure=check").cases.iter().zip(&point("standard").cases) {
        assert!(check.planned >= always.planned, "a check never plans less than a certificate");
    }
    assert_eq!(one.presets.len(), 3);
    assert!(one.presets.iter().all(|p| p.excess_over_front >= 0.0 && p.time_over_front >= 0.0));
    assert!(one.front.iter().all(|name| one.points.iter().any(|p| p.point.name == *name)));

    let document: serde_json::Value = serde_json::from_str(&json(&one).unwrap()).unwrap();
    assert_eq!(document["schema"], "lixel.trade/1");
    assert_eq!(document["points"][0]["name"], "draft");
    assert_eq!(document["points"][0]["settings"]["sampling"]["refine"], 4);
    assert!(document["points"][0]["seconds"].is_f64());
    assert_eq!(document["front"].as_array().unwrap().len(), one.front.len());
    assert_eq!(document["presets"][1]["preset"], "standard");
    assert!(document["presets"][1]["excess_over_front"].is_number());
    let svg = plot(&one);
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"));
    let text = table(&one);
    for preset in ["draft", "standard", "thorough"] {
        assert!(svg.contains(&format!(">{preset}</text>")) && text.contains(preset));
    }

    let model = Model::of(&one);
    assert!(model.point.iter().all(|p| !p.name.contains("method")), "the method is not a price");
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("here.toml");
    std::fs::write(&file, model.text(&file).unwrap()).unwrap();
    assert_eq!(Model::read(&file).unwrap(), model);
}

#[test]
fn a_budget_chooses_settings_and_the_plan_says_so() {
    let cancel = AtomicBool::new(false);
    let watch = Watch { progress: &|_| {}, cancel: &cancel, notes: &|_| {} };
    let within = |budget: &Budget| plan_within(&job(), budget, Path::new(""), false, &watch);
    let model = Model::shipped().unwrap();

    let most = Budget { seconds: 1e6, model: Some(model.clone()), measure: None };
    let plan = within(&most).unwrap();
    assert_eq!(plan, within(&most).unwrap(), "a table as it stands leaves nothing to the clock");
    let operating = plan.operating.clone().unwrap();
    let last = model.point.last().unwrap();
    assert_eq!((operating.point.as_str(), operating.model), (last.name.as_str(), TimeModel::Table));
    assert!(operating.deterministic && operating.within);
    assert_eq!(plan.job.job, LoadedJob { job: plan.job.job.clone(), ..job() }.with(&last.settings).unwrap().job);
    let text = lixel::plan::to_text(&plan, Format::Json).unwrap();
    assert_eq!(parse(&text, Format::Json, Path::new("plan.json")).unwrap(), plan);

    let least = within(&Budget { seconds: 1e-9, model: None, measure: None }).unwrap();
    let operating = least.operating.clone().unwrap();
    assert_eq!((operating.point.as_str(), operating.model), (model.point[0].name.as_str(), TimeModel::FirstFrame));
    assert!(!operating.deterministic && !operating.within && operating.expected_ms > 0.0);

    let measured =
        within(&Budget { seconds: 1e-9, model: Some(model.clone()), measure: Some(Measure::Always) }).unwrap();
    assert_eq!(measured.job.job.quality.measure, Measure::Always);
    let cheapest = Model { point: vec![model.point[0].clone()], ..model };
    let none = within(&Budget { seconds: 1.0, model: Some(cheapest), measure: Some(Measure::Always) });
    assert!(matches!(none, Err(TradeError::NoPoint { wanted: Measure::Always })));
}

#[test]
fn a_light_is_explained_in_one_sentence() {
    let cancel = AtomicBool::new(false);
    let watch = Watch { progress: &|_| {}, cancel: &cancel, notes: &|_| {} };
    let planned = |preset: Preset| {
        let settings: toml::Table = preset.text().parse().unwrap();
        lixel::plan::make(&job().with(&settings).unwrap(), Path::new(""), false, &watch).unwrap()
    };
    let standard = planned(Preset::Standard);
    let text = explain(&standard);
    assert_eq!(text.lines().count(), 2);
    for (line, light) in text.lines().zip(&standard.frames[0].lights) {
        let map = &light.maps[0];
        for part in [
            format!("frame 30, {}: planned, one map of {}x{}", light.light, map.width, map.height),
            format!("with {} certain", light.error.as_ref().unwrap().measured.as_ref().unwrap().misclassified),
            "the next smaller size tried".to_owned(),
            format!("a depth bias of slope {}", map.bias.slope),
        ] {
            assert!(line.contains(&part), "{part} is not in {line}");
        }
    }
    let draft = explain(&planned(Preset::Draft));
    assert!(draft.lines().all(|line| line.contains("by a sample of lookups with ")), "{draft}");
    assert!(draft.lines().all(|line| line.contains("nothing measured") && line.contains("by lookups")), "{draft}");
}

#[test]
fn the_command_writes_its_files_and_refuses_what_it_cannot_use() {
    let dir = tempfile::tempdir().unwrap();
    let lixel = |args: &[&str]| {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("lixel"));
        let Output { status, stdout, stderr } = command.current_dir(dir.path()).args(args).output().unwrap();
        (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
    };
    let scene = courtyard().display().to_string();
    let base = ["--camera", "walk", "--size", "60x40", "--epsilon", "0.02", "--frames", "30"];
    let with = |command: &'static str, more: &[&'static str]| -> Vec<String> {
        let all = [command, &scene].into_iter().chain(base).chain(more.iter().copied());
        all.map(str::to_owned).collect()
    };
    let run = |args: Vec<String>| lixel(&args.iter().map(String::as_str).collect::<Vec<_>>());

    let short = ["--lights", "1", "--repeat", "1", "--points", "draft grid=64"];
    let (code, stdout, stderr) =
        run(with("trade", &[&short[..], &["--json", "t.json", "--svg", "t.svg", "--model", "m.toml"]].concat()));
    assert_eq!(code, Some(0), "{stderr}");
    assert!(stdout.contains("5 points on 1 lights") && stdout.contains("thorough"), "{stdout}");
    assert!(["t.json", "t.svg", "m.toml"].iter().all(|file| dir.path().join(file).exists()));
    let (code, _, stderr) = run(with("plan", &["--time-budget", "50ms", "--time-model", "m.toml", "-o", "p.json"]));
    assert!(matches!(code, Some(0 | 3)), "{stderr}");
    assert!(stderr.contains("operating point `") && !stderr.contains("chosen by the clock"), "{stderr}");
    let (code, stdout, _) = run(with("plan", &["--preset", "draft", "-o", "d.json", "--explain"]));
    assert!(matches!(code, Some(0 | 3)) && stdout.contains("frame 30, "), "{stdout}");
    let (_, stdout, stderr) = run(with("plan", &["--preset", "draft", "--explain"]));
    assert!(stdout.starts_with('{') && stderr.contains("frame 30, "), "a plan on standard output stays one");
    assert!(stderr.contains("by prediction; nothing was measured"), "{stderr}");

    for (args, part) in [
        (with("plan", &["--time-budget", "50"]), "as in 50ms"),
        (with("plan", &["--time-budget", "50ms", "--preset", "draft"]), "cannot be used with"),
        (with("plan", &["--time-model", "m.toml"]), "--time-budget"),
        (with("plan", &["--time-budget", "1s", "--time-model", "none.toml"]), "none.toml: cannot be read"),
        (with("trade", &["--lights", "0"]), "at least 1"),
        (with("trade", &["--points", "drift"]), "drift"),
    ] {
        let (code, _, stderr) = run(args);
        assert_eq!(code, Some(2), "{stderr}");
        assert!(stderr.contains(part), "{part} is not in {stderr}");
    }
}
