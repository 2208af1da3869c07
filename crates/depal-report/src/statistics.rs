/// The `share` quantile of the samples (`0.5` median, `0.95` p95): the smallest sample that at least
/// `share` of all samples do not exceed (nearest rank), so always a value that was really seen.
///
/// With `n` sorted samples it is number `ceil(share * n)`, at least the first.
/// Samples that are not finite are left out; `None` when none is left.
pub fn percentile(samples: &[f64], share: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = finite(samples).collect();
    sorted.sort_by(f64::total_cmp);
    // 0.95 * 20 is a hair above 19 in binary; that hair is no reason to take the next sample.
    let rank = (share.clamp(0.0, 1.0) * sorted.len() as f64 - 1e-9).ceil();
    let position = (rank.max(1.0) as usize).min(sorted.len());
    sorted.get(position.checked_sub(1)?).copied()
}

/// Arithmetic mean of the finite samples; `None` when there is none.
pub fn mean(samples: &[f64]) -> Option<f64> {
    let count = finite(samples).count();
    (count > 0).then(|| finite(samples).sum::<f64>() / count as f64)
}

/// Largest finite sample.
pub(crate) fn largest(samples: &[f64]) -> Option<f64> {
    finite(samples).reduce(f64::max)
}

fn finite(samples: &[f64]) -> impl Iterator<Item = f64> + '_ {
    samples.iter().copied().filter(|sample| sample.is_finite())
}

/// `part / whole`, `None` for an empty whole.
pub(crate) fn ratio(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}
