//! The dialogue of command 701.

use depal_frames::JointPositions;
use depal_wire::{Calibrate, CalibrationPoint, Reply, Status};

use crate::job::Job;
use crate::session::Session;
use crate::wire_values::{joint_values, never_all_zero, pose_values};

/// What a session remembers of a calibration.
#[derive(Debug, Clone, Default)]
pub(crate) enum Calibration {
    #[default]
    Idle,
    /// The robot is on its way to a pose.
    Moving {
        /// Place of that pose in the settings.
        place: usize,
        /// Flange pose and joints that the robot sent at the beginning; it returns there.
        start: ([f64; 6], [f64; 6]),
    },
}

impl Session {
    pub(crate) fn calibrate(&mut self, request: &Calibrate) -> Reply {
        let refuse = |status| Reply::status(701, status);
        if self.calibration_poses.is_empty() {
            self.jobs.push_back(Job::NoCalibration { port: self.port });
            return refuse(Status::CalibrationParameter);
        }
        if !(0..=2).contains(&request.state) {
            return refuse(Status::CalibrationParameter);
        }
        let Some(joints_deg) = request.joints_deg else {
            return refuse(Status::CalibrationNoJoints);
        };
        if request.flange.iter().all(|value| *value == 0.0) {
            return refuse(Status::CalibrationNoFlange);
        }
        let (place, start) = match (request.state, &self.calibration) {
            (0, _) => (0, (request.flange, joints_deg)),
            (_, Calibration::Idle) => return refuse(Status::CalibrationParameter),
            (2, _) => {
                self.calibration = Calibration::Idle;
                return refuse(Status::CalibrationNotReached);
            }
            (_, Calibration::Moving { place, start }) => {
                let Some(base_from_flange) = self.near_pose(&request.flange) else {
                    return refuse(Status::CalibrationParameter);
                };
                self.jobs.push_back(Job::CaptureCalibration {
                    port: self.port,
                    number: place + 1,
                    base_from_flange,
                    joints: JointPositions::from_degrees(&joints_deg),
                });
                (place + 1, *start)
            }
        };
        let point = if let Some(pose) = self.calibration_poses.get(place) {
            self.calibration = Calibration::Moving { place, start };
            CalibrationPoint {
                is_done: false,
                flange: pose_values(self.settings.euler, &pose.base_from_flange),
                joints_deg: joint_values(&pose.joints),
            }
        } else {
            self.calibration = Calibration::Idle;
            CalibrationPoint {
                is_done: true,
                flange: never_all_zero(start.0),
                joints_deg: never_all_zero(start.1),
            }
        };
        Reply::CalibrationPoint(Box::new(point))
    }
}
