//! Where pictures and plans are computed.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};

use depal_cell::station::{Errand, Errands};

use crate::NetError;

/// Here and now: for replays, where nobody waits.
pub fn compute_at_once() -> Errands {
    Arc::new(run)
}

/// On a thread of its own, one after another. It ends when the station is dropped.
pub fn compute_on_thread() -> Result<Errands, NetError> {
    let (sender, errands) = channel::<Errand>();
    std::thread::Builder::new()
        .name("computing".to_owned())
        .spawn(move || errands.into_iter().for_each(run))
        .map_err(NetError::Start)?;
    let sender: Mutex<Sender<Errand>> = Mutex::new(sender);
    Ok(Arc::new(move |errand| {
        let sender = sender.lock().expect("nothing panics while it holds this");
        // Fails only while the process ends.
        let _ = sender.send(errand);
    }))
}

/// An errand that panics is our bug; the station notices that its result is lost, and all else goes on.
fn run(errand: Errand) {
    let _ = catch_unwind(AssertUnwindSafe(errand));
}
