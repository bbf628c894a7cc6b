//! Distant lights spread evenly over the sky.

use crate::math::Prng;
use crate::scene::{LightKindName, LightParams};
use std::ops::Range;

/// Directional lights whose positions in the sky are uniform over the upper hemisphere (y up), named h0000, h0001, ….
/// Light i depends on the seed and i alone, so that a long run may be made in parts.
pub fn random_hemisphere(lights: Range<u32>, seed: u64) -> Vec<LightParams> {
    lights
        .map(|i| {
            let mut stream = Prng::new(seed, u64::from(i));
            // Archimedes: the height of a uniform point on the sphere is uniform.
            let height = 1.0 - stream.unit();
            let azimuth = std::f64::consts::TAU * stream.unit();
            let across = (1.0 - height * height).sqrt();
            LightParams {
                name: format!("h{i:04}"),
                kind: Some(LightKindName::Directional),
                direction: Some([-across * azimuth.cos(), -height, -across * azimuth.sin()]),
                ..LightParams::default()
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_come_from_above_evenly_and_continue() {
        let lights = random_hemisphere(0..4000, 7);
        let directions: Vec<[f64; 3]> = lights.iter().filter_map(|l| l.direction).collect();
        assert_eq!(directions.len(), 4000);
        let mean = |k: usize| directions.iter().map(|d| d[k]).sum::<f64>() / 4000.0;
        assert!(directions.iter().all(|d| d[1] < 0.0 && (d.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-12));
        // Means of a uniform hemisphere: 0, 1/2, 0; their standard errors here are below 0.01.
        assert!(mean(0).abs() < 0.04 && (mean(1) + 0.5).abs() < 0.02 && mean(2).abs() < 0.04);
        assert_eq!(lights[50..100], random_hemisphere(50..100, 7));
        assert_ne!(lights[0], random_hemisphere(0..1, 8)[0]);
    }
}
