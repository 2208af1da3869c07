//! Real sockets: the vision server for real robots, and sockets for robot programs, paced against the wall clock.

pub mod robot_sockets;
