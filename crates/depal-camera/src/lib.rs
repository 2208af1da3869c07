//! Depth camera: software rasteriser and sensor model.
