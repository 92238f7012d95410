//! Random numbers of a surface cell.
//!
//! Paper: algorithm 3 seeds a generator with the cell index and leaves the generator open. The authors' code gives
//! neighbours the same seed, is constant at cell (0, 0), and can return exactly 1. Here a cell index (x, y) goes
//! through four Feistel rounds, which is a bijection of 64 bits: two cells never share a state. Draw k is a mix of the
//! first word plus k times the second word made odd, so the draws of a cell differ too. The words themselves, each the sum
//! of a round's mix, are as random and serve what every cell asks for. Wrapping u32 arithmetic only.

/// State of a cell: two words, different for any two cells of one seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellState {
    /// First word.
    pub a: u32,
    /// Second word.
    pub b: u32,
}

/// Mixes 32 bits; a bijection. The factors are the odd 32-bit numbers nearest to 2^32 times the fractional parts of
/// √3 and √7.
pub fn mix_bits(value: u32) -> u32 {
    let mut v = value;
    v ^= v >> 16;
    v = v.wrapping_mul(0xbb67_ae85);
    v ^= v >> 15;
    v = v.wrapping_mul(0xa54f_f53b);
    v ^= v >> 16;
    v
}

/// What all cells of row `y` share: the first round.
pub fn row_key(y: u32, seed: u32) -> u32 {
    mix_bits(y.wrapping_add(seed).wrapping_add(0x6a09_e667))
}

/// State of cell (x, y) under a surface seed.
pub fn cell_state(x: u32, y: u32, seed: u32) -> CellState {
    cell_state_in_row(x, y, row_key(y, seed), seed)
}

/// The same with the row's [`row_key`].
pub fn cell_state_in_row(x: u32, y: u32, key: u32, seed: u32) -> CellState {
    let mut a = x.wrapping_add(key);
    let mut b = y;
    b = b.wrapping_add(mix_bits(a.wrapping_add(0x3c6e_f372)));
    a = a.wrapping_add(mix_bits(b.wrapping_add(seed).wrapping_add(0x510e_527f)));
    b = b.wrapping_add(mix_bits(a.wrapping_add(0x9b05_688c)));
    CellState { a, b }
}

/// 32 random bits of a cell, draw `index`.
pub fn draw_bits(state: CellState, index: u32) -> u32 {
    mix_bits(state.a.wrapping_add((state.b | 1).wrapping_mul(index.wrapping_add(1))))
}

/// Uniform number in [0, 1) from random bits: a multiple of 2^−24, at most 1 − 2^−24.
pub fn uniform_from_bits(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Uniform number in [0, 1) of a cell, draw `index`.
pub fn draw_uniform(state: CellState, index: u32) -> f32 {
    uniform_from_bits(draw_bits(state, index))
}
