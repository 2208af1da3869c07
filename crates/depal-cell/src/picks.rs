//! From valve edges and physics events to picks with one outcome each.

use std::collections::{BTreeMap, BTreeSet};

use depal_frames::Pose;
use depal_gripper::LossReason;
use depal_time::{SimDuration, SimTime};
use depal_world::{Body, WorldEvent};

use crate::event::{EventKind, FailureReason, round};
use crate::score::{CartonFate, Score};
use crate::standing::{Aim, Deviation};

/// A released carton must touch the belt within this time, or the place was missed.
const PLACE_TIME: SimDuration = SimDuration::from_millis(1500);

/// A carton that was put on a place of a pattern is looked at after this time.
const STAND_TIME: SimDuration = SimDuration::from_millis(1000);

/// Follows the gripper through picks. A pick runs from vacuum on to the carton on the belt.
#[derive(Debug, Default)]
pub(crate) struct PickKeeper {
    valves_on: bool,
    vacuum_ok: bool,
    released_at: Option<SimTime>,
    /// Cartons that reached the belt or their place.
    arrived: BTreeSet<u32>,
    /// Place of the pattern that the open pick goes to, robot base.
    place: Option<Pose>,
    /// Places on which cartons were put, robot base.
    places: BTreeMap<u32, Pose>,
    last_failure: BTreeMap<u32, (FailureReason, String)>,
    collided: bool,
}

impl PickKeeper {
    /// Whether anything was hit in this run.
    pub(crate) fn collided(&self) -> bool {
        self.collided
    }

    /// Whether a carton has been put on a place of a pattern and is yet to be looked at.
    pub(crate) fn awaits_stand(&self) -> bool {
        self.place.is_some() && self.released_at.is_some()
    }

    /// Valves and vacuum switch of this tick. `aim` is what the current plan aims at, `deviation` tells how far a carton is
    /// from a place in the robot base.
    pub(crate) fn valves(
        &mut self,
        now: SimTime,
        valves: &[bool],
        vacuum_ok: bool,
        aim: impl FnOnce() -> Aim,
        deviation: impl Fn(u32, &Pose) -> Option<Deviation>,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        let on = valves.iter().any(|valve| *valve);
        if on && !self.valves_on {
            self.conclude(now, score, events);
            let Aim {
                cartons: targets,
                place,
            } = aim();
            self.place = place;
            let pick = score.start_pick(now, targets.clone());
            let sections = (0..valves.len()).filter(|i| valves[*i]).collect();
            events.push(EventKind::PickStarted {
                pick,
                sections,
                target: targets.first().copied(),
                targets,
            });
        }
        if vacuum_ok
            && !self.vacuum_ok
            && let Some(pick) = score.open_pick_mut()
        {
            pick.vacuum_reached = true;
            events.push(EventKind::VacuumReached { pick: pick.number });
        }
        let released = !on && self.valves_on;
        self.valves_on = on;
        if released {
            self.released_at = Some(now);
            if score.open_pick().is_some_and(|pick| pick.held.is_empty()) {
                self.conclude(now, score, events);
            }
        }
        self.vacuum_ok = vacuum_ok;
        if let (Some(released_at), Some(place)) = (self.released_at, self.place) {
            if now - released_at > STAND_TIME {
                self.stand(place, deviation, score, events);
                self.conclude(now, score, events);
            }
        } else if let Some(released_at) = self.released_at {
            let on_belt = score.open_pick().is_some_and(|pick| {
                !pick.held.is_empty() && pick.held.iter().all(|c| self.arrived.contains(c))
            });
            if on_belt || now - released_at > PLACE_TIME {
                self.conclude(now, score, events);
            }
        }
    }

    /// Looks whether what was put down stands on its place of a pattern.
    fn stand(
        &mut self,
        place: Pose,
        deviation: impl Fn(u32, &Pose) -> Option<Deviation>,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        let held = score
            .open_pick()
            .map_or(Vec::new(), |pick| pick.held.clone());
        for carton in held {
            let Some(found) = deviation(carton, &place) else {
                continue;
            };
            let (error_mm, error_deg) = (found.distance * 1e3, found.angle.to_degrees());
            if found.is_small() {
                self.arrived.insert(carton);
                self.places.insert(carton, place);
                score.fates.insert(carton, CartonFate::Placed);
                events.push(EventKind::Placed {
                    carton,
                    error_mm: round(error_mm, 1e3),
                    error_deg: round(error_deg, 1e3),
                });
            } else if let Some(pick) = score.open_pick_mut() {
                let detail = format!(
                    "carton {carton} stands {error_mm:.0} mm and {error_deg:.1} degrees off its place"
                );
                pick.failure
                    .get_or_insert((FailureReason::PlaceMissed, detail));
            }
        }
    }

    /// At the end of a run: what still stands on its place is delivered, what does not is lost.
    pub(crate) fn settle_places(
        &mut self,
        deviation: impl Fn(u32, &Pose) -> Option<Deviation>,
        now: SimTime,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        for (&carton, place) in &self.places {
            if score.fates.get(&carton) != Some(&CartonFate::Placed) {
                continue;
            }
            if deviation(carton, place).is_some_and(Deviation::is_small) {
                score.fates.insert(carton, CartonFate::Delivered);
                score.last_delivery = score.last_success.or(Some(now));
            } else {
                let reason = FailureReason::NeighbourMoved;
                score.fates.insert(carton, CartonFate::Lost(reason));
                events.push(EventKind::Lost {
                    carton,
                    reason,
                    detail: "pushed off its place after it had been put there".to_owned(),
                });
            }
        }
    }

    /// Ends the open pick, if there is one.
    pub(crate) fn conclude(
        &mut self,
        now: SimTime,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        self.released_at = None;
        let Some(pick) = score.open_pick() else {
            return;
        };
        let astray = pick.held.iter().find(|c| !self.arrived.contains(c));
        let left_behind = pick.targets.iter().find(|c| !pick.held.contains(c));
        let otherwise = if pick.held.is_empty() {
            Some((
                FailureReason::NoSeal,
                "the vacuum switch did not close on a carton".to_owned(),
            ))
        } else if let Some(carton) = left_behind {
            Some((
                FailureReason::NoSeal,
                format!("carton {carton} of the group was not taken hold of"),
            ))
        } else if let Some(carton) = astray.filter(|_| self.valves_on) {
            Some((
                FailureReason::Timeout,
                format!("the run ended while carton {carton} was held"),
            ))
        } else {
            astray.map(|carton| {
                (
                    FailureReason::PlaceMissed,
                    format!("carton {carton} was released but did not reach its place"),
                )
            })
        };
        let Some((pick, failure, cycle)) = score.finish_pick(now, otherwise) else {
            return;
        };
        if let Some(failure) = &failure {
            for carton in pick.held.iter().chain(&pick.targets) {
                let is_placed = self.arrived.contains(carton);
                if !is_placed {
                    self.last_failure.insert(*carton, failure.clone());
                }
            }
        }
        events.push(EventKind::PickFinished {
            pick: pick.number,
            carton: pick.held.first().copied(),
            cartons: pick.held,
            reason: failure.as_ref().map(|(reason, _)| *reason),
            detail: failure.map_or_else(
                || {
                    if self.place.is_some() {
                        "on its place"
                    } else {
                        "delivered to the belt"
                    }
                    .to_owned()
                },
                |(_, detail)| detail,
            ),
            cycle_s: round(cycle.as_secs_f64(), 1e6),
        });
    }

    /// One physics event. Returns the description of a collision that the controller must hear of.
    pub(crate) fn world_event(
        &mut self,
        event: &WorldEvent,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) -> Option<String> {
        match event {
            WorldEvent::GripStarted { carton, .. } => {
                if let Some(pick) = score.open_pick_mut() {
                    if !pick.targets.is_empty() && !pick.targets.contains(&carton.0) {
                        let planned: Vec<String> =
                            pick.targets.iter().map(u32::to_string).collect();
                        pick.failure.get_or_insert((
                            FailureReason::WrongBox,
                            format!(
                                "planned carton {}, took hold of carton {}",
                                planned.join(" and "),
                                carton.0
                            ),
                        ));
                    }
                    if !pick.held.contains(&carton.0) {
                        pick.held.push(carton.0);
                    }
                    events.push(EventKind::Gripped {
                        pick: pick.number,
                        carton: carton.0,
                    });
                }
            }
            WorldEvent::GripReleased { .. } => {}
            WorldEvent::GripLost {
                carton,
                reason,
                load_n,
                limit_n,
            } => {
                let reason = match reason {
                    LossReason::NoSeal => FailureReason::NoSeal,
                    LossReason::SealLost => FailureReason::SealLost,
                    LossReason::Dropped => FailureReason::Dropped,
                };
                let detail = format!(
                    "carton {}: load {load_n:.0} N, the sealed cups hold {limit_n:.0} N",
                    carton.0
                );
                if let Some(pick) = score.open_pick_mut() {
                    pick.failure.get_or_insert((reason, detail.clone()));
                    events.push(EventKind::GripLost {
                        pick: pick.number,
                        carton: carton.0,
                        reason,
                        detail: detail.clone(),
                    });
                }
                self.last_failure.insert(carton.0, (reason, detail));
            }
            WorldEvent::CartonTouchedBelt { carton, .. } => {
                self.arrived.insert(carton.0);
                score.fates.insert(carton.0, CartonFate::OnConveyor);
            }
            WorldEvent::CartonDelivered { carton, .. } => {
                score.fates.insert(carton.0, CartonFate::Delivered);
                events.push(EventKind::Delivered { carton: carton.0 });
            }
            WorldEvent::CartonOnFloor { carton } => {
                let (reason, detail) = self.last_failure.get(&carton.0).cloned().unwrap_or((
                    FailureReason::NeighbourMoved,
                    "pushed off without having been picked".to_owned(),
                ));
                score.fates.insert(carton.0, CartonFate::Lost(reason));
                events.push(EventKind::Lost {
                    carton: carton.0,
                    reason,
                    detail,
                });
            }
            WorldEvent::NeighbourMoved { carton, distance } => {
                events.push(EventKind::NeighbourMoved {
                    carton: carton.0,
                    distance_mm: round(distance * 1e3, 1e3),
                });
            }
            WorldEvent::Collision { a, b, force_n } => {
                let (a, b) = (body_name(a), body_name(b));
                let text = if force_n.is_finite() {
                    format!("{a} hit {b} with {force_n:.0} N")
                } else {
                    format!("{a} ran into {b}")
                };
                self.collided = true;
                if let Some(pick) = score.open_pick_mut() {
                    pick.failure
                        .get_or_insert((FailureReason::Collision, text.clone()));
                }
                // Infinity has no JSON form; nothing gives way, so the largest float says as much.
                let force_n = round(force_n.min(1e6), 1e3);
                events.push(EventKind::Collision { a, b, force_n });
                return Some(text);
            }
        }
        None
    }
}

fn body_name(body: &Body) -> String {
    match body {
        Body::Carton(id) => format!("carton {}", id.0),
        Body::Link(name) => format!("arm link {name}"),
        Body::Tool => "gripper".to_owned(),
        Body::Cups => "suction cups".to_owned(),
        Body::Fixed(name) | Body::Conveyor(name) => name.clone(),
    }
}
