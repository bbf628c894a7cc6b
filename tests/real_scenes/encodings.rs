//! One room in four encodings: what the encodings change in the size that a matrix needs and in the pixels it answers
//! wrongly, against what quantising to their step explains.
//!
//! All files are seen by the camera and lit by the sun of the plain one. The maps are the plain file's, by its fit alone and
//! chosen by measurement, drawn of each file's triangles and counted against each file's exact answers. The same is done
//! with the plain file quantised as the quantised one is, but on grids of other zeros: what these find are samples of what
//! such a step does. `docs/scenes.md` has the numbers.

use super::requantised::Glb;
use super::watching::watched;
use super::{SEEN_WHOLE, load};
use lixel::job::LoadedJob;
use lixel::math::Bounds;
use lixel::measure::Receivers;
use lixel::plan;
use lixel::resolution::{self, FilmQuestion, Judge, OnFilm, Planned};
use lixel::samples::{Grid, GridView, LightView, sample_light};
use lixel::scene::{SceneFrame, Shot, Triangle};
use lixel::visibility::{Answer, Bvh, RayOffset, Tracer, classify, see};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The files; the first is the one that the others are compared with.
const ENCODINGS: [&str; 4] = ["plain", "draco", "quantized", "meshopt"];
/// Films, and for each the maps that fitting gives alone (0 rounds of measuring), and those that measuring chooses.
const FILMS: [[u32; 2]; 2] = [[480, 270], [1920, 1080]];
const ROUNDS: [u32; 2] = [0, 16];
/// Plain files that are quantised anew. What is drawn as they are lies outside their range with a chance of at most 2 in 65.
const SEEDS: u64 = 64;
/// As many are planned on their own.
const PLANNED: u64 = 16;

/// Coordinates of up to 25 m are rounded to f32 by up to 0.001 mm, on their way through a file and a scene four times.
const ROUNDING_MM: f64 = 0.004;

/// A file's scene, posed.
struct Posed {
    loaded: LoadedJob,
    shot: Shot,
    frame: SceneFrame,
    still: Bvh,
}

/// What a file's triangles do under given maps.
#[derive(Clone, Debug)]
struct Found {
    /// Wrong pixels at the maps' size, certain and not.
    wrong: [u64; 2],
    /// The smallest size of the grid that meets the bound: every one below was measured and does not.
    first: usize,
    /// The size that the search for the smallest finds, which does not try every one.
    searched: usize,
}

impl Posed {
    fn load(file: &Path, size: [u32; 2], rounds: u32) -> Posed {
        let mut loaded = load(file, SEEN_WHOLE);
        loaded.job.image.size = Some(size);
        loaded.job.solver.measured_rounds = rounds;
        let shot = loaded.shot().unwrap();
        let frame = shot.scene.frame(shot.frames[0].time_s).unwrap();
        let still = Bvh::still(&shot.scene);
        Posed { loaded, shot, frame, still }
    }

    fn tracer(&self) -> Tracer<'_> {
        Tracer::new(self.shot.scene.geometry(&self.frame), &self.still, None)
    }

    fn question(&self) -> FilmQuestion<'_> {
        let job = &self.loaded.job;
        let [min, max] = self.tracer().bounds().unwrap();
        FilmQuestion {
            camera: &self.frame.camera,
            film: self.shot.film,
            light: &self.frame.lights[0],
            bounds: Bounds { min, max },
            quality: &job.quality,
            map: &job.map,
            solver: &job.solver,
            sample_cap: job.sampling.cap as usize,
        }
    }

    /// Hands over what a camera sees of this file, and the exact answer of every pixel.
    fn seen_by<R>(&self, question: &FilmQuestion, work: impl FnOnce(&OnFilm, &[Answer]) -> R) -> R {
        let FilmQuestion { camera, film, light, .. } = *question;
        let tracer = self.tracer();
        let (view, offset) = (see(&tracer, camera, film), RayOffset::for_scene(&tracer));
        let answers = classify(&tracer, &view, camera, light, offset);
        let receivers = Receivers::new(&view, camera, &answers);
        work(&OnFilm { tracer: &tracer, view: &view, receivers: &receivers, offset }, &answers)
    }

    /// The maps of this file, and its exact answers.
    fn planned(&self) -> (Planned, Vec<Answer>) {
        let question = self.question();
        let FilmQuestion { camera, light, .. } = question;
        let sampling = &self.loaded.job.sampling;
        self.seen_by(&question, |on, answers| {
            let positions = Grid::new(question.film, sampling.grid);
            let view = &GridView::see(on.tracer, camera, positions, Some(on.view));
            let lit = LightView { tracer: on.tracer, camera, view, light, offset: on.offset, answers };
            let samples = sample_light(&lit, sampling.refine, false);
            (resolution::planned(&question, &samples, on, true).unwrap().unwrap(), answers.to_vec())
        })
    }
}

/// What given maps find on a file.
fn found(on: &OnFilm, question: &FilmQuestion, planned: &Planned) -> Found {
    let mut judge = Judge::of_maps(*on, question, planned.maps.clone());
    let grid = resolution::grid_of(question, &planned.fitted);
    let (limit, bias) = (resolution::bound_limit(question.quality, question.film), planned.certified.bias);
    let mut verdict = |sizes: &[[u32; 2]]| {
        let drawn = judge.draw(sizes, bias).unwrap();
        let wrong = judge.wrong(&drawn);
        judge.verdict(&wrong)
    };
    let at_size = verdict(&planned.certified.sizes);
    let first = (0..grid.len()).find(|entry| verdict(grid.sizes(*entry)).meets(limit)).unwrap();
    let certified = resolution::certify(question, &planned.fitted, &mut judge).unwrap();
    let searched = (0..grid.len()).find(|entry| grid.sizes(*entry) == certified.sizes).unwrap();
    Found { wrong: [at_size.certain.wrong(), at_size.uncertain], first, searched }
}

fn triangles(file: &Path) -> Vec<Triangle> {
    Posed::load(file, FILMS[0], 0).shot.scene.still
}

/// The vertices of triangles in an order of their own, whatever theirs.
fn vertices(triangles: &[Triangle]) -> Vec<[u32; 3]> {
    let mut vertices: Vec<_> = triangles.as_flattened().iter().map(|v| v.to_array().map(f32::to_bits)).collect();
    vertices.sort_unstable();
    vertices
}

/// The four files, and so many plain ones quantised anew, in a folder that has to stay; `None` where there are none. Draco's
/// file is the plain one, meshopt's the quantised one, and that is the plain one quantised about the middle of each mesh.
fn encodings(seeds: u64) -> Option<(Vec<PathBuf>, Vec<PathBuf>, TempDir)> {
    let Some(folder) = std::env::var_os("LIXEL_SCENES").map(|folder| PathBuf::from(folder).join("room_encodings"))
    else {
        println!("skipped: LIXEL_SCENES not set");
        return None;
    };
    if !folder.is_dir() {
        println!("skipped: no {}", folder.display());
        return None;
    }
    let files: Vec<PathBuf> = ENCODINGS.iter().map(|name| folder.join(format!("room_{name}.glb"))).collect();
    let (plain, meshes, dir) = (Glb::read(&files[0]), Glb::read(&files[2]).quantised(), tempfile::tempdir().unwrap());
    let anew = |seed: Option<u64>| {
        let file = dir.path().join(format!("{seed:?}.glb"));
        plain.write_requantised(&meshes, seed, &file);
        file
    };
    let largest = |values: &mut dyn Iterator<Item = f64>| 1e3 * values.fold(0.0, f64::max);
    let moved_mm = |a: &[Triangle], b: &[Triangle]| {
        let pairs = a.as_flattened().iter().zip(b.as_flattened());
        largest(&mut pairs.map(|(a, b)| f64::from((a - b).abs().max_element())))
    };
    let [plain, draco, quantized, meshopt] = [0, 1, 2, 3].map(|k| triangles(&files[k]));
    assert!(vertices(&plain) == vertices(&draco) && vertices(&quantized) == vertices(&meshopt));
    let (step_mm, moved) = (largest(&mut meshes.iter().map(|mesh| mesh.step_m())), moved_mm(&plain, &quantized));
    println!("quantised by up to {step_mm:.2} mm a step: vertices lie up to {moved:.2} mm aside");
    let off_mm = moved_mm(&triangles(&anew(None)), &quantized);
    assert!(off_mm < ROUNDING_MM, "the plain file quantised is {off_mm} mm off the quantised one");
    let anew = (0..seeds).map(|seed| anew(Some(seed))).collect();
    Some((files, anew, dir))
}

/// What a file finds on a film: pixels whose exact answer is not the plain file's, and what each maps of it find.
struct Looked {
    changed: Vec<usize>,
    found: Vec<Found>,
}

/// Of the pixels that each file changes, those that no other of them changes.
fn alone(all: &[Looked]) -> Vec<u64> {
    let mut times: HashMap<usize, u64> = HashMap::new();
    all.iter().flat_map(|looked| &looked.changed).for_each(|pixel| *times.entry(*pixel).or_default() += 1);
    all.iter().map(|looked| looked.changed.iter().filter(|pixel| times[pixel] == 1).count() as u64).collect()
}

/// Counts of a file: changed pixels, of them those that none anew changes, wrong ones, these with uncertain ones, and the size
/// that is searched.
fn counts(looked: &Looked, alone: u64, maps: usize) -> [u64; 5] {
    let Found { wrong: [certain, uncertain], searched, .. } = looked.found[maps];
    [looked.changed.len() as u64, alone, certain, certain + uncertain, searched as u64]
}

#[test]
fn encodings_of_one_room_need_one_size_and_differ_by_what_quantisation_explains() {
    let Some((files, anew, _dir)) = encodings(SEEDS) else { return };
    println!("| film, rounds, maps | file | changed | alone | wrong | with uncertain | searched | smallest |");
    println!("|---|---|---|---|---|---|---|---|");
    for size in FILMS {
        let makers = ROUNDS.map(|rounds| Posed::load(&files[0], size, rounds));
        let planned = makers.each_ref().map(Posed::planned);
        let (plain, of_maps) = (&planned[0].1, makers.iter().zip(&planned));
        let look = |file: &PathBuf| {
            Posed::load(file, size, 0).seen_by(&makers[0].question(), |on, answers| Looked {
                changed: (0..answers.len()).filter(|pixel| answers[*pixel] != plain[*pixel]).collect(),
                found: of_maps.clone().map(|(maker, (planned, _))| found(on, &maker.question(), planned)).collect(),
            })
        };
        let (encoded, anew): (Vec<_>, Vec<_>) = (files.iter().map(look).collect(), anew.iter().map(look).collect());
        let (known, alone): (HashSet<usize>, _) =
            (anew.iter().flat_map(|looked| looked.changed.clone()).collect(), alone(&anew));
        for (k, (maker, (planned, _))) in of_maps.enumerate() {
            let [width, height] = planned.certified.sizes[0];
            let head = format!("| {}x{}, {}, {width}x{height}", size[0], size[1], ROUNDS[k]);
            let grid = resolution::grid_of(&maker.question(), &planned.fitted);
            let sized = |entry: usize| grid.sizes(entry)[0].map(|side| side.to_string()).join("x");
            let text = |[changed, alone, wrong, all, searched]: [u64; 5]| {
                format!("{changed} | {alone} | {wrong} | {all} | {}", sized(searched as usize))
            };
            let ranged: Vec<[u64; 5]> =
                anew.iter().zip(&alone).map(|(looked, alone)| counts(looked, *alone, k)).collect();
            let least: [u64; 5] = std::array::from_fn(|i| ranged.iter().map(|counts| counts[i]).min().unwrap());
            let most: [u64; 5] = std::array::from_fn(|i| ranged.iter().map(|counts| counts[i]).max().unwrap());
            for (name, looked) in ENCODINGS.iter().zip(&encoded) {
                let alone = looked.changed.iter().filter(|pixel| !known.contains(pixel)).count() as u64;
                let (counts, first) = (counts(looked, alone, k), looked.found[k].first);
                println!("{head} | {name} | {} | {} |", text(counts), sized(first));
                let steps = first.abs_diff(encoded[0].found[k].first);
                assert!(steps <= 1, "{head}, {name}: {steps} steps from the smallest size of the plain file");
                let quantised = !looked.changed.is_empty();
                for (i, count) in counts.iter().enumerate().filter(|(i, _)| quantised || *i > 1) {
                    assert!((least[i]..=most[i]).contains(count), "{head}, {name}: {count} of column {i}");
                }
            }
            let first = anew.iter().map(|looked| looked.found[k].first);
            println!("{head} | anew: least | {} | {} |", text(least), sized(first.clone().min().unwrap()));
            println!("{head} | anew: most | {} | {} |", text(most), sized(first.max().unwrap()));
        }
    }
}

#[test]
fn own_plans_of_one_room_scatter_as_those_of_the_plain_file_quantised_anew() {
    let Some((files, anew, dir)) = encodings(PLANNED) else { return };
    println!("| film | rounds | {} | {PLANNED} anew, texels |", ENCODINGS.join(" | "));
    println!("|---|---|---|---|---|---|---|");
    for (size, rounds) in FILMS.into_iter().flat_map(|size| ROUNDS.map(|rounds| (size, rounds))) {
        let own = |file: &PathBuf| {
            let Posed { loaded, .. } = Posed::load(file, size, rounds);
            let plan = watched(|watch| plan::make(&loaded, dir.path(), false, watch)).unwrap();
            let map = &plan.frames[0].lights[0].maps[0];
            (format!("{}x{}", map.width, map.height), map.texels())
        };
        let encoded: Vec<_> = files.iter().map(own).collect();
        let anew: Vec<u64> = anew.iter().map(|file| own(file).1).collect();
        let sizes: Vec<&str> = encoded.iter().map(|(size, _)| size.as_str()).collect();
        let (low, high) = (*anew.iter().min().unwrap(), *anew.iter().max().unwrap());
        println!("| {}x{} | {rounds} | {} | {low} to {high} |", size[0], size[1], sizes.join(" | "));
        for (name, (_, texels)) in ENCODINGS.iter().zip(&encoded) {
            assert!((low..=high).contains(texels), "{}x{}, {rounds} rounds, {name}: {texels}", size[0], size[1]);
        }
    }
}
