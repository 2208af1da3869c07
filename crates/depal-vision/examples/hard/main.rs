//! Hard narrow cases. hard CASE GAPS FIRST SEEDS
use depal_frames::{DepthFrame, Point, Pose, Vector};
use depal_time::RandomStreams;
use depal_vision::{Detection, RegionOfInterest, VisionSettings, detect};
use generator::{DISTANCE, Noise, SLAB, at, cartons, frame};
use rendered::{Carton, HEIGHT, Layout};
mod generator;
#[path = "../../tests/rendered/mod.rs"]
mod rendered;

struct Scene {
    cartons: Vec<Carton>,
    sizes: Layout,
    region: bool,
    tape: Option<Vec<(usize, f64)>>,
    pick: Option<Vec<bool>>,
}

fn top_frame(c: &Carton) -> Pose {
    Pose::from_parts(Vector::new(c.x, c.y, c.top).into(), c.rotation())
}

/// share of top seen from the eye
fn visible(cs: &[Carton], i: usize) -> f64 {
    let eye = Point::from(at().translation.vector);
    let t = top_frame(&cs[i]);
    let (mut n, mut seen) = (0, 0);
    for a in 0..60 {
        for b in 0..60 {
            let p = t * Point::new(
                (f64::from(a) / 59.0 - 0.5) * (cs[i].size[0] - 0.002),
                (f64::from(b) / 59.0 - 0.5) * (cs[i].size[1] - 0.002),
                0.0,
            );
            n += 1;
            let hidden = cs.iter().enumerate().any(|(j, o)| {
                if j == i {
                    return false;
                }
                let q = top_frame(o).inverse();
                let (e, p) = (q * eye, q * p);
                let d = p - e;
                let (mut enter, mut leave) = (0.0f64, 0.999f64);
                for k in 0..3 {
                    let (lo, hi) = if k == 2 {
                        (-o.size[2], 0.0)
                    } else {
                        (-o.size[k] / 2.0, o.size[k] / 2.0)
                    };
                    let (x, y) = ((lo - e[k]) / d[k], (hi - e[k]) / d[k]);
                    enter = enter.max(x.min(y));
                    leave = leave.min(x.max(y));
                }
                enter < leave
            });
            seen += i32::from(!hidden);
        }
    }
    f64::from(seen) / f64::from(n)
}

fn covered(cs: &[Carton], i: usize) -> bool {
    let t = top_frame(&cs[i]);
    (0..30).any(|a| {
        (0..30).any(|b| {
            let p = t * Point::new(
                (f64::from(a) / 29.0 - 0.5) * cs[i].size[0] * 0.97,
                (f64::from(b) / 29.0 - 0.5) * cs[i].size[1] * 0.97,
                0.02,
            );
            cs.iter().enumerate().any(|(j, o)| {
                let q = top_frame(o).inverse() * p;
                j != i
                    && q.x.abs() < o.size[0] / 2.0
                    && q.y.abs() < o.size[1] / 2.0
                    && q.z < 0.0
                    && q.z > -o.size[2]
            })
        })
    })
}

fn scene(case: &str, gap: f64, seed: u64) -> Scene {
    let mut r = RandomStreams::new(seed).stream("hard");
    DISTANCE.set(2.0);
    SLAB.set([1.8, 1.4, 0.0]);
    let mut s = Scene {
        cartons: vec![],
        sizes: Layout::Regular,
        region: false,
        tape: None,
        pick: None,
    };
    let any = |r: &mut depal_time::RandomStream, n: usize| {
        [
            Layout::Regular20,
            Layout::RunningBond20,
            Layout::Pinwheel21,
            Layout::Brick20,
        ][(r.uniform(0.0, n as f64)) as usize]
    };
    match case {
        "gtilt" => {
            SLAB.set([1.2, 1.0, 0.0]);
            s.region = true;
            s.cartons = cartons(Layout::Regular, gap, seed);
            let n = seed as usize * 7 % s.cartons.len();
            let angle = (2.0 + 1.5 * (seed % 4) as f64).to_radians();
            s.cartons[n].tilt[0] = angle;
            s.cartons[n].top += s.cartons[n].size[1] / 2.0 * angle.sin();
        }
        "gupper" => {
            SLAB.set([1.2, 1.0, 0.0]);
            s.region = true;
            s.cartons = cartons(Layout::Regular, gap, seed);
            let n = seed as usize * 3 % s.cartons.len();
            let b = s.cartons[n];
            let upper = Carton {
                x: b.x * 0.7,
                y: b.y * 0.7,
                top: b.top + HEIGHT,
                yaw: 0.3 * (seed % 7) as f64,
                tilt: [0.0; 2],
                size: b.size,
            };
            let reach = 0.5 * upper.size[0].hypot(upper.size[1]) + 0.07;
            let mut pick: Vec<bool> = s
                .cartons
                .iter()
                .map(|c| {
                    let dx = ((c.x - upper.x).abs() - c.size[0] / 2.0).max(0.0);
                    let dy = ((c.y - upper.y).abs() - c.size[1] / 2.0).max(0.0);
                    dx.hypot(dy) >= reach
                })
                .collect();
            pick.push(true);
            s.cartons.push(upper);
            s.pick = Some(pick);
        }
        "gtape" => {
            SLAB.set([1.2, 1.0, 0.0]);
            s.region = true;
            let layout = if seed % 2 == 0 {
                Layout::Regular
            } else {
                Layout::Brick
            };
            s.sizes = layout;
            s.cartons = cartons(layout, gap, seed);
            let across = usize::from(seed % 4 < 2);
            s.tape = Some(vec![(across, 0.0); s.cartons.len()]);
        }
        "gmixed" => {
            SLAB.set([1.2, 1.0, 0.0]);
            s.region = true;
            s.sizes = Layout::Mixed;
            s.cartons = cartons(Layout::Mixed, gap, seed);
        }
        "tilt" => {
            let l = any(&mut r, 4);
            s.cartons = cartons(l, gap, seed);
            let n = r.uniform(0.0, s.cartons.len() as f64) as usize;
            let angle = r.uniform(2.0, 8.0).to_radians()
                * if r.uniform(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
            let ax = usize::from(r.uniform(0.0, 1.0) < 0.5);
            let c = &mut s.cartons[n];
            c.tilt[ax] += angle;
            c.top += c.size[1 - ax] / 2.0 * angle.sin().abs();
        }
        "twoh" => {
            DISTANCE.set(2.2);
            let l = any(&mut r, 2);
            let lo = cartons(l, gap, seed);
            let up = cartons(Layout::Regular20, gap, seed + 500_000);
            let mut order: Vec<usize> = (0..20).collect();
            let k = r.uniform(4.0, 12.0) as usize;
            for i in 0..20 {
                let j = i + r.uniform(0.0, (20 - i) as f64) as usize;
                order.swap(i, j);
            }
            s.cartons = lo;
            for &i in &order[..k] {
                let mut c = up[i];
                c.top += HEIGHT;
                s.cartons.push(c);
            }
        }
        "upper" => {
            DISTANCE.set(2.2);
            let l = any(&mut r, 3);
            s.cartons = cartons(l, gap, seed);
            s.cartons.push(Carton {
                x: r.uniform(-0.4, 0.4),
                y: r.uniform(-0.3, 0.3),
                top: HEIGHT,
                yaw: r.uniform(0.0, std::f64::consts::PI),
                tilt: [0.0; 2],
                size: [0.3, 0.2, 0.2],
            });
        }
        "tape" | "tapex" | "tapes" => {
            let l = any(&mut r, 3);
            s.cartons = cartons(l, gap, seed);
            let ax = usize::from(case == "tape");
            s.tape = Some(
                s.cartons
                    .iter()
                    .map(|_| {
                        let off = r.uniform(-0.01, 0.01);
                        if case == "tapes" {
                            if r.uniform(0.0, 1.0) < 0.5 {
                                (1, 1e9)
                            } else {
                                (usize::from(r.uniform(0.0, 1.0) < 0.5), off)
                            }
                        } else {
                            (ax, off)
                        }
                    })
                    .collect(),
            );
        }
        "plain" => {
            let l = any(&mut r, 4);
            s.cartons = cartons(l, gap, seed);
        }
        _ => panic!("case"),
    }
    s
}

struct Result {
    free: usize,
    found: usize,
    may: usize,
    wrong: usize,
    text: String,
    xy: Vec<f64>,
}

fn run(case: &str, gap: f64, seed: u64) -> Result {
    let s = scene(case, gap, seed);
    let mut picture: DepthFrame = frame(&s.cartons, Noise::White, false, seed);
    if let Some(tape) = &s.tape {
        let k = picture.intrinsics;
        for (i, z) in picture.depth.iter_mut().enumerate() {
            let (u, v) = ((i % k.width) as f64, (i / k.width) as f64);
            let p = at() * Point::from(k.ray(u, v) * f64::from(*z));
            let taped = s.cartons.iter().zip(tape).any(|(c, (across, off))| {
                let q = c.rotation().inverse() * (p - Point::new(c.x, c.y, c.top));
                q.z.abs() < 0.01
                    && (q[*across] - off).abs() < 0.024
                    && q[1 - across].abs() < c.size[1 - across] / 2.0
            });
            if taped {
                *z = 0.0;
            }
        }
    }
    let mut settings = VisionSettings::new(s.sizes.sizes()).suited_to(&picture);
    if s.region {
        settings.region = Some(RegionOfInterest {
            camera_from_region: at().inverse() * Pose::translation(0.0, 0.0, 0.15),
            half_extents: Vector::new(1.0, 1.0, 0.25),
        });
    }
    let d: Detection = detect(&picture, &settings);
    let share: Vec<f64> = (0..s.cartons.len())
        .map(|i| visible(&s.cartons, i))
        .collect();
    let cov: Vec<bool> = (0..s.cartons.len())
        .map(|i| covered(&s.cartons, i))
        .collect();
    let pick: Vec<bool> = s.pick.clone().unwrap_or_else(|| {
        (0..s.cartons.len())
            .map(|i| share[i] > 0.98 && !cov[i])
            .collect()
    });
    let mut used = vec![false; s.cartons.len()];
    let mut text = String::new();
    let mut wrong = 0;
    let mut xy = vec![];
    for b in &d.boxes {
        let p = at() * Point::from(b.camera_from_box.translation.vector);
        let near = |c: &Carton| {
            Vector::new(c.x - p.x, c.y - p.y, c.top - p.z).norm() < 0.008
                && (c.size[0] - b.size.length).abs() < 0.001
                && (c.size[1] - b.size.width).abs() < 0.001
        };
        match (0..s.cartons.len())
            .find(|&i| !used[i] && near(&s.cartons[i]) && !cov[i] && share[i] > 0.3)
        {
            Some(i) => {
                used[i] = true;
                xy.push((s.cartons[i].x - p.x).hypot(s.cartons[i].y - p.y));
            }
            None => {
                wrong += 1;
                let best = s
                    .cartons
                    .iter()
                    .enumerate()
                    .min_by(|a, b| {
                        let d = |c: &Carton| (c.x - p.x).hypot(c.y - p.y) + (c.top - p.z).abs();
                        d(a.1).total_cmp(&d(b.1))
                    })
                    .map(|(i, c)| {
                        (
                            i,
                            ((c.x - p.x) * 1e3, (c.y - p.y) * 1e3, (c.top - p.z) * 1e3),
                            share[i],
                            cov[i],
                        )
                    });
                text += &format!(
                    "    WRONG {:.0}x{:.0} at {:.0} {:.0} {:.0} conf {:.2} sides {} best {best:.1?}\n",
                    b.size.length * 1e3,
                    b.size.width * 1e3,
                    p.x * 1e3,
                    p.y * 1e3,
                    p.z * 1e3,
                    b.confidence,
                    b.proven_sides
                );
            }
        }
    }
    let (mut free, mut found, mut may) = (0, 0, 0);
    for i in 0..s.cartons.len() {
        if pick[i] {
            free += 1;
            if used[i] {
                found += 1;
            } else {
                text += &format!(
                    "    missed {i} at {:.0} {:.0} {:.0} vis {:.2} tilt {:.1} {:.1}\n",
                    s.cartons[i].x * 1e3,
                    s.cartons[i].y * 1e3,
                    s.cartons[i].top * 1e3,
                    share[i],
                    s.cartons[i].tilt[0].to_degrees(),
                    s.cartons[i].tilt[1].to_degrees()
                );
            }
        } else if used[i] {
            may += 1;
        }
    }
    if free > found || wrong > 0 {
        for x in &d.rejected {
            let p = at() * x.centre_in_camera;
            text += &format!(
                "    rejected {:?} at {:.0} {:.0} {:.0} area {:.3}\n",
                x.reason,
                p.x * 1e3,
                p.y * 1e3,
                p.z * 1e3,
                x.area
            );
        }
    }
    Result {
        free,
        found,
        may,
        wrong,
        text,
        xy,
    }
}

fn main() {
    let a: Vec<String> = std::env::args().collect();
    let first: u64 = a[3].parse().expect("first");
    let seeds: u64 = a[4].parse().expect("seeds");
    let verbose = std::env::var("V").is_ok();
    let threads: u64 = std::env::var("T")
        .ok()
        .and_then(|t| t.parse().ok())
        .unwrap_or(2);
    for case in a[1].split(',') {
        for gap in a[2].split(',') {
            let g: f64 = gap.parse::<f64>().expect("gap") * 1e-3;
            let mut all: Vec<(u64, Result)> = std::thread::scope(|scope| {
                let hs: Vec<_> = (0..threads)
                    .map(|t| {
                        scope.spawn(move || {
                            (first..first + seeds)
                                .filter(|s| s % threads == t)
                                .map(|s| (s, run(case, g, s)))
                                .collect::<Vec<_>>()
                        })
                    })
                    .collect();
                hs.into_iter()
                    .flat_map(|h| h.join().expect("thread"))
                    .collect()
            });
            all.sort_by_key(|x| x.0);
            let sum = |f: fn(&Result) -> usize| all.iter().map(|x| f(&x.1)).sum::<usize>();
            let mut xy: Vec<f64> = all.iter().flat_map(|x| x.1.xy.clone()).collect();
            xy.sort_by(f64::total_cmp);
            let q = |p: f64| {
                xy.get(((xy.len().max(1) - 1) as f64 * p) as usize)
                    .copied()
                    .unwrap_or(0.0)
                    * 1e3
            };
            let (free, found) = (sum(|r| r.free), sum(|r| r.found));
            println!(
                "{case:7} gap {gap} seeds {first}+{seeds}: found {found}/{free} {:.1}% extra {} WRONG {} xy {:.2}/{:.2}/{:.2}",
                100.0 * found as f64 / free.max(1) as f64,
                sum(|r| r.may),
                sum(|r| r.wrong),
                q(0.5),
                q(0.95),
                q(1.0)
            );
            if verbose {
                for (s, r) in &all {
                    if r.found < r.free || r.wrong > 0 {
                        println!(
                            "  seed {s}: {}/{} wrong {}\n{}",
                            r.found,
                            r.free,
                            r.wrong,
                            r.text.trim_end()
                        );
                    }
                }
            }
        }
    }
}
