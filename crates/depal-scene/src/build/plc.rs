//! The controller of another make: how vision reaches it, and what its sequence is set up with.

use depal_cell::spec::{CellSpec, PlcPort, SectionSignals};
use depal_plc::{Fetch, PlcSettings, PlcTask, Source};
use depal_time::SimDuration;

use super::BuildError;
use crate::interface::Interface;
use crate::plc::{PathFetch, PathSource, Plc};

/// The port of the data block that vision polls.
pub(super) fn port(plc: &Plc, interface: &Interface) -> PlcPort {
    PlcPort {
        port: interface.port,
        db: plc.db as u16,
        rack: plc.rack as u8,
        slot: plc.slot as u8,
        poll: SimDuration::from_secs_f64(plc.poll_ms * 1e-3),
    }
}

/// The sequence, for the arm and the gripper of the cell.
pub(super) fn task(plc: &Plc, spec: &CellSpec) -> Result<PlcTask, BuildError> {
    if spec.controller.start.len() > 6 {
        return Err(BuildError::Mismatch {
            key: "robot.urdf",
            message: format!(
                "expected an arm of at most six axes, for the data block has room for six, found {}",
                spec.controller.start.len()
            ),
        });
    }
    Ok(PlcTask::new(PlcSettings {
        port: spec.port,
        project: plc.project as i16,
        box_size_mm: plc.box_mm.map(|size| size.map(|length| length as f32)),
        source: match plc.source {
            PathSource::Viz => Source::Viz,
            PathSource::Vision => Source::Vision,
        },
        fetch: match plc.fetch {
            PathFetch::PlanData => Fetch::PlanData,
            PathFetch::Path => Fetch::Path,
        },
        branches: plc
            .branch
            .iter()
            .map(|branch| (branch.step as i16, branch.exit as i16))
            .collect(),
        home: spec.controller.start,
        flange_from_tcp: spec.gripper.flange_from_tcp,
        section_groups: match &spec.wiring.sections {
            SectionSignals::Groups(groups) => groups.clone(),
            SectionSignals::Single(_) => {
                return Err(BuildError::Mismatch {
                    key: "gripper.sections_signal",
                    message:
                        "expected a group output for the controller of [plc], found single outputs"
                            .to_owned(),
                });
            }
        },
        vacuum_signal: spec.wiring.vacuum_ok.clone(),
        vacuum_time: SimDuration::from_secs_f64(plc.vacuum_s),
        vision_time: SimDuration::from_secs_f64(plc.vision_wait_s),
        retreat: plc.retreat_mm * 1e-3,
        path_percent: plc.path_percent,
        most_failures: plc.failures_max,
        ..PlcSettings::default()
    }))
}
