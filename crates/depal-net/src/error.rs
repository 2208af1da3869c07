use std::net::SocketAddr;

/// What the machine does not let us do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NetError {
    /// A port cannot be listened on.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// What the system says.
        source: std::io::Error,
    },
    /// Threads, signals or the event loop.
    #[error("cannot start serving: {0}")]
    Start(#[source] std::io::Error),
    /// The journal cannot be written, as on a full disk.
    #[error("cannot write the journal: {0}")]
    Journal(#[source] std::io::Error),
    /// The thread that owns the station died.
    #[error("the server stopped by itself: this is a bug of depal")]
    Died,
}
