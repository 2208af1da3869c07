//! The workflow as text.

use std::fmt;

use crate::pattern::CartonPattern;
use crate::project::{MoveMotion, Next, Place, Project, Reference, StepKind, Travel};

impl fmt::Display for Project {
    /// The workflow as text, one step a line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for step in &self.steps {
            write!(f, "{:>4}  {}", step.id, step.kind)?;
            match (&step.kind, step.next) {
                (StepKind::BranchByMsg { .. }, _) | (_, Next::Following) => writeln!(f)?,
                (_, Next::Step(id)) => writeln!(f, " -> {id}")?,
                (_, Next::End) => writeln!(f, " -> end")?,
            }
        }
        Ok(())
    }
}

impl fmt::Display for Travel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let motion = match self.motion {
            MoveMotion::Joint => "joint",
            MoveMotion::Linear => "linear",
        };
        write!(f, "{motion} at {} %", self.velocity_percent)
    }
}

impl fmt::Display for StepKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::VisualRecognition {
                project,
                reuses_result,
            } => {
                let reuse = if *reuses_result {
                    ", result reused"
                } else {
                    ""
                };
                write!(f, "visual_recognition project {project}{reuse}")
            }
            Self::VisionMove {
                uses_sections,
                plans_all,
                max_group,
                velocity_percent,
            } => {
                f.write_str("vision_move")?;
                if *uses_sections {
                    f.write_str(" by sections")?;
                }
                if *plans_all {
                    f.write_str(", all results")?;
                }
                if *max_group > 1 {
                    write!(f, ", up to {max_group} at once")?;
                }
                write!(f, " at {velocity_percent} %")
            }
            Self::BranchByMsg { exits } => {
                f.write_str("branch_by_msg ->")?;
                exits.iter().try_for_each(|id| write!(f, " {id}"))
            }
            Self::FixedPointMove { travel, .. } => write!(f, "fixed_point_move {travel}"),
            Self::RelativeMove {
                reference, travel, ..
            } => {
                let other = match reference {
                    Reference::Previous => "the waypoint before",
                    Reference::Next => "the next waypoint",
                };
                write!(f, "relative_move to {other}, {travel}")
            }
            Self::MoveByList { targets, travel } => {
                write!(f, "move_by_list of {}, {travel}", targets.len())
            }
            Self::MoveByGrid { grid, travel } => {
                let [x, y, z] = grid.counts;
                write!(f, "move_by_grid {x} x {y} x {z}, {travel}")
            }
            Self::CartonPattern {
                pattern: CartonPattern::Custom(places),
                travel,
            } => write!(f, "custom_pallet_pattern of {}, {travel}", places.len()),
            Self::CartonPattern {
                pattern: CartonPattern::Predefined(layers),
                travel,
            } => write!(
                f,
                "predefined_pallet_pattern {} rows x {} columns x {} layers{}, {travel}",
                layers.rows,
                layers.columns,
                layers.layers,
                if layers.is_alternating {
                    ", alternating"
                } else {
                    ""
                }
            ),
            Self::ExternalMove { travel } => write!(f, "external_move {travel}"),
            Self::SetDo => f.write_str("set_do"),
            Self::Notify { message } => write!(f, "notify {message}"),
            Self::PalletPattern {
                place: Place::Conveyor,
            } => f.write_str("pallet_pattern conveyor"),
        }
    }
}
