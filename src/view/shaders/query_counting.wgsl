// Answers draws of binomial and multinomial counts, one an invocation.

#import counting::eval

struct CountingQuery {
    // Trials, chance of a hit and of a miss, and levels of the multinomial draw.
    n: f32,
    p: f32,
    q: f32,
    levels: u32,
    // Random words of the binomial draw.
    bits: vec2u,
    weights: GlintLevels,
    // And of the multinomial one.
    words: GlintWords,
}

struct CountingAnswer {
    split: GlintSplit,
    counts: GlintLevels,
}

@group(0) @binding(0) var<storage, read> queries: array<CountingQuery>;
@group(0) @binding(1) var<storage, read_write> answers: array<CountingAnswer>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    answers[id.x] = CountingAnswer(
        glint_binomial(q.n, q.p, q.q, q.bits),
        glint_multinomial(q.n, q.weights, q.levels, q.words),
    );
}
