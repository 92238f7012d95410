// Counting: how many of N facets reflect each of K radiance levels, in time that does not grow with N.
// Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", section 6, algorithm 1, Eq. 22 to 25.
// Twin of glint-bake-core counting/eval.rs, where deviations from the paper are derived:
// one uniform number a binomial draw through the inverse of its distribution function, exact where few facets are hit and a
// Cornish-Fisher expansion where many are.
//
// Nodes are drawn four at a time: their chains of dependent operations overlap, and they share the turns of a loop. Where there
// are fewer, constants say so, and what is computed of the rest is dropped. Polynomials go by pairs of terms for the same reason.
//
// Pure functions, no accessors. N is any number from 0 to 1e16, p and q = 1 - p are from 0 to 1. Compilers must not reassociate the
// differences of GlintCounts.

// Largest expected count of the rarer outcome that is drawn exactly.
const GLINT_FEW: f32 = 6.0;
// From here on every f32 is a whole number.
const GLINT_WHOLE: f32 = 8388608.0;
// Whole numbers up to here are exact in one f32.
const GLINT_EXACT_COUNT: f32 = 16777216.0;
const GLINT_WALK_STEPS: f32 = 20.0;
// 2^-y is a normal number up to here.
const GLINT_MOST_HALVINGS: f32 = 125.0;
// Words are taken as at least this, half a step of 32 random bits.
const GLINT_LEAST_WORD: f32 = 1.1641532e-10;
// Nodes that are lighter are taken as this heavy, which they fill in part: one over the weight must be a number.
const GLINT_LEAST_WEIGHT: f32 = 1.0e-37;
// The nodes that are drawn of four.
const GLINT_ONE: vec4<bool> = vec4<bool>(true, false, false, false);
const GLINT_TWO: vec4<bool> = vec4<bool>(true, true, false, false);

// Whether counts above 2^24 carry what rounding to f32 takes from them. A program whose counts end up in a sum in f32, as a
// radiance is, does not show it and may set this to false before it draws.
var<private> glint_large_counts: bool = true;

// A whole number to 1e16: `high`, rounded where it is above 2^24, and what is missing.
struct GlintCount {
    high: f32,
    low: f32,
}

// Four of them.
struct GlintCounts {
    high: vec4f,
    low: vec4f,
}

// Hits and misses.
struct GlintSplit {
    hits: GlintCount,
    misses: GlintCount,
}

// Those of four draws.
struct GlintSplits {
    hits: GlintCounts,
    misses: GlintCounts,
}

// Numbers of up to sixteen levels, the darkest first.
struct GlintLevels {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

// Random words of a draw of up to sixteen levels: uniform numbers above 0 and at most 1, with the more digits the smaller they
// are. Word 0 makes the facets whole and is small where there is one more; word i draws node i of the tree and is small where the right
// branch gets more.
struct GlintWords {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

// Uniform numbers in (0, 1) of 32 random bits; small ones keep a resolution of 2^-32.
fn glint_unit_from_bits(bits: vec4u) -> vec4f {
    return min((vec4f(bits) + 0.5) * (1.0 / 4294967296.0), vec4f(0.99999994));
}

// -log2(1 - p) of p <= 1/2, to 4e-7 of itself.
fn glint_halvings(p: vec4f) -> vec4f {
    // Powers of less would be subnormal numbers, which take some processors long and add nothing.
    let least = max(p, vec4f(1.0e-9));
    let p2 = least * least;
    let high = (0.05484881 + p * 1.1331369) - p2 * (1.5603325 - p * 1.709495);
    return p * ((1.4426948 + p * 0.7214002) + p2 * ((0.47877657 + p * 0.3927744) + p2 * high));
}

// Digits of positive numbers: how often 1 is halved to less than twice the number (less than 0 where it is doubled), and 1 less the
// number times 2 to the power of that, which is at most 1/2. -log2 is the first and the halvings of the second.
struct GlintDigits {
    whole: vec4f,
    rest: vec4f,
}

fn glint_digits(x: vec4f) -> GlintDigits {
    let number = bitcast<vec4u>(x);
    let mantissa = bitcast<vec4f>((number & vec4u(0x007fffffu)) | vec4u(0x3f000000u));
    return GlintDigits(126.0 - vec4f(bitcast<vec4i>(number >> vec4u(23u))), 1.0 - mantissa);
}

// Numerator and denominator of z with P(Z > z) = u for a standard normal Z, to 3e-5, from y = -log2(4 u (1 - u)).
fn glint_normal_upper_fraction(u: vec4f, y: vec4f) -> array<vec4f, 2> {
    let y2 = y * y;
    let over = (1.2532073 + y * 0.28291672) + y2 * ((0.035295784 + y * 2.842739e-3) - y2 * 2.6916674e-5);
    let under = (1.0 + y * 0.04391194) + y2 * ((0.014345539 + y * 6.4092455e-5) - y2 * 1.8229288e-6);
    return array<vec4f, 2>((1.0 - 2.0 * u) * over, under);
}

struct GlintHalved {
    left: vec4f,
    lost: vec4f,
}

// 2^-y and 1 - 2^-y for y from 0 to 126, to 6e-7 of themselves.
fn glint_halved(y: vec4f) -> GlintHalved {
    let whole = floor(y);
    let f = y - whole;
    let f2 = f * f;
    // 2^-whole: above 2^23 the bits of an f32 are those of the whole number, and all but the exponent's shift out.
    let scale = bitcast<vec4f>(0x3f800000u - (bitcast<vec4u>(whole + GLINT_WHOLE) << vec4u(23u)));
    let series = (0.6931469 - f * 0.24021382) + f2 * ((0.05540434 - f * 9.337599e-3) + f2 * 1.0003551e-3);
    let lost = f * scale * series;
    return GlintHalved(scale - lost, (1.0 - scale) + lost);
}

// `high` + `low`, both whole, as counts.
fn glint_count_sum(high: vec4f, low: vec4f) -> GlintCounts {
    let sum = high + low;
    if !glint_large_counts {
        return GlintCounts(sum, vec4f(0.0));
    }
    let exact = sum <= vec4f(GLINT_EXACT_COUNT);
    return GlintCounts(select(high, sum, exact), select(low, vec4f(0.0), exact));
}

fn glint_count_value(counts: GlintCounts) -> vec4f {
    return counts.high + counts.low;
}

// Counts less smaller ones.
fn glint_count_difference(a: GlintCounts, b: GlintCounts) -> GlintCounts {
    let high = a.high - b.high;
    if !glint_large_counts {
        return GlintCounts(high, vec4f(0.0));
    }
    let rest = (a.high - high) - b.high;
    return glint_count_sum(high, rest + (a.low - b.low));
}

// A whole number with mean `n` by a uniform number.
fn glint_whole_count(n: f32, word: f32) -> f32 {
    let positive = max(n, 0.0);
    let whole = floor(positive);
    return select(whole, whole + 1.0, word < positive - whole);
}

// A walk along numbers of hits, up to the first of which more hits are not as likely as the uniform number says. `density` is the
// chance of as many hits as steps, `excess` that of more hits less the uniform number, both times the factorial of the steps, so that
// no step divides; 20! is far from the largest f32.
struct GlintWalk {
    density: f32,
    excess: f32,
    hits: f32,
}

// From step k to k + 1, with `left` = n - k.
fn glint_walk_step(walk: GlintWalk, left: f32, odds: f32, k: f32) -> GlintWalk {
    let hits = walk.hits + select(0.0, 1.0, walk.excess > 0.0);
    let density = walk.density * (left * odds);
    return GlintWalk(density, walk.excess * (k + 1.0) - density, hits);
}

// Four of them: a turn of a loop costs some devices more than a step.
fn glint_walk_steps(walk: GlintWalk, left: f32, odds: f32, k: f32) -> GlintWalk {
    let one = glint_walk_step(walk, left, odds, k);
    let two = glint_walk_step(one, left - 1.0, odds, k + 1.0);
    let three = glint_walk_step(two, left - 2.0, odds, k + 2.0);
    return glint_walk_step(three, left - 3.0, odds, k + 3.0);
}

// Hits k with P(hits > k) <= u of n trials with p <= 1/2, q = 1 - p, (1 - p)^n = 2^-y and np at most a few, of the nodes that are
// `few`; 0 of the others. Nodes that are not `drawn`, which is known when a program is made, are not walked.
fn glint_few_hits(
    n: vec4f,
    p: vec4f,
    q: vec4f,
    u: vec4f,
    y: vec4f,
    few: vec4<bool>,
    drawn: vec4<bool>,
) -> vec4f {
    let walked = few & drawn;
    // q is 0 besides p where nothing is drawn.
    let odds = p / max(q, vec4f(0.5));
    let none = glint_halved(min(y, vec4f(GLINT_MOST_HALVINGS)));
    let excess = select(vec4f(-1.0), none.lost - u, walked);
    var a = GlintWalk(none.left.x, excess.x, 0.0);
    var b = GlintWalk(none.left.y, excess.y, 0.0);
    var c = GlintWalk(none.left.z, excess.z, 0.0);
    var d = GlintWalk(none.left.w, excess.w, 0.0);
    // Every node takes as many steps as the last of the four. The test is at the end: some devices run what follows it once more.
    for (var k = 0.0; k < GLINT_WALK_STEPS; k += 4.0) {
        a = glint_walk_steps(a, n.x - k, odds.x, k);
        if drawn.y {
            b = glint_walk_steps(b, n.y - k, odds.y, k);
        }
        if drawn.z {
            c = glint_walk_steps(c, n.z - k, odds.z, k);
        }
        if drawn.w {
            d = glint_walk_steps(d, n.w - k, odds.w, k);
        }
        if !any(walked & (vec4f(a.excess, b.excess, c.excess, d.excess) > vec4f(0.0))) {
            break;
        }
    }
    return min(vec4f(a.hits, b.hits, c.hits, d.hits), n);
}

// What rounding took from a * b = `product`, by halves whose products are exact.
fn glint_product_rest(a: vec4f, b: vec4f, product: vec4f) -> vec4f {
    let a_high = bitcast<vec4f>(bitcast<vec4u>(a) & vec4u(0xfffff000u));
    let b_high = bitcast<vec4f>(bitcast<vec4u>(b) & vec4u(0xfffff000u));
    let a_low = a - a_high;
    let b_low = b - b_high;
    return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
}

// Hits k with P(hits > k) ~ u of n trials with p <= 1/2, q = 1 - p, y = -log2(4 u (1 - u)) and np more than GLINT_FEW.
fn glint_many_hits(n: GlintCounts, p: vec4f, q: vec4f, u: vec4f, y: vec4f) -> GlintCounts {
    let mean = n.high * p;
    var rest = vec4f(0.0);
    if glint_large_counts {
        rest = glint_product_rest(n.high, p, mean) + n.low * p;
    }
    let sigma = sqrt((mean + rest) * q);
    let fraction = glint_normal_upper_fraction(u, y);
    // z / sigma: one division for both.
    let slope = fraction[0] / (fraction[1] * sigma);
    let z = slope * sigma;
    let z2 = z * z;
    // 72 times (1 - 6 p q) (z^2 - 3) / 24 - (q - p)^2 (2 z^2 - 5) / 36 - 1 / 24, with (q - p)^2 = 1 - 4 p q.
    let third = p * q * (14.0 - 2.0 * z2) - (z2 + 2.0);
    let shift = sigma * z + (q - p) * (z2 - 1.0) * (1.0 / 6.0) + slope * third * (1.0 / 72.0);
    let small = clamp(round(mean + (rest + shift)), vec4f(0.0), glint_count_value(n));
    if !glint_large_counts {
        return GlintCounts(small, vec4f(0.0));
    }
    let large = glint_count_sum(mean, round(rest + shift));
    let is_small = mean < vec4f(GLINT_WHOLE);
    return GlintCounts(select(large.high, small, is_small), select(large.low, vec4f(0.0), is_small));
}

// Hits and misses of four lots of `n` trials with hit chance `p`; they add up to `n`. Where both p and q are 0, all hit. The hits are
// many where the uniform number `u` is small, the misses where `v` = 1 - u is. Lots that are not `drawn` are anything.
fn glint_whole_binomial(n: GlintCounts, p: vec4f, q: vec4f, u: vec4f, v: vec4f, drawn: vec4<bool>) -> GlintSplits {
    let swapped = p >= q;
    let rare = select(p, q, swapped);
    let frequent = select(q, p, swapped);
    let word = select(u, v, swapped);
    let value = glint_count_value(n);
    let few = value * rare <= vec4f(GLINT_FEW);
    // Logarithms of both ways are one polynomial.
    let digits = glint_digits(4.0 * u * v);
    let halvings = glint_halvings(select(digits.rest, rare, few));
    let walked = glint_few_hits(value, rare, frequent, word, value * halvings, few, drawn);
    let many = glint_many_hits(n, rare, frequent, word, digits.whole + halvings);
    let hits = GlintCounts(select(many.high, walked, few), select(many.low, vec4f(0.0), few));
    let misses = glint_count_difference(n, hits);
    return GlintSplits(
        GlintCounts(select(hits.high, misses.high, swapped), select(hits.low, misses.low, swapped)),
        GlintCounts(select(misses.high, hits.high, swapped), select(misses.low, hits.low, swapped)),
    );
}

// Hits and misses of any number `n` >= 0 of trials: the first word makes it whole, the second draws.
fn glint_binomial(n: f32, p: f32, q: f32, bits: vec2u) -> GlintSplit {
    let none = vec4f(0.0);
    let u = glint_unit_from_bits(vec4u(bits, ~bits.y, 0u));
    let whole = GlintCounts(vec4f(glint_whole_count(n, u.x), none.xyz), none);
    let splits = glint_whole_binomial(whole, vec4f(p, none.xyz), vec4f(q, vec3f(1.0)), u.yyyy, u.zzzz, GLINT_ONE);
    return GlintSplit(
        GlintCount(splits.hits.high.x, splits.hits.low.x), GlintCount(splits.misses.high.x, splits.misses.low.x),
    );
}

// Four nodes of the tree: how many of `n` go left and right, with chances in proportion to the weights.
fn glint_split(n: GlintCounts, left: vec4f, right: vec4f, words: vec4f, drawn: vec4<bool>) -> GlintSplits {
    // Nodes without weight have chances of 0, of which all go left.
    let share = 1.0 / max(left + right, vec4f(GLINT_LEAST_WEIGHT));
    // A word of 1 has a logarithm, too.
    let u = max(1.0 - words, vec4f(GLINT_LEAST_WORD));
    return glint_whole_binomial(n, left * share, right * share, u, words, drawn);
}

// Weight of four leaves.
fn glint_quad_weight(weights: vec4f) -> f32 {
    return (weights.x + weights.y) + (weights.z + weights.w);
}

// Counts of the children of two nodes, a node after the other.
fn glint_pair_counts(x: GlintSplits) -> GlintCounts {
    return GlintCounts(
        vec4f(x.hits.high.x, x.misses.high.x, x.hits.high.y, x.misses.high.y),
        vec4f(x.hits.low.x, x.misses.low.x, x.hits.low.y, x.misses.low.y),
    );
}

// Two subtrees of four leaves, of the first two of `tops`: words of their top nodes and of the four children.
fn glint_multinomial_eight(tops: GlintCounts, a: vec4f, b: vec4f, top: vec2f, children: vec4f, drawn: vec4<bool>) -> array<vec4f, 2> {
    let none = vec2f(0.0);
    let halves = glint_split(
        tops, vec4f(a.x + a.y, b.x + b.y, none), vec4f(a.z + a.w, b.z + b.w, none), vec4f(top, none), drawn & GLINT_TWO,
    );
    let leaves = glint_split(
        glint_pair_counts(halves), vec4f(a.x, a.z, b.x, b.z), vec4f(a.y, a.w, b.y, b.w), children, drawn.xxyy,
    );
    let left = glint_count_value(leaves.hits);
    let right = glint_count_value(leaves.misses);
    return array<vec4f, 2>(vec4f(left.x, right.x, left.y, right.y), vec4f(left.z, right.z, left.w, right.w));
}

// How many of `n` >= 0 facets fall to each of the first `levels` (1 to 16) levels, with chances in proportion to weights that
// are 0 beyond them. Whole numbers that add up to a whole number with mean `n`.
//
// Node i has the children 2i and 2i + 1, and its draw reads word i.
fn glint_multinomial(n: f32, weights: GlintLevels, levels: u32, words: GlintWords) -> GlintLevels {
    let none = vec4f(0.0);
    let root = GlintCounts(vec4f(glint_whole_count(n, words.a.x), none.xyz), none);
    if levels <= 4u {
        // With two levels the tree's only node is its root.
        let left = select(words.a.z, words.a.y, levels <= 2u);
        let counts = glint_multinomial_eight(root, weights.a, none, vec2f(words.a.y, 0.0), vec4f(left, words.a.w, 0.0, 0.0), GLINT_ONE);
        return GlintLevels(counts[0], none, none, none);
    }
    let a = glint_quad_weight(weights.a);
    let b = glint_quad_weight(weights.b);
    if levels <= 8u {
        let halves = glint_split(root, vec4f(a, none.xyz), vec4f(b, none.xyz), vec4f(words.a.y, none.xyz), GLINT_ONE);
        let counts =
            glint_multinomial_eight(glint_pair_counts(halves), weights.a, weights.b, words.a.zw, words.b, GLINT_TWO);
        return GlintLevels(counts[0], counts[1], none, none);
    }
    let c = glint_quad_weight(weights.c);
    let d = glint_quad_weight(weights.d);
    let halves = glint_split(root, vec4f(a + b, none.xyz), vec4f(c + d, none.xyz), vec4f(words.a.y, none.xyz), GLINT_ONE);
    let quarters = glint_pair_counts(
        glint_split(glint_pair_counts(halves), vec4f(a, c, none.xy), vec4f(b, d, none.xy), vec4f(words.a.zw, none.xy), GLINT_TWO),
    );
    let dark = glint_multinomial_eight(quarters, weights.a, weights.b, words.b.xy, words.c, GLINT_TWO);
    let rest = GlintCounts(quarters.high.zwzw, quarters.low.zwzw);
    let bright = glint_multinomial_eight(rest, weights.c, weights.d, words.b.zw, words.d, GLINT_TWO);
    return GlintLevels(dark[0], dark[1], bright[0], bright[1]);
}
