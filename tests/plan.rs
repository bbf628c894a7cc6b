//! Plan files: both formats carry everything, nothing that is not finite gets out, files appear whole.

mod plan_sample;

use std::fs;
use std::path::Path;

use lixel::job::Job;
use lixel::plan::{Dest, Domain, Format, Input, Plan, PlanError, parse, read, to_text, write};
use proptest::prelude::*;

fn sample() -> Plan {
    plan_sample::plan(vec![Input { path: "a.glb".to_owned(), sha256: "00".repeat(32) }])
}

#[test]
fn both_formats_read_back_equal() {
    let plan = sample();
    for format in [Format::Json, Format::Toml] {
        let text = to_text(&plan, format).unwrap();
        assert_eq!(parse(&text, format, Path::new("p")).unwrap(), plan, "{format:?}:\n{text}");
    }
}

#[test]
fn every_kind_of_domain_is_written_and_read() {
    let plane_from_world = [[0.1, 0.2, 0.3, -1e-12], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let half_space = Domain::HalfSpace { plane: [0.6, 0.0, -0.8, 1.0 / 3.0] };
    let depth = |from, to| Domain::ViewDepth { position: [0.0, 1.7, 5.0], forward: [0.0, 0.0, -1.0], from, to };
    let polygon = Domain::LightPlanePolygon { plane_from_world, sides: vec![[1.0, 0.0, 0.5], [-0.3, 0.2, 1.0 / 7.0]] };
    let domains = [
        half_space.clone(),
        depth(None, Some(12.5)),
        depth(Some(12.5), None),
        Domain::LightPlaneRectangle { plane_from_world, min: [-1.0, 0.5], max: [-0.25, 1e300] },
        Domain::Intersection { of: vec![polygon.clone(), half_space] },
        polygon,
    ];
    let mut plan = sample();
    plan.frames[0].lights[0].maps = domains.into_iter().map(|domain| plan_sample::map(domain, None)).collect();
    for format in [Format::Json, Format::Toml] {
        let text = to_text(&plan, format).unwrap();
        assert_eq!(parse(&text, format, Path::new("p")).unwrap(), plan, "{format:?}:\n{text}");
    }
    let validator = jsonschema::validator_for(&schemars::schema_for!(Plan).to_value()).unwrap();
    let mut value: serde_json::Value = serde_json::from_str(&to_text(&plan, Format::Json).unwrap()).unwrap();
    assert!(validator.is_valid(&value));
    value["frames"][0]["lights"][0]["maps"][0]["domain"]["plane"] = serde_json::json!([1, 0, 0]);
    assert!(!validator.is_valid(&value), "a plane of three numbers is no plane");
}

#[test]
fn json_has_rows_on_a_line_and_null_for_no_light_camera() {
    let text = to_text(&sample(), Format::Json).unwrap();
    assert!(text.contains("\n                [0.1,-0.3333333333333333,1e-308,5e-324],\n"), "{text}");
    assert!(text.contains("\"light_camera\": null,\n              \"light_camera_reason\": \"the matrix warps\""));
    assert!(text.starts_with("{\n  \"schema\": \"lixel.plan/1\",\n  \"lixel\": "));
    let toml = to_text(&sample(), Format::Toml).unwrap();
    assert_eq!(toml.matches("light_camera_reason").count(), 1);
    assert_eq!(toml.matches("light_camera]").count(), 2, "TOML has no null: the key is left away");
}

#[test]
fn the_job_of_a_plan_stands_flat_beside_its_inputs() {
    let value: serde_json::Value = serde_json::from_str(&to_text(&sample(), Format::Json).unwrap()).unwrap();
    assert_eq!(value["job"]["scene"][1], "sets/b.obj");
    assert_eq!(value["job"]["quality"]["epsilon"], 0.001);
    assert_eq!(value["job"]["inputs"][0]["path"], "a.glb");
}

#[test]
fn the_summary_counts_the_frames() {
    let summary = sample().summary;
    assert!(!summary.met, "the bulb is over");
    assert_eq!((summary.frames, summary.maps, summary.texels), (2, 3, 3 * 512 * 384));
    assert_eq!(summary.largest, Some([512, 384]));
    let worst = summary.worst.unwrap();
    assert_eq!((worst.frame, worst.light.as_str(), worst.misclassified), (1, "bulb", 9000));
}

#[test]
fn the_schemas_accept_what_is_written() {
    let schema = schemars::schema_for!(Plan).to_value();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let mut plan: serde_json::Value = serde_json::from_str(&to_text(&sample(), Format::Json).unwrap()).unwrap();
    let errors: Vec<String> = validator.iter_errors(&plan).map(|e| e.to_string()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    plan["frames"][0]["lights"][0]["maps"][0]["clip_from_world"][2] = serde_json::json!([1, 2, 3]);
    assert!(!validator.is_valid(&plan), "a row of three is no row");

    let schema = schemars::schema_for!(Job).to_value();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let job = serde_json::to_value(plan_sample::job()).unwrap();
    assert!(validator.is_valid(&job));
    let one: serde_json::Value = serde_json::json!({"scene": "a.glb"});
    assert!(validator.is_valid(&one), "one scene may be a plain string");
    assert!(!validator.is_valid(&serde_json::json!({"scene": "a.glb", "qality": {}})));
    assert!(!validator.is_valid(&serde_json::json!({})), "a job has a scene");
}

/// Every property of a schema says what it is.
#[test]
fn every_key_of_the_schemas_is_described() {
    fn walk(at: &str, node: &serde_json::Value, missing: &mut Vec<String>) {
        if let Some(properties) = node["properties"].as_object() {
            for (key, property) in properties {
                // The tag of an enum has the description of its variant.
                if property["description"].is_null() && property["const"].is_null() {
                    missing.push(format!("{at}/{key}"));
                }
            }
        }
        match node {
            serde_json::Value::Object(map) => map.iter().for_each(|(k, v)| walk(&format!("{at}/{k}"), v, missing)),
            serde_json::Value::Array(list) => list.iter().for_each(|v| walk(at, v, missing)),
            _ => {}
        }
    }
    let mut missing = Vec::new();
    walk("plan", schemars::schema_for!(Plan).as_value(), &mut missing);
    walk("job", schemars::schema_for!(Job).as_value(), &mut missing);
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn what_is_not_finite_is_refused_by_its_key() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("plan.json");
    fs::write(&file, "old").unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut plan = sample();
        plan.frames[0].lights[1].maps[1].clip_from_world[2][3] = bad;
        for format in [Format::Json, Format::Toml] {
            let error = write(&plan, &Dest::File(file.clone()), format).unwrap_err();
            let PlanError::NonFinite { key, .. } = error else { panic!("{error}") };
            assert_eq!(key, "frames[0].lights[1].maps[1].clip_from_world[2][3]");
        }
    }
    let mut plan = sample();
    plan.job.job.quality.quantile = f64::NAN;
    assert!(
        matches!(to_text(&plan, Format::Json), Err(PlanError::NonFinite { key, .. }) if key == "job.quality.quantile")
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), "old");
}

#[test]
fn a_file_is_replaced_whole_and_leaves_nothing_beside_it() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("plan");
    for format in [Format::Json, Format::Toml] {
        write(&sample(), &Dest::File(file.clone()), format).unwrap();
        assert_eq!(read(&file).unwrap(), sample(), "without an extension the content tells the format");
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);

    let missing = Dest::File(dir.path().join("none/plan.json"));
    assert!(matches!(missing.check(), Err(PlanError::Write { .. })));
    assert!(matches!(Dest::File(dir.path().to_owned()).check(), Err(PlanError::Write { .. })));
    assert!(Dest::File(file).check().is_ok());
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[cfg(unix)]
#[test]
fn new_files_have_the_usual_permissions_and_links_and_devices_stay() {
    use std::os::unix::fs::{MetadataExt, symlink};
    let dir = tempfile::tempdir().unwrap();
    let (file, usual, link) = (dir.path().join("p.json"), dir.path().join("usual"), dir.path().join("link.json"));
    fs::write(&usual, "").unwrap();
    symlink(&file, &link).unwrap();
    write(&sample(), &Dest::File(file.clone()), Format::Json).unwrap();
    assert_eq!(fs::metadata(&file).unwrap().mode(), fs::metadata(&usual).unwrap().mode());

    fs::write(&file, "old").unwrap();
    write(&sample(), &Dest::File(link.clone()), Format::Json).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(read(&file).unwrap(), sample());

    write(&sample(), &Dest::File("/dev/null".into()), Format::Json).unwrap();
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn what_is_no_plan_is_told_so() {
    let error = |text: &str| parse(text, Format::Json, Path::new("p.json")).unwrap_err().to_string();
    assert_eq!(
        error("{\"frames\": 3}"),
        "p.json is not a plan: it has no key `schema`; a plan begins with schema = \"lixel.plan/1\""
    );
    assert_eq!(
        error("{\"schema\": \"lixel.plan/7\"}"),
        "p.json has schema `lixel.plan/7`, this lixel reads `lixel.plan/1`; plan the job again"
    );
    assert_eq!(error("{"), "p.json is not a plan: EOF while parsing an object at line 1 column 1");
    let cut = to_text(&sample(), Format::Json).unwrap();
    assert!(error(&cut[..cut.len() / 2]).starts_with("p.json is not a plan: "));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Shortest decimals lose nothing, whatever the number.
    #[test]
    fn every_finite_number_survives(numbers in prop::array::uniform4(prop::num::f64::ANY.prop_filter("finite", |x| x.is_finite()))) {
        let mut plan = sample();
        plan.frames[0].lights[0].maps[0].clip_from_world[1] = numbers;
        plan.origin[0] = numbers[0];
        for format in [Format::Json, Format::Toml] {
            let read = parse(&to_text(&plan, format).unwrap(), format, Path::new("p")).unwrap();
            let row = read.frames[0].lights[0].maps[0].clip_from_world[1];
            prop_assert_eq!(row.map(f64::to_bits), numbers.map(f64::to_bits), "{:?}", format);
            prop_assert_eq!(read.origin[0].to_bits(), numbers[0].to_bits());
        }
    }
}
