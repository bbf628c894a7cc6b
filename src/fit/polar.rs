//! The legal projective parameters: p4 = (a, b, 1) with 1 + a x + b y > 0 on every hull vertex (math note §1).

use glam::DVec2;

/// The open convex polygon of legal (a, b); contains 0 because the hull's centroid is there.
#[derive(Clone, Debug)]
pub struct PolarPolygon<'a> {
    hull: &'a [DVec2],
}

impl<'a> PolarPolygon<'a> {
    /// Of a hull in normalised coordinates.
    pub fn new(hull: &'a [DVec2]) -> Self {
        PolarPolygon { hull }
    }

    /// Smallest w over the hull; positive inside.
    pub fn w_min(&self, ab: DVec2) -> f64 {
        self.hull.iter().map(|v| 1.0 + ab.dot(*v)).fold(f64::INFINITY, f64::min)
    }

    /// How far a ray in a unit direction stays inside; infinite never happens for a hull around 0.
    pub fn radius(&self, direction: DVec2) -> f64 {
        let most = self.hull.iter().map(|v| -v.dot(direction)).fold(0.0, f64::max);
        1.0 / most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_border_is_where_w_vanishes() {
        let hull = [(-1.0, -0.5), (0.9, -0.7), (0.3, 1.0)].map(|(x, y)| DVec2::new(x, y));
        let polar = PolarPolygon::new(&hull);
        for k in 0..16 {
            let d = DVec2::from_angle(f64::from(k));
            let r = polar.radius(d);
            assert!(polar.w_min(d * r).abs() < 1e-12);
            assert!(polar.w_min(d * (0.999 * r)) > 0.0);
        }
    }
}
