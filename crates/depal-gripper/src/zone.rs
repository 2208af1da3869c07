use crate::VacuumSpec;

/// Lowest set point of a vacuum switch, Pa: below it the pressure drop of air that merely flows
/// through open cups would close it.
const SWITCH_FLOOR: f64 = 5_000.0;

/// Memory of one section: its pressure and its switch.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Zone {
    /// The valve's command.
    pub valve: bool,
    /// Below ambient, Pa.
    pub vacuum: f64,
    /// Vacuum switch, with hysteresis.
    pub switch: bool,
}

impl Zone {
    /// Advances the pressure by `dt` seconds with `open_cups` lips open (a fraction counts).
    ///
    /// `dp/dt = (target - p) / tau`, solved exactly, so that the result does not depend on `dt`:
    /// the target is what the pump reaches against the open cups, or zero with the valve closed.
    pub fn advance(&mut self, spec: &VacuumSpec, available: f64, open_cups: f64, dt: f64) {
        let (target, time) = if self.valve {
            let share = (1.0 - spec.open_cup_loss * open_cups).max(0.0);
            (available * share, spec.build_up_time)
        } else {
            (0.0, spec.blow_off_time)
        };
        self.vacuum = if time > 0.0 {
            target + (self.vacuum - target) * (-dt / time).exp()
        } else {
            target
        };
        let fraction = if self.switch {
            spec.switch_off_fraction
        } else {
            spec.switch_on_fraction
        };
        self.switch = self.vacuum >= (fraction * spec.supply_vacuum).max(SWITCH_FLOOR);
    }
}
