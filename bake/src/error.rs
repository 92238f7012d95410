//! What can be wrong with the input of a bake.

use thiserror::Error;

/// Why a bake cannot be done. Messages name the texel and what to do; the caller adds the file.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum BakeError {
    /// The input's content is unusable (exit code 4).
    #[error("{0}")]
    BadInput(String),
    /// A combination of options that has no meaning (exit code 2).
    #[error("{0}")]
    BadOption(String),
    /// A limit that was asked for cannot be kept (exit code 6).
    #[error("{0}")]
    LimitExceeded(String),
}

/// Result of a bake step.
pub type Result<T> = std::result::Result<T, BakeError>;
