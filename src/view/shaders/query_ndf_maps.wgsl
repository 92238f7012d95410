// Answers queries of the density of normals under footprints on NDF maps, one an invocation.

#import bind_ndf_maps
#import bind_ndf_maps_layered

struct NdfMapsQuery {
    mean: vec2f,
    s: vec2f,
    // Covariance of the footprint, surface texels^2.
    xx: f32,
    xy: f32,
    yy: f32,
    max_ratio: f32,
    reach: f32,
    // 0 for the base, 1 for the coat.
    layer: u32,
    // Numbers from 0 to 1 to sample a direction by.
    random_x: f32,
    random_y: f32,
}

struct NdfMapsAnswer {
    density: f32,
    terms: f32,
    // 1 where the reach mask has the query.
    reached: f32,
    // Density by the definition at the footprint's centre.
    at_point: f32,
    // Moments of the footprint.
    mean: vec2f,
    xx: f32,
    xy: f32,
    yy: f32,
    // Roughness along both axes.
    alpha: vec2f,
    // Direction that the sample has, seen from NDF_MAPS_VIEW, and its density.
    light: vec3f,
    pdf: f32,
}

const NDF_MAPS_VIEW: vec3f = vec3f(0.36, -0.48, 0.8);

@group(0) @binding(0) var<storage, read> queries: array<NdfMapsQuery>;
@group(0) @binding(1) var<storage, read_write> answers: array<NdfMapsAnswer>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let material = glint_ndf_material(q.layer);
    let settings = GlintNdfSettings(q.max_ratio, q.reach);
    let sum = glint_ndf_density(material, GlintFootprint(q.mean, q.xx, q.xy, q.yy), settings, q.s);
    let moments = glint_ndf_moments(material, GlintFootprint(q.mean, q.xx, q.xy, q.yy), settings);
    let rough = glint_rough_normal(moments);
    // The third number is one of the others, so that both kinds of samples are drawn.
    let light = glint_moments_sample(moments, NDF_MAPS_VIEW, vec3f(q.random_x, q.random_y, q.random_x));
    answers[id.x] = NdfMapsAnswer(
        sum.density,
        sum.terms,
        select(0.0, 1.0, glint_ndf_reaches(material, q.s)),
        glint_ndf_density_at_point(material, q.mean, q.s),
        moments.mean,
        moments.covariance.x,
        moments.covariance.y,
        moments.covariance.z,
        rough.alpha,
        light,
        glint_moments_pdf(moments, NDF_MAPS_VIEW, light),
    );
}
