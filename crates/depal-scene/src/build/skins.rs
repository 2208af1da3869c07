//! What the camera sees of each carton.

use depal_camera::Material;
use depal_cell::skin::{CartonSkin, Label, Tape};
use depal_time::RandomStream;

use crate::layout::CartonPlacement;
use crate::scene::Scene;
use crate::skin::{CartonSurface, CartonTape, LABEL_TURN_DEG, flat_mm, label_room_mm};

/// White board: as white as a paper label.
const WHITE_BOARD: Material = Material::LABEL;
/// Board printed black: as dark as the dots of a calibration board.
const BLACK_BOARD: Material = Material::matt(0.05);

/// One for each carton. Every carton takes its draws, whether it has a label or not.
pub(super) fn skins(scene: &Scene, placements: &[CartonPlacement]) -> Vec<CartonSkin> {
    let mut random = scene.streams().stream("cartons.label");
    placements
        .iter()
        .map(|placement| skin(scene, placement, &mut random))
        .collect()
}

fn skin(scene: &Scene, placement: &CartonPlacement, random: &mut RandomStream) -> CartonSkin {
    let cartons = &scene.cartons;
    let block = placement.block.and_then(|n| cartons.block.get(n as usize));
    let skin = cartons.skin(block);
    let tape = match skin.tape {
        CartonTape::None => None,
        CartonTape::Kraft => Some(Material::KRAFT),
        CartonTape::Black => Some(Material::BLACK_TAPE),
        CartonTape::Glossy => Some(Material::GLOSSY_TAPE),
    };
    let size_mm = block.map_or(cartons.size_mm, |block| block.size_mm);
    let mut draw = |most: f64| random.uniform(-most, most);
    let (x, y, turn) = (draw(1.0), draw(1.0), draw(LABEL_TURN_DEG));
    let label = skin.label_mm.map(|label_mm| {
        let flat = flat_mm(size_mm, cartons.edge_radius_mm);
        let room = label_room_mm(label_mm);
        let spare = [0, 1].map(|side| 0.5 * (flat[side] - room[side]).max(0.0) * 1e-3);
        Label {
            size: label_mm.map(|side| side * 1e-3),
            at: [x * spare[0], y * spare[1]],
            turn: turn.to_radians(),
        }
    });
    CartonSkin {
        board: match skin.surface {
            CartonSurface::Kraft => Material::KRAFT,
            CartonSurface::White => WHITE_BOARD,
            CartonSurface::Film => Material::FILM,
            CartonSurface::Black => BLACK_BOARD,
        },
        tape: tape.map(|material| Tape {
            material,
            width: skin.tape_width_mm * 1e-3,
        }),
        label,
    }
}
