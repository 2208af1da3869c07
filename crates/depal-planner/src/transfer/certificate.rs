//! Proof on the bare bodies that nothing touches along a blended path.

use depal_frames::JointPositions;
use depal_motion::{BlendedPath, Piece};

use super::scene::{Contact, Distances, Scene};

/// Distances beyond this are not measured at first, m.
const CAP_M: f64 = 0.12;
/// ... and at most this far when all of the path is farther away than that.
const FAR_M: f64 = 2.5;
/// The true least distance may be smaller than the reported one by this much, m ...
const SLACK_M: f64 = 0.0005;
/// ... and by this share of it.
const SLACK_SHARE: f64 = 0.005;
/// Shares of a piece below this are not split any more.
const FINEST: f64 = 1e-6;
/// Measurements after which a path counts as too close to prove.
const MOST_MEASUREMENTS: usize = 20_000;

struct Prover<'a> {
    scene: &'a Scene<'a>,
    /// Upper bound of a body point's distance to any joint axis, m.
    reach: f64,
    cap: f64,
    /// How many turns a joint makes for each of its own, mimics included.
    gains: Vec<f64>,
    least: f64,
    measurements: usize,
}

/// Least distance along the path, m; or the contact, and none of them when it comes too close to be proved.
pub(crate) fn certify(
    scene: &Scene,
    start: &JointPositions,
    path: &BlendedPath,
) -> Result<f64, Option<Contact>> {
    let mut cap = CAP_M;
    loop {
        let mut prover = Prover {
            scene,
            reach: reach(scene),
            cap,
            gains: scene.arm.turn_gains(),
            least: cap,
            measurements: 0,
        };
        prover.measure(start)?;
        for piece in path.pieces() {
            prover.piece(piece)?;
        }
        if prover.least < cap || cap >= FAR_M {
            return Ok(prover.least);
        }
        cap = (cap * 4.0).min(FAR_M);
    }
}

/// The arm stretched out: no point is farther from an axis of a joint than the links between are long.
fn reach(scene: &Scene) -> f64 {
    let links = scene
        .arm
        .base_from_links(&JointPositions::zeros(scene.arm.joint_count()));
    let steps: f64 = links
        .windows(2)
        .map(|w| (w[1].translation.vector - w[0].translation.vector).norm())
        .sum();
    steps + scene.bodies.iter().map(|b| b.lever).fold(0.0, f64::max)
}

impl Prover<'_> {
    fn measure(&mut self, joints: &JointPositions) -> Result<Distances, Option<Contact>> {
        self.measurements += 1;
        // What is farther away than the least so far need not be known exactly, but well enough to take large steps.
        let exact = (self.least * 2.0 + 0.02).min(self.cap);
        let found = self.scene.distances_below(joints, self.cap, exact);
        if found.least <= 0.0 {
            return Err(found.contact);
        }
        if self.measurements > MOST_MEASUREMENTS {
            return Err(None);
        }
        self.least = self.least.min(found.least);
        Ok(found)
    }

    fn piece(&mut self, piece: &Piece) -> Result<(), Option<Contact>> {
        let mut at = (0.0, piece.at(0.0));
        let mut found = self.measure(&at.1)?;
        let steps = (piece.length() / 0.15).ceil().max(1.0) as usize;
        for i in 1..=steps {
            let share = i as f64 / steps as f64;
            let next = (share, piece.at(share));
            let next_found = self.measure(&next.1)?;
            self.between(piece, (&at, &found), (&next, &next_found))?;
            (at, found) = (next, next_found);
        }
        Ok(())
    }

    fn between(
        &mut self,
        piece: &Piece,
        a: (&(f64, JointPositions), &Distances),
        b: (&(f64, JointPositions), &Distances),
    ) -> Result<(), Option<Contact>> {
        let turned: f64 =
            a.0.1
                .iter()
                .zip(b.0.1.iter())
                .zip(&self.gains)
                .map(|((x, y), gain)| (x - y).abs() * gain)
                .sum();
        let share = b.0.0 - a.0.0;
        // A point p(q(u)) strays from its chord by at most an eighth of its largest second derivative:
        // reach * (sum |q'|)^2 + reach * sum |q''|.
        let bend = piece.bend(&self.gains) * share * share;
        let fastest = turned + 0.5 * bend;
        let stray = self.reach * (fastest * fastest + bend) / 8.0;
        let bound = self.scene.least_between(a.1, b.1, stray);
        if bound > 0.0 && bound >= self.least * (1.0 - SLACK_SHARE) - SLACK_M {
            return Ok(());
        }
        if share < FINEST {
            return Err(None);
        }
        let share = 0.5 * (a.0.0 + b.0.0);
        let middle = (share, piece.at(share));
        let found = self.measure(&middle.1)?;
        self.between(piece, a, (&middle, &found))?;
        self.between(piece, (&middle, &found), b)
    }
}
