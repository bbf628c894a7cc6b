//! The 36 sums: their condition with and without normalisation, and what it does to a value.

use super::problems::{edges, normalised, some_rows};
use super::table::{Row, Table, short};
use glam::DVec3;
use lixel::fit::normalise;
use lixel::math::Prng;
use lixel::metric::{EdgeSamples, Metric, cost, moments_of};
use nalgebra::{Matrix3, Vector3};

/// The sums with the other pair of indices summed out: Σ k |c|² q qᵀ and Σ k |q|² c cᵀ of the metric L2. (The 6 x 6 sums
/// themselves are singular by construction, since c is perpendicular to q.)
fn marginals(samples: &EdgeSamples) -> [Matrix3<f64>; 2] {
    let mut sums = [Matrix3::zeros(); 2];
    let vector = |v: DVec3| Vector3::new(v.x, v.y, v.z);
    for i in 0..samples.len() {
        let (q, k) = (samples.q[i], samples.length_px[i] * samples.inverse_volume[i].powi(2));
        for c in samples.footprint_vectors(i) {
            sums[0] += vector(q) * vector(q).transpose() * (k * c.length_squared());
            sums[1] += vector(c) * vector(c).transpose() * (k * q.length_squared());
        }
    }
    sums
}

/// Largest over smallest singular value, of the worse of the two.
fn condition(samples: &EdgeSamples) -> f64 {
    let of = |sums: &Matrix3<f64>| {
        let values = sums.singular_values();
        values.max() / values.min()
    };
    marginals(samples).iter().map(of).fold(0.0, f64::max)
}

/// What a set of edges comes to: condition, error of the moment form against the sum over samples, rounding.
struct Found {
    condition: [f64; 2],
    error: [f64; 2],
    rounding: [f64; 2],
}

fn found(seed: u64) -> Option<Found> {
    let mut stream = Prng::seeded(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let (hull, plain) = edges(&mut stream, 40);
    let by = normalise(&hull).filter(|_| hull.len() >= 3)?;
    let normal = normalised(&plain, &by);
    let on_normal = some_rows(&mut stream);
    let on_plane = on_normal.map(|row| by.normal_from_plane.transpose() * row);
    let of = |samples: &EdgeSamples, rows: &[DVec3; 3]| {
        let moments = moments_of(samples, Metric::L2);
        let exact = cost(samples, Metric::L2, rows);
        (condition(samples), (moments.value(rows) / exact - 1.0).abs(), moments.rounding())
    };
    let (with, without) = (of(&normal, &on_normal), of(&plain, &on_plane));
    Some(Found { condition: [with.0, without.0], error: [with.1, without.1], rounding: [with.2, without.2] })
}

/// Largest relative error of the normalised moment form that the limit allows.
const ERROR: f64 = 1e-9;

/// Over random edges.
pub(crate) fn table(count: u64) -> Table {
    let all: Vec<Found> = (1..=count).filter_map(found).collect();
    let row = |k: usize, name: &str| {
        let sorted = |of: fn(&Found) -> [f64; 2]| {
            let mut values: Vec<f64> = all.iter().map(|f| of(f)[k]).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let (condition, error) = (sorted(|f| f.condition), sorted(|f| f.error));
        let rounding = sorted(|f| f.rounding);
        let (Some(worst), Some(error_worst), Some(most)) = (condition.last(), error.last(), rounding.last()) else {
            return Row::of(name, Err("nothing was summed".to_owned()));
        };
        let broken = k == 0 && *error_worst > ERROR;
        let faults = if broken { vec![format!("value off by {error_worst:.1e}, limit {ERROR:e}")] } else { vec![] };
        let (median, error_median) = (condition[condition.len() / 2], error[error.len() / 2]);
        Row::of(
            name,
            Ok((vec![short(median), short(*worst), short(error_median), short(*error_worst), short(*most)], faults)),
        )
    };
    Table {
        title: "Moment sums",
        text: format!(
            "{} random sets of 40 edges, up to 30 times their size from the plane's centre, at scales of 1e-3 to 1e5. \
             *Condition* of Σ k |c|² q qᵀ or Σ k |q|² c cᵀ, the worse one; *error* of the moment form at random rows against the sum over the samples \
             themselves; *rounding*: what should vanish in the sums, over its terms. The limit, with normalisation: an \
             error of {ERROR:e}.",
            all.len()
        ),
        columns: &["coordinates", "condition, median", "max", "error, median", "max", "rounding, max"],
        rows: vec![row(0, "normalised"), row(1, "as they are")],
    }
}
