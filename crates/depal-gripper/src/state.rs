use std::collections::{BTreeMap, BTreeSet};

use crate::cup::{CupState, Opening};
use crate::zone::Zone;
use crate::{CupContact, CupForce, GripEvent, GripperSpec, LossReason};

/// Below this share of the supply a vented section no longer holds anything on purpose.
const RELEASED_FRACTION: f64 = 0.05;

/// A gripper at an instant: valves, section pressures, seals, and which cartons it holds.
#[derive(Debug, Clone, PartialEq)]
pub struct GripperState {
    zones: Vec<Zone>,
    cups: Vec<CupState>,
    grips: BTreeMap<u32, Grip>,
    events: Vec<GripEvent>,
    available_vacuum: f64,
}

/// The story of one carton at the cups, from the first touch with an open valve to its end.
#[derive(Debug, Clone, PartialEq, Default)]
struct Grip {
    started: bool,
    /// The start has been written as an event.
    reported: bool,
    sections: BTreeSet<usize>,
    touching: bool,
    sealed_cups: usize,
    /// Of the latest update, N.
    limit: f64,
    load: f64,
    /// Highest limit so far, N.
    best_limit: f64,
    /// (load, limit) just before the first cup opened, N.
    before_opening: Option<(f64, f64)>,
    pulled_off: usize,
    uncovered: usize,
}

impl GripperState {
    /// All valves closed, no vacuum, nothing held.
    pub fn new(spec: &GripperSpec) -> Self {
        Self {
            zones: vec![Zone::default(); spec.sections.len()],
            cups: vec![CupState::default(); spec.cups.len()],
            grips: BTreeMap::new(),
            events: Vec::new(),
            available_vacuum: spec.vacuum.supply_vacuum,
        }
    }

    /// What the pump can reach from now on, Pa below ambient: a weak pump or a lost supply.
    /// The vacuum switches keep their set points.
    pub fn set_available_vacuum(&mut self, vacuum: f64) {
        self.available_vacuum = vacuum.max(0.0);
    }

    /// Advances valves, seals and pressures by `dt` seconds and gives the forces of the cups.
    ///
    /// `valves`: one command per section, in the spec's order; missing ones count as closed.
    /// `contacts`: one per cup, in the spec's order; missing ones count as open.
    /// The forces come in the order of the cups, one for every cup pressed on a carton.
    pub fn update(
        &mut self,
        spec: &GripperSpec,
        valves: &[bool],
        contacts: &[CupContact],
        dt: f64,
    ) -> Vec<CupForce> {
        let contact = |cup: usize| contacts.get(cup).copied().unwrap_or(CupContact::OPEN);
        for (index, zone) in self.zones.iter_mut().enumerate() {
            zone.valve = valves.get(index).copied().unwrap_or(false);
        }
        self.follow_lips(spec, &contact);
        for (index, zone) in self.zones.iter_mut().enumerate() {
            let cups = spec.cups.iter().zip(&self.cups);
            let (mut sealed, mut open) = (0.0, 0.0);
            for (_, state) in cups.filter(|(cup, _)| cup.section == index) {
                sealed += state.seal;
                open += 1.0 - state.seal;
            }
            zone.advance(&spec.vacuum, self.available_vacuum, sealed, open, dt);
        }
        let mut forces = Vec::new();
        for (index, (cup, state)) in spec.cups.iter().zip(&mut self.cups).enumerate() {
            let vacuum = self.zones[cup.section].vacuum;
            let friction = spec.vacuum.friction;
            forces.extend(state.force(index, cup, &contact(index), vacuum, friction, dt));
        }
        self.follow_grips(spec, &contact, &forces);
        forces
    }

    fn follow_lips(&mut self, spec: &GripperSpec, contact: &impl Fn(usize) -> CupContact) {
        for (index, cup) in spec.cups.iter().enumerate() {
            let sealed_on = self.cups[index].sealed_on;
            let opening = self.cups[index].follow(&contact(index));
            let (Some(opening), Some(carton)) = (opening, sealed_on) else {
                continue;
            };
            let Some(grip) = self.grips.get_mut(&carton) else {
                continue;
            };
            if self.zones[cup.section].valve {
                grip.before_opening.get_or_insert((grip.load, grip.limit));
                match opening {
                    Opening::PulledOff => grip.pulled_off += 1,
                    Opening::Uncovered => grip.uncovered += 1,
                }
            }
        }
    }

    fn follow_grips(
        &mut self,
        spec: &GripperSpec,
        contact: &impl Fn(usize) -> CupContact,
        forces: &[CupForce],
    ) {
        for grip in self.grips.values_mut() {
            grip.touching = false;
            grip.sealed_cups = 0;
            grip.limit = 0.0;
            grip.load = 0.0;
        }
        for (index, (cup, state)) in spec.cups.iter().zip(&self.cups).enumerate() {
            let contact = contact(index);
            let Some(carton) = contact.carton.filter(|_| contact.gap <= 0.0) else {
                continue;
            };
            let zone = &self.zones[cup.section];
            if zone.valve {
                self.grips.entry(carton).or_default().touching = true;
            }
            let Some(grip) = self.grips.get_mut(&carton) else {
                continue;
            };
            if state.sealed_on == Some(carton) {
                grip.sealed_cups += 1;
                grip.limit += state.limit(cup, zone.vacuum);
                grip.sections.insert(cup.section);
                grip.started |= zone.switch && zone.valve;
            }
        }
        for force in forces {
            if let Some(grip) = self.grips.get_mut(&force.carton) {
                grip.load += force.pull;
            }
        }
        self.report_grips(spec);
    }

    /// Begins and ends the stories and writes their events, in the order of carton numbers.
    fn report_grips(&mut self, spec: &GripperSpec) {
        let any_held = self.grips.values().any(|grip| grip.started);
        let vented = RELEASED_FRACTION * spec.vacuum.supply_vacuum;
        let mut events = Vec::new();
        let zones = &self.zones;
        self.grips.retain(|&carton, grip| {
            grip.best_limit = grip.best_limit.max(grip.limit);
            if grip.started && !grip.reported {
                grip.reported = true;
                events.push(GripEvent::Started {
                    carton,
                    sections: grip.sections.iter().copied().collect(),
                });
            }
            let lost = |reason, (load_n, limit_n)| GripEvent::Lost {
                carton,
                reason,
                load_n,
                limit_n,
            };
            if grip.started {
                let mut sections = grip.sections.iter().map(|&index| &zones[index]);
                let closed = sections.clone().all(|zone| !zone.valve);
                if closed && (grip.sealed_cups == 0 || sections.all(|z| z.vacuum < vented)) {
                    events.push(GripEvent::Released { carton });
                    return false;
                }
                if !closed && grip.sealed_cups == 0 {
                    let reason = if grip.pulled_off >= grip.uncovered {
                        LossReason::Dropped
                    } else {
                        LossReason::SealLost
                    };
                    let figures = grip.before_opening.unwrap_or((grip.load, grip.best_limit));
                    events.push(lost(reason, figures));
                    return false;
                }
                return true;
            }
            if !grip.touching {
                if !any_held {
                    events.push(lost(LossReason::NoSeal, (0.0, grip.best_limit)));
                }
                return false;
            }
            true
        });
        self.events.append(&mut events);
    }

    /// The events since the last call, in the order in which they happened.
    pub fn take_events(&mut self) -> Vec<GripEvent> {
        std::mem::take(&mut self.events)
    }

    /// True when at least one valve is open and the switch of every open one is closed.
    pub fn vacuum_ok(&self) -> bool {
        let mut open = self.zones.iter().filter(|zone| zone.valve).peekable();
        open.peek().is_some() && open.all(|zone| zone.switch)
    }

    /// Vacuum of a section, Pa below ambient; zero for an unknown section.
    pub fn section_vacuum(&self, section: usize) -> f64 {
        self.zones.get(section).map_or(0.0, |zone| zone.vacuum)
    }

    /// Vacuum switch of a section; open for an unknown section.
    pub fn section_switch(&self, section: usize) -> bool {
        self.zones.get(section).is_some_and(|zone| zone.switch)
    }

    /// Cartons held now: the switch has closed and the grip has not ended. Ascending.
    pub fn held_cartons(&self) -> Vec<u32> {
        let held = self.grips.iter().filter(|(_, grip)| grip.started);
        held.map(|(&carton, _)| carton).collect()
    }

    /// Cartons on which at least one cup is sealed, with vacuum or without.
    pub fn cartons_at_cups(&self) -> BTreeSet<u32> {
        self.cups.iter().filter_map(|cup| cup.sealed_on).collect()
    }

    /// Number of cups sealed on a carton.
    pub fn sealed_cups(&self, carton: u32) -> usize {
        let sealed = self.cups.iter();
        sealed.filter(|cup| cup.sealed_on == Some(carton)).count()
    }

    /// What the cups on a carton could hold in the latest update, N; zero when it is not gripped.
    pub fn holding_force(&self, carton: u32) -> f64 {
        self.grips.get(&carton).map_or(0.0, |grip| grip.limit)
    }

    /// Sum of the cups' pull on a carton in the latest update, N: negative while pressed on.
    pub fn load(&self, carton: u32) -> f64 {
        self.grips.get(&carton).map_or(0.0, |grip| grip.load)
    }
}
