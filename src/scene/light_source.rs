//! Which lights a shot has, and where each is at a time.

use super::model::{FileLight, FileLightKind, LightTracks, Model, Node};
use super::names::{Found, Names, did_you_mean, find, list, name_all};
use super::pose::{Pose, minus_z};
use super::track::Track;
use super::{Light, LightKind, LightKindName, LightParams, SceneError};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

const REMEDY: &str = "add lights to the file (KHR_lights_punctual), or [[light]] with name, kind and direction or \
                      position to the job";

/// Widest cone that a file may state, half angle, radians: π/2, which writers round up to the next f32.
pub(super) const WIDEST_CONE_RAD: f64 = std::f32::consts::FRAC_PI_2 as f64;

/// A light of the shot.
#[derive(Clone, Debug)]
pub(super) enum LightSource {
    /// Defined in the job; world space.
    Fixed(Light),
    /// Held by a node.
    Node {
        /// As in the file or job.
        name: String,
        /// Index into the model's nodes; shines along its -z.
        node: usize,
        /// Without placement.
        kind: FileLightKind,
        /// What the animation changes.
        tracks: LightTracks,
    },
}

/// Resolves `[[light]]`: all of the files' lights when there is none.
///
/// # Errors
/// [`SceneError::Light`] for no light at all, unknown or repeated names; [`SceneError::BadValue`] for bad keys.
pub(super) fn choose(params: &[LightParams], model: &Model) -> Result<Vec<LightSource>, SceneError> {
    let own = model.lights.iter().map(|light| (&model.nodes[light.node], light.name.as_deref()));
    let names = name_all("light", own);
    let fail = |problem: String| SceneError::Light { problem, known: list(&names), remedy: REMEDY };
    if params.is_empty() {
        if model.lights.is_empty() {
            return Err(fail("no light to plan for".into()));
        }
        let from_file = |(names, light): (&Names, &FileLight)| from_node(names.unique.clone(), light);
        return Ok(names.iter().zip(&model.lights).map(from_file).collect());
    }
    let mut chosen = Vec::with_capacity(params.len());
    for (k, light) in params.iter().enumerate() {
        if params[..k].iter().any(|other| other.name == light.name) {
            return Err(fail(format!("two [[light]] are named {:?}", light.name)));
        }
        let Some(kind) = light.kind else {
            placement_needs_kind(light)?;
            chosen.push(match find(&names, &light.name) {
                Found::One(index) => from_node(light.name.clone(), &model.lights[index]),
                Found::None => {
                    let hint = did_you_mean(&names, &light.name);
                    return Err(fail(format!("no light is named {:?}{hint}", light.name)));
                }
                Found::Several => {
                    return Err(fail(format!("several lights are named {:?}; use its node's", light.name)));
                }
            });
            continue;
        };
        chosen.push(LightSource::Fixed(defined(light, kind)?));
    }
    Ok(chosen)
}

fn from_node(name: String, light: &FileLight) -> LightSource {
    LightSource::Node { name, node: light.node, kind: light.kind, tracks: light.tracks.clone() }
}

fn key(light: &LightParams, key: &str) -> String {
    format!("light {:?}: {key}", light.name)
}

fn placement_needs_kind(light: &LightParams) -> Result<(), SceneError> {
    let given = [
        ("direction", light.direction.is_some()),
        ("position", light.position.is_some()),
        ("cone", light.cone.is_some()),
        ("range", light.range.is_some()),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((name, _)) => {
            let problem = "without `kind` the light is taken from the scene's files as it is; add kind = \
                           \"directional\", \"point\" or \"spot\"";
            Err(SceneError::bad_key(key(light, name), problem))
        }
    }
}

/// A light that the job describes.
fn defined(light: &LightParams, kind: LightKindName) -> Result<Light, SceneError> {
    let missing = |name: &str, what: &str| {
        SceneError::bad_key(key(light, name), format!("missing; a {kind:?} light needs it: {what}"))
    };
    let unused = |name: &str, given: bool| match given {
        true => Err(SceneError::bad_key(key(light, name), format!("a {kind:?} light has none; remove it"))),
        false => Ok(()),
    };
    let direction = || {
        let given = light.direction.ok_or_else(|| missing("direction", "[x, y, z], the way light travels"))?;
        let problem = "is not a direction; give three finite numbers, not all zero";
        DVec3::from_array(given)
            .try_normalize()
            .ok_or_else(|| SceneError::bad_value(key(light, "direction"), given, problem))
    };
    let position = || {
        let given = light.position.ok_or_else(|| missing("position", "[x, y, z] in metres"))?;
        let position = DVec3::from_array(given);
        let finite = position.is_finite().then_some(position);
        finite.ok_or_else(|| SceneError::bad_value(key(light, "position"), given, "must be finite"))
    };
    if let Some(range) = light.range.filter(|&range| range.is_nan() || range <= 0.0) {
        return Err(SceneError::bad_value(key(light, "range"), range, "must be positive, metres"));
    }
    let kind = match kind {
        LightKindName::Directional => {
            unused("position", light.position.is_some())?;
            unused("cone", light.cone.is_some())?;
            unused("range", light.range.is_some())?;
            LightKind::Directional { direction: direction()? }
        }
        LightKindName::Point => {
            unused("direction", light.direction.is_some())?;
            unused("cone", light.cone.is_some())?;
            LightKind::Point { position: position()?, range: light.range }
        }
        LightKindName::Spot => {
            let cone = light.cone.ok_or_else(|| missing("cone", "half angle in degrees"))?;
            if !(cone > 0.0 && cone <= 90.0) {
                return Err(SceneError::bad_value(
                    key(light, "cone"),
                    cone,
                    "must be in (0, 90] degrees, the half angle",
                ));
            }
            let cone_rad = cone.to_radians();
            LightKind::Spot { position: position()?, direction: direction()?, cone_rad, range: light.range }
        }
    };
    Ok(Light { name: light.name.clone(), kind })
}

impl LightSource {
    /// False while the light's node is hidden.
    pub(super) fn is_on(&self, pose: &Pose) -> bool {
        match self {
            LightSource::Fixed(_) => true,
            LightSource::Node { node, .. } => !pose.hidden[*node],
        }
    }

    /// The light in scene space, given the nodes' pose at a time.
    ///
    /// # Errors
    /// [`SceneError::Pose`] when its node has no -z axis, or its animated range or cone makes no sense.
    pub(super) fn at(&self, nodes: &[Node], pose: &Pose, origin: DVec3, time_s: f64) -> Result<Light, SceneError> {
        match self {
            LightSource::Fixed(light) => {
                let mut light = light.clone();
                match &mut light.kind {
                    LightKind::Directional { .. } => {}
                    LightKind::Point { position, .. } | LightKind::Spot { position, .. } => *position -= origin,
                }
                Ok(light)
            }
            LightSource::Node { name, node, kind, tracks } => {
                let world = &pose.world_from_node[*node];
                let position = world.translation - origin;
                let no_axis =
                    || nodes[*node].pose_error("the light has no direction, its z axis is scaled to 0", time_s);
                let direction = || minus_z(world.matrix3).ok_or_else(no_axis);
                let animated = |what, track: &Option<Track>, rest: Option<f64>, top: f64| match track {
                    None => Ok(rest),
                    Some(track) => match track.sample(time_s).x {
                        value if value > 0.0 && value <= top => Ok(Some(value)),
                        value => {
                            let problem = format!("the animated {what} of its light is {value}; fix its keys");
                            Err(nodes[*node].pose_error(&problem, time_s))
                        }
                    },
                };
                let range = |rest| animated("range", &tracks.range, rest, f64::INFINITY);
                let kind = match *kind {
                    FileLightKind::Directional => LightKind::Directional { direction: direction()? },
                    FileLightKind::Point { range: rest } => LightKind::Point { position, range: range(rest)? },
                    FileLightKind::Spot { cone_rad, range: rest } => {
                        let cone = animated("outerConeAngle", &tracks.cone_rad, Some(cone_rad), WIDEST_CONE_RAD)?;
                        let cone_rad = cone.unwrap_or(cone_rad).min(FRAC_PI_2);
                        LightKind::Spot { position, direction: direction()?, cone_rad, range: range(rest)? }
                    }
                };
                Ok(Light { name: name.clone(), kind })
            }
        }
    }
}
