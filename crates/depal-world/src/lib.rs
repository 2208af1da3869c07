//! The physics: cartons, pallet, conveyor, arm links and cup forces on rapier.
