//! Parts and drafts as files.
//!
//! ```text
//! magic "lixel.part\n"   version u32   length u64, header   length u64, body   SHA-256 of all before
//! ```
//!
//! Integers are little-endian; header and body are postcard, whose f64 are exact. Every file carries the identity of its shot,
//! so that it says by itself what it belongs to.

use super::super::write::{check_part, write_atomically};
use super::identity::Identity;
use super::{Draft, FrameState};
use crate::plan::{PlanError, relative_path};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 11] = b"lixel.part\n";
/// Of the format; a change of what a stage keeps is a change of it.
const VERSION: u32 = 2;
const DIGEST: usize = 32;

/// What stands in the way of a shot in pieces.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// A file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file of something else.
    #[error("{} is no part of a shot: give files that `lixel sample`, `solve` or `certify` wrote", path.display())]
    NotAPart {
        /// The file.
        path: PathBuf,
    },
    /// A part of another version.
    #[error("{} has version {found} of the part format, this lixel reads {VERSION}: make it again with one lixel", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// A part that is cut short or changed.
    #[error("{} is damaged: {problem}; make it again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// A part of another stage.
    #[error("{} is {found}; `lixel {command}` takes {wanted}", path.display())]
    Stage {
        /// The file.
        path: PathBuf,
        /// What it is.
        found: &'static str,
        /// What is wanted.
        wanted: &'static str,
        /// The command.
        command: &'static str,
    },
    /// Parts of different jobs.
    #[error("{} is of another job than {}: {difference}; give parts of one job", path.display(), other.display())]
    Foreign {
        /// The part.
        path: PathBuf,
        /// One of the others.
        other: PathBuf,
        /// What differs.
        difference: String,
    },
    /// Parts certified for different drafts.
    #[error("{} was certified for another draft than {}: certify its frames again for one draft", path.display(), other.display())]
    OtherDraft {
        /// The part.
        path: PathBuf,
        /// One of the others.
        other: PathBuf,
    },
    /// The job's files are not those of the part.
    #[error("{} does not fit the job's files as they are now: {difference}; put them back, or sample the shot again", path.display())]
    Changed {
        /// The part.
        path: PathBuf,
        /// What differs.
        difference: String,
    },
    /// A frame in several parts.
    #[error("frames {frames} are in {} and in {}: leave one of them out, or sample ranges that do not overlap", first.display(), second.display())]
    Duplicate {
        /// The frames, as a range.
        frames: String,
        /// The part given first.
        first: PathBuf,
        /// The other one.
        second: PathBuf,
    },
    /// Frames in no part.
    #[error("no part has frames {frames}: add theirs, from `lixel {command} … --frames {frames}`")]
    Missing {
        /// The frames, as a range.
        frames: String,
        /// The command that makes them.
        command: &'static str,
    },
    /// No part was given.
    #[error("no part is given")]
    None,
    /// A range beside the shot.
    #[error("--frames {range} holds no frame of the shot, {shot}")]
    NoFrame {
        /// The range.
        range: String,
        /// The shot's.
        shot: String,
    },
    /// A folder with the work of another job.
    #[error("{} holds the work of another job: {difference}; give another folder, or delete this one", dir.display())]
    Work {
        /// The folder.
        dir: PathBuf,
        /// What differs.
        difference: String,
    },
}

/// Which stage a file comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub(super) enum Kind {
    Sampled,
    Draft,
    Certified,
    /// Whose a folder of finished work is.
    Owner,
}

impl Kind {
    fn words(self) -> &'static str {
        match self {
            Kind::Sampled => "a part of `lixel sample`",
            Kind::Draft => "a draft of `lixel solve`",
            Kind::Certified => "a part of `lixel certify`",
            Kind::Owner => "the mark of a folder of `lixel plan --work`",
        }
    }
}

/// What a file says of itself.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Header {
    pub(super) kind: Kind,
    pub(super) identity: Identity,
    /// Fingerprint of the draft that it is, or answers; zero for samples.
    pub(super) draft: [u8; DIGEST],
    /// The job's folder, relative to the file's.
    pub(super) dir: String,
}

/// What a file holds.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct Body {
    /// Absent in samples.
    pub(super) draft: Option<Draft>,
    pub(super) frames: Vec<FrameState>,
}

/// A file, read.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) path: PathBuf,
    pub(super) header: Header,
    pub(super) body: Body,
}

/// Writes a file, whole or not at all.
pub(super) fn write(path: &Path, header: &Header, body: &Body) -> Result<(), PlanError> {
    let failed = |source: io::Error| PartError::Write { path: path.to_owned(), source };
    let encoded = |e: postcard::Error| PlanError::Encode { format: "a part", message: e.to_string() };
    for (light, answer) in
        body.frames.iter().flat_map(|f| &f.lights).filter_map(|l| Some((&l.light, l.answer.as_ref()?)))
    {
        check_part(&light.name, &answer.entry)?;
    }
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    for block in [postcard::to_stdvec(header).map_err(encoded)?, postcard::to_stdvec(body).map_err(encoded)?] {
        bytes.extend((block.len() as u64).to_le_bytes());
        bytes.extend(block);
    }
    let digest: [u8; DIGEST] = Sha256::digest(&bytes).into();
    bytes.extend(digest);
    Ok(write_atomically(path, &bytes).map_err(failed)?)
}

/// The folder of a job as seen from that of a file.
pub(super) fn job_folder(job_dir: &Path, from: &Path) -> String {
    relative_path(if job_dir.as_os_str().is_empty() { Path::new(".") } else { job_dir }, from)
}

/// The bytes of a draft, as they are fingerprinted.
pub(super) fn draft_bytes(draft: &Draft) -> Result<Vec<u8>, PlanError> {
    postcard::to_stdvec(draft).map_err(|e| PlanError::Encode { format: "a draft", message: e.to_string() })
}

/// Reads a file.
pub(super) fn read(path: &Path) -> Result<Part, PartError> {
    let bytes = fs::read(path).map_err(|source| PartError::Read { path: path.to_owned(), source })?;
    let damaged = |problem: String| PartError::Damaged { path: path.to_owned(), problem };
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        // The beginning of a part that was cut short in its first line is still that.
        let cut = !bytes.is_empty() && MAGIC.starts_with(&bytes);
        return Err(if cut {
            damaged("it ends in its first line".into())
        } else {
            PartError::NotAPart { path: path.to_owned() }
        });
    };
    let short = || damaged(format!("it ends after {} bytes", bytes.len()));
    let (version, rest) = rest.split_first_chunk::<4>().ok_or_else(short)?;
    let version = u32::from_le_bytes(*version);
    if version != VERSION {
        return Err(PartError::Version { path: path.to_owned(), found: version });
    }
    let (header, rest) = block(rest).ok_or_else(short)?;
    let (body, rest) = block(rest).ok_or_else(short)?;
    let digest: &[u8; DIGEST] = rest.try_into().map_err(|_| match rest.len() < DIGEST {
        true => short(),
        false => damaged(format!("{} bytes follow its end", rest.len() - DIGEST)),
    })?;
    let found: [u8; DIGEST] = Sha256::digest(&bytes[..bytes.len() - DIGEST]).into();
    if found != *digest {
        return Err(damaged("its checksum is not that of its content".into()));
    }
    fn decoded<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
        postcard::from_bytes(bytes).map_err(|e| format!("its content cannot be read, {e}"))
    }
    let header = decoded(header).map_err(damaged)?;
    let body = decoded(body).map_err(damaged)?;
    Ok(Part { path: path.to_owned(), header, body })
}

/// A block with its length before it, and what follows.
fn block(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<8>()?;
    rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)
}

impl Part {
    /// Refuses a part of another stage.
    pub(super) fn expect(&self, kinds: &[Kind], command: &'static str) -> Result<(), PartError> {
        let Some(first) = kinds.first() else { return Ok(()) };
        if kinds.contains(&self.header.kind) {
            return Ok(());
        }
        let (found, wanted) = (self.header.kind.words(), first.words());
        Err(PartError::Stage { path: self.path.clone(), found, wanted, command })
    }

    /// The job's folder.
    pub(super) fn dir(&self) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(&self.header.dir)
    }
}

/// Entries of a plan leave keys out, which only a self-describing format can read back.
pub(in crate::plan) mod as_json {
    use serde::de::DeserializeOwned;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser};

    pub(in crate::plan) fn serialize<T: Serialize, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
        serde_json::to_string(value).map_err(ser::Error::custom)?.serialize(serializer)
    }

    pub(in crate::plan) fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<T, D::Error> {
        serde_json::from_str(&String::deserialize(deserializer)?).map_err(de::Error::custom)
    }
}
