//! Counting: how many of N facets reflect each of K radiance levels, in time that does not grow with N.
//!
//! Method: Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", section 6 and algorithm 1. Counts of
//! K levels are a multinomial draw, made of K − 1 binomial ones in a binary tree ([`multinomial()`]). The paper draws
//! a binomial number from gates and a clamped Gaussian ([`paper`], kept as a baseline). Here it is the inverse of the
//! distribution function at one uniform number: exact where few facets are hit, a Cornish–Fisher expansion around the
//! Gaussian where many are ([`binomial()`]). Both are in [`eval`], f32, as shaders have them; [`query`] says which facets a pixel sees, as the random words
//! that its draws read. [`pow1m`](mod@pow1m) holds powers
//! (1 − p)^N against the paper's; [`reference`](mod@reference) says the same as [`eval`] from the definitions in f64, and
//! [`quality`] measures one by the other.
//!
//! What deviates from the paper, and why, stands on top of each file and in `docs/methods/counting.md`. The main points:
//! - counts are whole numbers, their mean is Np, and their variance that of the binomial distribution;
//! - one random word a binomial draw instead of two numbers, and counts change monotonously with p for a fixed word;
//! - counts above 2²⁴ come with what rounding to f32 takes from them ([`Count`]): their variance holds to N = 1e16;
//! - a fractional N is a random whole number with mean N, rounded once at the root of the tree and never below it.

pub mod eval;
pub mod paper;
pub mod pow1m;
pub mod quality;
pub mod query;
pub mod reference;

crate::shader::shaders!("counting": "eval", "query");

pub use eval::{Count, MAX_LEVELS, binomial, multinomial};
