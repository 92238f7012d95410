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

/// Generator of one item.
pub struct ItemRng(Pcg32);

impl ItemRng {
    /// The stream of `item` under `seed`; `purpose` keeps uses of the same seed apart.
    pub fn new(seed: u64, purpose: u32, item: u32) -> ItemRng {
        // Streams of neighbouring PCG states are correlated, so seed and item are mixed before they choose one.
        let stream = mixed(seed ^ mixed((purpose as u64) << 32 | item as u64));
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
