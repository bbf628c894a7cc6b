//! Scene-optimised shadow mapping, Algorithm 1 of Chong and Gortler, TR-07-07, as published: h (eq. 9) and its gradient are
//! summed over all samples for each candidate, three iterations of nine angles.
//!
//! As fast as we can write it: one conversion of the samples into arrays of what the sums need, four sums side by side
//! so that the compiler can vectorise, no allocation per candidate, no bounds check in a sum.

use glam::{DMat3, DQuat, DVec2, DVec3};
use lixel::fit::normalise_similar;
use lixel::math::{LightSpace, convex_hull, det3};
use lixel::methods::{Inputs, Method, solve};

const ANGLES_DEGREES: [f64; 9] = [-10.0, 3.0, 5.0, 9.0, 16.0, 23.0, 30.0, 40.0, 50.0];
const ITERATIONS: u32 = 3;
/// Sums side by side.
const LANES: usize = 4;
type Lanes = [f64; LANES];

/// Four samples: q (with q3 = 1), c_1, c_2 and length / V².
#[derive(Clone, Copy, Default)]
struct Block {
    q: [Lanes; 2],
    c: [[Lanes; 3]; 2],
    k: Lanes,
}

/// The rival's matrix.
pub(crate) struct Answer {
    /// Rows p1, p2 in texels and p4.
    rows: [DVec3; 3],
    /// h.
    value: f64,
}

/// The complete fit of a directional light, compiled for AVX2 where the machine has it, as our own sums are.
pub(crate) fn scene_optimal(inputs: &Inputs) -> Option<Answer> {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "AVX2 was just detected, which is all that the callee asks for")]
        return unsafe { scene_optimal_avx2(inputs) };
    }
    scene_optimal_here(inputs)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn scene_optimal_avx2(inputs: &Inputs) -> Option<Answer> {
    scene_optimal_here(inputs)
}

#[inline(always)]
fn scene_optimal_here(inputs: &Inputs) -> Option<Answer> {
    let space = LightSpace::around(inputs.light, inputs.covered).ok()?;
    let points: Vec<DVec2> = inputs.covered.iter().map(|p| space.q(*p).truncate()).collect();
    let hull = convex_hull(&points);
    let normalisation = normalise_similar(&hull)?;
    let hull: Vec<DVec2> = hull.iter().map(|p| normalisation.point(*p)).collect();
    let normal_from_scene =
        normalisation.normal_from_plane * DMat3::from_cols(space.dq(DVec3::X), space.dq(DVec3::Y), space.dq(DVec3::Z));
    let of_centre = normalisation.normal_from_plane * space.offset;
    let mut blocks = vec![Block::default(); inputs.edges.len().div_ceil(LANES)];
    for (block, edges) in blocks.iter_mut().zip(inputs.edges.chunks(LANES)) {
        for (lane, edge) in edges.iter().enumerate() {
            // A parallel light: q3 = 1.
            let q = normal_from_scene * (edge.position - space.center) + of_centre;
            let t = edge.derivatives.map(|d| normal_from_scene * d);
            let volume = q.dot(t[0].cross(t[1]));
            block.q[0][lane] = q.x;
            block.q[1][lane] = q.y;
            for (c, t) in block.c.iter_mut().zip(t) {
                let v = t.cross(q).to_array();
                c.iter_mut().zip(v).for_each(|(c, v)| c[lane] = v);
            }
            block.k[lane] = edge.length_px / (volume * volume);
        }
    }
    let mut projected = Vec::with_capacity(hull.len());
    let mut best = candidate(&blocks, &hull, DVec3::Z, inputs.texels, &mut projected)?;
    for _ in 0..ITERATIONS {
        let p4 = best.rows[2];
        let turn = p4.cross(-gradient_p4(&blocks, &best.rows)).try_normalize()?;
        for degrees in ANGLES_DEGREES {
            let turned = DQuat::from_axis_angle(turn, degrees.to_radians()) * p4;
            if let Some(found) = candidate(&blocks, &hull, turned, inputs.texels, &mut projected)
                && found.value < best.value
            {
                best = found;
            }
        }
    }
    Some(best)
}

/// Says how far the rival's h lies from that of the crate's own `scene-optimal`, which sums moments instead.
pub(crate) fn check(inputs: &Inputs, answer: &Answer) {
    let all = Inputs { sample_cap: usize::MAX, ..*inputs };
    let Ok(regions) = solve(Method::SceneOptimal, &all) else { return };
    let Some(region) = regions.first() else { return };
    let own = DVec3::new(region.h.row(2).x, region.h.row(2).y, region.h.row(2).z).normalize();
    let Ok(space) = LightSpace::around(inputs.light, inputs.covered) else { return };
    let points: Vec<DVec2> = inputs.covered.iter().map(|p| space.q(*p).truncate()).collect();
    let Some(normalisation) = normalise_similar(&convex_hull(&points)) else { return };
    let rival = normalisation.normal_from_plane.transpose() * answer.rows[2];
    let apart = own.angle_between(rival.normalize()).to_degrees();
    eprintln!("p4 of the rival and of the crate's scene-optimal are {apart:.2e} degrees apart");
}

// Not a closure: that would be a function of its own, compiled without AVX2.
#[inline(always)]
fn candidate(blocks: &[Block], hull: &[DVec2], p4: DVec3, texels: f64, projected: &mut Vec<DVec2>) -> Option<Answer> {
    let rows = texel_rows(hull, p4, texels, projected)?;
    let value = value(blocks, &rows);
    value.is_finite().then_some(Answer { rows, value })
}

/// Rows in texels of the minimum-area rectangle around the hull seen through p4 (unit).
fn texel_rows(hull: &[DVec2], p4: DVec3, texels: f64, projected: &mut Vec<DVec2>) -> Option<[DVec3; 3]> {
    let e1 = p4.any_orthonormal_vector();
    let e2 = p4.cross(e1);
    projected.clear();
    for v in hull {
        let q = v.extend(1.0);
        let w = p4.dot(q);
        if w <= 0.0 {
            return None;
        }
        projected.push(DVec2::new(e1.dot(q), e2.dot(q)) / w);
    }
    let mut best: Option<(f64, DVec2, DVec2)> = None;
    for i in 0..projected.len() {
        let Some(n) = (projected[(i + 1) % projected.len()] - projected[i]).try_normalize() else { continue };
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in projected.iter() {
            let d = DVec2::new(n.dot(*p), n.perp().dot(*p));
            (low, high) = (low.min(d), high.max(d));
        }
        let size = high - low;
        if best.is_none_or(|b| size.x * size.y < b.0) {
            best = Some((size.x * size.y, n, low));
        }
    }
    let (area, n, low) = best?;
    // The unit square, with as many texels along each side as it is long. The offset of p1 and p2 drops out of h, but
    // not out of the gradient, which holds them.
    let per_side = (texels / area).sqrt();
    let row = |n: DVec2, low: f64| (e1 * n.x + e2 * n.y - p4 * low) * per_side;
    Some([row(n, low.x), row(n.perp(), low.y), p4])
}

/// h = det⁻² Σ k w² Σ_ij (q_i'·c_j)².
#[inline(always)]
fn value(blocks: &[Block], rows: &[DVec3; 3]) -> f64 {
    let [p1, p2, p4] = *rows;
    let (a, b) = (p1.cross(p4), p2.cross(p4));
    let mut sums = [0.0; LANES];
    for block in blocks {
        for lane in 0..LANES {
            let w = p4.x * block.q[0][lane] + p4.y * block.q[1][lane] + p4.z;
            let mut squares = 0.0;
            for [x, y, z] in &block.c {
                let along_a = a.x * x[lane] + a.y * y[lane] + a.z * z[lane];
                let along_b = b.x * x[lane] + b.y * y[lane] + b.z * z[lane];
                squares += along_a * along_a + along_b * along_b;
            }
            sums[lane] += block.k[lane] * w * w * squares;
        }
    }
    let det = det3(p1, p2, p4);
    sums.iter().sum::<f64>() / (det * det)
}

/// ∂h/∂p4.
#[inline(always)]
fn gradient_p4(blocks: &[Block], rows: &[DVec3; 3]) -> DVec3 {
    let [p1, p2, p4] = *rows;
    let (a, b) = (p1.cross(p4), p2.cross(p4));
    // Σ k w² S, Σ k w S q, Σ k w² Σ_j (a·c_j) c_j and the same of b.
    let mut sums = [[0.0; LANES]; 10];
    for block in blocks {
        for lane in 0..LANES {
            let w = p4.x * block.q[0][lane] + p4.y * block.q[1][lane] + p4.z;
            let (kw, mut squares) = (block.k[lane] * w, 0.0);
            for [x, y, z] in &block.c {
                let along_a = a.x * x[lane] + a.y * y[lane] + a.z * z[lane];
                let along_b = b.x * x[lane] + b.y * y[lane] + b.z * z[lane];
                squares += along_a * along_a + along_b * along_b;
                for (k, c) in [x, y, z].into_iter().enumerate() {
                    sums[4 + k][lane] += kw * w * along_a * c[lane];
                    sums[7 + k][lane] += kw * w * along_b * c[lane];
                }
            }
            sums[0][lane] += kw * w * squares;
            sums[1][lane] += kw * squares * block.q[0][lane];
            sums[2][lane] += kw * squares * block.q[1][lane];
            sums[3][lane] += kw * squares;
        }
    }
    let s = sums.map(|lanes| lanes.iter().sum::<f64>());
    let vector = |k: usize| DVec3::new(s[k], s[k + 1], s[k + 2]);
    let det = det3(p1, p2, p4);
    let of_sum = (vector(1) + vector(4).cross(p1) + vector(7).cross(p2)) * 2.0;
    of_sum / (det * det) - p1.cross(p2) * (2.0 * s[0] / (det * det * det))
}
