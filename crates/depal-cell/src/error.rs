//! Why a cell could not be built.

use depal_controller::ControllerError;
use depal_interface::InterfaceError;

/// Why a cell could not be built.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CellError {
    /// The cabinet refuses its settings.
    #[error("robot: {0}")]
    Controller(#[from] ControllerError),
    /// The vision server refuses its settings.
    #[error("interface: {0}")]
    Interface(#[from] InterfaceError),
    /// The planning project refuses its steps.
    #[error("viz: {0}")]
    Workflow(String),
    /// A signal of the gripper is not defined in the cabinet.
    #[error(
        "the gripper needs the signal {signal}, which the robot does not have; add it to robot.signal"
    )]
    Wiring {
        /// The signal.
        signal: String,
    },
}
