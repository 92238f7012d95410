//! What every method looks like on screen: no pixel without a number, the same bytes twice, mean over seeds, slow zooms.

#[path = "../parity/adapter.rs"]
mod adapter;
mod bound;
mod furnace;
mod indirect;
mod pictures;
mod subjects;
mod zoom;
