//! Time of one estimation on one thread: 1280 x 1024, eight cartons on a pallet.

#![allow(missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use depal_vision::{VisionSettings, detect};

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

fn bench(c: &mut Criterion) {
    let settings = VisionSettings::new(vec![synthetic::carton()]);
    let mut group = c.benchmark_group("detect");
    group.sample_size(20);
    for (layer, gap_mm) in [(6, 4.0), (6, 0.0), (1, 4.0), (1, 2.0)] {
        let frame = synthetic::stack(layer, gap_mm * 1e-3, 1).frame(1);
        group.bench_function(format!("layer_{layer}_gap_{gap_mm}_mm"), |b| {
            b.iter(|| detect(&frame, &settings));
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
