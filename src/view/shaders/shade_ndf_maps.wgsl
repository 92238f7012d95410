// A surface with the NDF maps of tiny examples, in one or two layers: f = F D G / (4 (n.l)(n.v)), D the density of the projected
// half vector; a clear coat over it after Xing et al. 2024, Eq. 3: f = f_base (1 - F_coat) + f_coat.
//
// material.switches: bit 0 swaps the two layers; bit 1 takes the settings that accuracy is measured with in place of those for
// pictures. material.f0 is that of the base, or of the only layer.

#import view_scene
#import brdf
#import bind_ndf_maps

const SHADE_NDF_SWAP: u32 = 1u;
const SHADE_NDF_ACCURATE: u32 = 2u;

// What is known of the data when the pipeline is made, so that it holds no code for what they do not need; by default all is read
// from the data. Whether there are two layers.
override NDF_MAPS_LAYERED: bool = true;
// Cells of the stochastic placement along an axis, 0 where materials are tiled; 0xffffffff for any.
override NDF_MAPS_CELLS: u32 = 0xffffffffu;
// Whether material.switches may have SHADE_NDF_ACCURATE.
override NDF_MAPS_ACCURATE: bool = true;

fn shade_ndf_settings() -> GlintNdfSettings {
    if NDF_MAPS_ACCURATE && (material.switches & SHADE_NDF_ACCURATE) != 0u {
        return GlintNdfSettings(16.0, 4.0);
    }
    return glint_ndf_maps_settings();
}

fn shade_ndf_material(layer: u32) -> GlintNdfMaterial {
    var found = glint_ndf_material(layer);
    if NDF_MAPS_CELLS != 0xffffffffu {
        found.cells = NDF_MAPS_CELLS;
    }
    return found;
}

fn shade_ndf_footprint(point: ViewPoint) -> GlintFootprint {
    let texels = material.texels_per_unit;
    return glint_footprint_of_pixel(
        point.uv * texels, point.d_dx * texels, point.d_dy * texels, material.pixel_sigma,
    );
}

// Density at the half vector's projection s of one layer; the reference's at one place, else that of the footprint.
fn shade_ndf_density(layer: u32, footprint: GlintFootprint, s: vec2f, reference: bool) -> f32 {
    if reference {
        return glint_ndf_density_at_point(shade_ndf_material(layer), footprint.mean, s);
    }
    // Most of a picture lies outside the highlight and is done with here.
    if !glint_ndf_reaches(shade_ndf_material(layer), s) {
        return 0.0;
    }
    return glint_ndf_density(shade_ndf_material(layer), footprint, shade_ndf_settings(), s).density;
}

fn shade_ndf_brdf(point: ViewPoint, light: vec3f, footprint: GlintFootprint, reference: bool) -> vec3f {
    let half = glint_half_vector(point.view, light);
    let layered = NDF_MAPS_LAYERED && ndf_maps_layers.count > 1u;
    let swap = select(0u, material.switches & SHADE_NDF_SWAP, layered);
    // A density over the disk of projected normals is one over normals by their projected area, which D is.
    let lower = vec3f(shade_ndf_density(swap, footprint, half.xy, reference));
    let base = glint_facet_brdf(lower, material.f0, point.view, light);
    if !layered {
        return base;
    }
    let upper = vec3f(shade_ndf_density(1u - swap, footprint, half.xy, reference));
    let coat_f0 = vec3f(ndf_maps_layers.coat_f0);
    let through = vec3f(1.0) - glint_fresnel(coat_f0, dot(point.view, half));
    return base * through + glint_facet_brdf(upper, coat_f0, point.view, light);
}

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    return shade_ndf_brdf(point, light, shade_ndf_footprint(point), false) * light.z;
}

// One place under the footprint, by Box and Muller, and the micro-normal that shows there.
fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    var footprint = shade_ndf_footprint(point);
    let radius = material.pixel_sigma * sqrt(-2.0 * log(1.0 - random.x));
    let angle = 6.2831853 * random.y;
    let place = point.uv + point.d_dx * (radius * cos(angle)) + point.d_dy * (radius * sin(angle));
    footprint.mean = place * material.texels_per_unit;
    return shade_ndf_brdf(point, light, footprint, true) * light.z;
}

// Binary logarithm of the footprint's minor axis over the texel, 0 for one below it.
fn shade_lod(point: ViewPoint) -> f32 {
    return log2(max(glint_principal(shade_ndf_footprint(point)).minor, 1.0));
}
