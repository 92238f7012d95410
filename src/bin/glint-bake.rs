//! Bakes packs, and shows what they look like.

fn main() -> std::process::ExitCode {
    glint_bake::cli::run(std::env::args_os(), glint_bake::commands::bake)
}
