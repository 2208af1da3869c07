//! Questions about single states and straight moves of a scene.

use depal_frames::JointPositions;

use super::{
    request::TransferScene,
    route::Checker,
    scene::{BARE, Scene},
};

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
