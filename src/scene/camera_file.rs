//! Camera paths from files, as keys of the job: `.chan` text, and one matrix a frame in JSON or CSV.
//!
//! `.chan`, a line a frame, columns apart by blanks: frame, translation x y z, rotation x y z in degrees, and optionally the
//! vertical field of view in degrees. Rotations are applied in the order of `[camera] rotation_order`, "zxy" (z first) as
//! compositing programs write them.
//!
//! Matrices are world from camera, 4 rows of 4, column vectors, the camera looking along -z with y up; their scale is
//! dropped. JSON: a list of `[[..], [..], [..], [..]]` for frames 1, 2, ..., or of `{"frame": 7, "matrix": [..]}` (with
//! `"fov"` where it changes). CSV: 16 numbers a line for frames 1, 2, ..., or 17 with the frame first.
//!
//! Lines that are empty or begin with `#` are skipped; so is a first line of CSV without numbers.

use super::file::affine;
use super::pose::orthonormal_rotation;
use super::{CameraKey, RotationOrder, SceneError};
use glam::{DQuat, DVec3};
use serde::Deserialize;
use std::path::Path;

/// Reads a camera path; `None` for a file of another kind.
///
/// # Errors
/// [`SceneError::Malformed`] with the line.
pub(super) fn keys(path: &Path, bytes: &[u8], order: RotationOrder) -> Option<Result<Vec<CameraKey>, SceneError>> {
    let ends_in = |ending: &str| path.extension().is_some_and(|have| have.eq_ignore_ascii_case(ending));
    let text = String::from_utf8_lossy(bytes);
    let read = if ends_in("chan") {
        lines(path, &text).map(|line| chan(&line?, order)).collect()
    } else if ends_in("csv") {
        lines(path, &text).enumerate().map(|(row, line)| csv(row, &line?)).collect()
    } else if ends_in("json") {
        json(path, &text)
    } else {
        return None;
    };
    let some = |keys: Vec<CameraKey>| match keys.is_empty() {
        true => Err(malformed(path, "camera path", "holds no frame")),
        false => Ok(keys),
    };
    Some(read.and_then(some))
}

/// A line of numbers.
struct Line<'a> {
    path: &'a Path,
    /// From 1.
    number: usize,
    numbers: Vec<f64>,
}

impl Line<'_> {
    fn fail(&self, problem: impl Into<String>) -> SceneError {
        malformed(self.path, format!("line {}", self.number), problem)
    }
}

fn malformed(path: &Path, place: impl Into<String>, problem: impl Into<String>) -> SceneError {
    SceneError::Malformed {
        path: path.to_owned(),
        place: place.into(),
        problem: format!("{}; fix it or write the path again", problem.into()),
    }
}

/// The lines that hold numbers.
fn lines<'a>(path: &'a Path, text: &'a str) -> impl Iterator<Item = Result<Line<'a>, SceneError>> {
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let full = lines.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    let titled = |line: &str| line.split([',', ';']).all(|word| word.trim().parse::<f64>().is_err());
    full.filter(move |(k, line)| *k > 0 || !titled(line) || line.split_whitespace().any(|w| w.parse::<f64>().is_ok()))
        .map(|(k, line)| {
            let words = line.split([',', ';', ' ', '\t']).map(str::trim).filter(|word| !word.is_empty());
            let mut line = Line { path, number: k + 1, numbers: Vec::new() };
            for word in words {
                match word.parse::<f64>() {
                    Ok(number) if number.is_finite() => line.numbers.push(number),
                    _ => return Err(line.fail(format!("{word:?} is not a finite number"))),
                }
            }
            Ok(line)
        })
}

fn chan(line: &Line<'_>, order: RotationOrder) -> Result<CameraKey, SceneError> {
    let (&[frame, x, y, z, rx, ry, rz], fov) = match line.numbers.split_first_chunk::<7>() {
        Some((pose, [])) => (pose, None),
        Some((pose, &[fov, ..])) => (pose, Some(fov)),
        None => {
            let problem =
                format!("{} numbers; frame, 3 of translation and 3 of rotation are needed", line.numbers.len());
            return Err(line.fail(problem));
        }
    };
    let rotation = order.quaternion([rx, ry, rz].map(f64::to_radians));
    let (position, rotation) = (Some([x, y, z]), Some(rotation.to_array()));
    Ok(CameraKey { frame, position, rotation, fov, ..CameraKey::default() })
}

/// `row` counts from 0.
fn csv(row: usize, line: &Line<'_>) -> Result<CameraKey, SceneError> {
    let (frame, matrix) = match line.numbers.len() {
        16 => ((row + 1) as f64, &line.numbers[..]),
        17 => (line.numbers[0], &line.numbers[1..]),
        other => return Err(line.fail(format!("{other} numbers; a line has 16, or 17 with the frame first"))),
    };
    let rows = std::array::from_fn(|r| std::array::from_fn(|c| matrix[4 * r + c]));
    key(frame, &rows).map_err(|problem| line.fail(problem))
}

/// An entry of a JSON path.
#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Rows([[f64; 4]; 4]),
    Framed {
        frame: f64,
        matrix: [[f64; 4]; 4],
        #[serde(default)]
        fov: Option<f64>,
    },
}

fn json(path: &Path, text: &str) -> Result<Vec<CameraKey>, SceneError> {
    let form = "a list of 4 rows of 4, or of {\"frame\": .., \"matrix\": 4 rows of 4}, is needed";
    let entries: Vec<Entry> =
        serde_json::from_str(text).map_err(|error| malformed(path, "camera path", format!("{error}; {form}")))?;
    let keys = entries.into_iter().enumerate().map(|(k, entry)| {
        let found = match entry {
            Entry::Rows(rows) => key((k + 1) as f64, &rows),
            Entry::Framed { frame, matrix, fov } => key(frame, &matrix).map(|key| CameraKey { fov, ..key }),
        };
        found.map_err(|problem| malformed(path, format!("entry {k}"), problem))
    });
    keys.collect()
}

/// A key from a matrix.
fn key(frame: f64, rows: &[[f64; 4]; 4]) -> Result<CameraKey, String> {
    let Some(placed) = affine(rows) else {
        let turned = rows[..3].iter().all(|row| row[3] == 0.0) && rows[3][3] == 1.0;
        let hint = if turned { "; it looks transposed: translations go into the last column" } else { "" };
        return Err(format!("the matrix is not finite with a last row 0 0 0 1{hint}"));
    };
    let rotation =
        orthonormal_rotation(placed.matrix3).ok_or("the matrix has no orientation, an axis has no length")?;
    let rotation = DQuat::from_mat3(&rotation).normalize().to_array();
    Ok(CameraKey {
        frame,
        position: Some(placed.translation.to_array()),
        rotation: Some(rotation),
        ..CameraKey::default()
    })
}

impl RotationOrder {
    /// World from camera for rotations about x, y and z, radians; the axis named first turns first.
    pub(super) fn quaternion(self, about: [f64; 3]) -> DQuat {
        let axes = match self {
            RotationOrder::Xyz => [0, 1, 2],
            RotationOrder::Xzy => [0, 2, 1],
            RotationOrder::Yxz => [1, 0, 2],
            RotationOrder::Yzx => [1, 2, 0],
            RotationOrder::Zxy => [2, 0, 1],
            RotationOrder::Zyx => [2, 1, 0],
        };
        let [first, second, third] = axes.map(|axis| DQuat::from_axis_angle(DVec3::AXES[axis], about[axis]));
        third * second * first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str, text: &str) -> Result<Vec<CameraKey>, String> {
        keys(Path::new(name), text.as_bytes(), RotationOrder::Zxy).unwrap().map_err(|error| error.to_string())
    }

    fn looks(key: &CameraKey) -> DVec3 {
        DQuat::from_array(key.rotation.unwrap()) * DVec3::NEG_Z
    }

    #[test]
    fn chan_lines_are_poses() {
        let found = read("a.chan", "# nuke\n1 0 1 2 0 0 0 40\n\n2\t1 1 2\t0 90 0\t41.5\n3 0 0 0 -90 0 90\n").unwrap();
        assert_eq!(
            found.iter().map(|k| (k.frame, k.fov)).collect::<Vec<_>>(),
            [(1.0, Some(40.0)), (2.0, Some(41.5)), (3.0, None)]
        );
        assert_eq!(found[1].position, Some([1.0, 1.0, 2.0]));
        assert!(looks(&found[0]).abs_diff_eq(DVec3::NEG_Z, 1e-15));
        assert!(looks(&found[1]).abs_diff_eq(DVec3::NEG_X, 1e-15));
        assert!(looks(&found[2]).abs_diff_eq(DVec3::NEG_Y, 1e-15), "a roll before the tilt moves no view axis");
        let tilt_first = RotationOrder::Xyz.quaternion([-90.0, 0.0, 90.0].map(f64::to_radians)) * DVec3::NEG_Z;
        assert!(tilt_first.abs_diff_eq(DVec3::X, 1e-15));
        assert!(read("a.chan", "1 2 3\n").unwrap_err().contains("line 1: 3 numbers"));
        assert!(read("a.chan", "1 0 0 0 0 0 0\n2 0 0 x 0 0 0").unwrap_err().contains("line 2: \"x\""));
        assert!(read("a.chan", "1 0 0 0 0 0 nan").unwrap_err().contains("finite"));
        assert!(read("a.chan", "\n").unwrap_err().contains("no frame"));
    }

    #[test]
    fn matrices_are_poses() {
        let turned = "0,0,1,4, 0,1,0,5, -1,0,0,6, 0,0,0,1";
        let found = read("a.csv", &format!("m00,m01\n2,0,0,0,0,2,0,0,0,0,2,0,0,0,0,1\n{turned}\n")).unwrap();
        assert_eq!([found[0].frame, found[1].frame], [1.0, 2.0]);
        assert!(looks(&found[0]).abs_diff_eq(DVec3::NEG_Z, 1e-15), "scale is dropped");
        assert_eq!(found[1].position, Some([4.0, 5.0, 6.0]));
        assert!(looks(&found[1]).abs_diff_eq(DVec3::NEG_X, 1e-15));
        assert_eq!(read("a.csv", &format!("7,{turned}")).unwrap()[0].frame, 7.0);
        let rows = "[[0,0,1,4],[0,1,0,5],[-1,0,0,6],[0,0,0,1]]";
        let listed = read("a.json", &format!("[{rows},{{\"frame\":9,\"matrix\":{rows},\"fov\":30}}]")).unwrap();
        assert_eq!((listed[0].frame, listed[1].frame, listed[1].fov), (1.0, 9.0, Some(30.0)));
        assert_eq!(listed[0].position, found[1].position);
        assert!(read("a.csv", "1,0,0,0,0,1,0,0,0,0,1,0,4,5,6,1").unwrap_err().contains("transposed"));
        assert!(read("a.csv", "1,2").unwrap_err().contains("line 1: 2 numbers"));
        assert!(read("a.json", "[[1,2]]").unwrap_err().contains("4 rows of 4"));
        assert!(read("a.csv", "0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1").unwrap_err().contains("no orientation"));
        assert!(keys(Path::new("a.txt"), b"", RotationOrder::Zxy).is_none());
    }
}
