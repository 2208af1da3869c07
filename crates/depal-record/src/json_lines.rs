use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use depal_cell::event::Event;
use depal_cell::observer::{CaptureView, Observer, Snapshot};

use crate::RecordError;

/// The event log as JSON lines: one event a line, in order, nothing else.
#[derive(Debug)]
pub struct JsonLines {
    writer: BufWriter<File>,
    path: PathBuf,
    partial: PathBuf,
    failure: Option<std::io::Error>,
}

impl JsonLines {
    /// Begins `path` under a temporary name beside it.
    pub fn create(path: &Path) -> Result<Self, RecordError> {
        let partial = path.with_extension("jsonl.partial");
        let file = File::create(&partial).map_err(|source| RecordError::Write {
            path: path.to_owned(),
            source,
        })?;
        Ok(Self {
            writer: BufWriter::new(file),
            path: path.to_owned(),
            partial,
            failure: None,
        })
    }

    /// Flushes and gives the file its name. Reports the first write error of the run.
    pub fn finish(mut self) -> Result<(), RecordError> {
        let flushed = match self.failure.take() {
            Some(error) => Err(error),
            None => self.writer.flush(),
        };
        flushed
            .and_then(|()| std::fs::rename(&self.partial, &self.path))
            .map_err(|source| RecordError::Write {
                path: self.path,
                source,
            })
    }
}

impl Observer for JsonLines {
    fn on_event(&mut self, event: &Event) {
        if self.failure.is_some() {
            return;
        }
        let line = serde_json::to_string(event).expect("events hold no maps with non-string keys");
        self.failure = writeln!(self.writer, "{line}").err();
    }

    fn on_snapshot(&mut self, _: &Snapshot) {}

    fn on_capture(&mut self, _: &CaptureView<'_>) {}
}
