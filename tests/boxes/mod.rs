//! Boxes, of which small scenes are built.

use super::fixture::Gltf;
use serde_json::json;

/// A mesh of a box around a centre.
pub(crate) fn cuboid(gltf: &mut Gltf, centre: [f32; 3], half: [f32; 3]) -> usize {
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
