//! Says what a pack holds and whether it is intact.

fn main() -> std::process::ExitCode {
    glint_bake::cli::run(std::env::args_os(), glint_bake::commands::info)
}
