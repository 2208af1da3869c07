//! The session of the station that a data block talks to.

use std::net::SocketAddr;

use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use crate::brain::{BrainLink, Client, ToBrain, Turn};

/// One client of the station for the life of the server, whoever reaches the block.
pub(crate) struct SessionLink {
    client: Client,
    to_brain: BrainLink,
    /// Until the first connection.
    sender: Option<UnboundedSender<Turn>>,
    from_brain: UnboundedReceiver<Turn>,
}

impl SessionLink {
    pub(crate) fn new(client: Client, to_brain: BrainLink) -> Self {
        let (sender, from_brain) = unbounded_channel();
        Self {
            client,
            to_brain,
            sender: Some(sender),
            from_brain,
        }
    }

    /// The block is in touch with `peer`; the first time this opens the session.
    pub(crate) fn open(&mut self, peer: SocketAddr) {
        if let Some(sender) = self.sender.take() {
            // The brain is gone only while the process ends; so below.
            self.to_brain
                .send(ToBrain::Connected(self.client, peer, sender));
        }
    }

    pub(crate) fn send(&self, request: Vec<u8>) {
        self.to_brain.send(ToBrain::Bytes(self.client, request));
    }

    /// The next replies; never any before the session is open.
    pub(crate) async fn recv(&mut self) -> Vec<Vec<u8>> {
        match self.from_brain.recv().await {
            Some(turn) => turn.replies,
            None => std::future::pending().await,
        }
    }

    /// Replies that are there already.
    pub(crate) fn try_recv(&mut self) -> Option<Vec<Vec<u8>>> {
        self.from_brain.try_recv().ok().map(|turn| turn.replies)
    }
}
