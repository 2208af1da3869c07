mod beside;
mod cell;
mod collisions;
mod grips;
mod pallet;
