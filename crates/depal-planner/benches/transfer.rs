//! Ways among boxes: one state, one edge, the 44 transfers off a pallet, and the hard cells in full.
//!
//! The sets are run once in full and summed up in one line each before the timed runs; with `LISTED` set, line by line.
#![allow(missing_docs)]
// A bench reads the clock; that is what it is for.
#![allow(clippy::disallowed_methods)]

use std::time::Instant;

use criterion::{Criterion, criterion_group, criterion_main};
use depal_planner::{TransferChecker, TransferGoal, plan_transfer};

#[path = "../tests/transfers/cell.rs"]
mod cell;
#[path = "../tests/transfers/hard_set.rs"]
mod hard_set;
#[path = "../tests/transfers/oracle/mod.rs"]
mod oracle;

use cell::{goal, obstacles, scene, transfers};
use hard_set::Question;
use oracle::Oracle;

/// Questions of every kind.
const HARD_PER_KIND: usize = 20;

fn pallet() -> Vec<Question> {
    let question = |(name, layers, slot, start)| Question {
        name,
        scene: scene(obstacles(layers, slot)),
        start,
        goal: goal(),
    };
    transfers().into_iter().map(question).collect()
}

fn at(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len() - 1;
    values
        .get((last as f64 * share) as usize)
        .copied()
        .unwrap_or(f64::NAN)
}

/// Plans a set once, checks every way with the oracle and prints what is promised of it.
fn summary(name: &str, questions: &[Question]) {
    let (mut plan_ms, mut ratios, mut points) = (Vec::new(), Vec::new(), Vec::new());
    let (mut touches, mut unsolved) = (0, Vec::new());
    for question in questions {
        let before = Instant::now();
        let goal = TransferGoal::Joints(question.goal);
        let outcome = plan_transfer(&question.scene, &question.start, &goal);
        plan_ms.push(before.elapsed().as_secs_f64() * 1e3);
        match outcome {
            Ok(plan) => {
                if std::env::var_os("LISTED").is_some() {
                    println!(
                        "  {}: {:.3}, {} points, {:.1} mm, {}, {:.2} ms",
                        question.name,
                        plan.motion_time / plan.lower_bound,
                        plan.waypoints.len(),
                        plan.min_clearance * 1e3,
                        plan.found_by,
                        plan_ms[plan_ms.len() - 1],
                    );
                }
                ratios.push(plan.motion_time / plan.lower_bound);
                points.push(plan.waypoints.len() as f64);
                touches += usize::from(Oracle::new(&question.scene, 0.0).check(&plan).is_err());
            }
            Err(refusal) => unsolved.push(format!("{}: {}", question.name, refusal.reason)),
        }
    }
    println!(
        "{name}: {} of {} solved, {touches} touch, plan {:.2} ms median {:.1} p95 {:.1} most; \
         motion {:.3} x the bound median {:.3} p95 {:.3} most; points {} median {} most",
        ratios.len(),
        questions.len(),
        at(&mut plan_ms, 0.5),
        at(&mut plan_ms, 0.95),
        at(&mut plan_ms, 1.0),
        at(&mut ratios, 0.5),
        at(&mut ratios, 0.95),
        at(&mut ratios, 1.0),
        at(&mut points, 0.5),
        at(&mut points, 1.0),
    );
    for line in unsolved {
        println!("  unsolved: {line}");
    }
}

fn bench_transfers(criterion: &mut Criterion) {
    let set = pallet();
    summary("44 transfers", &set);
    let hard = hard_set::questions(1, HARD_PER_KIND);
    for (kind, part) in hard_set::KINDS.iter().zip(hard.chunks(HARD_PER_KIND)) {
        summary(kind, part);
    }
    summary("closed cells", &hard_set::unsolvable(1, 10));
    let question = &set[5];
    let checker = TransferChecker::new(&question.scene);
    let (start, goal) = (question.start, question.goal);
    criterion.bench_function("state check, 105 obstacles", |bencher| {
        let states: Vec<_> = (0..200)
            .map(|i| start.lerp(&goal, f64::from(i) / 199.0))
            .collect();
        let mut next = 0;
        bencher.iter(|| {
            next = (next + 1) % states.len();
            checker.is_free(&states[next])
        });
    });
    let mut raised = start;
    (raised[1], raised[2]) = (-0.2, -0.2);
    raised[4] += start[1] + start[2] + 0.4;
    assert!(checker.line_is_free(&start, &raised, 0.05));
    criterion.bench_function("edge check, a free lift in steps of 0.05 rad", |bencher| {
        bencher.iter(|| checker.line_is_free(&start, &raised, 0.05));
    });
    criterion.bench_function("scene made ready, 105 obstacles", |bencher| {
        bencher.iter(|| TransferChecker::new(&question.scene).is_free(&start));
    });
    let mut turn = 0;
    criterion.bench_function("a transfer off the pallet, certified", |bencher| {
        bencher.iter(|| {
            turn = (turn + 1) % set.len();
            let goal = TransferGoal::Joints(set[turn].goal);
            plan_transfer(&set[turn].scene, &set[turn].start, &goal)
        });
    });
}

criterion_group!(benches, bench_transfers);
criterion_main!(benches);
