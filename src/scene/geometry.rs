//! The triangles of one frame, counted through: those of the still list, those of still instances, then the same of what
//! moves.

use super::instance::{Instance, SharedMesh};
use super::marks::{Mark, Marks};
use super::mask::{Cutout, Mask};
use super::{Scene, SceneFrame, Triangle};
use glam::{DVec3, Vec3};
use std::ops::Range;

/// The triangles of one frame. A triangle's index counts through still ones and moving ones.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a> {
    /// Listed triangles that never move during the shot.
    pub still: &'a [Triangle],
    /// Listed triangles posed for this frame.
    pub moving: &'a [Triangle],
    /// Of the still and of the moving list.
    pub marks: [&'a Marks; 2],
    /// Masks of the triangles with holes.
    pub masks: &'a [Mask],
    /// Meshes of instances.
    pub meshes: &'a [SharedMesh],
    /// Instances that stand still, and those that move; by ascending first triangle.
    pub instances: [&'a [Instance]; 2],
}

/// Of plain triangles.
static PLAIN: Marks = Marks::new();

/// Where a triangle is.
enum Place<'a> {
    /// In the still (0) or moving (1) list, at a place.
    Listed(usize, u32),
    /// In an instance, at a place in its mesh.
    Placed(&'a Instance, u32),
}

impl<'a> Geometry<'a> {
    /// Triangles without holes, single-sided where that matters, and no instances.
    pub fn plain(still: &'a [Triangle], moving: &'a [Triangle]) -> Self {
        Geometry { still, moving, marks: [&PLAIN; 2], masks: &[], meshes: &[], instances: [&[]; 2] }
    }

    /// Of a scene and a frame of it.
    pub(super) fn of(scene: &'a Scene, frame: &'a SceneFrame) -> Self {
        Geometry {
            still: &scene.still,
            moving: &frame.moving,
            marks: [&scene.still_marks, &frame.moving_marks],
            masks: &scene.masks,
            meshes: &scene.shared.meshes,
            instances: [&scene.still_instances, &frame.moving_instances],
        }
    }

    /// Number of still triangles: they have the first indices.
    pub fn still_len(&self) -> usize {
        self.list_len(0)
    }

    /// Number of moving triangles.
    pub fn moving_len(&self) -> usize {
        self.list_len(1)
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.still_len() + self.moving_len()
    }

    /// True when there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn list_len(&self, list: usize) -> usize {
        match self.instances[list].last() {
            Some(last) => (last.first + last.count) as usize,
            None => self.listed(list).len(),
        }
    }

    /// The still (0) or the moving (1) list.
    pub fn listed(&self, list: usize) -> &'a [Triangle] {
        if list == 0 { self.still } else { self.moving }
    }

    /// The mesh of an instance.
    pub fn mesh(&self, instance: &Instance) -> &'a SharedMesh {
        &self.meshes[instance.mesh as usize]
    }

    fn locate(&self, index: u32) -> Place<'a> {
        let still = self.still_len() as u32;
        let (list, index) = if index < still { (0, index) } else { (1, index - still) };
        if (index as usize) < self.listed(list).len() {
            return Place::Listed(list, index);
        }
        let after = self.instances[list].partition_point(|instance| instance.first <= index);
        match self.instances[list].get(after.wrapping_sub(1)) {
            Some(instance) => Place::Placed(instance, index - instance.first),
            None => Place::Listed(list, index),
        }
    }

    /// The triangle with an index below [`Geometry::len`].
    pub fn triangle(&self, index: u32) -> Triangle {
        match self.locate(index) {
            Place::Listed(list, index) => self.listed(list)[index as usize],
            Place::Placed(instance, k) => instance.triangle(self.mesh(instance), k as usize),
        }
    }

    /// The same vertices in f64.
    pub fn triangle_f64(&self, index: u32) -> [DVec3; 3] {
        self.triangle(index).map(|v| v.as_dvec3())
    }

    fn mark(&self, index: u32) -> Mark {
        match self.locate(index) {
            Place::Listed(list, index) => self.marks[list].get(index),
            Place::Placed(instance, k) => instance.mark(self.mesh(instance), k),
        }
    }

    /// The holes of a triangle and their mask.
    #[inline]
    pub fn cutout(&self, index: u32) -> Option<(Cutout, &'a Mask)> {
        let cutout = self.mark(index).cutout?;
        Some((cutout, self.masks.get(cutout.mask as usize)?))
    }

    /// True for a triangle that is drawn from both sides even where a renderer leaves out fronts or backs.
    pub fn two_sided(&self, index: u32) -> bool {
        self.mark(index).two_sided
    }

    /// Triangles with holes, ascending.
    pub fn cut(&self) -> impl Iterator<Item = u32> {
        let this = *self;
        (0..2_usize).flat_map(move |list| {
            let begin = if list == 0 { 0 } else { this.still_len() as u32 };
            let listed = this.marks[list].cut().iter().map(move |k| begin + k);
            let placed = this.instances[list].iter().flat_map(move |instance| {
                this.mesh(instance).marks.cut().iter().map(move |k| begin + instance.first + k)
            });
            listed.chain(placed)
        })
    }

    /// All triangles in runs of at most `longest`, ascending.
    pub fn runs(&self, longest: usize) -> Vec<Run<'a>> {
        self.runs_of(0, longest).chain(self.runs_of(1, longest)).collect()
    }

    /// The moving triangles in runs of at most `longest`, ascending.
    pub fn moving_runs(&self, longest: usize) -> impl Iterator<Item = Run<'a>> {
        self.runs_of(1, longest)
    }

    fn runs_of(&self, list: usize, longest: usize) -> impl Iterator<Item = Run<'a>> {
        let this = *self;
        let begin = if list == 0 { 0 } else { this.still_len() as u32 };
        let listed = this.listed(list).chunks(longest).enumerate();
        let listed = listed.map(move |(k, run)| Run { first: begin + (k * longest) as u32, of: Of::List(run) });
        let placed = this.instances[list].iter().flat_map(move |instance| {
            let count = instance.count as usize;
            (0..count).step_by(longest).map(move |k| Run {
                first: begin + instance.first + k as u32,
                of: Of::Instance(instance, this.mesh(instance), k..(k + longest).min(count)),
            })
        });
        listed.chain(placed)
    }
}

/// Triangles one after the other.
#[derive(Clone, Debug)]
pub struct Run<'a> {
    /// Index of the first.
    pub first: u32,
    of: Of<'a>,
}

#[derive(Clone, Debug)]
enum Of<'a> {
    List(&'a [Triangle]),
    Instance(&'a Instance, &'a SharedMesh, Range<usize>),
}

/// Where the triangles of instances are placed, run after run.
#[derive(Debug, Default)]
pub struct Room {
    vertices: Vec<Vec3>,
    triangles: Vec<Triangle>,
}

/// Vertices between the first and the last that a run uses are placed all at once, where they are no more than so many a
/// triangle: each serves six triangles or so.
const VERTICES_A_TRIANGLE: usize = 2;

impl<'a> Run<'a> {
    /// The triangles; `room` is where those of instances are placed.
    pub fn triangles<'b>(&self, room: &'b mut Room) -> &'b [Triangle]
    where
        'a: 'b,
    {
        let (instance, mesh, range) = match &self.of {
            Of::List(triangles) => return triangles,
            Of::Instance(instance, mesh, range) => (instance, mesh, range),
        };
        let triangles = &mesh.triangles[range.clone()];
        let used = triangles.as_flattened().iter().map(|&vertex| vertex as usize);
        let (low, high) = used.fold((usize::MAX, 0), |(low, high), vertex| (low.min(vertex), high.max(vertex)));
        room.triangles.clear();
        if low > high || high - low >= VERTICES_A_TRIANGLE * triangles.len() {
            room.triangles.extend(range.clone().map(|k| instance.triangle(mesh, k)));
            return &room.triangles;
        }
        room.vertices.clear();
        room.vertices.extend(mesh.vertices[low..=high].iter().map(|vertex| instance.place(*vertex)));
        let placed = |vertex: u32| room.vertices[vertex as usize - low];
        room.triangles.extend(triangles.iter().map(|&[a, b, c]| match instance.mirrored {
            true => [a, c, b].map(placed),
            false => [a, b, c].map(placed),
        }));
        &room.triangles
    }

    /// The box of the instance that the run is of, scene space, metres.
    pub fn instance_bounds(&self) -> Option<[Vec3; 2]> {
        match &self.of {
            Of::List(_) => None,
            Of::Instance(instance, ..) => Some(instance.bounds),
        }
    }
}
