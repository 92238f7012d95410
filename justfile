# The habits of this repository. Everything also works without just; see the README.

# List the recipes.
default:
    @just --list

# Install the tools that are nice to have.
setup:
    rustup component add rustfmt clippy
    cargo install cargo-deny --locked

# Everything a change must pass.
test:
    scripts/test.sh

# Format, then lint.
lint:
    cargo fmt --all
    cargo clippy --workspace --all-targets --all-features -- -D warnings

# Bake the built-in example and paint a picture of it.
demo *ARGS:
    cargo run --release --bin glint-bake -- demo {{ARGS}}

# Show packs in a window, or draw them without one; see glint-view --help.
view *ARGS:
    cargo run --release --features view --bin glint-view -- {{ARGS}}

# Static programs for any Linux of this processor, without shared libraries, into target/TRIPLE/release. At a fixed address, as
# relocation would touch pages that are not used otherwise.
dist TRIPLE="x86_64-unknown-linux-gnu":
    RUSTFLAGS="-C target-feature=+crt-static -C relocation-model=static" cargo build --release --locked --target {{TRIPLE}}

# Measure speed against error anew: the reports and plots in docs/reports, and the headline in the README. METHODS are those of
# `glint-bake report --list`, all when none is named; frames need an adapter, and hours on a software one.
report *METHODS:
    cargo run --release --features view --bin glint-bake -- report {{METHODS}} --data "${GLINT_DATA:-../shared/data}" -o docs/reports --readme README.md

# Draw the viewer's gallery anew (an adapter, ImageMagick).
gallery:
    cargo build --release --features view --bins
    scripts/gallery.sh

# Fit the LTC tables of area lights anew; they come with the program, and a test checks that this gives the same bytes.
ltc-tables:
    cargo run --release -p glint-bake-core --example fit_ltc_tables bake/src/area_light/ltc_tables.bin

# All reports with few samples, into target/bench: minutes instead of hours, to see whether all works.
bench *METHODS:
    cargo run --release --features view --bin glint-bake -- report {{METHODS}} --quick --data "${GLINT_DATA:-../shared/data}" -o target/bench

# Feed the pack reader with arbitrary bytes (needs nightly Rust and cargo-fuzz).
fuzz TARGET="read_pack" SECONDS="60":
    cargo +nightly fuzz run {{TARGET}} -- -max_total_time={{SECONDS}}
