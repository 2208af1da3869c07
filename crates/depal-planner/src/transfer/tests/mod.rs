mod cell;
mod pallet;
mod time_law;
