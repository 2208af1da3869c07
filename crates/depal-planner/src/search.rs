use depal_frames::JointPositions;
use depal_time::{RandomStream, RandomStreams};

use crate::{
    contact::Check,
    path::{Blocked, drawn_in, edge_is_free, touch_on_way},
    request::PlannerSettings,
    timing::Trapezoid,
};

/// Longest step by which a tree grows, rad.
const RANGE: f64 = 0.6;
/// Random short-cuts tried on a found way.
const SHORT_CUTS: usize = 60;

struct Tree {
    states: Vec<JointPositions>,
    parents: Vec<usize>,
}

impl Tree {
    fn new(root: JointPositions) -> Self {
        Self {
            states: vec![root],
            parents: vec![0],
        }
    }

    fn nearest(&self, to: &JointPositions) -> usize {
        (0..self.states.len())
            .min_by(|&a, &b| {
                distance(&self.states[a], to).total_cmp(&distance(&self.states[b], to))
            })
            .expect("a tree has its root")
    }

    /// From a state down to the root.
    fn to_root(&self, mut index: usize) -> Vec<JointPositions> {
        let mut way = vec![self.states[index]];
        while index != 0 {
            index = self.parents[index];
            way.push(self.states[index]);
        }
        way
    }
}

fn distance(a: &JointPositions, b: &JointPositions) -> f64 {
    a.iter()
        .zip(b.iter())
        .map(|(x, y)| (x - y) * (x - y))
        .sum::<f64>()
        .sqrt()
}

/// Two trees that grow towards each other (J. Kuffner, S. LaValle, "RRT-Connect", ICRA 2000), then short-cuts by time.
///
/// The seed is fixed, so the same question gets the same way. Where the tool hangs upright at both ends,
/// only upright postures are drawn, and between two of them it stays upright; otherwise all joints are drawn freely.
pub(crate) fn search(
    check: &Check,
    from: &JointPositions,
    to: &JointPositions,
    upright: Option<f64>,
    settings: &PlannerSettings,
) -> Option<Vec<JointPositions>> {
    let mut random = RandomStreams::new(settings.search_seed).stream("planner search");
    let mut trees = [Tree::new(*from), Tree::new(*to)];
    for round in 0..settings.search_rounds {
        let (here, there) = (round % 2, (round + 1) % 2);
        let Some(drawn) = draw(check, from, to, &mut random) else {
            continue;
        };
        let Some(new) = extend(&mut trees[here], &drawn, check, upright, settings) else {
            continue;
        };
        let target = trees[here].states[new];
        // The other tree tries to come all the way.
        while let Some(step) = extend(&mut trees[there], &target, check, upright, settings) {
            if distance(&trees[there].states[step], &target) > 1e-9 {
                continue;
            }
            let mut way = trees[here].to_root(new);
            way.reverse();
            way.extend(trees[there].to_root(step).into_iter().skip(1));
            if here == 1 {
                way.reverse();
            }
            let way = shorten(way, check, upright, settings, &mut random);
            return match touch_on_way(check, &way, upright, settings) {
                Ok(()) => Some(way),
                Err(Blocked::Touches(_) | Blocked::Leans) => None,
            };
        }
    }
    None
}

/// A random posture inside the limits; axes 4 and 6 stay within half a turn of the ends.
fn draw(
    check: &Check,
    from: &JointPositions,
    to: &JointPositions,
    random: &mut RandomStream,
) -> Option<JointPositions> {
    use std::f64::consts::PI;
    let arm = check.robot.arm;
    let mut drawn = *from;
    for (i, limit) in arm.limits().iter().enumerate() {
        let (mut low, mut high) = (limit.lower, limit.upper);
        if i == 3 || i == 5 {
            low = low.max(from[i].min(to[i]) - PI);
            high = high.min(from[i].max(to[i]) + PI);
        }
        drawn[i] = random.uniform(low, high);
    }
    let hangs = |at: &JointPositions| drawn_in(at, drawn[1], drawn[2]);
    if drawn.len() < 6 {
        // A palletizer's tool hangs anyhow.
    } else if let (Some(a), Some(b)) = (hangs(from), hangs(to)) {
        let share = random.uniform(0.0, 1.0);
        drawn[3] = a[3] + (b[3] - a[3]) * share;
        drawn[4] = a[4] + (b[4] - a[4]) * share;
    }
    arm.within_limits(&drawn).then_some(drawn)
}

/// Grows a tree by one step towards a posture; none when that step is not free.
fn extend(
    tree: &mut Tree,
    to: &JointPositions,
    check: &Check,
    upright: Option<f64>,
    settings: &PlannerSettings,
) -> Option<usize> {
    let nearest = tree.nearest(to);
    let from = tree.states[nearest];
    let way = distance(&from, to);
    if way < 1e-9 {
        return None;
    }
    let next = if way <= RANGE {
        *to
    } else {
        from.lerp(to, RANGE / way)
    };
    if !edge_is_free(check, &from, &next, upright, settings) {
        return None;
    }
    tree.states.push(next);
    tree.parents.push(nearest);
    Some(tree.states.len() - 1)
}

/// Leaves out vertices and cuts between random points where that is free and saves time.
fn shorten(
    mut way: Vec<JointPositions>,
    check: &Check,
    upright: Option<f64>,
    settings: &PlannerSettings,
    random: &mut RandomStream,
) -> Vec<JointPositions> {
    let limits = check.robot.arm.limits();
    let time = |points: &[JointPositions]| -> f64 {
        points
            .windows(2)
            .map(|w| Trapezoid::joints(&w[0], &w[1], limits).duration)
            .sum()
    };
    let free =
        |a: &JointPositions, b: &JointPositions| edge_is_free(check, a, b, upright, settings);
    let mut at = 0;
    while at + 2 < way.len() {
        let far = (at + 2..way.len())
            .rev()
            .find(|&far| free(&way[at], &way[far]));
        if let Some(far) = far {
            way.drain(at + 1..far);
        }
        at += 1;
    }
    for _ in 0..SHORT_CUTS {
        if way.len() < 3 {
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
        if a.0 == b.0 || !free(&a.1, &b.1) {
            continue;
        }
        let mut shorter: Vec<JointPositions> = way[..=a.0].to_vec();
        shorter.extend([a.1, b.1]);
        shorter.extend_from_slice(&way[b.0 + 1..]);
        if time(&shorter) < time(&way) {
            way = shorter;
        }
    }
    way
}
