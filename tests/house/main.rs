//! The plan of the house: which way imports run, and that a shader and its twin are the same functions.

mod crates;
mod imports;
mod twins;
