//! A deforming mesh from frame to frame: sorted anew, or the first frame's tree refitted.
//!
//!     cargo bench --bench deform
//!
//! A ragged ball of half a million triangles bends more and more, as under a morph target. Rebuilt: what a frame's tree is
//! made with, PLOC, leaves of up to eight, reinsertion. Refitted: the boxes of the tree at rest, taken again from the bent
//! triangles, leaves up. Rays go through both by obvhs' own traversal, so only their ratio means something for ours. One thread.

use std::hint::black_box;
use std::time::Instant;

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::{Ray, RayHit};

/// Rings of the ball; four times their square triangles.
const RINGS: usize = 354;
/// Rays a side of a square bundle.
const RAYS: usize = 500;
/// Passes; the median counts.
const PASSES: usize = 5;

type Triangle = [Vec3A; 3];

fn main() {
    let rest = ball(0.0);
    let mut tree = build(&rest);
    let order = parents_first(&tree);
    println!("{} triangles; seconds, medians of {PASSES} passes", rest.len());
    println!(
        "{:>6} {:>9} {:>9} {:>13} {:>14} {:>9}",
        "bend", "rebuild", "refit", "rays rebuilt", "rays refitted", "ratio"
    );
    for bend in [0.05, 0.2, 0.5, 1.0] {
        let bent = ball(bend);
        let rebuilding = median(|| drop(black_box(build(&bent))));
        let rebuilt = build(&bent);
        let refitting = median(|| refit(&mut tree, &order, &bent));
        let [new, old] = [&rebuilt, &tree].map(|tree| {
            median(|| {
                black_box(bundle(tree, &bent));
            })
        });
        // obvhs' boxes are not grown, so a ray along one may be lost.
        assert!(bundle(&rebuilt, &bent).abs_diff(bundle(&tree, &bent)) < RAYS, "the rays meet other triangles");
        println!("{bend:>6} {rebuilding:>9.3} {refitting:>9.3} {new:>13.3} {old:>14.3} {:>9.2}", old / new);
    }
}

/// A ball, bent by so much of three waves.
fn ball(bend: f32) -> Vec<Triangle> {
    let at = |i: usize, j: usize| {
        let (polar, around) =
            (std::f32::consts::PI * i as f32 / RINGS as f32, std::f32::consts::PI * j as f32 / RINGS as f32);
        let radius = 1.0 + 0.15 * (5.0 * polar).sin() * (4.0 * around).sin();
        let v = radius * Vec3A::new(polar.sin() * around.cos(), polar.cos(), polar.sin() * around.sin());
        let wave = |t: f32| (3.0 * t).sin();
        v + bend * Vec3A::new(wave(v.y), wave(v.z), wave(v.x))
    };
    (0..RINGS)
        .flat_map(|i| (0..2 * RINGS).map(move |j| (i, j)))
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j + 1), at(i + 1, j)], [at(i, j), at(i, j + 1), at(i + 1, j + 1)]])
        .collect()
}

fn build(triangles: &[Triangle]) -> Bvh2 {
    let boxes: Vec<Aabb> = triangles.iter().map(|t| Aabb::from_points(t)).collect();
    let indices = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        &boxes,
        indices,
        SortPrecision::U64,
        3,
    );
    collapse(&mut tree, 8, 1e6);
    ReinsertionOptimizer::default().run(&mut tree, 0.05, None);
    tree
}

/// All nodes, every one after its parent.
fn parents_first(tree: &Bvh2) -> Vec<usize> {
    let mut order = vec![0];
    let mut next = 0;
    while let Some(&k) = order.get(next) {
        let node = &tree.nodes[k];
        if !node.is_leaf() {
            order.extend([node.first_index as usize, node.first_index as usize + 1]);
        }
        next += 1;
    }
    order
}

/// Boxes of the leaves from triangles, then those above.
fn refit(tree: &mut Bvh2, order: &[usize], triangles: &[Triangle]) {
    for &k in order.iter().rev() {
        let node = tree.nodes[k];
        let first = node.first_index as usize;
        let aabb = if node.is_leaf() {
            let run = &tree.primitive_indices[first..first + node.prim_count as usize];
            run.iter().fold(Aabb::empty(), |all, &i| all.union(&Aabb::from_points(&triangles[i as usize])))
        } else {
            tree.nodes[first].aabb().union(tree.nodes[first + 1].aabb())
        };
        tree.nodes[k] = Bvh2Node::new(aabb, node.prim_count, node.first_index);
    }
}

/// Rays from one side through everything: how many meet something.
fn bundle(tree: &Bvh2, triangles: &[Triangle]) -> usize {
    let mut hits = 0;
    for k in 0..RAYS * RAYS {
        let place = |k: usize| 4.0 * (k as f32 + 0.37) / RAYS as f32 - 2.0;
        let origin = Vec3A::new(place(k % RAYS), place(k / RAYS), 5.0);
        let ray = Ray::new(origin, Vec3A::new(0.01, -0.02, -1.0), 0.0, f32::INFINITY);
        let met = tree.ray_traverse(ray, &mut RayHit::none(), |ray, slot| {
            meet(ray, &triangles[tree.primitive_indices[slot] as usize])
        });
        hits += usize::from(met);
    }
    hits
}

/// Möller and Trumbore 1997.
fn meet(ray: &Ray, [a, b, c]: &Triangle) -> f32 {
    let (e1, e2) = (*b - *a, *c - *a);
    let p = ray.direction.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let s = ray.origin - *a;
    let u = s.dot(p) * inverse;
    let q = s.cross(e1);
    let v = ray.direction.dot(q) * inverse;
    let t = e2.dot(q) * inverse;
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 { t } else { f32::INFINITY }
}

fn median(mut work: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..PASSES)
        .map(|_| {
            let begin = Instant::now();
            work();
            begin.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[PASSES / 2]
}
