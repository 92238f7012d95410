// A surface of examples placed at random at a few places under a footprint, each seen as one tile: for real-time settings. Twin of
// glint-bake-core ndf_maps/probes.rs; a deviation from Xing et al. 2024, section 6.3, which sums every tile of every sub-region.

#import ndf_maps::regions

// Places lie within this many standard deviations of the footprint's centre; with their tiles they spread as it does.
const GLINT_NDF_PROBE_REACH: f32 = 1.5;
// Edge of their tiles, at most, and their distance along the major axis, relative to that along the minor axis.
const GLINT_NDF_PROBE_TILE: f32 = 1.35;

fn glint_ndf_probes(
    material: GlintNdfMaterial,
    ellipse: GlintNdfEllipse,
    cells: GlintNdfCells,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let most = f32(settings.max_terms);
    let extent = 2.0 * GLINT_NDF_PROBE_REACH * vec2f(ellipse.major, ellipse.minor);
    let step = max(min(extent.y / f32(settings.probes), material.cell_texels), sqrt(extent.x * extent.y / most));
    // A quarter of a step more is no reason for another place.
    let steps = extent / vec2f(GLINT_NDF_PROBE_TILE * step, step);
    let count = clamp(ceil(steps - 0.25), vec2f(1.0), vec2f(most));
    // Tiles of a level are twice as large as those before.
    let finest = f32(glint_ndf_record(material.level_records).x);
    let times = max(GLINT_NDF_PROBE_TILE * step / finest, 1.0);
    let level = min((bitcast<u32>(times) >> 23u) - 127u, material.levels - 1u);
    let record = glint_ndf_record(material.level_records + level);
    let per_texel = 1.0 / f32(record.x);
    let last = record.yz - 1u;
    let size = vec2f(material.size);
    let per_size = 1.0 / size;
    let per_region = 2.0 / material.cell_texels;
    let along = ellipse.axis * ellipse.major;
    let across = vec2f(-ellipse.axis.y, ellipse.axis.x) * ellipse.minor;
    let gap = 2.0 * GLINT_NDF_PROBE_REACH / count;
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    // One loop, not two, and its test at the end: pixels in step wait for the most places of one of them once.
    var at = vec2f(0.0);
    loop {
        let t = (at + 0.5) * gap - GLINT_NDF_PROBE_REACH;
        let weight = exp(-0.5 * dot(t, t));
        let place = ellipse.mean + along * t.x + across * t.y;
        let owner = glint_ndf_owner_of(material, cells, vec2i(floor(place * per_region)));
        let position = bitcast<vec4f>(glint_ndf_record(material.palette_records + 2u * owner.class_index));
        let normal = bitcast<vec4f>(glint_ndf_record(material.palette_records + 2u * owner.class_index + 1u));
        let x = glint_ndf_apply(position, place - owner.centre) + owner.offset;
        let local = x - floor(x * per_size) * size;
        let index = min(vec2u(max(local, vec2f(0.0)) * per_texel), last);
        let tile = record.w + index.y * record.y + index.x;
        let density = glint_ndf_tile_density(material, tile, glint_ndf_apply(normal, s));
        sum.density += weight * abs(glint_ndf_determinant(normal)) * density;
        sum.share += weight;
        sum.terms += 1.0;
        at.x += 1.0;
        if at.x >= count.x {
            at = vec2f(0.0, at.y + 1.0);
        }
        if at.y >= count.y {
            break;
        }
    }
    return sum;
}
