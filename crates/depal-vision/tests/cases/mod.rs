//! What makes layers hard: other sizes, tilt, two heights, covers, tape, a sheet.
#![allow(dead_code)]

use depal_camera::{Material, RenderShape};
use depal_frames::BoxSize;

use crate::rendered::{Carton, HEIGHT, Layout, block, layer, stacked};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    MixedSizes3mm,
    MixedSizes1mm,
    OneTilted,
    TwoHeights,
    UpperCovers,
    BlackTape,
    SlipSheet,
}

impl Case {
    pub const ALL: [Self; 7] = [
        Self::MixedSizes3mm,
        Self::MixedSizes1mm,
        Self::OneTilted,
        Self::TwoHeights,
        Self::UpperCovers,
        Self::BlackTape,
        Self::SlipSheet,
    ];

    fn layout(self) -> Layout {
        match self {
            Self::MixedSizes3mm | Self::MixedSizes1mm => Layout::Mixed,
            _ => Layout::Regular,
        }
    }

    pub fn sizes(self) -> Vec<BoxSize> {
        self.layout().sizes()
    }

    /// The cartons that should be found, and everything that stands there.
    pub fn scene(self, top: f64, seed: u64) -> (Vec<Carton>, Vec<RenderShape>) {
        let gap = if self == Self::MixedSizes1mm {
            0.001
        } else {
            0.003
        };
        let mut cartons = layer(self.layout(), gap, top, seed);
        let chosen = seed as usize % cartons.len();
        let mut wanted: Vec<usize> = (0..cartons.len()).collect();
        let mut more = Vec::new();
        match self {
            Self::MixedSizes3mm | Self::MixedSizes1mm => {}
            Self::OneTilted => {
                // One of the first row, its far long side raised: clear of its neighbours.
                let tilted = &mut cartons[seed as usize % 4];
                tilted.tilt[0] = -5f64.to_radians();
                tilted.y -= 0.03;
                tilted.top += 0.008;
            }
            Self::TwoHeights => {
                for carton in &mut cartons[..8] {
                    carton.top -= 0.1;
                }
            }
            Self::UpperCovers => {
                let upper = Carton {
                    top: top + HEIGHT,
                    ..cartons[chosen]
                };
                // Standing across the middle of one and over the half of another, it covers both.
                let upper = Carton {
                    x: upper.x + if upper.x > 0.0 { -0.15 } else { 0.15 },
                    ..upper
                };
                wanted.retain(|&n| {
                    (cartons[n].x - upper.x).abs() > 0.29 || (cartons[n].y - upper.y).abs() > 0.19
                });
                let kept: Vec<Carton> = wanted.iter().map(|&n| cartons[n]).collect();
                let mut shapes = stacked(&cartons, top);
                shapes.push(upper.shape(3000));
                return (kept.into_iter().chain([upper]).collect(), shapes);
            }
            Self::BlackTape => {
                for (n, c) in cartons.iter().enumerate() {
                    let mut strip = block(
                        4000 + n as u32,
                        [c.x, c.y, c.top],
                        [c.size[0] - 0.004, 0.040, 0.000_2],
                        c.yaw,
                        Material::BLACK_TAPE,
                    );
                    strip.world_from_shape.translation.z += 0.000_1;
                    more.push(strip);
                }
            }
            Self::SlipSheet => {
                wanted.clear();
                more.push(block(
                    2000,
                    [0.0, 0.0, top + 0.003],
                    [1.2, 0.8, 0.003],
                    0.004,
                    Material::KRAFT,
                ));
            }
        }
        let mut shapes = stacked(&cartons, top);
        shapes.extend(more);
        (wanted.iter().map(|&n| cartons[n]).collect(), shapes)
    }
}
