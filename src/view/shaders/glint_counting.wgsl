// Counting: how many of N facets reflect each of K radiance levels, in time that does not grow with N.
// Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", section 6, algorithm 1, Eq. 22 to 25.
// Twin of glint-bake-core counting/{normal,pow1m,count,binomial,multinomial}.rs, where deviations from the paper are derived:
// one uniform number a binomial draw through the inverse of its distribution function, exact where few facets are hit and a
// Cornish-Fisher expansion where many are.
//
// Pure functions, no accessors. Random words are uniform 32-bit numbers. N is any number from 0 to 1e16, p and q = 1 - p are from
// 0 to 1. Compilers must not reassociate the differences of GlintCount.

// Largest expected count of the rarer outcome that is drawn exactly.
const GLINT_FEW: f32 = 6.0;
// From here on every f32 is a whole number.
const GLINT_WHOLE: f32 = 8388608.0;
// Whole numbers up to here are exact in one f32.
const GLINT_EXACT_COUNT: f32 = 16777216.0;
const GLINT_WALK_STEPS: u32 = 20u;
const GLINT_LARGEST_EXPONENT: f32 = 87.0;

// A whole number to 1e16: `high`, rounded where it is above 2^24, and what is missing.
struct GlintCount {
    high: f32,
    low: f32,
}

// Hits and misses.
struct GlintSplit {
    hits: GlintCount,
    misses: GlintCount,
}

// Numbers of up to sixteen levels, the darkest first.
struct GlintLevels {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

// Random words of a draw of up to sixteen levels: word 0 makes the facets whole, word i draws node i of the tree.
struct GlintWords {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    d: vec4u,
}

// Uniform number in (0, 1) of 32 random bits; small ones keep a resolution of 2^-32.
fn glint_unit_from_bits(bits: u32) -> f32 {
    return min((f32(bits) + 0.5) * (1.0 / 4294967296.0), 0.99999994);
}

// z with P(Z > z) = u for a standard normal Z, to 3e-5.
fn glint_normal_upper_quantile(u: f32) -> f32 {
    let x = 1.0 - 2.0 * u;
    let w = -log(4.0 * u * (1.0 - u));
    if w < 5.0 {
        let d = w - 2.5;
        let high = 3.071955e-4 + d * (-6.411285e-6 + d * (-4.487788e-6 + d * 5.037158e-7));
        return x * (2.123313 + d * (0.34880218 + d * (-5.9057454e-3 + d * (-1.772403e-3 + d * high))));
    }
    let d = sqrt(w) - 3.4632419;
    let high = 1.6521519e-3 + d * (-1.9210854e-3 + d * 8.503982e-4);
    return x * (4.6647286 + d * (1.424175 + d * (4.9826747e-3 + d * (-2.5789616e-3 + d * high))));
}

// -log(1 - p) of p <= 1/2.
fn glint_rare_negative_log1m(p: f32, q: f32) -> f32 {
    let s = p / (1.0 + q);
    let t = s * s;
    let series = 1.0 / 9.0 + t * (1.0 / 11.0 + t * (1.0 / 13.0 + t * (1.0 / 15.0)));
    return 2.0 * s * (1.0 + t * (1.0 / 3.0 + t * (1.0 / 5.0 + t * (1.0 / 7.0 + t * series))));
}

// -log(1 - p) to a few units in the last place; at most 88. A logarithm between 1/2 and 2 is never asked for.
fn glint_negative_log1m(p: f32, q: f32) -> f32 {
    if p > 0.5 {
        return -log(max(q, 1.1754944e-38));
    }
    return glint_rare_negative_log1m(p, q);
}

// (1 - p)^n. p^n is glint_pow1m(q, p, n).
fn glint_pow1m(p: f32, q: f32, n: f32) -> f32 {
    return exp(-min(n * glint_negative_log1m(p, q), GLINT_LARGEST_EXPONENT));
}

// 1 - exp(-x) for x from 0 to 1/2.
fn glint_small_one_minus_exp(x: f32) -> f32 {
    let series = 1.0 / 24.0 - x * (1.0 / 120.0 - x * (1.0 / 720.0 - x * (1.0 / 5040.0)));
    return x * (1.0 - x * (0.5 - x * (1.0 / 6.0 - x * series)));
}

// 1 - exp(-x) for x >= 0, with a small relative error where it is small.
fn glint_one_minus_exp(x: f32) -> f32 {
    let bounded = min(x, GLINT_LARGEST_EXPONENT);
    return select(glint_small_one_minus_exp(bounded), 1.0 - exp(-bounded), bounded >= 0.5);
}

// 1 - (1 - p)^n, the chance of at least one hit.
fn glint_one_minus_pow1m(p: f32, q: f32, n: f32) -> f32 {
    return glint_one_minus_exp(min(n * glint_negative_log1m(p, q), GLINT_LARGEST_EXPONENT));
}

// `high` + `low`, both whole, as a count.
fn glint_count(high: f32, low: f32) -> GlintCount {
    let sum = high + low;
    if sum <= GLINT_EXACT_COUNT {
        return GlintCount(sum, 0.0);
    }
    return GlintCount(high, low);
}

fn glint_count_value(count: GlintCount) -> f32 {
    return count.high + count.low;
}

// A count less a smaller one.
fn glint_count_subtract(a: GlintCount, b: GlintCount) -> GlintCount {
    let high = a.high - b.high;
    let rest = (a.high - high) - b.high;
    return glint_count(high, rest + (a.low - b.low));
}

// A whole number with mean `n`.
fn glint_whole_count(n: f32, bits: u32) -> f32 {
    let positive = max(n, 0.0);
    let whole = floor(positive);
    return select(whole, whole + 1.0, glint_unit_from_bits(bits) < positive - whole);
}

// Hits k with P(hits > k) <= u of n trials with p <= 1/2, q = 1 - p and np at most a few.
fn glint_few_hits(n: f32, p: f32, q: f32, u: f32) -> f32 {
    let odds = p / q;
    // (1 - p)^n and 1 - (1 - p)^n, as glint_pow1m and glint_one_minus_pow1m have them for p <= 1/2.
    let x = min(n * glint_rare_negative_log1m(p, q), GLINT_LARGEST_EXPONENT);
    var density = exp(-x);
    var more = select(glint_small_one_minus_exp(x), 1.0 - density, x >= 0.5);
    var k = 0.0;
    for (var step = 0u; step < GLINT_WALK_STEPS; step++) {
        if u >= more {
            break;
        }
        density *= (n - k) * odds / (k + 1.0);
        more -= density;
        k += 1.0;
    }
    return min(k, n);
}

// What rounding took from a * b = `product`, by halves whose products are exact.
fn glint_product_rest(a: f32, b: f32, product: f32) -> f32 {
    let a_high = bitcast<f32>(bitcast<u32>(a) & 0xfffff000u);
    let b_high = bitcast<f32>(bitcast<u32>(b) & 0xfffff000u);
    let a_low = a - a_high;
    let b_low = b - b_high;
    return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
}

// Hits k with P(hits > k) ~ u of n trials with p <= 1/2, q = 1 - p and np more than GLINT_FEW.
fn glint_many_hits(n: GlintCount, p: f32, q: f32, u: f32) -> GlintCount {
    let mean = n.high * p;
    let rest = glint_product_rest(n.high, p, mean) + n.low * p;
    let sigma = sqrt((mean + rest) * q);
    let z = glint_normal_upper_quantile(u);
    let skew = q - p;
    let z2 = z * z;
    let third = (1.0 - 6.0 * p * q) * (z2 - 3.0) * (1.0 / 24.0) - skew * skew * (2.0 * z2 - 5.0) * (1.0 / 36.0);
    let spread = sigma * z + skew * (z2 - 1.0) * (1.0 / 6.0) + z * (third - 1.0 / 24.0) / sigma;
    if mean < GLINT_WHOLE {
        return GlintCount(clamp(round(mean + (rest + spread)), 0.0, glint_count_value(n)), 0.0);
    }
    return glint_count(mean, round(rest + spread));
}

// Hits and misses of `n` trials with hit chance `p`; they add up to `n`.
fn glint_whole_binomial(n: GlintCount, p: f32, q: f32, bits: u32) -> GlintSplit {
    let swapped = p > q;
    let rare = select(p, q, swapped);
    let frequent = select(q, p, swapped);
    let u = glint_unit_from_bits(select(bits, ~bits, swapped));
    var hits: GlintCount;
    if glint_count_value(n) * rare <= GLINT_FEW {
        hits = GlintCount(glint_few_hits(glint_count_value(n), rare, frequent, u), 0.0);
    } else {
        hits = glint_many_hits(n, rare, frequent, u);
    }
    let misses = glint_count_subtract(n, hits);
    if swapped {
        return GlintSplit(misses, hits);
    }
    return GlintSplit(hits, misses);
}

// Hits and misses of any number `n` >= 0 of trials: the first word makes it whole, the second draws.
fn glint_binomial(n: f32, p: f32, q: f32, bits: vec2u) -> GlintSplit {
    return glint_whole_binomial(GlintCount(glint_whole_count(n, bits.x), 0.0), p, q, bits.y);
}

// One node of the tree: how many of `n` go left and right, with chances in proportion to the weights.
fn glint_split(n: GlintCount, left: f32, right: f32, bits: u32) -> GlintSplit {
    if right > 0.0 && n.high > 0.0 {
        let whole = left + right;
        return glint_whole_binomial(n, left / whole, right / whole, bits);
    }
    return GlintSplit(n, GlintCount(0.0, 0.0));
}

// Weight of four leaves.
fn glint_quad_weight(weights: vec4f) -> f32 {
    return (weights.x + weights.y) + (weights.z + weights.w);
}

// A subtree of four leaves; words of its top node and of its two children.
fn glint_multinomial_quad(n: GlintCount, weights: vec4f, top: u32, left: u32, right: u32) -> vec4f {
    let halves = glint_split(n, weights.x + weights.y, weights.z + weights.w, top);
    let first = glint_split(halves.hits, weights.x, weights.y, left);
    let second = glint_split(halves.misses, weights.z, weights.w, right);
    return vec4f(
        glint_count_value(first.hits), glint_count_value(first.misses),
        glint_count_value(second.hits), glint_count_value(second.misses),
    );
}

// How many of `n` >= 0 facets fall to each of the first `levels` (1 to 16) levels, with chances in proportion to weights that
// are 0 beyond them. Whole numbers that add up to a whole number with mean `n`.
//
// Node i has the children 2i and 2i + 1, and its draw reads word i. Leaves are taken four at a time; with up to eight there is
// no dynamic index.
fn glint_multinomial(n: f32, weights: GlintLevels, levels: u32, words: GlintWords) -> GlintLevels {
    let root = GlintCount(glint_whole_count(n, words.a.x), 0.0);
    let none = vec4f(0.0);
    if levels <= 4u {
        // With two levels the tree's only node is its root.
        let left = select(words.a.z, words.a.y, levels <= 2u);
        return GlintLevels(glint_multinomial_quad(root, weights.a, words.a.y, left, words.a.w), none, none, none);
    }
    let a = glint_quad_weight(weights.a);
    let b = glint_quad_weight(weights.b);
    if levels <= 8u {
        let halves = glint_split(root, a, b, words.a.y);
        return GlintLevels(
            glint_multinomial_quad(halves.hits, weights.a, words.a.z, words.b.x, words.b.y),
            glint_multinomial_quad(halves.misses, weights.b, words.a.w, words.b.z, words.b.w),
            none, none,
        );
    }
    let c = glint_quad_weight(weights.c);
    let d = glint_quad_weight(weights.d);
    let halves = glint_split(root, a + b, c + d, words.a.y);
    let dark = glint_split(halves.hits, a, b, words.a.z);
    let bright = glint_split(halves.misses, c, d, words.a.w);
    var tops = array<GlintCount, 4>(dark.hits, dark.misses, bright.hits, bright.misses);
    var weight = array<vec4f, 4>(weights.a, weights.b, weights.c, weights.d);
    var top = array<u32, 4>(words.b.x, words.b.y, words.b.z, words.b.w);
    var left = array<u32, 4>(words.c.x, words.c.z, words.d.x, words.d.z);
    var right = array<u32, 4>(words.c.y, words.c.w, words.d.y, words.d.w);
    var counts = array<vec4f, 4>(none, none, none, none);
    // A loop, which keeps the program small.
    for (var quad = 0u; quad < 4u; quad++) {
        counts[quad] = glint_multinomial_quad(tops[quad], weight[quad], top[quad], left[quad], right[quad]);
    }
    return GlintLevels(counts[0], counts[1], counts[2], counts[3]);
}
