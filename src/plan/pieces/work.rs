//! A folder that keeps what is finished of a shot, so that an interrupted plan goes on from there.
//!
//! Every file appears whole or not at all; what a killed process was writing is done again. The files are parts and drafts
//! like any others.

use super::super::make::Loaded;
use super::super::{PlanError, Watch};
use super::file::{Body, Header, Kind, Part, PartError, draft_bytes, job_folder, read, write};
use super::identity::Identity;
use super::{Draft, FrameState};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The folder of one job.
pub(super) struct Work<'a> {
    dir: PathBuf,
    identity: Identity,
    job_dir: String,
    watch: &'a Watch<'a>,
}

impl<'a> Work<'a> {
    /// Makes the folder, or finds it; clears away what a killed process was writing.
    ///
    /// # Errors
    /// [`PartError::Work`] when it is another job's.
    pub(super) fn open(
        dir: &Path,
        loaded: &Loaded,
        timings: bool,
        watch: &'a Watch<'a>,
    ) -> Result<Work<'a>, PlanError> {
        let failed = |source: io::Error| PartError::Write { path: dir.to_owned(), source };
        fs::create_dir_all(dir).map_err(failed)?;
        for file in fs::read_dir(dir).map_err(failed)?.flatten() {
            let name = file.file_name();
            let name = name.to_string_lossy();
            if name.starts_with(".lixel-") && name.ends_with(".tmp") {
                fs::remove_file(file.path()).map_err(failed)?;
            }
        }
        let identity = Identity::of(loaded, timings)?;
        let job_dir = job_folder(&loaded.given.dir, dir);
        let work = Work { dir: dir.to_owned(), identity, job_dir, watch };
        let mark = dir.join("job.mark");
        if work.found(&mark)?.is_none() {
            work.keep(&mark, Kind::Owner, [0; 32], None, Vec::new())?;
        }
        Ok(work)
    }

    /// A file of the folder; `None` where there is none, or it is damaged.
    fn found(&self, path: &Path) -> Result<Option<Part>, PlanError> {
        if !path.exists() {
            return Ok(None);
        }
        match read(path) {
            Ok(part) => match part.header.identity.difference(&self.identity) {
                None => Ok(Some(part)),
                Some(difference) => Err(PartError::Work { dir: self.dir.clone(), difference }.into()),
            },
            Err(error @ (PartError::Damaged { .. } | PartError::NotAPart { .. })) => {
                self.watch.note(&format!("{error}: doing so"));
                Ok(None)
            }
            Err(error) => Err(error.into()),
        }
    }

    fn keep(
        &self,
        path: &Path,
        kind: Kind,
        draft: [u8; 32],
        settled: Option<Draft>,
        frames: Vec<FrameState>,
    ) -> Result<(), PlanError> {
        let header = Header { kind, identity: self.identity.clone(), draft, dir: self.job_dir.clone() };
        write(path, &header, &Body { draft: settled, frames })
    }

    fn sample_path(&self, place: usize) -> PathBuf {
        self.dir.join(format!("sample-{place:06}.part"))
    }

    fn draft_path(&self, round: u32) -> PathBuf {
        self.dir.join(format!("round-{round}.draft"))
    }

    fn answer_path(&self, round: u32, place: usize) -> PathBuf {
        self.dir.join(format!("round-{round}-{place:06}.part"))
    }

    /// The sample of a frame, by place.
    pub(super) fn sample(&self, place: usize) -> Result<Option<FrameState>, PlanError> {
        let part = self.found(&self.sample_path(place))?;
        Ok(part.and_then(|p| p.body.frames.into_iter().find(|f| f.place == place)))
    }

    /// Keeps a sample.
    pub(super) fn keep_sample(&self, state: &FrameState) -> Result<(), PlanError> {
        self.keep(&self.sample_path(state.place), Kind::Sampled, [0; 32], None, vec![state.clone()])
    }

    /// The draft of the last round, with its frames.
    pub(super) fn draft(&self) -> Result<Option<(Draft, Vec<FrameState>)>, PlanError> {
        let mut last = None;
        for round in 1.. {
            let Some(part) = self.found(&self.draft_path(round))? else { break };
            let Body { draft: Some(draft), frames } = part.body else { break };
            last = Some((draft, frames));
        }
        Ok(last)
    }

    /// Keeps a draft.
    pub(super) fn keep_draft(&self, draft: &Draft, frames: &[FrameState]) -> Result<(), PlanError> {
        let fingerprint = self.identity.fingerprint(&draft_bytes(draft)?);
        self.keep(&self.draft_path(draft.round), Kind::Draft, fingerprint, Some(draft.clone()), frames.to_vec())
    }

    /// The answers of a frame, by place, to a draft.
    pub(super) fn answered(&self, draft: &Draft, place: usize) -> Result<Option<FrameState>, PlanError> {
        let path = self.answer_path(draft.round, place);
        let Some(part) = self.found(&path)? else { return Ok(None) };
        let same = part.header.draft == self.identity.fingerprint(&draft_bytes(draft)?);
        Ok(part.body.frames.into_iter().find(|f| same && f.place == place))
    }

    /// Keeps the answers of a frame.
    pub(super) fn keep_answer(&self, draft: &Draft, state: &FrameState) -> Result<(), PlanError> {
        let fingerprint = self.identity.fingerprint(&draft_bytes(draft)?);
        let path = self.answer_path(draft.round, state.place);
        self.keep(&path, Kind::Certified, fingerprint, None, vec![state.clone()])
    }
}
