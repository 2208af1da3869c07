//! Loops for the widest vectors that the machine has; the same bits with any.

/// Work that is done once.
struct Job<F>(F);

impl<R, F: FnMut() -> R> pulp::WithSimd for Job<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(mut self, _: S) -> R {
        // Not as `FnOnce`: through that, what only borrows is called from afar and made for no vectors at all.
        (self.0)()
    }
}

/// Does the work, whose closure is to be marked `#[inline(always)]`, as all that it calls.
#[inline(always)]
pub fn with_widest_vectors<R>(work: impl FnMut() -> R) -> R {
    pulp::Arch::new().dispatch(Job(work))
}
