//! Long computing beside the clock: it is done elsewhere, and its result is handed over when its
//! simulated time has come. Nothing depends on how long it really took.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use crate::event::EventKind;
use crate::score::Score;
use crate::spec::CellSpec;
use crate::vision_side::Work;

/// A piece of computing, to be run once on any thread.
pub type Errand = Box<dyn FnOnce() + Send>;

/// Takes errands: runs each of them at once, or hands it to another thread.
pub type Errands = Arc<dyn Fn(Errand) + Send + Sync>;

/// What an errand came to.
pub(crate) struct Computed {
    /// Poses or a path.
    pub(crate) work: Work,
    /// What happened on the way.
    pub(crate) events: Vec<EventKind>,
}

/// A result that is on its way.
pub(crate) struct Computing {
    result: Receiver<Computed>,
    arrived: Option<Box<Computed>>,
    is_lost: bool,
}

impl Computing {
    /// Whether [`wait`](Self::wait) would return at once.
    pub(crate) fn is_there(&mut self) -> bool {
        if self.arrived.is_none() && !self.is_lost {
            match self.result.try_recv() {
                Ok(computed) => self.arrived = Some(Box::new(computed)),
                Err(TryRecvError::Empty) => return false,
                Err(TryRecvError::Disconnected) => self.is_lost = true,
            }
        }
        true
    }

    /// The result; `None` if the errand died.
    pub(crate) fn wait(self) -> Option<Computed> {
        match self.arrived {
            Some(computed) => Some(*computed),
            None => self.result.recv().ok(),
        }
    }
}

/// Where the long computing of a vision side is done.
#[derive(Clone)]
pub(crate) struct Elsewhere {
    pub(crate) spec: Arc<CellSpec>,
    pub(crate) errands: Errands,
}

impl Elsewhere {
    /// Hands `compute` away.
    pub(crate) fn compute(
        &self,
        compute: impl FnOnce(&CellSpec, &mut Score, &mut Vec<EventKind>) -> Work + Send + 'static,
    ) -> Computing {
        let spec = Arc::clone(&self.spec);
        let (sender, result) = channel();
        (self.errands)(Box::new(move || {
            let (mut score, mut events) = (Score::default(), Vec::new());
            let work = compute(&spec, &mut score, &mut events);
            // Nobody waits any more if the run was stopped.
            let _ = sender.send(Computed { work, events });
        }));
        Computing {
            result,
            arrived: None,
            is_lost: false,
        }
    }
}
