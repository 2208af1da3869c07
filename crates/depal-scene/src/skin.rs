//! What the cartons' outside is made of, as the camera sees it.

use crate::choice::choice;
use crate::reader::Checker;
use crate::stack::{CartonBlock, Cartons, long_and_short_mm};

/// A label is turned by no more than this either way, degrees: by hand or by a machine, it is put on squarely.
pub(crate) const LABEL_TURN_DEG: f64 = 5.0;

choice! {
    /// What the outside of a carton is made of.
    pub enum CartonSurface {
        /// Brown corrugated board.
        Kraft = "kraft",
        /// White board: it scatters more light back than brown one.
        White = "white",
        /// Stretch film over brown board: folds, scatter and some gloss.
        Film = "film",
        /// Board printed black: little light comes back, and far off none.
        Black = "black",
    }
}

choice! {
    /// Tape over the flaps of a carton.
    pub enum CartonTape {
        /// No tape.
        None = "none",
        /// Paper tape, which looks like brown board.
        Kraft = "kraft",
        /// Black tape: it swallows the projector's pattern, and most of its depth is lost.
        Black = "black",
        /// Clear or brown film with a glossy back: around the projector's mirror image it is over-exposed.
        Glossy = "glossy",
    }
}

/// Board, tape and label of a carton of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Skin {
    pub(crate) surface: CartonSurface,
    pub(crate) tape: CartonTape,
    pub(crate) tape_width_mm: f64,
    pub(crate) label_mm: Option<[f64; 2]>,
}

impl Cartons {
    /// What cartons of a block, or those of no block, look like.
    pub(crate) fn skin(&self, block: Option<&CartonBlock>) -> Skin {
        Skin {
            surface: block.and_then(|b| b.surface).unwrap_or(self.surface),
            tape: block.and_then(|b| b.tape).unwrap_or(self.tape),
            tape_width_mm: block
                .and_then(|b| b.tape_width_mm)
                .unwrap_or(self.tape_width_mm),
            label_mm: block.and_then(|b| b.label_mm).or(self.label_mm),
        }
    }
}

/// Along and across the long side, mm: the most room that a label of these sides needs at any turn that it may have.
pub(crate) fn label_room_mm([a, b]: [f64; 2]) -> [f64; 2] {
    let most = |along: f64, across: f64| {
        // Greatest where its diagonal lies along, if it may be turned so far.
        let turn = across.atan2(along).min(LABEL_TURN_DEG.to_radians());
        along * turn.cos() + across * turn.sin()
    };
    [most(a, b), most(b, a)]
}

/// Flat part of a top, along its long and its short side, mm.
pub(crate) fn flat_mm(size_mm: [f64; 3], edge_radius_mm: f64) -> [f64; 2] {
    long_and_short_mm(size_mm).map(|side| side - 2.0 * edge_radius_mm)
}

/// Tape and label must have room on the flat part of every top.
pub(crate) fn check_skins(cartons: &Cartons, checker: &mut Checker<'_, '_>) {
    let own = cartons.block.is_empty().then_some((None, cartons.size_mm));
    let blocks = cartons.block.iter().map(|b| (Some(b), b.size_mm));
    for (block, size_mm) in own.into_iter().chain(blocks) {
        let skin = cartons.skin(block);
        let [along, across] = flat_mm(size_mm, cartons.edge_radius_mm);
        let key = |is_own: bool, name: &'static str| if is_own { "block" } else { name };
        if skin.tape != CartonTape::None && skin.tape_width_mm > across {
            checker.problem(
                key(
                    block.is_some_and(|b| b.tape_width_mm.is_some()),
                    "tape_width_mm",
                ),
                format!(
                    "expected tape of at most {across} mm (the flat part of the short side of a top), found {}",
                    skin.tape_width_mm
                ),
                None,
            );
        }
        let Some(label_mm) = skin.label_mm else {
            continue;
        };
        let room = label_room_mm(label_mm);
        if room[0] > along || room[1] > across {
            checker.problem(
                key(block.is_some_and(|b| b.label_mm.is_some()), "label_mm"),
                format!(
                    "expected a label that fits on {along} x {across} mm (the flat part of a top) when it is turned by \
                     {LABEL_TURN_DEG} degrees, found {} x {} mm, which needs {:.0} x {:.0} mm",
                    label_mm[0], label_mm[1], room[0], room[1]
                ),
                Some("its first side lies along the long side of the carton"),
            );
        }
    }
}
