//! What undoes the filters of mode 0, in place; formulas of appendix B of KHR_meshopt_compression, in f32 as there.
//! Elements that its formulas leave undefined (a zero where 1.0 is encoded) come out as some number.

use super::Filter;
use std::f32::consts::FRAC_1_SQRT_2;

/// Elements of `stride` bytes, which the filter allows.
pub(super) fn undo(filter: Filter, stride: usize, bytes: &mut [u8]) {
    match filter {
        Filter::None => {}
        Filter::Exponential => bytes.as_chunks_mut().0.iter_mut().for_each(exponential),
        Filter::Quaternion => each_i16(bytes, quaternion),
        Filter::Octahedral if stride == 4 => each_i8(bytes, |v| octahedral(v, 127.0)),
        Filter::Octahedral => each_i16(bytes, |v| octahedral(v, 32767.0)),
        Filter::Color if stride == 4 => each_i8(bytes, |v| colour(v, 0xff)),
        Filter::Color => each_i16(bytes, |v| colour(v, 0xffff)),
    }
}

fn each_i8(bytes: &mut [u8], f: impl Fn([i32; 4]) -> [i32; 4]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        *element = f(element.map(|b| i32::from(b.cast_signed()))).map(|v| v as u8);
    }
}

fn each_i16(bytes: &mut [u8], f: impl Fn([i32; 4]) -> [i32; 4]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let old = std::array::from_fn(|i| i32::from(i16::from_le_bytes([element[2 * i], element[2 * i + 1]])));
        for (pair, value) in element.as_chunks_mut::<2>().0.iter_mut().zip(f(old)) {
            *pair = (value as u16).to_le_bytes();
        }
    }
}

/// 8 bits of exponent above 24 of mantissa, both signed.
fn exponential(element: &mut [u8; 4]) {
    let word = i32::from_le_bytes(*element);
    let (exponent, mantissa) = (word >> 24, (word << 8) >> 8);
    // 2^-128 to 2^127 and 24 bits: exact in f64, and rounded once.
    *element = ((f64::from(exponent).exp2() * f64::from(mantissa)) as f32).to_le_bytes();
}

fn quaternion(v: [i32; 4]) -> [i32; 4] {
    let scale = FRAC_1_SQRT_2 / (v[3] | 3) as f32;
    let [x, y, z] = [0, 1, 2].map(|i| v[i] as f32 * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let largest = (v[3] & 3) as usize;
    let mut out = [0; 4];
    for (k, value) in [w, x, y, z].into_iter().enumerate() {
        out[(largest + k) % 4] = (value * 32767.0).round() as i32;
    }
    out
}

fn octahedral(v: [i32; 4], top: f32) -> [i32; 4] {
    let one = v[2] as f32;
    let (x, y) = (v[0] as f32 / one, v[1] as f32 / one);
    let z = 1.0 - x.abs() - y.abs();
    // The lower half is folded over the edges of the upper one.
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let scale = top / (x * x + y * y + z * z).sqrt();
    [(x * scale).round() as i32, (y * scale).round() as i32, (z * scale).round() as i32, v[3]]
}

fn colour(v: [i32; 4], top: i32) -> [i32; 4] {
    let alpha = v[3] & top;
    let scale_bits = 32 - alpha.leading_zeros();
    let all = ((1_i64 << scale_bits) - 1).max(1) as i32;
    let (y, co, cg) = (v[0] & top, v[1], v[2]);
    let a = alpha & (all >> 1);
    let scale = top as f32 / all as f32;
    [y + co - cg, y + cg, y - co - cg, (a << 1) | (a & 1)].map(|c| (c as f32 * scale).round() as i32)
}
