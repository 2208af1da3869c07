/// Density of the air that is drawn in, kg/m3 (20 degrees, 1013 hPa).
const AIR_DENSITY: f64 = 1.2;
/// Share of a hole's area through which the jet passes: sharp-edged hole.
const DISCHARGE: f64 = 0.62;
/// Halvings of the search for the balance of pump and leaks.
const HALVINGS: usize = 48;

/// Air through one section: a pump of its own against holes and porous cardboard.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowSpec {
    /// The pump's curve: vacuum (Pa below ambient) and the flow that it still draws there (m3/s at ambient pressure).
    /// From no vacuum upwards, the flow falling to zero at the last point. Straight between the points.
    pub pump: Vec<[f64; 2]>,
    /// Area of the narrowest hole behind an open cup, m2: the cup's own, or a flow resistor's.
    pub orifice: f64,
    /// Share of that area that stays open when a check valve has shut an open cup; 1 without check valves.
    pub open_share: f64,
    /// Air that a sealed cup draws through the carton's wall, m3/s per Pa: porous cardboard.
    pub porosity: f64,
}

impl FlowSpec {
    /// What the pump draws at this vacuum, m3/s.
    fn drawn(&self, vacuum: f64) -> f64 {
        let Some([first, second]) = self
            .pump
            .windows(2)
            .map(|pair| [pair[0], pair[1]])
            .find(|pair| vacuum <= pair[1][0])
        else {
            return 0.0;
        };
        let span = second[0] - first[0];
        if span <= 0.0 {
            return second[1];
        }
        let share = ((vacuum - first[0]) / span).clamp(0.0, 1.0);
        first[1] + share * (second[1] - first[1])
    }

    /// What leaks in at this vacuum, m3/s: `C A sqrt(2 p / rho)` for every open cup (fractions count), and porosity.
    fn leaked(&self, vacuum: f64, sealed: f64, open: f64) -> f64 {
        let jet = DISCHARGE * self.orifice * self.open_share * (2.0 * vacuum / AIR_DENSITY).sqrt();
        open * jet + sealed * self.porosity * vacuum
    }

    /// Vacuum at which pump and leaks balance, Pa. `strength` scales the pump's vacuum: 1 is a pump in order.
    pub(crate) fn balance(&self, sealed: f64, open: f64, strength: f64) -> f64 {
        let strongest = self.pump.last().map_or(0.0, |point| point[0]) * strength;
        if strongest <= 0.0 {
            return 0.0;
        }
        // The surplus falls with the vacuum.
        let (mut low, mut high) = (0.0, strongest);
        for _ in 0..HALVINGS {
            let middle = (low + high) * 0.5;
            if self.drawn(middle / strength) > self.leaked(middle, sealed, open) {
                low = middle;
            } else {
                high = middle;
            }
        }
        (low + high) * 0.5
    }
}
