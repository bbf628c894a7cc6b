//! Boxes, of which small scenes are built.

use super::fixture::Gltf;
use serde_json::json;
use std::path::Path;

/// A scene of boxes.
pub(crate) struct Boxes {
    pub(crate) gltf: Gltf,
    nodes: Vec<usize>,
}

impl Boxes {
    /// A floor, given by half its sides, with posts of some width on it.
    pub(crate) fn posts(floor: [f32; 2], width: f32, posts: impl IntoIterator<Item = [f32; 2]>) -> Boxes {
        let mut boxes = Boxes { gltf: Gltf::new(), nodes: Vec::new() };
        boxes.add([0.0, -0.1, 0.0], [floor[0], 0.1, floor[1]]);
        for [x, z] in posts {
            boxes.add([x, 0.8, z], [0.5 * width, 0.8, 0.5 * width]);
        }
        boxes
    }

    /// Adds a box around a centre; its node.
    pub(crate) fn add(&mut self, centre: [f32; 3], half: [f32; 3]) -> usize {
        let mesh = cuboid(&mut self.gltf, centre, half);
        let node = self.gltf.push("nodes", json!({ "mesh": mesh }));
        self.nodes.push(node);
        node
    }

    /// Writes `scene.glb`.
    pub(crate) fn write(mut self, folder: &Path) {
        self.gltf.json["scenes"][0]["nodes"] = json!(self.nodes);
        self.gltf.write(folder);
    }
}

/// A mesh of a box around a centre.
fn cuboid(gltf: &mut Gltf, centre: [f32; 3], half: [f32; 3]) -> usize {
    let corner = |k: usize| -> [f32; 3] {
        std::array::from_fn(|axis| centre[axis] + if k >> axis & 1 == 0 { -half[axis] } else { half[axis] })
    };
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let values: Vec<f32> = (0..8).flat_map(corner).collect();
    let position = gltf.f32s("VEC3", &values);
    let indices: Vec<u16> = faces.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect();
    let indices = gltf.indices(&indices);
    gltf.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": position }, "indices": indices }] }))
}
