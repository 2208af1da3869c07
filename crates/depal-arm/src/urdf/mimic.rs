//! Joints that another joint moves.

use urdf_rs::{JointType, Robot};

use crate::{ArmError, shapes::Reader, source::Source};

/// Which joint moves another: `multiplier * joint + offset`.
pub(super) struct Driver {
    pub joint: usize,
    pub multiplier: f64,
    pub offset: f64,
}

/// Every mimic must follow a joint that is there, even that of a joint which cannot move.
pub(super) fn check_mimics(robot: &Robot, source: &Source) -> Result<(), ArmError> {
    for joint in &robot.joints {
        if let Some(mimic) = &joint.mimic
            && robot.joints.iter().all(|j| j.name != mimic.joint)
        {
            return Err(ArmError::UnknownMimic {
                at: source.at(&format!("joint '{}' <mimic>", joint.name)),
                joint: joint.name.clone(),
                master: mimic.joint.clone(),
            });
        }
    }
    Ok(())
}

/// Follows mimics to the joint that has none; none for fixed joints.
pub(super) fn driver(
    robot: &Robot,
    joint: usize,
    source: &Source,
) -> Result<Option<Driver>, ArmError> {
    if robot.joints[joint].joint_type == JointType::Fixed {
        return Ok(None);
    }
    let mut driver = Driver {
        joint,
        multiplier: 1.0,
        offset: 0.0,
    };
    for _ in 0..=robot.joints.len() {
        let at = &robot.joints[driver.joint];
        let Some(mimic) = &at.mimic else {
            return Ok(Some(driver));
        };
        let (multiplier, offset) = (mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0));
        let reader = Reader {
            source,
            meshes: None,
        };
        reader.finite(
            &format!("joint '{}' <mimic>", at.name),
            &[multiplier, offset],
        )?;
        let master = robot.joints.iter().position(|j| j.name == mimic.joint);
        driver = Driver {
            joint: master.expect("every mimic's joint was looked up"),
            multiplier: driver.multiplier * multiplier,
            offset: driver.multiplier * offset + driver.offset,
        };
    }
    Err(ArmError::MimicLoop {
        at: source.at(&format!("joint '{}' <mimic>", robot.joints[joint].name)),
        joint: robot.joints[joint].name.clone(),
    })
}
