mod block;
mod golden;
mod laws;
mod offered_block;
