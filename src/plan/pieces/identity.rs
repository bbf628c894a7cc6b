//! Whose piece a piece is: the resolved job, every byte of the files it reads, and the version that planned it.

use super::super::make::Loaded;
use super::super::{Input, PlanError, hash_inputs};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Pieces with equal identities belong together.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub(super) struct Identity {
    /// The version of lixel.
    lixel: String,
    /// The job with all layers resolved, as JSON; its paths are relative to the job's folder.
    pub(super) job: String,
    /// Every file read, its path relative to the job's folder.
    inputs: Vec<Input>,
    /// Wall times are put into entries.
    pub(super) timings: bool,
    /// The numbers of the shot's frames, in order.
    pub(super) frames: Vec<i64>,
}

impl Identity {
    /// Of a job whose files are read.
    pub(super) fn of(loaded: &Loaded, timings: bool) -> Result<Identity, PlanError> {
        let encode = |e: serde_json::Error| PlanError::Encode { format: "JSON", message: e.to_string() };
        Ok(Identity {
            lixel: env!("CARGO_PKG_VERSION").to_owned(),
            job: serde_json::to_string(&loaded.given.job).map_err(encode)?,
            inputs: hash_inputs(&loaded.shot.scene.inputs, &loaded.given.dir)?,
            timings,
            frames: loaded.shot.frames.iter().map(|f| f.frame).collect(),
        })
    }

    /// A fingerprint of a draft of this shot.
    pub(super) fn fingerprint(&self, draft: &[u8]) -> [u8; 32] {
        let mut hasher = Sha256::new();
        hasher.update(self.job.as_bytes());
        for input in &self.inputs {
            hasher.update(input.sha256.as_bytes());
        }
        hasher.update(draft);
        hasher.finalize().into()
    }

    /// What another identity differs in, in words; `None` when they are the same.
    pub(super) fn difference(&self, other: &Identity) -> Option<String> {
        if self == other {
            return None;
        }
        if self.lixel != other.lixel {
            return Some(format!("it is of lixel {}, not {}", self.lixel, other.lixel));
        }
        if self.frames != other.frames {
            return Some(format!("its shot has the frames {}, not {}", ranges(&self.frames), ranges(&other.frames)));
        }
        for input in &self.inputs {
            match other.inputs.iter().find(|o| o.path == input.path) {
                Some(same) if same.sha256 != input.sha256 => return Some(format!("{} had other content", input.path)),
                None => return Some(format!("it read {}, which is not read here", input.path)),
                Some(_) => {}
            }
        }
        if let Some(more) = other.inputs.iter().find(|o| self.inputs.iter().all(|i| i.path != o.path)) {
            return Some(format!("it did not read {}", more.path));
        }
        Some(if self.timings == other.timings {
            job_difference(&self.job, &other.job)
        } else {
            "--timings differs".into()
        })
    }
}

/// The first key in which two jobs differ.
fn job_difference(here: &str, there: &str) -> String {
    let parse = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap_or_default();
    let (here, there) = (parse(here), parse(there));
    let mut path = String::new();
    let (mut a, mut b) = (&here, &there);
    while let (Some(x), Some(y)) = (a.as_object(), b.as_object()) {
        let Some(key) = x.keys().chain(y.keys()).find(|k| x.get(*k) != y.get(*k)) else { break };
        path += if path.is_empty() { "" } else { "." };
        path += key;
        (a, b) = (&x.get(key).unwrap_or(&serde_json::Value::Null), &y.get(key).unwrap_or(&serde_json::Value::Null));
    }
    let text = |v: &serde_json::Value| if v.is_null() { "absent".to_owned() } else { v.to_string() };
    format!("job.{path} is {} in it, not {}", text(a), text(b))
}

/// Frame numbers as a range: `1-4,7`.
pub(super) fn ranges(frames: &[i64]) -> String {
    let mut spans: Vec<[i64; 2]> = Vec::new();
    for frame in frames {
        match spans.last_mut() {
            Some([_, last]) if *last + 1 == *frame => *last = *frame,
            _ => spans.push([*frame; 2]),
        }
    }
    let written = spans.iter().map(|[a, b]| if a == b { a.to_string() } else { format!("{a}-{b}") });
    written.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_written_as_ranges() {
        assert_eq!(ranges(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
        assert_eq!(ranges(&[]), "");
        assert_eq!(ranges(&[-3, -2, 5]), "-3--2,5");
    }

    #[test]
    fn the_first_difference_is_named() {
        let input = |path: &str, sha: &str| Input { path: path.into(), sha256: sha.into() };
        let one = Identity {
            lixel: "1".into(),
            job: r#"{"quality":{"epsilon":0.1}}"#.into(),
            inputs: vec![input("a.glb", "x")],
            timings: false,
            frames: vec![1, 2],
        };
        let said = |other: Identity| one.difference(&other);
        assert_eq!(said(one.clone()), None);
        assert!(said(Identity { frames: vec![1], ..one.clone() }).unwrap().contains("1-2"));
        assert!(said(Identity { inputs: vec![input("a.glb", "y")], ..one.clone() }).unwrap().contains("a.glb"));
        assert!(said(Identity { inputs: vec![], ..one.clone() }).unwrap().contains("a.glb"));
        let job = said(Identity { job: r#"{"quality":{"epsilon":0.2}}"#.into(), ..one.clone() }).unwrap();
        assert_eq!(job, "job.quality.epsilon is 0.1 in it, not 0.2");
    }
}
