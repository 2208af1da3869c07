//! Questions about single states and straight moves of a scene.

use depal_frames::JointPositions;
use depal_motion::{BlendedPath, Samples};

use super::{
    request::TransferScene,
    scene::{BARE, Contact, Scene},
};

/// Neighbouring states of a checked path, rad.
const STEP: f64 = 0.05;
/// The same where the padding is thin.
pub(crate) const FINE_STEP: f64 = 0.01;

/// Distances beyond this are not measured, m.
const FAR_M: f64 = 2.5;

/// A scene made ready for many questions: what touches, what is free, how near things are.
/// Bodies are bare: no padding.
pub struct TransferChecker<'a> {
    scene: Scene<'a>,
}

impl<'a> TransferChecker<'a> {
    /// Builds the solids and the tree over them once.
    pub fn new(scene: &'a TransferScene) -> Self {
        Self {
            scene: Scene::new(scene),
        }
    }

    /// What touches at these joints, in words; none when nothing does.
    ///
    /// # Panics
    /// If `joints` has fewer entries than the arm, as for the other questions.
    pub fn touch(&self, joints: &JointPositions) -> Option<String> {
        let contact = self.scene.contact(joints, BARE);
        contact.map(|c| self.scene.words(c))
    }

    /// Whether nothing touches at these joints; quicker than words.
    pub fn is_free(&self, joints: &JointPositions) -> bool {
        self.scene.contact(joints, BARE).is_none()
    }

    /// Whether the straight joint move is free at states at most `step` rad (L2) apart, both ends included.
    pub fn line_is_free(&self, from: &JointPositions, to: &JointPositions, step: f64) -> bool {
        Checker::bare(&self.scene).line_is_free(from, to, step)
    }

    /// Least distance of moving bodies to obstacles and between pairs that must not meet, m; at most 2.5.
    pub fn clearance(&self, joints: &JointPositions) -> f64 {
        self.scene.distances(joints, FAR_M).least
    }
}

/// Counts checked states and knows the limits of what may be spent.
pub(crate) struct Checker<'a> {
    pub scene: &'a Scene<'a>,
    pub thickness: usize,
    pub checks: usize,
    pub most_checks: usize,
    /// Where along its way the last blocked path was blocked, 0 to 1: the next one is looked at there first.
    pub hint: f64,
    /// Small steps in spite of thick bodies: something thin stands in the way.
    pub careful: bool,
}

impl<'a> Checker<'a> {
    /// For bare bodies, without a limit.
    pub fn bare(scene: &'a Scene<'a>) -> Self {
        Self {
            scene,
            thickness: BARE,
            checks: 0,
            most_checks: usize::MAX,
            hint: 0.5,
            careful: false,
        }
    }

    /// The far end is a state of its own: a line without length has no others.
    pub fn line_is_free(&mut self, from: &JointPositions, to: &JointPositions, step: f64) -> bool {
        let path = BlendedPath::new(&[*from, *to], &[0.0, 0.0]);
        self.all_free(&path.samples(step)) && self.contact(to).is_none()
    }

    pub fn step(&self) -> f64 {
        if self.thickness == 0 && !self.careful {
            STEP
        } else {
            FINE_STEP
        }
    }

    pub fn contact(&mut self, joints: &JointPositions) -> Option<Contact> {
        self.checks += 1;
        self.scene.contact(joints, self.thickness)
    }

    /// Whether all states are free: the middle first, then the middles of the halves, and so on.
    pub fn all_free(&mut self, states: &Samples) -> bool {
        let count = states.count();
        let mut stride = count.next_power_of_two();
        while stride > 1 {
            for i in (stride / 2..count).step_by(stride) {
                if self.contact(&states.at(i)).is_some() {
                    self.hint = i as f64 / (count - 1) as f64;
                    return false;
                }
            }
            stride /= 2;
        }
        count == 0 || self.contact(&states.at(0)).is_none()
    }

    pub fn path_is_free(&mut self, path: &BlendedPath) -> bool {
        let states = path.samples(self.step());
        if states.count() == 0 {
            return true;
        }
        let hint = ((states.count() - 1) as f64 * self.hint).round() as usize;
        self.contact(&states.at(hint)).is_none() && self.all_free(&states)
    }

    pub fn edge_is_free(&mut self, from: &JointPositions, to: &JointPositions) -> bool {
        let path = BlendedPath::new(&[*from, *to], &[0.0, 0.0]);
        self.all_free(&path.samples(self.step()))
    }
}
