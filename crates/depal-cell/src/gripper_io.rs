//! The cabinet's outputs to valves of the gripper's sections.

use depal_controller::Controller;
use depal_gripper::GripperSpec;

use crate::spec::{GripperWiring, SectionSignals};

/// One valve command per section. A section that no output is wired to stays closed.
pub(crate) fn valves(
    gripper: &GripperSpec,
    wiring: &GripperWiring,
    controller: &Controller,
) -> Vec<bool> {
    let is_on = |place: usize, digital_output: u16| match &wiring.sections {
        SectionSignals::Groups(groups) => {
            let group = groups.get(usize::from(digital_output / 16))?;
            let value = controller.output(group).ok()? as u32;
            Some(value >> (digital_output % 16) & 1 == 1)
        }
        SectionSignals::Single(outputs) => {
            let value = controller.output(outputs.get(place)?).ok()?;
            Some(value != 0.0)
        }
    };
    gripper
        .sections
        .iter()
        .enumerate()
        .map(|(place, section)| is_on(place, section.digital_output).unwrap_or(false))
        .collect()
}
