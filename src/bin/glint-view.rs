//! Shows packs in a window, or as pictures without one.

fn main() -> std::process::ExitCode {
    glint_bake::cli::run(std::env::args_os(), glint_bake::commands::view)
}
