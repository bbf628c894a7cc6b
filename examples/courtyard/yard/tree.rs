//! Two trees from one seed: a trunk that forks three times, and twigs of leaves, one mesh placed at every branch's end.

use super::authoring::document::{Content, Document, Placement};
use super::authoring::mesh::{Mesh, tube};
use super::{FOOTING_M, Palette};
use glam::{DMat4, DQuat, DVec3, dvec3};
use lixel::math::Prng;
use std::f64::consts::TAU;

/// Turn from one branch (or leaf) to the next around its stem: the golden angle, radians.
const GOLDEN_RAD: f64 = TAU * 0.381_966_011_250_105;

/// How a branch of each level forks: children, their length and radius relative to its own, sides of its tube.
const FORKS: [(usize, f64, f64, usize); 4] =
    [(6, 0.74, 0.52, 12), (3, 0.68, 0.62, 8), (3, 0.66, 0.60, 5), (3, 0.0, 0.0, 4)];

/// Points along a branch.
const JOINTS: usize = 6;

struct Branch {
    start: DVec3,
    direction: DVec3,
    length: f64,
    radius: f64,
    level: usize,
}

/// A tree's wood, and where its twigs grow.
struct Tree {
    wood: Mesh,
    twigs: Vec<Placement>,
}

pub(super) fn build(doc: &mut Document, palette: &Palette) -> usize {
    let mut tree = Tree { wood: Mesh::default(), twigs: Vec::new() };
    let trunk = Branch {
        start: DVec3::ZERO,
        direction: dvec3(0.06, 1.0, 0.03).normalize(),
        length: 2.6,
        radius: 0.19,
        level: 0,
    };
    tree.grow(&trunk, &mut Prng::seeded(7));
    let wood = doc.mesh("trunk and branches", palette.bark, &tree.wood);
    let twig = doc.mesh("twig", palette.leaf, &twig());

    // Twice as deep as other things: the foot of the trunk is a tilted ring.
    let court = Placement::at(9.0, -2.0 * FOOTING_M, -0.6);
    // The other one stands outside the fence: mirrored, turned, and squatter.
    let street = Placement {
        rotation: DQuat::from_rotation_y(2.2),
        scale: dvec3(-1.05, 0.92, 1.05),
        ..Placement::at(-12.4, -2.0 * FOOTING_M, 1.2)
    };
    let mut trees = Vec::new();
    for (name, place) in [("court tree", court), ("street tree", street)] {
        let twigs = tree.twigs.iter().enumerate();
        let children =
            twigs.map(|(i, &at)| doc.node(format!("{name} twig {}", i + 1), Content::Mesh(twig), at, vec![])).collect();
        trees.push(doc.node(name, Content::Mesh(wood), place, children));
    }
    doc.node("trees", Content::Group, Placement::default(), trees)
}

impl Tree {
    fn grow(&mut self, branch: &Branch, random: &mut Prng) {
        let (children, shorter, thinner, sides) = FORKS[branch.level];
        let tip = branch.level + 1 == FORKS.len();
        let mut path = vec![(branch.start, branch.radius * if branch.level == 0 { 1.7 } else { 1.0 })];
        let (mut point, mut direction) = (branch.start, branch.direction);
        for i in 1..=JOINTS {
            let wobble = if branch.level == 0 { 0.05 } else { 0.16 };
            let mut sway = || random.between(-wobble, wobble);
            direction = (direction + dvec3(sway(), sway() + 0.05, sway())).normalize();
            point += direction * (branch.length / JOINTS as f64);
            let taper = 1.0 - i as f64 / JOINTS as f64 * if tip { 1.0 } else { 0.45 };
            path.push((point, branch.radius * taper));
        }
        self.wood.add(&tube(&path, sides), DMat4::IDENTITY);

        let side = direction.any_orthonormal_vector();
        let phase = random.between(0.0, TAU);
        for i in 0..children {
            let joint = JOINTS - i * (JOINTS - 2) / children;
            let tilt = random.between(0.55, 0.95) * if i == 0 { 0.5 } else { 1.0 };
            let around = DQuat::from_axis_angle(direction, phase + GOLDEN_RAD * i as f64) * side;
            let towards = (direction * tilt.cos() + around * tilt.sin()).normalize();
            let (start, radius) = path[joint];
            if tip {
                let roll = DQuat::from_rotation_y(random.between(0.0, TAU));
                let rotation = DQuat::from_rotation_arc(DVec3::Y, towards) * roll;
                let scale = DVec3::splat(random.between(1.1, 1.6));
                self.twigs.push(Placement { translation: start, rotation, scale });
            } else {
                let length = branch.length * shorter * random.between(0.85, 1.1);
                let radius = radius.min(branch.radius * thinner);
                self.grow(&Branch { start, direction: towards, length, radius, level: branch.level + 1 }, random);
            }
        }
    }
}

/// A stem along y with leaves around it. A leaf is a diamond folded along its rib: two triangles.
fn twig() -> Mesh {
    let stem = |y: f64| dvec3(0.05 * (3.0 * y).sin(), y, 0.04 * (4.0 * y).cos() - 0.04);
    let joint = |i: u32| (stem(0.32 * f64::from(i)), 0.006 - 0.003 * f64::from(i));
    let mut mesh = tube(&(0..=2).map(joint).collect::<Vec<_>>(), 3);
    for i in 0..30_u32 {
        let y = 0.06 + 0.0195 * f64::from(i);
        let (sin, cos) = (GOLDEN_RAD * f64::from(i)).sin_cos();
        let (out, beside) = (dvec3(cos, 0.0, sin), dvec3(-sin, 0.0, cos));
        // Leaves droop a little and get smaller towards the tip.
        let (size, lean) = (1.0 - 0.4 * y, -0.25 + 1.3 * y);
        let rib = (out + lean * DVec3::Y).normalize();
        let fold = rib.cross(beside);
        let (base, middle) = (stem(y), stem(y) + rib * (0.10 * size));
        let wing = |side: f64| middle + beside * (0.05 * size * side) - fold * (0.014 * size);
        let tip = base + rib * (0.19 * size) - DVec3::Y * 0.02;
        mesh.add_quad([base, wing(-1.0), tip, wing(1.0)]);
    }
    mesh
}
