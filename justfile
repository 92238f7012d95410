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

# Measure speed against error anew: the reports and plots in docs/, and their headlines in the README.
report MAPS="../shared/data/tiny/brushed_16x16.png":
    cargo run --release --bin glint-bake -- report {{MAPS}} -o docs
    cargo run --release -p glint-bake-core --example dictionary_report -- --svg docs/dictionary-report.svg --readme README.md > docs/dictionary-report.md
    cargo run --release -p glint-bake-core --example counting_report -- --svg docs/counting-report.svg > docs/counting-report.md
    cargo run --release --example environment_report -- --svg docs/environment-report.svg > docs/environment-report.md
    cargo run --release --example glint_report -- "${GLINT_DATA:-../shared/data}" > docs/environment-glints.md
    cargo run --release --example area_light_report -- "${GLINT_DATA:-../shared/data}" --svg docs/area-light-report.svg > docs/area-light-report.md
    cargo run --release --example lobes_report -- "${GLINT_DATA:-../shared/data}" --svg docs/lobes-report.svg > docs/lobes-report.md
    cargo run --release --example surface_report -- "${GLINT_DATA:-../shared/data}" > docs/surface-report.md

# Measure the viewer's frame times anew (an adapter, and minutes on a software one), and draw its gallery (ImageMagick).
view-report *ARGS:
    cargo build --release --features view --bins
    scripts/view_report.sh {{ARGS}} > docs/viewer-report.md
    scripts/gallery.sh

# Fit the LTC tables of area lights anew; they come with the program, and a test checks that this gives the same bytes.
ltc-tables:
    cargo run --release -p glint-bake-core --example fit_ltc_tables bake/src/area_light/ltc_tables.bin

# The NDF maps' report with few footprints, into target/bench: minutes instead of tens of minutes.
bench MAPS="../shared/data/tiny/brushed_16x16.png":
    mkdir -p target/bench
    cargo run --release --bin glint-bake -- report {{MAPS}} -o target/bench --footprints 4

# Feed the pack reader with arbitrary bytes (needs nightly Rust and cargo-fuzz).
fuzz TARGET="read_pack" SECONDS="60":
    cargo +nightly fuzz run {{TARGET}} -- -max_total_time={{SECONDS}}
