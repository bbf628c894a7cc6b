//! The camera of an image, from `worldToNDC` and `worldToCamera` of its header.
//!
//! The standard attributes: matrices for row vectors (v M); camera space left-handed with z forward; NDC 0 to 1 across the
//! display window, y down. Renderers also write matrices for column vectors, right-handed camera spaces that look along
//! -z, NDC from -1 to 1, y up. Which one a matrix is follows from what a camera must be:
//!
//! * In NDC = (x/w, y/w) the gradient of w is the view axis f. Divided by its length, x's gradient is c f + s r: c is
//!   where the axis meets the image, ½ or 0 (NDC 0…1 or -1…1); r ⊥ f is the image's right, and half the range over s the
//!   tangent of half the angle of view. y's gradient likewise: its r' must be at right angles to r, and the two scales must
//!   make square pixels. A transposed matrix fails these bounds.
//! * Up is r × f in a right-handed world; y runs along it or against it.
//! * A rotation of determinant -1 is a left-handed camera space, which looks along +z, else one that looks along -z.
//!
//! What is not centred, sheared or ambiguous is refused with the numbers.

use crate::scene::{Camera, Film, Projection};
use glam::{DMat3, DMat4, DVec3, DVec4};

/// The camera of a header, as written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeaderCamera {
    /// `worldToCamera`, in file order.
    pub world_to_camera: Option<[f32; 16]>,
    /// `worldToNDC`, in file order.
    pub world_to_ndc: Option<[f32; 16]>,
    /// `near`, in the file's unit of length.
    pub near: Option<f32>,
}

/// Errors of f32 matrices, and of what writers compute in f32, relative to 1.
const ACCURACY: f64 = 1e-3;

/// Near plane where the header has none, metres.
const NEAR_M: f64 = 0.01;

/// The camera that a header describes, in its own world and unit; `None` where it has neither matrix. `fov_deg` is the
/// vertical field of view for headers without `worldToNDC`, degrees.
///
/// # Errors
/// What is wrong with the matrices, with the numbers and the remedy.
pub fn camera_of_header(header: &HeaderCamera, film: Film, fov_deg: Option<f64>) -> Result<Option<Camera>, String> {
    let pose = header.world_to_camera.map(|m| pose(&m)).transpose();
    let near = header.near.map(f64::from).filter(|near| *near > 0.0 && near.is_finite()).unwrap_or(NEAR_M);
    let camera = |(position, world_from_camera), projection| {
        let name = "image header".to_owned();
        Some(Camera { name, position, world_from_camera, projection, near, far: None })
    };
    if let Some(ndc) = &header.world_to_ndc {
        let readings = [rows(ndc), rows(ndc).transpose()].map(|m| of_ndc(&m, film));
        return match readings {
            [Ok(a), Ok(b)] if a != b => Err("worldToNDC is a camera both for row and for column vectors".to_owned()),
            [Ok((at, projection)), _] | [_, Ok((at, projection))] => match at.0 {
                Some(position) => Ok(camera((position, at.1), projection)),
                None => {
                    let Some((position, _)) = pose? else {
                        return Err("worldToNDC is orthographic and does not say where the camera stands; write \
                                    worldToCamera too"
                            .to_owned());
                    };
                    Ok(camera((position, at.1), projection))
                }
            },
            [Err(rows), Err(columns)] => Err(format!(
                "worldToNDC makes no centred camera with square pixels: for row vectors {rows}; for column vectors \
                 {columns}; lens shift and overscan in the camera are not supported"
            )),
        };
    }
    let Some(pose) = pose? else { return Ok(None) };
    let Some(fov) = fov_deg else {
        return Err(
            "worldToCamera has no angle of view, and there is no worldToNDC; give the vertical one in degrees \
                    as [camera] fov"
                .to_owned(),
        );
    };
    Ok(camera(pose, Projection::Perspective { yfov_rad: fov.to_radians() }))
}

/// `worldToNDC` and `worldToCamera` of a camera, in file order and the standard's conventions.
pub fn header_of(camera: &Camera, film: Film) -> HeaderCamera {
    let from_world = DMat4::from_mat3(camera.world_from_camera.transpose()) * DMat4::from_translation(-camera.position);
    let left_handed = DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)) * from_world;
    let window = DMat4::from_translation(DVec3::new(0.5, 0.5, 0.0)) * DMat4::from_scale(DVec3::new(0.5, -0.5, 1.0));
    let in_file = |m: DMat4| m.to_cols_array().map(|v| v as f32);
    HeaderCamera {
        world_to_camera: Some(in_file(left_handed)),
        world_to_ndc: Some(in_file(window * camera.clip_from_scene(film))),
        near: Some(camera.near as f32),
    }
}

/// A matrix for column vectors from one written for row vectors.
fn rows(m: &[f32; 16]) -> DMat4 {
    // In file order the rows follow each other: as columns they are the transpose.
    DMat4::from_cols_array(&m.map(f64::from))
}

/// Position, where it is known, and world from camera; the projection.
type Reading = ((Option<DVec3>, DMat3), Projection);

/// A camera from a matrix for column vectors that takes the world to NDC.
fn of_ndc(m: &DMat4, film: Film) -> Result<Reading, String> {
    if !m.is_finite() {
        return Err("it is not finite".to_owned());
    }
    let [x, y, w] = [m.row(0), m.row(1), m.row(3)];
    let largest = x.abs().max(y.abs()).max_element();
    if w.truncate().length() > ACCURACY * 1e-3 * largest {
        perspective(x, y, w, film)
    } else {
        orthographic(x / w.w, y / w.w, m.row(2).truncate() / w.w, film)
    }
}

fn perspective(x: DVec4, y: DVec4, w: DVec4, film: Film) -> Result<Reading, String> {
    let scale = w.truncate().length();
    let forward = w.truncate() / scale;
    let part = |row: DVec4| {
        let a = row.truncate() / scale;
        let centre = a.dot(forward);
        (centre, a - forward * centre)
    };
    let ((cx, across), (cy, down)) = (part(x), part(y));
    let range = range_of(cx, cy)?;
    let (right, world_from_camera) = axes(across, down, forward)?;
    let tangents = [range / across.length(), range / down.length()];
    square(tangents, film)?;
    let system = DMat3::from_cols(x.truncate(), y.truncate(), w.truncate()).transpose();
    let position = -(system.inverse() * DVec3::new(x.w, y.w, w.w));
    if !(position.is_finite() && right.is_finite()) {
        return Err("it is singular".to_owned());
    }
    let projection = Projection::Perspective { yfov_rad: 2.0 * tangents[1].atan() };
    Ok(((Some(position), world_from_camera), projection))
}

fn orthographic(x: DVec4, y: DVec4, depth: DVec3, film: Film) -> Result<Reading, String> {
    let (across, down) = (x.truncate(), y.truncate());
    let (forward, sides) = (across.cross(down).normalize_or_zero(), [across.length(), down.length()]);
    // Depth grows forward, whatever its range.
    let forward = if depth.dot(forward) < 0.0 { -forward } else { forward };
    let (_, world_from_camera) = axes(across, down, forward)?;
    // Whether the window is 0…1 or -1…1 does not show in an orthographic matrix: the standard holds.
    let halves = sides.map(|side| 0.5 / side);
    square(halves, film)?;
    Ok(((None, world_from_camera), Projection::Orthographic { half_height: halves[1] }))
}

/// Half the range of NDC from where the view axis meets it.
fn range_of(cx: f64, cy: f64) -> Result<f64, String> {
    let at = |c: f64| (cx - c).abs() <= ACCURACY && (cy - c).abs() <= ACCURACY;
    if at(0.5) {
        Ok(0.5)
    } else if at(0.0) {
        Ok(1.0)
    } else {
        Err(format!("the view axis is at NDC ({cx:.4}, {cy:.4}), not at (0.5, 0.5) or (0, 0)"))
    }
}

/// The right and the axes (right, up, backward) of a camera from the gradients of its image coordinates.
fn axes(across: DVec3, down: DVec3, forward: DVec3) -> Result<(DVec3, DMat3), String> {
    let (right, other) = (across.normalize_or_zero(), down.normalize_or_zero());
    let skew = right.dot(other);
    let flat = right == DVec3::ZERO || other == DVec3::ZERO || forward == DVec3::ZERO;
    if flat || skew.abs() > ACCURACY || right.dot(forward).abs() > ACCURACY || other.dot(forward).abs() > ACCURACY {
        return Err(format!("its axes are not at right angles (cosine {skew:.4})"));
    }
    let up = right.cross(forward).normalize();
    Ok((right, DMat3::from_cols(up.cross(-forward).normalize(), up, -forward)))
}

/// Whether half width over half height is that of the film.
fn square([half_width, half_height]: [f64; 2], film: Film) -> Result<(), String> {
    let aspect = half_width / half_height;
    if (aspect / film.aspect() - 1.0).abs() > ACCURACY {
        return Err(format!("its window is {aspect:.4} wide and 1 high, the image {:.4}", film.aspect()));
    }
    Ok(())
}

/// Position and axes from `worldToCamera`.
fn pose(m: &[f32; 16]) -> Result<(DVec3, DMat3), String> {
    let read = |m: DMat4| {
        let last = m.row(3);
        let affine = (last - DVec4::W).abs().max_element() <= ACCURACY * 1e-3;
        let linear = DMat3::from_mat4(m);
        let rigid = (linear * linear.transpose() - DMat3::IDENTITY).to_cols_array();
        let rigid = rigid.iter().all(|v| v.abs() <= ACCURACY);
        (affine && rigid && m.is_finite()).then_some((linear, m.col(3).truncate()))
    };
    let (for_rows, for_columns) = (read(rows(m)), read(rows(m).transpose()));
    let (linear, translation) = match (for_rows, for_columns) {
        (Some(a), Some(b)) if a != b => {
            return Err("worldToCamera is a rotation without translation, both for row and for column vectors; write \
                        worldToNDC too"
                .to_owned());
        }
        (Some(reading), _) | (None, Some(reading)) => reading,
        (None, None) => {
            return Err(format!(
                "worldToCamera = {m:?} is no rotation and translation, neither for row nor for column vectors"
            ));
        }
    };
    let position = -(linear.transpose() * translation);
    // Rows of the rotation: right, up and the camera's z, which is forward in a left-handed space.
    let [right, up] = [linear.row(0), linear.row(1)];
    let backward = if linear.determinant() < 0.0 { -linear.row(2) } else { linear.row(2) };
    // f32 leaves them a little off; orthonormal again.
    let backward = backward.normalize();
    let right = (right - backward * right.dot(backward)).normalize();
    let camera = DMat3::from_cols(right, backward.cross(right), backward);
    if camera.y_axis.dot(up) < 0.0 {
        return Err("worldToCamera is mirrored".to_owned());
    }
    Ok((position, camera))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILM: Film = Film { width: 160, height: 90 };

    fn camera() -> Camera {
        let backward = DVec3::new(0.3, 0.2, 1.0).normalize();
        let right = DVec3::Y.cross(backward).normalize();
        Camera {
            name: String::new(),
            position: DVec3::new(3.0, 1.5, -7.0),
            world_from_camera: DMat3::from_cols(right, backward.cross(right), backward),
            projection: Projection::Perspective { yfov_rad: 0.7 },
            near: 0.1,
            far: None,
        }
    }

    /// worldToNDC for row vectors (in file order) and worldToCamera, in the standard's conventions.
    fn standard(camera: &Camera) -> ([f32; 16], [f32; 16]) {
        let header = header_of(camera, FILM);
        (header.world_to_ndc.unwrap(), header.world_to_camera.unwrap())
    }

    fn transposed(m: [f32; 16]) -> [f32; 16] {
        std::array::from_fn(|k| m[k % 4 * 4 + k / 4])
    }

    /// A change of NDC: x' = a x + b w and y' likewise, for row vectors.
    fn windowed(m: [f32; 16], [a, b]: [f32; 2], [c, d]: [f32; 2]) -> [f32; 16] {
        let mut out = m;
        for r in 0..4 {
            let (x, y, w) = (m[4 * r], m[4 * r + 1], m[4 * r + 3]);
            out[4 * r] = a * x + b * w;
            out[4 * r + 1] = c * y + d * w;
        }
        out
    }

    fn near(a: &Camera, b: &Camera) -> bool {
        let turned = (a.world_from_camera - b.world_from_camera).to_cols_array();
        let (Projection::Perspective { yfov_rad: x }, Projection::Perspective { yfov_rad: y }) =
            (a.projection, b.projection)
        else {
            return false;
        };
        a.position.abs_diff_eq(b.position, 1e-4) && turned.iter().all(|v| v.abs() < 1e-5) && (x - y).abs() < 1e-5
    }

    #[test]
    fn every_known_way_of_writing_the_matrices_is_the_same_camera() {
        let camera = camera();
        let (ndc, pose) = standard(&camera);
        let ways = [
            ndc,
            transposed(ndc),
            windowed(ndc, [2.0, -1.0], [2.0, -1.0]),
            windowed(ndc, [2.0, -1.0], [-2.0, 1.0]),
            transposed(windowed(ndc, [2.0, -1.0], [-2.0, 1.0])),
            windowed(ndc, [1.0, 0.0], [-1.0, 1.0]),
            ndc.map(|v| v * 7.0),
        ];
        for (k, world_to_ndc) in ways.into_iter().enumerate() {
            let header = HeaderCamera { world_to_ndc: Some(world_to_ndc), ..HeaderCamera::default() };
            let read = camera_of_header(&header, FILM, None).unwrap().unwrap();
            assert!(near(&read, &camera), "way {k}: {read:?}");
        }
        let right_handed: [f32; 16] = std::array::from_fn(|k| if k % 4 == 2 { -pose[k] } else { pose[k] });
        for (k, pose) in [pose, transposed(pose), right_handed, transposed(right_handed)].into_iter().enumerate() {
            let header = HeaderCamera { world_to_camera: Some(pose), ..HeaderCamera::default() };
            let read = camera_of_header(&header, FILM, Some(0.7_f64.to_degrees())).unwrap().unwrap();
            assert!(near(&read, &camera), "pose {k}: {read:?}");
            let without = camera_of_header(&header, FILM, None).unwrap_err();
            assert!(without.contains("[camera] fov"), "{without}");
        }
    }

    #[test]
    fn what_is_no_centred_camera_is_refused_with_the_numbers() {
        let (ndc, pose) = standard(&camera());
        let refused = |world_to_ndc, world_to_camera, film| {
            let header = HeaderCamera { world_to_ndc, world_to_camera, near: None };
            camera_of_header(&header, film, Some(40.0)).unwrap_err()
        };
        let shifted = refused(Some(windowed(ndc, [1.0, 0.1], [1.0, 0.0])), None, FILM);
        assert!(shifted.contains("(0.6000, 0.5000)") && shifted.contains("lens shift"), "{shifted}");
        let wide = refused(Some(ndc), None, Film { width: 160, height: 120 });
        assert!(wide.contains("1.7778") && wide.contains("1.3333"), "{wide}");
        let scaled = refused(None, Some(pose.map(|v| v * 2.0)), FILM);
        assert!(scaled.contains("no rotation and translation"), "{scaled}");
        let nothing = camera_of_header(&HeaderCamera::default(), FILM, None).unwrap();
        assert_eq!(nothing, None);
        let mut turn = pose;
        turn[12..15].fill(0.0);
        assert!(refused(None, Some(turn), FILM).contains("both for row and for column vectors"));
    }
}
