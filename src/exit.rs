//! Exit codes and the failures that lead to them. Codes are documented in docs/CLI.md and never reused.

use glint_bake_core::error::BakeError;
use std::path::Path;

/// One row a code feeds the enum, the help and the list that the tests compare with docs/CLI.md.
macro_rules! exits {
    ($($name:ident = $code:literal, $meaning:literal;)*) => {
        /// How a program ends.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Exit {
            $(#[doc = $meaning] $name = $code,)*
        }

        impl Exit {
            /// Every code with its meaning, in order.
            pub const ALL: &[(Exit, &str)] = &[$((Exit::$name, $meaning),)*];
        }

        /// The codes as `--help` shows them.
        pub const HELP: &str = concat!("Exit codes:", $("\n  ", stringify!($code), "  ", $meaning),*);
    };
}

exits! {
    Success = 0, "success";
    Unexpected = 1, "unexpected: a fault of this program";
    Usage = 2, "usage: an argument is wrong";
    InputOutput = 3, "input or output: a file cannot be read or written";
    BadInput = 4, "bad input: a file is damaged or is not what it should be";
    Unsupported = 5, "unsupported: a file is sound but of a kind that is not read";
    LimitExceeded = 6, "limit exceeded: memory, size or the error that was asked for";
    Differs = 7, "differs: two things that should be equal are not";
    Interrupted = 130, "interrupted";
}

/// Why a program stops, with the code it stops with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// The code.
    pub exit: Exit,
    /// What is said on standard error; may be empty when all was said already.
    pub message: String,
}

impl Failure {
    /// A failure with its message.
    pub fn new(exit: Exit, message: impl Into<String>) -> Failure {
        Failure { exit, message: message.into() }
    }

    /// A wrong argument.
    pub fn usage(message: impl Into<String>) -> Failure {
        Failure::new(Exit::Usage, message)
    }

    /// A file that cannot be read or written.
    pub fn io(path: &Path, what: &str, error: &std::io::Error) -> Failure {
        Failure::new(Exit::InputOutput, format!("{}: {what}: {error}", path.display()))
    }

    /// A bake of `path` that cannot be done.
    pub fn bake(path: &Path, error: &BakeError) -> Failure {
        Failure::new(exit_of(error), format!("{}: {}", path.display(), message_of(error)))
    }
}

/// What went wrong. Options that are bad or ask for too much stand before a colon by their names, which are those of their flags:
/// `entries, lobe-std: expected …`.
fn message_of(error: &BakeError) -> String {
    let is_name = |text: &str| {
        text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-') && !text.starts_with('-')
    };
    let (BakeError::BadOption(what) | BakeError::LimitExceeded(what)) = error else { return error.to_string() };
    match what.split_once(": ") {
        Some((names, rest)) if names.split(", ").all(is_name) => {
            let flags: Vec<String> = names.split(", ").map(|name| format!("--{name}")).collect();
            format!("{}: {rest}", flags.join(", "))
        }
        _ => what.clone(),
    }
}

fn exit_of(error: &BakeError) -> Exit {
    match error {
        BakeError::BadInput(_) => Exit::BadInput,
        BakeError::BadOption(_) => Exit::Usage,
        BakeError::LimitExceeded(_) => Exit::LimitExceeded,
    }
}

impl From<BakeError> for Failure {
    /// A bake that has no input to name.
    fn from(error: BakeError) -> Failure {
        Failure::new(exit_of(&error), message_of(&error))
    }
}

#[cfg(feature = "view")]
impl From<glint_view::gpu::GpuError> for Failure {
    fn from(error: glint_view::gpu::GpuError) -> Failure {
        use glint_view::gpu::GpuError;
        let exit = match error {
            GpuError::NoAdapter { .. } | GpuError::NoDevice { .. } | GpuError::Failed(_) => Exit::Unsupported,
            GpuError::Refused(_) => Exit::Unexpected,
            GpuError::BadPack(_) => Exit::BadInput,
            GpuError::TooLarge(_) => Exit::LimitExceeded,
        };
        Failure::new(exit, error.to_string())
    }
}
