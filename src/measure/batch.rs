//! [`look_up`](super::look_up) for many receivers of one map: the same arithmetic in the same order, in blocks, so that
//! divisions run side by side and the map's memory is asked for many texels at once.

use super::Drawn;
use glam::{DMat4, DVec3};

/// Receivers of a block: its arrays stay in the first-level cache.
const BLOCK: usize = 256;

/// Where nothing is looked up.
const OUTSIDE: u32 = u32::MAX;

/// The index of a texel and the depth to compare with it.
struct Block {
    texels: [u32; BLOCK],
    depths: [f32; BLOCK],
    /// Scratch: coordinates in the scene and in clip space.
    scene: [[f64; BLOCK]; 3],
    clip: [[f64; BLOCK]; 4],
}

/// Calls `answered(receiver, shadowed)` for each of some positions, in order; `None` is outside. The map's domain is not
/// asked.
pub(super) fn look_up_all(drawn: &Drawn, positions: &[DVec3], mut answered: impl FnMut(usize, Option<bool>)) {
    let mut block =
        Block { texels: [OUTSIDE; BLOCK], depths: [0.0; BLOCK], scene: [[0.0; BLOCK]; 3], clip: [[0.0; BLOCK]; 4] };
    let size = [drawn.map.width, drawn.map.height];
    for (number, points) in positions.chunks(BLOCK).enumerate() {
        project(&mut block, &drawn.clip_from_scene, size, points);
        for i in 0..points.len() {
            let stored = drawn.map.depth.get(block.texels[i] as usize);
            answered(number * BLOCK + i, stored.map(|stored| block.depths[i] > *stored));
        }
    }
}

/// Projects a block's receivers, by the best instructions there are.
fn project(block: &mut Block, m: &DMat4, size: [u32; 2], points: &[DVec3]) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "AVX2 was just detected, which is all that the callee asks for")]
        return unsafe { project_avx2(block, m, size, points) };
    }
    project_here(block, m, size, points, |c| f64::from(c as i32));
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn project_avx2(block: &mut Block, m: &DMat4, size: [u32; 2], points: &[DVec3]) {
    project_here(block, m, size, points, f64::floor);
}

/// `whole` takes a coordinate inside the map down to a whole number.
#[inline(always)]
fn project_here(block: &mut Block, m: &DMat4, [width, height]: [u32; 2], points: &[DVec3], whole: impl Fn(f64) -> f64) {
    /// Added to a whole number below 2³², it leaves that in the low bits.
    const LOW_BITS: f64 = (1_u64 << 52) as f64;
    let Block { texels, depths, scene: at, clip } = block;
    for (i, p) in points.iter().enumerate() {
        (at[0][i], at[1][i], at[2][i]) = (p.x, p.y, p.z);
    }
    let columns = m.to_cols_array_2d();
    for (row, out) in clip.iter_mut().enumerate() {
        let [a, b, c, d] = [columns[0][row], columns[1][row], columns[2][row], columns[3][row]];
        for i in 0..BLOCK {
            out[i] = a * at[0][i] + b * at[1][i] + c * at[2][i] + d;
        }
    }
    let [x, y, z, w] = &*clip;
    let (wide, high) = (f64::from(width), f64::from(height));
    for i in 0..BLOCK {
        let u = (x[i] / w[i] * 0.5 + 0.5) * wide;
        let v = (y[i] / w[i] * 0.5 + 0.5) * high;
        let inside = (w[i] > 0.0) & (u >= 0.0) & (u < wide) & (v >= 0.0) & (v < high);
        // At most 2²⁸ texels (`SIZE_MAX`): exact in f64, and below `OUTSIDE`.
        let texel = whole(v) * wide + whole(u);
        let texel = if inside { texel } else { f64::from(OUTSIDE) };
        texels[i] = (texel + LOW_BITS).to_bits() as u32;
        depths[i] = (z[i] / w[i] * 0.5 + 0.5).clamp(0.0, 1.0) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Looked, look_up};
    use super::*;
    use crate::math::Domain;
    use crate::raster::DepthMap;
    use glam::DVec4;

    #[test]
    fn blocks_answer_as_one_by_one() {
        let (width, height) = (37, 23);
        let depth = (0..width * height).map(|i| (i * 7919 % 101) as f32 / 100.0).collect();
        let drawn = Drawn {
            domain: Domain::All,
            clip_from_scene: DMat4::from_cols(
                DVec4::new(1.1, 0.2, 0.1, 0.3),
                DVec4::new(-0.3, 0.9, 0.4, -0.2),
                DVec4::new(0.2, 0.1, 0.7, 0.5),
                DVec4::new(0.05, -0.1, 0.2, 0.9),
            ),
            map: DepthMap { width, height, depth },
        };
        let at =
            |i: u32, k: u32| f64::from(i.wrapping_mul(2_654_435_761).wrapping_mul(k) >> 8) / f64::from(1 << 22) - 2.0;
        let mut points: Vec<DVec3> = (1..5000).map(|i| DVec3::new(at(i, 3), at(i, 5), at(i, 7))).collect();
        points.extend([DVec3::NAN, DVec3::INFINITY, DVec3::ZERO]);
        let (mut seen, mut outside) = (0, 0);
        look_up_all(&drawn, &points, |i, found| {
            let expected = match look_up(std::slice::from_ref(&drawn), points[i]) {
                Looked::Answered { shadowed } => Some(shadowed),
                Looked::Outside => None,
            };
            assert_eq!(found, expected, "{}", points[i]);
            seen += 1;
            outside += usize::from(found.is_none());
        });
        assert_eq!(seen, points.len());
        assert!(outside > 500 && seen - outside > 500);
    }
}
