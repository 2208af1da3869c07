//! Time laws: joint and linear moves, zones and blending under speed and acceleration limits.
