//! Finite differences of a depth image that refuse discontinuities.
//!
//! SOSM uses only samples "where we can compute reliable partial derivatives", and tells them "by thresholding the
//! acceleration in z". A threshold in z has a unit and depends on distance, slope and resolution. Here instead:
//!
//! * Differences are taken of ρ = 1/z, which is linear in film coordinates on any plane, however it is inclined (of z for
//!   an orthographic camera): a plane has no acceleration.
//! * The step J between two pixels is compared with the steps s₁, s₂ on its outer sides. On one smooth surface, and where
//!   two planes cross between the pixels (a crease), J lies between s₁ and s₂; a jump lies outside. How far outside is
//!   allowed is a part of the slopes, and of u = ρ ω, the step of ρ over one pixel's width ω z of a surface at 45°; how
//!   large a part, the image itself tells ([`bent`]). Nothing here has a unit of length, nor depends on the resolution.

/// Part of a slope by which a step may lie outside its neighbours, where depths are exact: roundings, and tessellation.
const BENT_LEAST: f64 = 0.01;
/// The same where an image is so rough that nothing finer can be told: the step of a quarter of the slope.
const BENT_MOST: f64 = 0.25;
/// The allowance over the median acceleration of an image: of noise that is normal, six times its median is four
/// deviations.
const OVER_MEDIAN: f64 = 6.0;
/// Slopes on both sides that differ by less than this part of the allowance are one slope.
const ONE_SLOPE: f64 = 0.5;
/// Roundings of f32 that a stored depth may be off by, twice.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// How bent the surfaces of an image may be, as a part of their slopes: from the accelerations of its pixels
/// ([`acceleration`]), most of which lie on surfaces. Depths averaged over pixels from a few samples, taken off the
/// pixel's centre, or of 16 bits, are rough everywhere.
pub(super) fn bent(mut accelerations: Vec<f64>) -> f64 {
    let middle = accelerations.len() / 2;
    if accelerations.is_empty() {
        return BENT_LEAST;
    }
    let (_, median, _) = accelerations.select_nth_unstable_by(middle, f64::total_cmp);
    (OVER_MEDIAN * *median).clamp(BENT_LEAST, BENT_MOST)
}

/// The acceleration over three pixels, as a part of the slopes: 0 on a plane, 1 and more at jumps.
pub(super) fn acceleration([before, rho, after]: [f64; 3], pixel: f64) -> f64 {
    let (back, ahead) = (rho - before, after - rho);
    (ahead - back).abs() / (2.0 * pixel + back.abs().max(ahead.abs()))
}

/// How far a step may lie outside its neighbours: `rho` where it is, `pixel` = u. A surface seen face on has no slope: the
/// pixel's own width stands for one.
fn allowance(rho: f64, pixel: f64, steepest: f64, bent: f64) -> f64 {
    bent * (2.0 * pixel + steepest) + ROUNDING * rho.abs()
}

/// Whether the middle two of four neighbouring pixels are one surface. Values that are not finite are no surface; `pixel`
/// is the step of ρ over one pixel's width of a surface at 45°.
pub(super) fn joined(rho: [f64; 4], pixel: f64, bent: f64) -> bool {
    let [before, a, b, after] = rho;
    let step = b - a;
    if !step.is_finite() {
        return false;
    }
    let sides = [a - before, after - b];
    let slopes = || sides.into_iter().filter(|s| s.is_finite());
    let steepest = slopes().fold(0.0_f64, |m, s| m.max(s.abs()));
    let (low, high) = slopes().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)));
    // A lone pair has nothing to compare with but a surface seen face on.
    let (low, high) = if low > high { (0.0, 0.0) } else { (low, high) };
    let outside = (low - step).max(step - high).max(0.0);
    outside <= allowance(a.abs().max(b.abs()), pixel, steepest, bent)
}

/// The slope of ρ at the middle of five pixels, of which neighbours are joined or not (four pairs). Central where both
/// sides have one slope; at a crease the side that goes on straight (as essentially non-oscillatory schemes choose, Harten
/// et al. 1987). `None` where neither neighbour is joined.
pub(super) fn slope(rho: [f64; 5], joined: [bool; 4], pixel: f64, bent: f64) -> Option<f64> {
    let [far_left, left, middle, right, far_right] = rho;
    let (back, ahead) = (middle - left, right - middle);
    match (joined[1], joined[2]) {
        (false, false) => None,
        (true, false) => Some(back),
        (false, true) => Some(ahead),
        (true, true) => {
            let steepest = back.abs().max(ahead.abs());
            if (ahead - back).abs() <= ONE_SLOPE * allowance(middle, pixel, steepest, bent) {
                return Some((back + ahead) * 0.5);
            }
            let bend_back = if joined[0] { (back - (left - far_left)).abs() } else { f64::INFINITY };
            let bend_ahead = if joined[3] { ((far_right - right) - ahead).abs() } else { f64::INFINITY };
            let alike = bend_back == bend_ahead || (bend_back - bend_ahead).abs() <= ROUNDING * middle.abs();
            let take_back = if alike { back.abs() <= ahead.abs() } else { bend_back < bend_ahead };
            Some(if take_back { back } else { ahead })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXEL_RAD: f64 = 1e-3;

    /// ρ of planes z = d + t tan(angle) seen at pixels 0, 1, …
    fn plane(z: f64, slope: f64) -> impl Fn(f64) -> f64 {
        // z = z0 + slope x, x = z k ω.
        move |k: f64| (1.0 - slope * k * PIXEL_RAD) / z
    }

    #[test]
    fn planes_and_creases_are_one_surface_at_any_scale() {
        for scale in [1e-6, 1.0, 1e9] {
            for incline in [0.0, 1.0, 20.0, 300.0, -300.0] {
                let a = plane(10.0 * scale, incline);
                let u = a(1.5) * PIXEL_RAD;
                assert!(joined([a(0.0), a(1.0), a(2.0), a(3.0)], u, BENT_LEAST), "{scale} {incline}");
                // A crease: another plane from 1.3 on.
                let turn = |k: f64| a(1.3) + (k - 1.3) * 40.0 * u;
                assert!(joined([a(0.0), a(1.0), turn(2.0), turn(3.0)], u, BENT_LEAST), "{scale} {incline}");
            }
        }
    }

    #[test]
    fn jumps_are_refused_at_any_scale_and_slope() {
        for scale in [1e-6, 1.0, 1e9] {
            for incline in [0.0, 1.0, 20.0] {
                let (a, b) = (plane(10.0 * scale, incline), plane(10.0 * scale * 1.05, incline));
                let u = a(1.5) * PIXEL_RAD;
                assert!(!joined([a(0.0), a(1.0), b(2.0), b(3.0)], u, BENT_MOST), "{scale} {incline}: 5 % farther");
                assert!(!joined([f64::NAN, a(1.0), b(2.0), f64::NAN], u, BENT_MOST), "nothing to compare with");
                assert!(!joined([a(0.0), a(1.0), f64::NAN, a(3.0)], u, BENT_MOST), "the background");
            }
        }
    }

    #[test]
    fn rough_images_allow_more() {
        let (a, u) = (plane(10.0, 2.0), 1e-4);
        let noisy = |k: f64| a(k) + 0.05 * u * (k * k * 12.9898).sin();
        let of = |f: &dyn Fn(f64) -> f64| {
            let three = |k: u32| acceleration([0.0, 1.0, 2.0].map(|d| f(f64::from(k) + d)), u);
            bent((0..500).map(three).collect())
        };
        assert_eq!(of(&a), BENT_LEAST);
        let rough = of(&noisy);
        assert!(rough > BENT_LEAST && rough < BENT_MOST, "{rough}");
        let all_joined = (0..500).all(|k| joined([0.0, 1.0, 2.0, 3.0].map(|d| noisy(f64::from(k) + d)), u, rough));
        assert!(all_joined);
        assert_eq!(bent(Vec::new()), BENT_LEAST);
    }

    #[test]
    fn slopes_do_not_look_across_creases_and_ends() {
        let (a, u) = (plane(10.0, 2.0), 1e-4);
        let own = a(1.0) - a(0.0);
        let close = |found: Option<f64>, wanted: f64| (found.unwrap() - wanted).abs() < 1e-12;
        let at = |f: &dyn Fn(f64) -> f64, all: [bool; 4]| slope([0.0, 1.0, 2.0, 3.0, 4.0].map(f), all, u, BENT_LEAST);
        assert!(close(at(&a, [true; 4]), own));
        let crease = |k: f64| if k <= 2.0 { a(k) } else { a(2.0) + (k - 2.0) * 50.0 * u };
        assert!(close(at(&crease, [true, true, true, true]), own), "both straight: the flatter");
        let end = |k: f64| if k <= 2.0 { a(k) } else { 0.02 };
        assert!(close(at(&end, [true, true, false, true]), own));
        assert_eq!(at(&a, [true, false, false, true]), None);
    }
}
