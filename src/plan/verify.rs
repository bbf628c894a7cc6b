//! Checking a plan against the scene: input hashes, witnesses, and every light measured again.
//!
//! Uses no sample, metric or fit: what judges a plan shares none of what chose it.

use std::path::Path;

use serde::Serialize;

use super::{Input, Plan, PlanError, Watch, sha256_hex};

/// What a check of a plan found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verification {
    /// True when every input, every light and every bound holds.
    pub passed: bool,
    /// The files of the plan.
    pub inputs: Vec<InputCheck>,
    /// The lights of the plan's frames.
    pub lights: Vec<LightCheck>,
}

/// Whether a file is what the plan was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct InputCheck {
    /// As in the plan.
    pub path: String,
    /// True when its hash is the plan's.
    pub passed: bool,
    /// What is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Whether a light of a frame keeps what the plan says of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightCheck {
    /// Frame number.
    pub frame: i64,
    /// Name of the light.
    pub light: String,
    /// Number of maps.
    pub maps: u64,
    /// Texels of its maps.
    pub texels: u64,
    /// Wrong pixels as the plan has them; absent when it was not measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub planned: Option<u64>,
    /// Wrong pixels now.
    pub measured: u64,
    /// Wrong pixels whose exact answer is uncertain, now.
    pub uncertain: u64,
    /// Pixels of the image.
    pub of_pixels: u64,
    /// Witnesses that the plan's matrices and exact visibility bear out.
    pub witnesses_held: u64,
    /// Witnesses in the plan.
    pub witnesses: u64,
    /// True when all of this holds.
    pub passed: bool,
    /// What does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Checks a plan whose paths are relative to `plan_dir`.
///
/// # Errors
/// [`PlanError`] when the check itself cannot be made; a plan found wrong is a [`Verification`] that did not pass.
pub fn verify(plan: &Plan, plan_dir: &Path, watch: &Watch) -> Result<Verification, PlanError> {
    watch.check()?;
    let inputs = check_inputs(plan, plan_dir);
    if inputs.iter().all(|i| i.passed) {
        return Err(PlanError::NotBuilt("measuring a plan again"));
    }
    Ok(Verification { passed: false, inputs, lights: Vec::new() })
}

/// Compares the hash of every input with the plan's.
fn check_inputs(plan: &Plan, plan_dir: &Path) -> Vec<InputCheck> {
    let check = |input: &Input| match sha256_hex(&plan_dir.join(&input.path)) {
        Ok(hash) if hash == input.sha256 => None,
        Ok(_) => Some("its content is not what the plan was made from; plan the job again".to_owned()),
        Err(error) => Some(error.to_string()),
    };
    let found = |input: &Input| {
        let reason = check(input);
        InputCheck { path: input.path.clone(), passed: reason.is_none(), reason }
    };
    plan.job.inputs.iter().map(found).collect()
}
