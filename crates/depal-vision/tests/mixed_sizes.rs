//! Layers of cartons of several sizes, of which two of one cover just what one of another does: rows of random depth and
//! length. With gaps narrower than a pixel only some seams show; what two readings may mean is not reported.

use depal_frames::{BoxSize, Vector};
use depal_time::RandomStreams;
use depal_vision::{VisionSettings, detect};
use generator::{Noise, at, frame};
use rendered::{Carton, HEIGHT, Score};

mod generator;
mod rendered;

/// Long and short sides, millimetres.
type Sizes = &'static [[f64; 2]];

/// Two of the second are one of the first.
const HALVES: Sizes = &[[300.0, 200.0], [200.0, 150.0]];
/// Two of the second are one of the first, two of the third one of the second.
const QUARTERS: Sizes = &[[600.0, 400.0], [400.0, 300.0], [300.0, 200.0]];

/// Rows over 1.2 x 1.0 m, `gap` metres apart; heights and tilts of cartons differ by `relief` times those of
/// [`generator::cartons`].
fn rows(sizes: Sizes, gap: f64, relief: f64, seed: u64) -> Vec<Carton> {
    const LAYER: [f64; 2] = [1.2, 1.0];
    let mut r = RandomStreams::new(seed).stream("rows");
    let mut pick = |n: usize| (r.uniform(0.0, n as f64) as usize).min(n - 1);
    // Extents along a row and across it, for both ways round.
    let ways: Vec<[f64; 2]> = sizes
        .iter()
        .flat_map(|&[a, b]| [[a * 1e-3, b * 1e-3], [b * 1e-3, a * 1e-3]])
        .collect();
    let mut places = Vec::new();
    let mut y = 0.0;
    loop {
        let mut depths: Vec<f64> = ways.iter().map(|way| way[1]).collect();
        depths.retain(|depth| y + depth <= LAYER[1] + 0.02);
        depths.sort_by(f64::total_cmp);
        depths.dedup();
        if depths.is_empty() {
            break;
        }
        let depth = depths[pick(depths.len())];
        let mut row = Vec::new();
        let mut x = 0.0;
        loop {
            let mut fitting = ways.clone();
            fitting.retain(|way| (way[1] - depth).abs() < 1e-6 && x + way[0] <= LAYER[0] + 0.01);
            if fitting.is_empty() {
                break;
            }
            let length = fitting[pick(fitting.len())][0];
            row.push((x + length / 2.0, length));
            x += length + gap;
        }
        let middle = (x - gap) / 2.0;
        places.extend(row.iter().map(|&(at, length)| {
            let centre = [at - middle, y + depth / 2.0 - LAYER[1] / 2.0];
            (centre, [length, depth])
        }));
        y += depth + gap;
    }
    let degree = relief * 1f64.to_radians();
    let shifted = 0.0002 * f64::from(u8::from(gap > 0.002));
    places
        .into_iter()
        .map(|([x, y], [length, depth])| {
            let turned = depth > length;
            let mut carton = Carton {
                x: 0.0,
                y: 0.0,
                top: 0.0,
                yaw: if turned {
                    std::f64::consts::FRAC_PI_2
                } else {
                    0.0
                },
                tilt: [r.normal(1.0) * 0.2 * degree, r.normal(1.0) * 0.2 * degree],
                size: [length.max(depth), length.min(depth), HEIGHT],
            };
            let centre = Vector::new(
                x + r.normal(1.0) * shifted,
                y + r.normal(1.0) * shifted,
                relief * r.uniform(-0.001, 0.001) - HEIGHT / 2.0,
            );
            let top = centre + carton.rotation() * Vector::z() * (HEIGHT / 2.0);
            (carton.x, carton.y, carton.top) = (top.x, top.y, top.z);
            carton
        })
        .collect()
}

fn score(sizes: Sizes, gap_mm: f64, relief: f64, seeds: std::ops::Range<u64>) -> Score {
    let known: Vec<BoxSize> = sizes
        .iter()
        .map(|&[a, b]| BoxSize::from_mm([a, b, HEIGHT * 1e3]))
        .collect();
    let mut score = Score::default();
    for seed in seeds {
        let cartons = rows(sizes, gap_mm * 1e-3, relief, seed);
        let frame = frame(&cartons, Noise::White, false, seed);
        let settings = VisionSettings::new(known.clone()).suited_to(&frame);
        score.add(&at(), &cartons, &detect(&frame, &settings).boxes);
    }
    score
}

fn demand(name: &str, score: &Score, share: f64) {
    let line = score.line();
    assert_eq!(score.false_positives, 0, "{name}: {line}");
    let least = share * score.wanted as f64;
    assert!(score.found as f64 >= least, "{name}: {line}");
    let worst = rendered::quantile(&score.xy_mm, 1.0);
    assert!(score.found == 0 || worst <= 3.0, "{name}: {worst:.2} mm");
}

/// Without seams between them two halves are one plane only by chance: no layer needs all its seams.
#[test]
fn what_two_sizes_cover_alike_is_told_by_heights() {
    for (name, sizes) in [("halves", HALVES), ("quarters", QUARTERS)] {
        let narrow = score(sizes, 1.0, 1.0, 20_000..20_006);
        demand(&format!("{name}, 1 mm"), &narrow, 0.95);
        let wide = score(sizes, 3.0, 1.0, 20_000..20_002);
        demand(&format!("{name}, 3 mm"), &wide, 0.95);
    }
}

/// Heights that hardly differ leave it open: no box may be taken for two or two for one, however many are refused.
#[test]
fn what_neither_heights_nor_gaps_tell_is_refused() {
    for (name, sizes) in [("halves", HALVES), ("quarters", QUARTERS)] {
        for relief in [0.1, 0.3] {
            let score = score(sizes, 1.0, relief, 20_010..20_013);
            demand(&format!("{name}, relief {relief}"), &score, 0.0);
        }
    }
}

/// Gaps wider than a pixel cannot hide: heights need not differ then.
#[test]
fn what_gaps_tell_needs_no_heights() {
    for (name, sizes) in [("halves", HALVES), ("quarters", QUARTERS)] {
        let score = score(sizes, 5.0, 0.0, 20_020..20_022);
        demand(name, &score, 0.95);
    }
}
