//! Random numbers: one PCG stream an item, so that results do not depend on the order of work.

use rand::Rng;
use rand_pcg::Pcg32;

/// Every bit of the result depends on every bit of `x` (the finaliser of splitmix64).
fn mixed(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

/// What random numbers are drawn for. Uses of one seed with different purposes are independent of each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Transforms of the palette of NDF maps.
    NdfPalette,
    /// Centres of the regions of a stochastic surface of NDF maps.
    NdfCentres,
    /// Footprints that error is measured over.
    MeasuredFootprints,
    /// First centres of k-means in a cell of this edge, in texels.
    LobeCells(u32),
    /// First centres of k-means in this round of the reduction of a synthesised surface to the lobes of its last level.
    SurfaceLobes(u32),
    /// Footprints on and off the seams of a synthesised surface.
    SurfaceFootprints,
    /// Texels of an environment that are measured.
    EnvironmentTexels,
    /// Look-ups in an environment that are measured.
    EnvironmentReads,
    /// Explicitly placed facets of the reference of glints under an environment.
    PlacedFacets,
    /// Candidates of patches, thinned out.
    Candidates,
    /// The patch of a place, of those that fit equally well.
    Patches,
    /// Middle patches of corner tiles.
    MiddlePatches,
    /// Corner patches of corner tiles.
    CornerPatches,
    /// Draws and places of the report on glints under an environment.
    GlintReport,
    /// Places on a normal map that area lights are measured at.
    AreaLightPlaces,
    /// Turns of the scenes that area lights are measured in.
    AreaLightScenes,
    /// Any use by a test, or by a report that bakes nothing.
    Test(u32),
}

impl Purpose {
    /// The number that, with seed and item, chooses the stream. Numbers stay as they are, so that seeds keep their results.
    fn number(self) -> u32 {
        match self {
            Purpose::NdfPalette => 1,
            Purpose::NdfCentres => 2,
            Purpose::MeasuredFootprints => 3,
            Purpose::LobeCells(edge) => 7 + (edge << 8),
            Purpose::SurfaceLobes(round) => 8 + (round << 8),
            Purpose::SurfaceFootprints => 9,
            Purpose::EnvironmentTexels => 30,
            Purpose::EnvironmentReads => 32,
            Purpose::PlacedFacets => 31,
            Purpose::Candidates => 50,
            Purpose::Patches => 51,
            Purpose::MiddlePatches => 52,
            Purpose::CornerPatches => 53,
            Purpose::GlintReport => 60,
            Purpose::AreaLightPlaces => 77,
            Purpose::AreaLightScenes => 99,
            Purpose::Test(number) => number,
        }
    }
}

/// Generator of one item.
pub struct ItemRng(Pcg32);

impl ItemRng {
    /// The stream of `item` under `seed`; `purpose` keeps uses of the same seed apart.
    pub fn new(seed: u64, purpose: Purpose, item: u32) -> ItemRng {
        // Streams of neighbouring PCG states are correlated, so seed and item are mixed before they choose one.
        let stream = mixed(seed ^ mixed(u64::from(purpose.number()) << 32 | u64::from(item)));
        ItemRng(Pcg32::new(stream, mixed(stream)))
    }

    /// 32 uniform bits.
    pub fn bits(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// Uniform in [0, 1), a multiple of 2⁻³².
    pub fn unit(&mut self) -> f64 {
        self.bits() as f64 / 4_294_967_296.0
    }

    /// Uniform in 0 … n − 1 (n ≥ 1, small against 2³²).
    pub fn below(&mut self, n: u32) -> u32 {
        ((self.bits() as u64 * n as u64) >> 32) as u32
    }

    /// A random order of 0 … n − 1.
    pub fn permutation(&mut self, n: u32) -> Vec<u32> {
        let mut order: Vec<u32> = (0..n).collect();
        for k in (1..n).rev() {
            order.swap(k as usize, self.below(k + 1) as usize);
        }
        order
    }
}
