//! Two trees that grow towards each other (J. Kuffner, S. LaValle, "RRT-Connect", ICRA 2000), and short-cuts afterwards.

use depal_frames::JointPositions;
use depal_time::RandomStream;

/// What the trees grow in.
pub(crate) trait Ground {
    /// A random posture to grow towards; none to leave this turn out. Turns count from 0.
    fn draw(&mut self, turn: usize, random: &mut RandomStream) -> Option<JointPositions>;
    /// Whether the straight joint move between two postures is free, its far end included.
    fn edge_is_free(&mut self, from: &JointPositions, to: &JointPositions) -> bool;
    /// What a way costs; short-cuts lower it.
    fn cost(&self, way: &[JointPositions]) -> f64;
    /// No more effort may be spent.
    fn spent(&self) -> bool;
}

struct Tree {
    states: Vec<JointPositions>,
    parents: Vec<usize>,
}

/// Length of the straight way in joint space, rad.
pub(crate) fn distance(a: &JointPositions, b: &JointPositions) -> f64 {
    a.iter()
        .zip(b.iter())
        .map(|(x, y)| (x - y) * (x - y))
        .sum::<f64>()
        .sqrt()
}

impl Tree {
    fn new(root: &JointPositions) -> Self {
        Self {
            states: vec![*root],
            parents: vec![0],
        }
    }

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

    /// From a state down to the root.
    fn to_root(&self, mut index: usize) -> Vec<JointPositions> {
        let mut way = vec![self.states[index]];
        while index != 0 {
            index = self.parents[index];
            way.push(self.states[index]);
        }
        way
    }

    /// One step of at most `range` rad towards a posture; none when that step is not free.
    fn extend(
        &mut self,
        ground: &mut impl Ground,
        to: &JointPositions,
        range: f64,
    ) -> Option<usize> {
        let nearest = self.nearest(to);
        let from = self.states[nearest];
        let way = distance(&from, to);
        if way < 1e-9 {
            return None;
        }
        let next = if way <= range {
            *to
        } else {
            from.lerp(to, range / way)
        };
        if !ground.edge_is_free(&from, &next) {
            return None;
        }
        self.states.push(next);
        self.parents.push(nearest);
        Some(self.states.len() - 1)
    }
}

/// A free chain of straight joint moves; none when the effort or the `turns` are spent. Counts turns in `rounds`.
pub(crate) fn connect(
    ground: &mut impl Ground,
    from: &JointPositions,
    to: &JointPositions,
    range: f64,
    turns: usize,
    random: &mut RandomStream,
    rounds: &mut usize,
) -> Option<Vec<JointPositions>> {
    let mut trees = [Tree::new(from), Tree::new(to)];
    for turn in 0..turns {
        if ground.spent() {
            return None;
        }
        *rounds += 1;
        let (here, there) = (turn % 2, (turn + 1) % 2);
        let Some(drawn) = ground.draw(turn, random) else {
            continue;
        };
        let Some(new) = trees[here].extend(ground, &drawn, range) else {
            continue;
        };
        let target = trees[here].states[new];
        // The other tree tries to come all the way.
        while let Some(step) = trees[there].extend(ground, &target, range) {
            if distance(&trees[there].states[step], &target) > 1e-9 {
                continue;
            }
            let mut way = trees[here].to_root(new);
            way.reverse();
            way.extend(trees[there].to_root(step).into_iter().skip(1));
            if here == 1 {
                way.reverse();
            }
            return Some(way);
        }
    }
    None
}

/// Leaves out points that the way can do without.
pub(crate) fn drop_vertices(ground: &mut impl Ground, way: &mut Vec<JointPositions>) {
    let mut at = 0;
    while at + 2 < way.len() {
        let far = (at + 2..way.len())
            .rev()
            .find(|&far| ground.edge_is_free(&way[at], &way[far]));
        if let Some(far) = far {
            way.drain(at + 1..far);
        }
        at += 1;
    }
}

/// Cuts between random points of a way where that is free and costs less; ways of more than `most_points` grow no longer.
pub(crate) fn short_cuts(
    ground: &mut impl Ground,
    way: &mut Vec<JointPositions>,
    tries: usize,
    most_points: usize,
    random: &mut RandomStream,
) {
    for _ in 0..tries {
        if way.len() < 3 || ground.spent() {
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
        if a.0 == b.0 || !ground.edge_is_free(&a.1, &b.1) {
            continue;
        }
        let mut shorter: Vec<JointPositions> = way[..=a.0].to_vec();
        shorter.extend([a.1, b.1]);
        shorter.extend_from_slice(&way[b.0 + 1..]);
        if ground.cost(&shorter) < ground.cost(way) && shorter.len() <= most_points.max(way.len()) {
            *way = shorter;
        }
    }
}
