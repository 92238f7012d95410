//! What the three programs share: flags, files, progress, reports.

pub mod input;
