//! Bits of the cabinet's group outputs to valves of the gripper's sections.

use depal_controller::Controller;
use depal_gripper::GripperSpec;

use crate::spec::GripperWiring;

/// One valve command per section: digital output `d` is bit `d % 16` of group output `d / 16`.
/// A section whose output lies in no wired group stays closed.
pub(crate) fn valves(
    gripper: &GripperSpec,
    wiring: &GripperWiring,
    controller: &Controller,
) -> Vec<bool> {
    let bit = |digital_output: u16| {
        let group = wiring.groups.get(usize::from(digital_output / 16))?;
        let value = controller.output(group).ok()? as u32;
        Some(value >> (digital_output % 16) & 1 == 1)
    };
    gripper
        .sections
        .iter()
        .map(|section| bit(section.digital_output).unwrap_or(false))
        .collect()
}
