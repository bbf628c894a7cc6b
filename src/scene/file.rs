//! `scene`: the files of a shot, each with its unit, its up axis and a placement. World = `transform` × axes × unit × file.

use super::SceneError;
use glam::{DAffine3, DMat3, DVec3};
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::path::{Path, PathBuf};

/// One scene file: a name, or a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneFile {
    /// A .gltf, .glb or .obj file, relative to the job file.
    pub file: PathBuf,
    /// World from file, after unit and axes: 4 rows of 4, the last one 0 0 0 1; metres. Absent = identity.
    pub transform: Option<[[f64; 4]; 4]>,
    /// The axis that points up in the file.
    pub up: UpAxis,
    /// The unit of the file's coordinates.
    pub unit: LengthUnit,
}

/// The axis that points up in a file; both are right-handed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum UpAxis {
    /// As in glTF and here.
    #[default]
    Y,
    /// (x, y, z) of the file is (x, z, -y) here.
    Z,
}

/// Units of length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    #[default]
    M,
    /// Kilometres.
    Km,
    /// Inches, 0.0254 m.
    In,
    /// Feet, 0.3048 m.
    Ft,
}

impl LengthUnit {
    /// Metres in one unit.
    pub fn metres(self) -> f64 {
        match self {
            LengthUnit::Mm => 0.001,
            LengthUnit::Cm => 0.01,
            LengthUnit::M => 1.0,
            LengthUnit::Km => 1000.0,
            LengthUnit::In => 0.0254,
            LengthUnit::Ft => 0.3048,
        }
    }
}

/// [`SceneFile`] as a table, for serde and the schema.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "SceneTable")]
struct SceneTable {
    /// A .gltf, .glb or .obj file, relative to the job file.
    file: PathBuf,
    /// World from file, after unit and axes: 4 rows of 4, the last one 0 0 0 1; metres. Absent = identity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    transform: Option<[[f64; 4]; 4]>,
    /// The axis that points up in the file. Absent = y.
    #[serde(default)]
    up: UpAxis,
    /// The unit of the file's coordinates. Absent = m.
    #[serde(default)]
    unit: LengthUnit,
}

impl<P: Into<PathBuf>> From<P> for SceneFile {
    fn from(file: P) -> Self {
        SceneFile { file: file.into(), ..SceneFile::default() }
    }
}

impl SceneFile {
    /// The same at another path.
    pub fn at(&self, file: PathBuf) -> Self {
        SceneFile { file, ..self.clone() }
    }

    /// World from file; `None` where that is the identity.
    ///
    /// # Errors
    /// [`SceneError::BadValue`] for a transform that is not finite, not affine, or singular.
    pub(super) fn world_from_file(&self) -> Result<Option<DAffine3>, SceneError> {
        if self.transform.is_none() && self.up == UpAxis::Y && self.unit == LengthUnit::M {
            return Ok(None);
        }
        let axes = match self.up {
            UpAxis::Y => DMat3::IDENTITY,
            UpAxis::Z => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        };
        let own = DAffine3::from_mat3(axes * self.unit.metres());
        let Some(rows) = self.transform else { return Ok(Some(own)) };
        let placed = affine(&rows).filter(|placed| placed.matrix3.determinant() != 0.0);
        let placed = placed.ok_or_else(|| {
            let key = format!("transform of {}", self.file.display());
            SceneError::bad_value(key, rows, "must be 4 rows of finite numbers, the last 0 0 0 1, that flatten nothing")
        })?;
        Ok(Some(placed * own))
    }

    /// A path for messages.
    pub fn path(&self) -> &Path {
        &self.file
    }
}

/// The map that 4 rows of 4 describe (column vectors); `None` when they are not finite or not affine.
pub(super) fn affine(rows: &[[f64; 4]; 4]) -> Option<DAffine3> {
    let finite = rows.as_flattened().iter().all(|v| v.is_finite());
    let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
    let matrix3 = DMat3::from_cols(column(0), column(1), column(2));
    (finite && rows[3] == [0.0, 0.0, 0.0, 1.0]).then(|| DAffine3 { matrix3, translation: column(3) })
}

impl Serialize for SceneFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let SceneFile { file, transform, up, unit } = self.clone();
        if *self == SceneFile::from(file.clone()) {
            return file.serialize(serializer);
        }
        SceneTable { file, transform, up, unit }.serialize(serializer)
    }
}

/// A visitor rather than an untagged enum: those lose the line of an error.
impl<'de> Deserialize<'de> for SceneFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct File;
        impl<'de> Visitor<'de> for File {
            type Value = SceneFile;

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("a file name or a table with `file`")
            }

            fn visit_str<E: de::Error>(self, file: &str) -> Result<SceneFile, E> {
                Ok(SceneFile::from(file))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<SceneFile, A::Error> {
                let SceneTable { file, transform, up, unit } =
                    SceneTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(SceneFile { file, transform, up, unit })
            }
        }
        deserializer.deserialize_any(File)
    }
}

impl JsonSchema for SceneFile {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "SceneFile".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let table = generator.subschema_for::<SceneTable>();
        schemars::json_schema!({
            "description": "One scene file: a name, or a table with its unit, up axis and placement.",
            "anyOf": [{ "type": "string" }, table]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_axes_come_before_the_transform() {
        let mut file = SceneFile { up: UpAxis::Z, unit: LengthUnit::Cm, ..SceneFile::from("a.obj") };
        let at = |file: &SceneFile, p: [f64; 3]| {
            let placed = file.world_from_file().unwrap().unwrap();
            placed.transform_point3(DVec3::from_array(p)).to_array()
        };
        assert_eq!(at(&file, [100.0, 200.0, 300.0]), [1.0, 3.0, -2.0]);
        file.transform = Some([[1.0, 0.0, 0.0, 5.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);
        assert_eq!(at(&file, [100.0, 200.0, 300.0]), [6.0, 6.0, -2.0]);
        assert!(SceneFile::from("a.obj").world_from_file().unwrap().is_none());
        for bad in [[[0.0; 4]; 4], [[1.0; 4]; 4], [[f64::NAN; 4]; 4]] {
            file.transform = Some(bad);
            assert!(file.world_from_file().unwrap_err().to_string().contains("transform of a.obj"));
        }
    }
}
