//! Which box to pick, with which sections, and a collision-free way there and back.
