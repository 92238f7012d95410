//! The frame around every program: response files, parsing, interruption, and the exit code.

mod common;
pub mod normal_maps;
mod option_list;
mod response;
mod run_flags;
mod terminal;
mod threads;
pub mod values;

pub use common::{Colour, Common, ProgressWhen};
pub use option_list::{OptionList, typed};
pub use run_flags::RunFlags;
pub use terminal::{Terminal, bars};
pub use threads::on_threads;

use crate::exit::{Exit, Failure};
use crate::input::is_decoding;
use crate::output;
use clap::Parser;
use std::ffi::OsString;
use std::process::ExitCode;

/// Version, commit, and the pack versions that are read and written.
pub const LONG_VERSION: &str =
    concat!(env!("CARGO_PKG_VERSION"), " (git ", env!("GLINT_GIT_HASH"), ")\npacks: writes 1.0, reads 1.x");

/// The commit this program was built from; empty when it is not known.
pub fn git_hash() -> &'static str {
    match env!("GLINT_GIT_HASH") {
        "unknown" => "",
        hash => hash,
    }
}

/// Parses `args`, runs `program`, prints its failure, and gives the exit code.
pub fn run<P: Parser>(
    args: impl Iterator<Item = OsString>,
    program: impl FnOnce(P) -> Result<(), Failure>,
) -> ExitCode {
    // Without a handler the shell sees a signal, not a code; a second handler cannot be there yet.
    let _ = ctrlc::set_handler(|| {
        output::stop_writing();
        std::process::exit(i32::from(Exit::Interrupted as u8))
    });
    let report_panic = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        // A decoder's panic is caught and becomes an error that names the file.
        if is_decoding() {
            return;
        }
        report_panic(info);
        std::process::exit(i32::from(Exit::Unexpected as u8));
    }));
    let args = match response::expand(args) {
        Ok(args) => args,
        Err(failure) => return finish(Err(failure)),
    };
    match P::try_parse_from(args) {
        Ok(parsed) => finish(program(parsed)),
        Err(error) => {
            // Help and version are errors to clap, with code 0. A closed pipe is no reason to complain.
            let _ = error.print();
            ExitCode::from(error.exit_code() as u8)
        }
    }
}

fn finish(result: Result<(), Failure>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if !failure.message.is_empty() {
                Terminal::from_process().error(&failure.message);
            }
            ExitCode::from(failure.exit as u8)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_formats::container::VERSION;

    #[test]
    fn the_version_names_the_pack_version() {
        assert!(LONG_VERSION.contains(&format!("writes {}.{}, reads {}.x", VERSION.0, VERSION.1, VERSION.0)));
    }
}
