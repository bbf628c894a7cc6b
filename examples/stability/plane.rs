//! The metric of the planner at a given matrix, from rooms that are public: edges of a frame in the light plane, rows of
//! the matrix on it.

use glam::{DMat4, DVec2, DVec3, DVec4};
use lixel::fit::{Normalisation, normalise};
use lixel::math::{LightSpace, convex_hull};
use lixel::metric::{EdgeSamples, Metric, cost, volume};
use lixel::samples::LightSamples;
use lixel::scene::Light;

/// Edges of a light in its light plane.
pub(crate) struct Edges {
    pub(crate) space: LightSpace,
    pub(crate) normalisation: Normalisation,
    pub(crate) samples: EdgeSamples,
}

/// Smallest |V| relative to its vectors; nearer to edge-on the planner leaves a sample out.
const GRAZING: f64 = 1e-7;

impl Edges {
    /// In the coordinates that the planner would use.
    ///
    /// # Errors
    /// When the cover has no plane or no extent in it.
    pub(crate) fn of(light: &Light, found: &LightSamples) -> Result<Edges, String> {
        let space = LightSpace::around(light, &found.covered).map_err(|e| e.to_string())?;
        let flat: Vec<DVec2> = found.covered.iter().map(|p| space.q(*p)).map(|q| q.truncate() / q.z).collect();
        let hull = convex_hull(&flat);
        let normalisation = normalise(&hull).ok_or("a cover without extent")?;
        let mut samples = EdgeSamples::default();
        for edge in &found.edges {
            let (q, t) = normalisation.vectors(space.q(edge.position), edge.derivatives.map(|d| space.dq(d)));
            // Derivatives of q / q3, less the part along q, which no measure sees.
            let size = q.length() * t[0].length() * t[1].length();
            let volume = volume(q, t, size);
            if volume.abs() > GRAZING * size {
                samples.push(q, t, volume, &edge.into());
            }
        }
        Ok(Edges { space, normalisation, samples })
    }

    /// Rows p1, p2 (in texels) and p4 on normalised q of a light matrix.
    pub(crate) fn rows(&self, clip_from_scene: &DMat4, [width, height]: [u32; 2]) -> [DVec3; 3] {
        let [x, y, w] = [0, 1, 3].map(|k| clip_from_scene.row(k));
        let texels = |row: DVec4, side: u32| (row + w) * (0.5 * f64::from(side));
        [texels(x, width), texels(y, height), w].map(|row| self.normalisation.row(self.row_on_q(row)))
    }

    /// A row on (X, 1) as a row on q.
    fn row_on_q(&self, row: DVec4) -> DVec3 {
        let [r1, r2, r3] = self.space.axes;
        let linear = row.truncate();
        let third = if self.space.directional { linear.dot(self.space.center) + row.w } else { linear.dot(r3) };
        DVec3::new(linear.dot(r1), linear.dot(r2), third)
    }

    /// Expected wrong pixels of rows.
    pub(crate) fn cost(&self, rows: &[DVec3; 3]) -> f64 {
        cost(&self.samples, Metric::Saturating, rows)
    }
}
