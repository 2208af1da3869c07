//! Robot arms from URDF: forward and inverse kinematics, limits and link shapes.
