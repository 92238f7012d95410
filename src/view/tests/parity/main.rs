//! The WGSL of every method against its CPU twin, on whatever adapter there is (in CI: Mesa's software one).
//!
//! Without an adapter the tests say that they are skipped; with `GLINT_REQUIRE_ADAPTER=1` they fail instead.

mod adapter;
mod area_light;
mod counting;
mod dictionary;
mod environment;
mod glints;
mod lobes;
mod ndf_maps;
mod support;
mod surface;
mod textures;
