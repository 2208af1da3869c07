//! The first success in a fixed order, looked for by all threads.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

/// Candidates of one batch, after the first one has failed by itself.
///
/// It does not follow the number of threads. The first candidate mostly wins, and then none beside it costs anything.
const BATCH: usize = 4;

/// Tries candidates in batches until one succeeds: gives what those before it failed with, in their order, and the success.
///
/// A candidate is left out when one before it has succeeded already, so a single thread tries no more than it has to.
/// Whatever the threads do, all before the first success are tried to their end, and those after it leave no trace.
pub(crate) fn first_in_order<T: Send, S: Send, F: Send>(
    candidates: Vec<T>,
    attempt: impl Fn(T) -> Result<S, F> + Sync,
) -> (Vec<F>, Option<S>) {
    let mut failures = Vec::new();
    let mut candidates = candidates.into_iter();
    let mut size = 1;
    loop {
        let batch: Vec<T> = candidates.by_ref().take(size).collect();
        if batch.is_empty() {
            return (failures, None);
        }
        let first = AtomicUsize::new(usize::MAX);
        let outcomes: Vec<Option<Result<S, F>>> = batch
            .into_par_iter()
            .enumerate()
            .map(|(place, candidate)| {
                if first.load(Ordering::Relaxed) < place {
                    return None;
                }
                let outcome = attempt(candidate);
                if outcome.is_ok() {
                    first.fetch_min(place, Ordering::Relaxed);
                }
                Some(outcome)
            })
            .collect();
        for outcome in outcomes {
            match outcome.expect("only those after the first success are left out") {
                Ok(success) => return (failures, Some(success)),
                Err(failure) => failures.push(failure),
            }
        }
        size = BATCH;
    }
}
