use depal_frames::{PlacedShape, Pose};

use crate::FlowSpec;

/// A sectioned vacuum gripper. The tool frame `tcp` is at the middle of the cup plane,
/// Z pointing out of the gripper towards the carton, X along the gripper's long side.
#[derive(Debug, Clone, PartialEq)]
pub struct GripperSpec {
    /// Name for messages and the replay.
    pub name: String,
    /// `flange_from_tcp`.
    pub flange_from_tcp: Pose,
    /// Mass of the tool, kg.
    pub mass: f64,
    /// Solid bodies of the tool (plate, post), in the `tcp` frame: physics, camera and planner use them.
    pub bodies: Vec<PlacedShape>,
    /// The separately switched zones.
    pub sections: Vec<SectionSpec>,
    /// All cups.
    pub cups: Vec<CupSpec>,
    /// Pump, valves and seal.
    pub vacuum: VacuumSpec,
}

/// One zone: a rectangle of cups behind one valve.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionSpec {
    /// Digital output that switches it, as sent in the DO list.
    pub digital_output: u16,
    /// Rectangle in the `tcp` frame: min x, max x, min y, max y, metres.
    pub area: [f64; 4],
}

/// One suction cup.
#[derive(Debug, Clone, PartialEq)]
pub struct CupSpec {
    /// Lip centre in the `tcp` plane (x, y), metres.
    pub position: [f64; 2],
    /// Index of its section.
    pub section: usize,
    /// Effective diameter, metres.
    pub diameter: f64,
    /// Axial stiffness of the collapsed cup, N/m; the open bellows has a tenth of it.
    pub stiffness: f64,
    /// Axial damping, N s/m.
    pub damping: f64,
    /// Free travel of the lip beyond the `tcp` plane, metres: the cup touches this much early.
    /// With the face at the `tcp` plane the bellows is flat.
    pub stroke: f64,
}

/// Vacuum generation and the rules of the seal. Pressures are *below ambient*, positive, in pascals.
#[derive(Debug, Clone, PartialEq)]
pub struct VacuumSpec {
    /// Vacuum that the pump reaches on a closed zone, Pa.
    pub supply_vacuum: f64,
    /// Time constant of building up vacuum in a sealed zone, s.
    pub build_up_time: f64,
    /// Time constant of venting with blow-off, s.
    pub blow_off_time: f64,
    /// Vacuum switch closes above this fraction of `supply_vacuum` ...
    pub switch_on_fraction: f64,
    /// ... and opens below this one.
    pub switch_off_fraction: f64,
    /// Share of the supply that one open cup of `n` in a zone loses (flow resistors keep it below 1):
    /// with `m` open cups the zone reaches `supply * (1 - m * loss)`, never below zero.
    /// Not used where `flow` is given.
    pub open_cup_loss: f64,
    /// Pump curve and leaks of a section; absent: `open_cup_loss` stands for them.
    pub flow: Option<FlowSpec>,
    /// Coefficient of friction between lip and carton.
    pub friction: f64,
}

impl VacuumSpec {
    /// Vacuum that a section comes to with so many sealed and open cups (fractions count), Pa;
    /// `available` is what the pump reaches on a closed section, [`VacuumSpec::supply_vacuum`] if it is in order.
    pub fn reached(&self, sealed: f64, open: f64, available: f64) -> f64 {
        match &self.flow {
            Some(flow) => flow.balance(sealed, open, available / self.supply_vacuum),
            None => available * (1.0 - self.open_cup_loss * open).max(0.0),
        }
    }
}

impl GripperSpec {
    /// Vacuum of a section with all its cups sealed, Pa.
    pub fn sealed_vacuum(&self, section: usize) -> f64 {
        let cups = self.cups.iter().filter(|cup| cup.section == section);
        let vacuum = &self.vacuum;
        vacuum.reached(cups.count() as f64, 0.0, vacuum.supply_vacuum)
    }
}
