//! What is shown and kept of a flight, as the options of `run` and `hil` ask for.

use super::{Failure, RunArgs, created};
use host_sim::{FrameRecording, Logbook, Observer, Snapshot, TreeLog};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::PathBuf;

type Out = BufWriter<File>;

/// The observers of a flight.
pub(super) struct Kept {
    shown: Box<dyn Observer>,
    moves: Option<Logbook<Out>>,
    frames: Option<FrameRecording<Out>>,
    trees: Option<TreeLog<Out>>,
}

impl RunArgs {
    /// Creates the files that are to be kept.
    pub(super) fn keep(&self, shown: Box<dyn Observer>) -> Result<Kept, Failure> {
        let file = |path: &Option<PathBuf>| path.as_deref().map(created).transpose();
        Ok(Kept {
            shown,
            moves: file(&self.log)?.map(Logbook::new),
            frames: file(&self.frames)?.map(FrameRecording::new),
            trees: file(&self.tree_log)?.map(TreeLog::new),
        })
    }
}

impl Kept {
    /// Ends the files.
    pub(super) fn finish(self) -> io::Result<()> {
        self.moves.map(Logbook::finish).transpose()?;
        self.frames.map(FrameRecording::finish).transpose()?;
        self.trees.map(TreeLog::finish).transpose()?;
        Ok(())
    }
}

impl Observer for Kept {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        self.shown.observe(snapshot);
        self.moves.iter_mut().for_each(|moves| moves.observe(snapshot));
        self.frames.iter_mut().for_each(|frames| frames.observe(snapshot));
        self.trees.iter_mut().for_each(|trees| trees.observe(snapshot));
    }
}
