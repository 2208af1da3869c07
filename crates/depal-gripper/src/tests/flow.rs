//! Pump curves and leaks.

use super::*;

/// 20 l/s open, nothing at 40 kPa, straight between; cups behind holes of 4 mm2.
fn flow() -> FlowSpec {
    FlowSpec {
        pump: vec![[0.0, 0.020], [40_000.0, 0.0]],
        orifice: 4.0e-6,
        open_share: 1.0,
        porosity: 0.0,
    }
}

fn with(flow: FlowSpec) -> GripperSpec {
    let mut spec = GripperSpec::four_sections();
    spec.vacuum.supply_vacuum = 40_000.0;
    spec.vacuum.flow = Some(flow);
    spec
}

/// Vacuum of the first section after two seconds with so many of its twelve cups on a carton.
fn settled(spec: &GripperSpec, covered: usize) -> f64 {
    let mut state = GripperState::new(spec);
    let contacts = vec![CupContact::touching(1, -0.01); covered];
    for _ in 0..500 {
        state.update(spec, &[true], &contacts, 0.004);
    }
    state.section_vacuum(0)
}

/// Pump `Q0 (1 - p / p0)` against `n C A sqrt(2 p / rho)`: a quadratic in the root of p.
fn by_hand(open: f64) -> f64 {
    let jet = open * 0.62 * 4.0e-6 * (2.0f64 / 1.2).sqrt();
    let (a, b, c) = (0.020 / 40_000.0, jet, -0.020);
    let root = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    root * root
}

#[test]
fn open_cups_leak_by_the_orifice_law() {
    let spec = with(flow());
    assert!((settled(&spec, 12) - 40_000.0).abs() < 1.0);
    let mut before = 40_000.0;
    for covered in [11, 9, 6, 3] {
        let (found, hand) = (settled(&spec, covered), by_hand((12 - covered) as f64));
        assert!(
            (found - hand).abs() < 0.01 * hand,
            "{covered} covered: {found} Pa, by hand {hand} Pa"
        );
        assert!(found < before);
        before = found;
    }
}

#[test]
fn resistors_and_check_valves_keep_the_vacuum() {
    let half = |flow| settled(&with(flow), 6);
    let plain = half(FlowSpec {
        orifice: 40.0e-6,
        ..flow()
    });
    let resistors = half(flow());
    let valves = half(FlowSpec {
        orifice: 40.0e-6,
        open_share: 0.02,
        ..flow()
    });
    assert!(
        plain < 0.6 * resistors,
        "{plain} Pa, with resistors {resistors} Pa"
    );
    assert!(
        valves > 1.05 * resistors && valves < 40_000.0,
        "{valves} Pa with check valves"
    );
}

#[test]
fn porous_board_costs_vacuum_and_the_spec_knows_it() {
    // 12 cups of 1 ml/s at a kilopascal: Q0 (1 - p / p0) = 12 k p.
    let spec = with(FlowSpec {
        porosity: 1.0e-9,
        ..flow()
    });
    let hand = 0.020 / (0.020 / 40_000.0 + 12.0e-9);
    assert!((settled(&spec, 12) - hand).abs() < 1.0);
    assert!((spec.sealed_vacuum(0) - hand).abs() < 1.0);
}

#[test]
fn a_weak_pump_reaches_its_share() {
    let spec = with(flow());
    let mut state = GripperState::new(&spec);
    state.set_available_vacuum(10_000.0);
    let contacts = vec![CupContact::touching(1, -0.01); 12];
    for _ in 0..500 {
        state.update(&spec, &[true], &contacts, 0.004);
    }
    assert!((state.section_vacuum(0) - 10_000.0).abs() < 1.0);
    assert!(!state.vacuum_ok());
}
