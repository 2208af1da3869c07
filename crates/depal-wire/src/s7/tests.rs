mod block;
mod golden;
mod laws;
