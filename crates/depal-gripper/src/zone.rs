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
    /// Available vacuum, sealed and open cups for which the balance was found last, and the balance.
    balance: Option<([f64; 3], f64)>,
}

impl Zone {
    /// What the section would come to; found anew only when a lip or the pump has changed.
    fn target(&mut self, spec: &VacuumSpec, available: f64, sealed: f64, open: f64) -> f64 {
        let asked = [available, sealed, open];
        match self.balance {
            Some((known, balance)) if known == asked => balance,
            _ => {
                let balance = spec.reached(sealed, open, available);
                self.balance = Some((asked, balance));
                balance
            }
        }
    }

    /// Advances the pressure by `dt` seconds with so many lips sealed and open (fractions count).
    ///
    /// `dp/dt = (target - p) / tau`, solved exactly, so that the result does not depend on `dt`:
    /// the target is what the pump reaches against the open cups, or zero with the valve closed.
    pub fn advance(&mut self, spec: &VacuumSpec, available: f64, sealed: f64, open: f64, dt: f64) {
        let (target, time) = if self.valve {
            let target = self.target(spec, available, sealed, open);
            (target, spec.build_up_time)
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
