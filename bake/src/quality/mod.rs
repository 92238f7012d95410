//! How error is measured, the same way for every method.

pub mod metrics;
pub mod sweep;
