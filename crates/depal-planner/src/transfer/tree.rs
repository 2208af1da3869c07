//! Two trees that grow towards each other (J. Kuffner, S. LaValle, "RRT-Connect", ICRA 2000).

use std::f64::consts::PI;

use depal_frames::JointPositions;
use depal_time::RandomStream;

use super::{law::distance, route::Checker};

/// Longest step by which a tree grows, rad.
const RANGE: f64 = 1.0;
/// Random short-cuts tried on a found way.
const SHORT_CUTS: usize = 60;
/// Most waypoints of a way, ends included.
const MOST_POINTS: usize = 9;

struct Tree {
    states: Vec<JointPositions>,
    parents: Vec<usize>,
}

impl Tree {
    fn nearest(&self, to: &JointPositions) -> usize {
        let mut best = (f64::INFINITY, 0);
        for (i, state) in self.states.iter().enumerate() {
            let far = distance(state, to);
            if far < best.0 {
                best = (far, i);
            }
        }
        best.1
    }

    fn to_root(&self, mut index: usize) -> Vec<JointPositions> {
        let mut way = vec![self.states[index]];
        while index != 0 {
            index = self.parents[index];
            way.push(self.states[index]);
        }
        way
    }

    /// One step towards a posture; none when that step is not free.
    fn extend(&mut self, checker: &mut Checker, to: &JointPositions) -> Option<usize> {
        let nearest = self.nearest(to);
        let from = self.states[nearest];
        let way = distance(&from, to);
        if way < 1e-9 {
            return None;
        }
        let next = if way <= RANGE {
            *to
        } else {
            from.lerp(to, RANGE / way)
        };
        if !checker.edge_is_free(&from, &next) {
            return None;
        }
        self.states.push(next);
        self.parents.push(nearest);
        Some(self.states.len() - 1)
    }
}

/// A free chain of straight joint moves, shortened; none when the checks are spent. Adds up the random postures drawn.
pub(crate) fn grow(
    checker: &mut Checker,
    from: &JointPositions,
    to: &JointPositions,
    random: &mut RandomStream,
    rounds: &mut usize,
) -> Option<Vec<JointPositions>> {
    let root = |at: &JointPositions| Tree {
        states: vec![*at],
        parents: vec![0],
    };
    let mut trees = [root(from), root(to)];
    // A tenth is kept for shortening.
    let last_check = checker.most_checks - checker.most_checks / 10;
    let mut turn = 0;
    while checker.checks < last_check {
        turn += 1;
        *rounds += 1;
        let (here, there) = (turn % 2, (turn + 1) % 2);
        let drawn = draw(checker, from, to, turn, random);
        let Some(new) = trees[here].extend(checker, &drawn) else {
            continue;
        };
        let target = trees[here].states[new];
        while let Some(step) = trees[there].extend(checker, &target) {
            if distance(&trees[there].states[step], &target) > 1e-9 {
                continue;
            }
            let mut way = trees[here].to_root(new);
            way.reverse();
            way.extend(trees[there].to_root(step).into_iter().skip(1));
            if here == 1 {
                way.reverse();
            }
            return Some(shorten(checker, way, random));
        }
    }
    None
}

/// A random posture inside the limits, every other time near the box that start and goal span;
/// joints that can turn all round stay within half a turn of the ends.
fn draw(
    checker: &Checker,
    from: &JointPositions,
    to: &JointPositions,
    turn: usize,
    random: &mut RandomStream,
) -> JointPositions {
    let near = turn % 4 < 2;
    let mut drawn = *from;
    for (i, limit) in checker.scene.arm.limits().iter().enumerate() {
        let room = if near { 0.9 } else { PI };
        let low = limit.lower.max(from[i].min(to[i]) - room);
        let high = limit.upper.min(from[i].max(to[i]) + room);
        drawn[i] = random.uniform(low, high);
    }
    drawn
}

/// Leaves out vertices and cuts between random points where that is free and shorter in time.
fn shorten(
    checker: &mut Checker,
    mut way: Vec<JointPositions>,
    random: &mut RandomStream,
) -> Vec<JointPositions> {
    drop_vertices(checker, &mut way);
    for _ in 0..SHORT_CUTS {
        if way.len() < 3 || checker.spent() {
            break;
        }
        let mut point = || {
            let along = random.uniform(0.0, (way.len() - 1) as f64);
            let edge = (along as usize).min(way.len() - 2);
            (edge, way[edge].lerp(&way[edge + 1], along - edge as f64))
        };
        let (mut a, mut b) = (point(), point());
        if a.0 > b.0 {
            std::mem::swap(&mut a, &mut b);
        }
        if a.0 == b.0 || !checker.edge_is_free(&a.1, &b.1) {
            continue;
        }
        let mut shorter: Vec<JointPositions> = way[..=a.0].to_vec();
        shorter.extend([a.1, b.1]);
        shorter.extend_from_slice(&way[b.0 + 1..]);
        let length = |points: &[JointPositions]| -> f64 {
            points.windows(2).map(|w| distance(&w[0], &w[1])).sum()
        };
        if length(&shorter) < length(&way) && shorter.len() <= MOST_POINTS.max(way.len()) {
            way = shorter;
        }
    }
    drop_vertices(checker, &mut way);
    way
}

fn drop_vertices(checker: &mut Checker, way: &mut Vec<JointPositions>) {
    let mut at = 0;
    while at + 2 < way.len() {
        let far = (at + 2..way.len())
            .rev()
            .find(|&far| checker.edge_is_free(&way[at], &way[far]));
        if let Some(far) = far {
            way.drain(at + 1..far);
        }
        at += 1;
    }
}
