mod block;
mod client;
mod golden;
mod laws;
mod offered_block;
