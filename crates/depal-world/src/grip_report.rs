use std::collections::VecDeque;

use depal_frames::Vector;
use depal_gripper::GripEvent;

use crate::arm::Arm;
use crate::{CartonId, WorldEvent};

/// Span over which the highest load counts for a loss, s.
const LOAD_SPAN: f64 = 0.2;

/// The load that the tool's motion asks of the cups, per kilogram held: the latest 0.2 s.
#[derive(Default)]
pub(crate) struct LoadHistory {
    specific: VecDeque<f64>,
}

impl LoadHistory {
    /// Adds a step of `dt` seconds: weight and inertia along the cups' axis, plus the lateral
    /// part over the friction, `m (g + a / mu)` for a level gripper.
    pub fn add(&mut self, arm: &Arm, gravity: &Vector, dt: f64) {
        let specific = arm.tool_acceleration - gravity;
        let away = -(arm.tool.to.rotation * Vector::z());
        let axial = specific.dot(&away);
        let lateral = (specific - away * axial).norm();
        let load = axial.max(0.0) + lateral / arm.gripper.vacuum.friction.max(1e-3);
        self.specific.push_back(load);
        while self.specific.len() as f64 * dt > LOAD_SPAN {
            self.specific.pop_front();
        }
    }

    /// Highest load on the cups for a carton of `mass` kg, N.
    fn peak(&self, mass: f64) -> f64 {
        mass * self.specific.iter().copied().fold(0.0, f64::max)
    }
}

/// The gripper's event as one of the world; `mass` is the carton's.
pub(crate) fn world_event(event: GripEvent, loads: &LoadHistory, mass: f64) -> WorldEvent {
    match event {
        GripEvent::Started { carton, sections } => WorldEvent::GripStarted {
            carton: CartonId(carton),
            sections,
        },
        GripEvent::Released { carton } => WorldEvent::GripReleased {
            carton: CartonId(carton),
        },
        GripEvent::Lost {
            carton,
            reason,
            load_n,
            limit_n,
        } => WorldEvent::GripLost {
            carton: CartonId(carton),
            reason,
            load_n: loads.peak(mass).max(load_n),
            limit_n,
        },
    }
}
