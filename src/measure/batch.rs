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
}

/// Calls `answered(receiver, shadowed)` for each of some positions, in order; `None` is outside. The map's domain is not
/// asked.
pub(super) fn look_up_all(drawn: &Drawn, positions: &[DVec3], mut answered: impl FnMut(usize, Option<bool>)) {
    let mut block = Block { texels: [OUTSIDE; BLOCK], depths: [0.0; BLOCK] };
    let size = [drawn.map.width, drawn.map.height];
    for (number, points) in positions.chunks(BLOCK).enumerate() {
        block.project(&drawn.clip_from_scene, size, points);
        for i in 0..points.len() {
            let stored = drawn.map.depth.get(block.texels[i] as usize);
            answered(number * BLOCK + i, stored.map(|stored| block.depths[i] > *stored));
        }
    }
}

impl Block {
    #[inline(always)]
    fn project(&mut self, m: &DMat4, [width, height]: [u32; 2], points: &[DVec3]) {
        let mut clip = [[0.0_f64; BLOCK]; 4];
        let columns = m.to_cols_array_2d();
        for (i, p) in points.iter().enumerate() {
            for (row, out) in clip.iter_mut().enumerate() {
                let [a, b, c, d] = [columns[0][row], columns[1][row], columns[2][row], columns[3][row]];
                out[i] = a * p.x + b * p.y + c * p.z + d;
            }
        }
        let [x, y, z, w] = &clip;
        let (wide, high) = (f64::from(width), f64::from(height));
        for i in 0..BLOCK {
            let u = (x[i] / w[i] * 0.5 + 0.5) * wide;
            let v = (y[i] / w[i] * 0.5 + 0.5) * high;
            let inside = (w[i] > 0.0) & (u >= 0.0) & (u < wide) & (v >= 0.0) & (v < high);
            // At most 2²⁸ texels (`SIZE_MAX`): exact in f64, and below `OUTSIDE`.
            let texel = (v as i32).wrapping_mul(width as i32).wrapping_add(u as i32);
            self.texels[i] = if inside { texel as u32 } else { OUTSIDE };
            self.depths[i] = (z[i] / w[i] * 0.5 + 0.5).clamp(0.0, 1.0) as f32;
        }
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
