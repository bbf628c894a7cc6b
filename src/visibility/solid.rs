//! Which of the triangles on a ray are there at the point where it meets them: all, or those whose alpha mask says so.
//!
//! The kernel asks before it takes a hit, so a ray goes on through a hole. Scenes without holes use [`Everything`], with
//! which the kernel is compiled to what it would be without the question.

use glam::DVec3;

use super::ray::SceneRay;
use crate::scene::{Geometry, Marks, Mask, Triangle};

/// Says whether a hit counts.
pub(super) trait Solid {
    /// True when every hit does.
    const ALL: bool;

    /// Whether a hit of a triangle, by its index in the tree's list, does.
    fn is_hit(&self, triangle: u32) -> bool;
}

/// Triangles without holes.
pub(super) struct Everything;

impl Solid for Everything {
    const ALL: bool = true;

    #[inline(always)]
    fn is_hit(&self, _: u32) -> bool {
        true
    }
}

/// Triangles, some of which have holes, and the ray that meets them.
pub(super) struct WithHoles<'a> {
    pub(super) ray: &'a SceneRay,
    pub(super) triangles: &'a [Triangle],
    pub(super) marks: &'a Marks,
    pub(super) masks: &'a [Mask],
}

impl Solid for WithHoles<'_> {
    const ALL: bool = false;

    fn is_hit(&self, triangle: u32) -> bool {
        let Some(cutout) = self.marks.cutout(triangle) else { return true };
        let Some(mask) = self.masks.get(cutout.mask as usize) else { return true };
        mask.is_solid(cutout, weights(self.ray, &self.triangles[triangle as usize]))
    }
}

/// The same for triangles of instances, by their index within the list, still (0) or moving (1).
pub(super) struct InstancesWithHoles<'a> {
    pub(super) ray: &'a SceneRay,
    pub(super) geometry: Geometry<'a>,
    /// Index of the list's first triangle.
    pub(super) begin: u32,
}

impl Solid for InstancesWithHoles<'_> {
    const ALL: bool = false;

    fn is_hit(&self, triangle: u32) -> bool {
        let index = self.begin + triangle;
        let Some((cutout, mask)) = self.geometry.cutout(index) else { return true };
        mask.is_solid(&cutout, weights(self.ray, &self.geometry.triangle(index)))
    }
}

/// Barycentric weights of the point where a ray meets the plane of a triangle, not scaled; in f64. The signed volumes of
/// the ray with the triangle's edges: edge-on all are about zero, and any point of the triangle is as good.
fn weights(ray: &SceneRay, triangle: &Triangle) -> DVec3 {
    let [a, b, c] = triangle.map(|v| v.as_dvec3() - ray.origin);
    let volume = |p: DVec3, q: DVec3| ray.direction.dot(p.cross(q));
    let weights = DVec3::new(volume(b, c), volume(c, a), volume(a, b));
    match weights.element_sum() {
        sum if sum != 0.0 && sum.is_finite() => weights / sum,
        _ => DVec3::X,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn weights_are_those_of_the_point_hit() {
        let triangle = [Vec3::new(1.0, 0.0, -2.0), Vec3::new(0.0, 3.0, -2.5), Vec3::new(-1.0, 0.5, -4.0)];
        let [a, b, c] = triangle.map(|v| v.as_dvec3());
        let point = a * 0.2 + b * 0.5 + c * 0.3;
        for direction in [point, -point] {
            let ray = SceneRay { origin: point - direction, direction, t_min: 0.0, t_max: 2.0 };
            assert!(weights(&ray, &triangle).abs_diff_eq(DVec3::new(0.2, 0.5, 0.3), 1e-14));
        }
        let along = SceneRay { origin: a, direction: b - a, t_min: 0.0, t_max: 1.0 };
        assert!(weights(&along, &triangle).is_finite());
    }
}
