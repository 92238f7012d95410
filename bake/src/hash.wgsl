// Random numbers of a surface cell: draws, and the two words of its state themselves. Twin of hash.rs, bit by bit.
//
// A cell index (x, y) goes through four Feistel rounds, which is a bijection of 64 bits: two cells never share a state.

struct GlintCellState {
    a: u32,
    b: u32,
}

// Mixes 32 bits; a bijection.
fn glint_mix_bits(value: u32) -> u32 {
    var v = value;
    v ^= v >> 16u;
    v *= 0xbb67ae85u;
    v ^= v >> 15u;
    v *= 0xa54ff53bu;
    v ^= v >> 16u;
    return v;
}

// What all cells of row `y` share: the first round.
fn glint_row_key(y: u32, seed: u32) -> u32 {
    return glint_mix_bits(y + seed + 0x6a09e667u);
}

// State of cell (x, y) under a surface seed.
fn glint_cell_state(x: u32, y: u32, seed: u32) -> GlintCellState {
    return glint_cell_state_in_row(x, y, glint_row_key(y, seed), seed);
}

// The same with the row's glint_row_key.
fn glint_cell_state_in_row(x: u32, y: u32, key: u32, seed: u32) -> GlintCellState {
    var a = x + key;
    var b = y;
    b += glint_mix_bits(a + 0x3c6ef372u);
    a += glint_mix_bits(b + seed + 0x510e527fu);
    b += glint_mix_bits(a + 0x9b05688cu);
    return GlintCellState(a, b);
}

// 32 random bits of a cell, draw `index`.
fn glint_draw_bits(state: GlintCellState, index: u32) -> u32 {
    return glint_mix_bits(state.a + (state.b | 1u) * (index + 1u));
}

// Uniform number in [0, 1) from random bits: a multiple of 2^-24.
fn glint_uniform_from_bits(bits: u32) -> f32 {
    return f32(bits >> 8u) * (1.0 / 16777216.0);
}

// Uniform number in [0, 1) of a cell, draw `index`.
fn glint_draw_uniform(state: GlintCellState, index: u32) -> f32 {
    return glint_uniform_from_bits(glint_draw_bits(state, index));
}
