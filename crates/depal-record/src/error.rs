use std::path::PathBuf;

/// Why a recording could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file system refused.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The recording library refused.
    #[error("cannot write the recording {}: {message}", path.display())]
    Recording {
        /// The file.
        path: PathBuf,
        /// The reason.
        message: String,
    },
}
