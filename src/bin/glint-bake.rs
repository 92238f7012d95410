//! placeholder, replaced with the command line.
fn main() {}
