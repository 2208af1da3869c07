//! One function of the interface: registers, Trigger, Acknowledge, Status.

use std::task::Poll;

use depal_time::{SimDuration, SimTime};
use depal_wire::s7::{DataBlock, Field};

/// Vision acknowledges within a few polls; what takes longer is no vision.
const ACKNOWLEDGE_TIME: SimDuration = SimDuration::from_millis(5_000);
/// Longer than the ten seconds that vision allows itself.
const STATUS_TIME: SimDuration = SimDuration::from_millis(30_000);

/// The parameters of one call; the others keep what they hold.
#[derive(Debug, Clone, Default)]
pub(crate) struct Registers {
    pub(crate) command: i16,
    pub(crate) pose_type: i16,
    pub(crate) project: i16,
    pub(crate) joints_deg: Option<[f32; 6]>,
    pub(crate) branch: Option<(i16, i16)>,
    pub(crate) box_size_mm: Option<[f32; 3]>,
    pub(crate) sections: i16,
}

/// A call under way.
#[derive(Debug, Clone)]
pub(crate) struct Call {
    command: i16,
    waits_for: WaitsFor,
    since: SimTime,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum WaitsFor {
    Raised,
    Lowered,
    Status,
}

impl Call {
    /// Fills the registers and raises Trigger.
    pub(crate) fn start(now: SimTime, block: &mut DataBlock, registers: &Registers) -> Self {
        block.set_int(Field::Command, 0, registers.command);
        block.set_int(Field::PoseType, 0, registers.pose_type);
        block.set_int(Field::PoseNumber, 0, 0);
        block.set_int(Field::Project, 0, registers.project);
        block.set_int(Field::Sections, 0, registers.sections);
        for (place, joint) in registers.joints_deg.iter().flatten().enumerate() {
            block.set_real(Field::Joints, place, *joint);
        }
        for (place, side) in registers.box_size_mm.iter().flatten().enumerate() {
            block.set_real(Field::BoxSize, place, *side);
        }
        if let Some((step, exit)) = registers.branch {
            block.set_int(Field::BranchStep, 0, step);
            block.set_int(Field::BranchExit, 0, exit);
        }
        block.set_bool(Field::Trigger, true);
        Self {
            command: registers.command,
            waits_for: WaitsFor::Raised,
            since: now,
        }
    }

    /// Status, once it is there; or what vision did not do.
    pub(crate) fn poll(
        &mut self,
        now: SimTime,
        block: &mut DataBlock,
    ) -> Poll<Result<i16, String>> {
        loop {
            let is_raised = block.bool(Field::Acknowledge);
            match self.waits_for {
                WaitsFor::Raised if is_raised => {
                    block.set_bool(Field::Trigger, false);
                    self.go_on(now, WaitsFor::Lowered);
                }
                WaitsFor::Lowered if !is_raised => self.go_on(now, WaitsFor::Status),
                WaitsFor::Status if block.int(Field::Status, 0) != 0 => {
                    return Poll::Ready(Ok(block.int(Field::Status, 0)));
                }
                waits_for => {
                    let (limit, what) = match waits_for {
                        WaitsFor::Raised => (ACKNOWLEDGE_TIME, "Trigger Acknowledge"),
                        WaitsFor::Lowered => (ACKNOWLEDGE_TIME, "the end of Trigger Acknowledge"),
                        WaitsFor::Status => (STATUS_TIME, "Status Code"),
                    };
                    if self.since + limit > now {
                        return Poll::Pending;
                    }
                    block.set_bool(Field::Trigger, false);
                    return Poll::Ready(Err(format!(
                        "command {}: {what} did not come within {:.0} s",
                        self.command,
                        limit.as_secs_f64()
                    )));
                }
            }
        }
    }

    fn go_on(&mut self, now: SimTime, waits_for: WaitsFor) {
        self.waits_for = waits_for;
        self.since = now;
    }
}
