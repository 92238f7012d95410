#!/bin/sh
# Everything a change must pass: format, lint, licences where cargo-deny is installed, and all tests.
# `just test`, .ci/run and the README call this; it needs nothing but Rust and a C compiler. Tests of the viewer skip where
# there is no GPU adapter; GLINT_REQUIRE_ADAPTER=1 makes them fail instead.
set -eu
cd "$(dirname "$0")/.."

cargo fmt --all --check
cargo clippy --workspace --all-targets --all-features --locked -- -D warnings
if cargo deny --version >/dev/null 2>&1; then
    cargo deny check licenses bans sources
else
    echo "cargo-deny is not installed: licences were not checked (cargo install cargo-deny --locked)"
fi
cargo test --workspace --all-features --locked
