//! The plan: the versioned result of planning a shot, its JSON and TOML files, and checking one later.

mod across;
mod budget;
mod choice;
mod conventions;
mod domain;
mod error;
mod explain;
mod images;
mod inputs;
mod json;
mod light_camera;
mod light_entry;
mod light_maps;
mod make;
mod map_entry;
mod pieces;
mod read;
mod remeasure;
mod render;
mod reproject;
mod seen;
mod stage;
mod types;
mod verify;
mod watch;
mod whole_shot;
mod witnesses;
mod write;

pub use budget::{BudgetCurves, BudgetPoint, LightCurve, LightPoint, PlanPoint, budget_curves};
pub use conventions::Conventions;
pub use error::PlanError;
pub use explain::explain;
pub use inputs::{Input, hash_inputs, relative_path, sha256_hex};
pub(crate) use light_entry::{Settled, plan_light};
pub use make::make;
pub(crate) use make::{in_scene_space, load_shot, open, plan_on};
pub use pieces::{Merged, PartError, certify, make_in, merge, sample, solve};
pub use read::{parse, read};
pub use render::{render, render_images, strip};
pub(crate) use stage::{FrameStage, Stages};
pub use types::*;
pub use verify::{InputCheck, LightCheck, Outcome, Verification, verify};
pub use watch::{Progress, Stage, Watch};
pub(crate) use write::write_atomically;
pub use write::{Dest, Format, to_text, write};

/// The version of the plan format that this lixel reads and writes. Keys may be added under the same name.
pub const SCHEMA: &str = "lixel.plan/1";
