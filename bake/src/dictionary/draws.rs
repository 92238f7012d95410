//! The random numbers that a dictionary stands for: one uniform number a lobe and marginal, stratified across marginals.
//!
//! Paper: section 4.4 draws lobe means one by one and independently. Deviation: lobe k of all N marginals is one Latin
//! hypercube, a random order of the N strata of [0, 1) with a random place in each. A single marginal still sees
//! independent uniform numbers, so its glints stay; the mean over the dictionary converges far faster.
//!
//! From lobe [`PAIRED_FROM`] on, lobes come in pairs half a turn apart (u and u + ½ mod 1). It halves the work where
//! nearly all lobes are, and takes the lowest frequency out of a marginal's deviation from the target. Lobes below it
//! are independent within a marginal: there pairs would be seen as missing glints.
//!
//! The numbers are the input that the bake and the reference share; each turns them into slopes in its own way.

use rand::Rng;
use rand_pcg::Pcg32;

/// First lobe that is drawn in pairs; even.
pub const PAIRED_FROM: u32 = 1024;
const HALF_TURN: u32 = 1 << 31;

/// Draws the uniform numbers of one lobe after the other.
#[derive(Clone, Debug)]
pub struct Draws {
    seed: u64,
    order: Vec<u32>,
    uniform: Vec<u32>,
    drawn: Option<u32>,
}

impl Draws {
    /// Draws for a dictionary of `marginals` marginals, at least 1.
    pub fn new(seed: u64, marginals: u32) -> Draws {
        let n = marginals as usize;
        Draws { seed, order: vec![0; n], uniform: vec![0; n], drawn: None }
    }

    /// Uniform numbers of lobe `lobe`, in units of 2^−32, one a marginal. One generator stream a lobe or pair of lobes,
    /// so any lobe can be drawn alone; asking for the second of a pair after the first costs nothing new.
    pub fn lobe(&mut self, lobe: u32) -> &[u32] {
        if self.drawn == Some(lobe) {
            return &self.uniform;
        }
        if lobe < PAIRED_FROM || lobe.is_multiple_of(2) {
            self.draw(lobe);
        } else {
            if self.drawn != Some(lobe - 1) {
                self.draw(lobe - 1);
            }
            for u in &mut self.uniform {
                *u = u.wrapping_add(HALF_TURN);
            }
        }
        self.drawn = Some(lobe);
        &self.uniform
    }

    fn draw(&mut self, item: u32) {
        let mut rng = Pcg32::new(stream_state(self.seed, item), u64::from(item));
        let n = self.order.len() as u64;
        for j in 0..self.order.len() {
            let r = ((u64::from(rng.next_u32()) * (j as u64 + 1)) >> 32) as usize;
            self.order[j] = self.order[r];
            self.order[r] = j as u32;
        }
        let width = (1u64 << 32) / n;
        for i in 0..self.order.len() {
            let within = (u64::from(rng.next_u32()) * width) >> 32;
            self.uniform[i] = (u64::from(self.order[i]) * width + within) as u32;
        }
    }
}

/// First state of an item's generator. Streams of a linear congruential generator that start from related states stay
/// related, which shows as contrast that grows with the number of lobes, so seed and item are mixed well first.
fn stream_state(seed: u64, item: u32) -> u64 {
    let mut s = seed ^ (u64::from(item) << 32 | u64::from(item));
    for factor in [0x9e37_79b9_7f4a_7c15u64, 0xbb67_ae85_84ca_a73b, 0xa54f_f53a_5f1d_36f1] {
        s = (s ^ (s >> 32)).wrapping_add(factor).wrapping_mul(factor);
    }
    s ^ (s >> 32)
}
