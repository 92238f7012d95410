//! Errors of writing a pack and of opening one.

use crate::issue::Issue;
use std::fmt;
use thiserror::Error;

/// Why a section or a parameter value was refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FormatError {
    /// The name is not allowed.
    #[error("{section}: {reason}")]
    Name {
        /// Kind and name of the section.
        section: String,
        /// What is wrong.
        reason: String,
    },
    /// The pack has a section of this kind and name already.
    #[error("{section}: the pack has this section already")]
    Duplicate {
        /// Kind and name of the section.
        section: String,
    },
    /// The resource descriptor is impossible.
    #[error("{section}: {reason}")]
    Resource {
        /// Kind and name of the section.
        section: String,
        /// What is wrong.
        reason: String,
    },
    /// Payload and resource descriptor disagree.
    #[error("{section}: the resource descriptor gives {expected} bytes, the payload has {found}")]
    PayloadLength {
        /// Kind and name of the section.
        section: String,
        /// Bytes by the descriptor.
        expected: u64,
        /// Bytes of the payload.
        found: u64,
    },
    /// The pack is full.
    #[error("a pack has at most {most} sections")]
    TooManySections {
        /// The limit.
        most: u32,
    },
    /// Compression failed.
    #[error("{section}: compression failed: {reason}")]
    Compress {
        /// Kind and name of the section.
        section: String,
        /// What the compressor said.
        reason: String,
    },
    /// Parameters are larger than the decode limit.
    #[error("parameters have at most {most} bytes, found {found}")]
    ParametersTooLarge {
        /// The limit.
        most: usize,
        /// Bytes found.
        found: usize,
    },
    /// Parameters do not decode.
    #[error("parameters do not decode: {reason}")]
    Parameters {
        /// What the decoder said.
        reason: String,
    },
    /// Bytes follow the decoded value.
    #[error("the value ends after {used} bytes, the section has {found}")]
    ParametersTrailing {
        /// Bytes of the value.
        used: usize,
        /// Bytes found.
        found: usize,
    },
}

/// Why a pack was not opened.
#[derive(Debug)]
pub enum OpenError {
    /// The file could not be read.
    Io(std::io::Error),
    /// The file was read and is not a pack this program can use.
    Invalid(Vec<Issue>),
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OpenError::Io(error) => error.fmt(f),
            OpenError::Invalid(issues) => {
                for (i, issue) in issues.iter().enumerate() {
                    let line_end = if i == 0 { "" } else { "\n" };
                    write!(f, "{line_end}{issue}")?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for OpenError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            OpenError::Io(error) => Some(error),
            OpenError::Invalid(_) => None,
        }
    }
}
