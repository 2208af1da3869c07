//! Robot arms from URDF: forward and inverse kinematics, limits and link shapes.
//!
//! An [`Arm`] is read once from URDF text and then only asked: where are flange and links at these joints
//! ([`Arm::base_from_flange`], [`Arm::base_from_links`]), which joints reach this flange pose
//! ([`Arm::inverse`], [`Arm::inverse_nearest`]), what may the joints do ([`Arm::limits`], [`Arm::torque_limits`]),
//! and what torques does a motion take with a load at the flange ([`Arm::joint_torques`]).
//! It is constant data; share it in an `Arc`.
//!
//! It must never know: time, tools, cartons, controllers, files.
//!
//! ```
//! use depal_arm::Arm;
//! use depal_frames::JointPositions;
//! let urdf = include_str!("../../../urdf/abb_irb6700_150_320.urdf");
//! let accelerations = [3.1, 3.1, 3.1, 7.0, 7.0, 8.7];
//! let arm = Arm::from_urdf(urdf, "abb_irb6700_150_320.urdf", &accelerations)?;
//! let joints = JointPositions::from_degrees(&[10.0, 20.0, 5.0, 0.0, 60.0, 0.0]);
//! let base_from_flange = arm.base_from_flange(&joints);
//! let found = arm.inverse_nearest(&base_from_flange, &joints).expect("it was reached just now");
//! assert!(found.max_distance(&joints) < 1e-6);
//! # Ok::<(), depal_arm::ArmError>(())
//! ```
//!
//! Units and frames: metres, radians, kilograms, f64. `base` is the root link of the file.
//! `flange` is the link `tool0`, else `flange`, else the end of the longest chain; its Z should point out of the flange.
//! Joint vectors follow the chain from base to flange.
//!
//! Inverse kinematics: closed form for six axes in ortho-parallel order with a spherical wrist (all branches and turns)
//! and for four-axis palletizers written as a chain with two mimics (all branches);
//! for any other chain of up to eight joints a search from fixed beginnings, always the same ones: a damped descent
//! comes near, Newton's method of the chain library (`k`) ends it, which may miss solutions and takes milliseconds.
//! Of a UR10e and a CRX-10iA (wrists that are no ball) every one of 1000 random poses is solved, with 7 and 8 postures on
//! average.
//! With more than six joints up to 24 of the endless many are given; with fewer only poses that it can reach exactly.
//!
//! Every fault and every warning names file, line and element ([`Place`]).
//!
//! Limitations: revolute and continuous joints only (continuous ones may turn once either way); movable joints beside the chain
//! stay at zero. Visual meshes are not read; collision meshes become convex hulls where a source of their bytes is given
//! ([`Arm::from_urdf_with_meshes`]): STL, OBJ and COLLADA without controllers (skins) and without `<lines>`-only geometry;
//! no GLTF, PLY or compressed files; a link whose visuals are all meshes is drawn as its solids.
//! [`Arm::warnings`] tells what was left out.
//! Torques are those of rigid links on an upright base: no friction, no rotor inertia, no counterweights or springs
//! beyond what the masses of the file say.
//! A palletizer's window between joints 2 and 3 (its rods) is not checked: URDF cannot say it.
//! On loading, the flat chain is compared with a second, independent chain (`k`) and with the closed-form solver;
//! a description on which they disagree by more than 1e-9 m is refused.
//!
//! Reference: M. Brandstoetter, A. Angerer, M. Hofbaur, "An analytical solution of the inverse kinematics problem of
//! industrial serial manipulators with an ortho-parallel basis and a spherical wrist", Austrian Robotics Workshop 2014.

mod arm;
mod chain;
mod dynamics;
mod error;
mod hull;
mod mesh;
mod newton;
mod numeric;
mod opw;
mod palletizer;
mod shapes;
mod source;
mod urdf;
mod verify;

pub use arm::{Arm, JointLimit, Link};
pub use dynamics::Load;
pub use error::{ArmError, ArmWarning};
pub use shapes::MeshSource;
pub use source::Place;

#[cfg(test)]
mod tests;
