//! Box poses from one depth frame.
