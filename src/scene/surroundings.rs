//! How large the scene is, for cameras that the job describes.

use super::bake::{Bounds, Placed};
use super::instance::Shared;
use super::tasks;
use glam::{DVec3, Vec3};

/// What a camera that is not in a file needs to know of the scene; world space, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    /// Of the bounding sphere of the first frame.
    pub centre: DVec3,
    /// Of the bounding sphere of the first frame.
    pub radius: f64,
    /// Upper bound of the distance of anything from `centre`, over all frames.
    pub reach: f64,
    /// Of the bounding box over all frames.
    pub diagonal: f64,
}

impl Surroundings {
    /// Of what is placed at the first frame, about the centre of its box; `bounds` hold all frames, and stand for a first
    /// frame without any triangle.
    pub(super) fn of(placed: &[&Placed], shared: &Shared, bounds: &Bounds, origin: DVec3) -> Self {
        let world = |vertex: &Vec3| vertex.as_dvec3() + origin;
        let boxes = of_vertices(placed, shared, |run| Bounds::of(run.iter().map(world)));
        let first = if boxes.is_empty() { *bounds } else { Bounds::of(boxes.iter().flat_map(Bounds::ends)) };
        let centre = first.min.midpoint(first.max);
        let farther = |squared: f64, point: DVec3| {
            let other = point.distance_squared(centre);
            if other > squared { other } else { squared }
        };
        let mut farthest = of_vertices(placed, shared, |run| run.iter().map(world).fold(0.0, farther));
        if boxes.is_empty() {
            farthest.push(bounds.ends().into_iter().fold(0.0, farther));
        }
        let radius = farthest.into_iter().fold(0.0, f64::max).sqrt();
        let reach = bounds.corners().into_iter().map(|corner| corner.distance(centre)).fold(radius, f64::max);
        Surroundings { centre, radius, reach, diagonal: bounds.diagonal() }
    }
}

/// What `of` makes of all vertices, run by run, each of at least one.
fn of_vertices<T: Send>(placed: &[&Placed], shared: &Shared, of: impl Fn(&[Vec3]) -> T + Sync) -> Vec<T> {
    let mut all = Vec::new();
    for placed in placed {
        let listed = placed.triangles.as_flattened();
        all.extend(tasks::runs(listed.len(), |run| of(&listed[run])));
        for instance in &placed.instances {
            let vertices = &shared.meshes[instance.mesh as usize].vertices;
            let place =
                |run: std::ops::Range<usize>| vertices[run].iter().map(|v| instance.place(*v)).collect::<Vec<_>>();
            all.extend(tasks::runs(vertices.len(), |run| of(&place(run))));
        }
    }
    all
}
