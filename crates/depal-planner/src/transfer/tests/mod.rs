mod cell;
mod hard;
mod pallet;
mod time_law;
