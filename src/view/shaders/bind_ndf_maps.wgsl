// Bindings of NDF maps for ndf_maps/query.wgsl: group 1, sections as they lie in the pack, those of the base and then those of the coat
// over it. Without a coat zeros are bound in its place.
//
// The including program defines NDF_MAPS_LAYERED: bool, whether a coat may be bound; false, where that is known when the pipeline is
// made, takes all that belongs to one out of the program.

#import include_ndf_maps
#import bind_loads
#import bind_table

// Section NMUB.
struct NdfMapsData {
    material: GlintNdfMaterial,
    // Levels, palette and reach mask.
    records: array<vec4u, 256>,
}

@group(1) @binding(0) var<uniform> ndf_maps: NdfMapsData;
// Section NMND.
@group(1) @binding(1) var ndf_maps_nodes: texture_2d<u32>;
// Section NMDE.
@group(1) @binding(2) var ndf_maps_density: texture_2d<f32>;
// Section NMNO.
@group(1) @binding(3) var ndf_maps_normals: texture_2d<u32>;
// Section PLNO.
@group(1) @binding(4) var ndf_maps_noise: texture_2d<u32>;
// Section PLCL.
@group(1) @binding(5) var ndf_maps_classes: texture_2d<u32>;
// The same sections of the coat. Its uniform bytes are a storage buffer: some adapters fail on branches on a program's fourth uniform.
@group(1) @binding(6) var<storage, read> ndf_maps_coat: array<vec4u>;
@group(1) @binding(7) var ndf_maps_coat_nodes: texture_2d<u32>;
@group(1) @binding(8) var ndf_maps_coat_density: texture_2d<f32>;
@group(1) @binding(9) var ndf_maps_coat_normals: texture_2d<u32>;
@group(1) @binding(10) var ndf_maps_coat_noise: texture_2d<u32>;
@group(1) @binding(11) var ndf_maps_coat_classes: texture_2d<u32>;
// Section LAUB.
@group(1) @binding(12) var<storage, read> ndf_maps_layers: GlintNdfLayers;
@group(1) @binding(13) var ndf_maps_sampler: sampler;

// The base, 0, or the coat, 1.
fn glint_ndf_material(layer: u32) -> GlintNdfMaterial {
    if NDF_MAPS_LAYERED {
        if layer != 0u {
            let a = ndf_maps_coat[0];
            let b = ndf_maps_coat[1];
            let c = ndf_maps_coat[2];
            let d = ndf_maps_coat[3];
            return GlintNdfMaterial(
                a.xy, a.z, a.w, bitcast<f32>(b.x), bitcast<f32>(b.y), bitcast<f32>(b.z), b.w, c.x, bitcast<f32>(c.y), c.z, c.w,
                bitcast<vec2f>(d.xy), layer, bitcast<f32>(d.w),
            );
        }
    }
    return ndf_maps.material;
}

fn glint_ndf_record(layer: u32, at: u32) -> vec4u {
    bound_loads += 1u;
    if NDF_MAPS_LAYERED {
        if layer != 0u {
            return ndf_maps_coat[at + 4u];
        }
    }
    return ndf_maps.records[at];
}

fn glint_ndf_node(layer: u32, at: u32) -> vec4u {
    bound_loads += 1u;
    if NDF_MAPS_LAYERED {
        if layer != 0u {
            return textureLoad(ndf_maps_coat_nodes, bind_table_place(at), 0);
        }
    }
    return textureLoad(ndf_maps_nodes, bind_table_place(at), 0);
}

fn glint_ndf_roots(layer: u32, at: vec2f) -> vec4f {
    bound_loads += 1u;
    if NDF_MAPS_LAYERED {
        if layer != 0u {
            return textureGather(0, ndf_maps_coat_density, ndf_maps_sampler, at);
        }
    }
    return textureGather(0, ndf_maps_density, ndf_maps_sampler, at);
}

fn glint_ndf_normal_texel(layer: u32, at: vec2u) -> vec4u {
    bound_loads += 1u;
    if NDF_MAPS_LAYERED {
        if layer != 0u {
            return textureLoad(ndf_maps_coat_normals, at, 0);
        }
    }
    return textureLoad(ndf_maps_normals, at, 0);
}

fn glint_ndf_noise_texel(layer: u32, at: vec2u) -> vec4u {
    bound_loads += 1u;
    if NDF_MAPS_LAYERED {
        if layer != 0u {
            return textureLoad(ndf_maps_coat_noise, at, 0);
        }
    }
    return textureLoad(ndf_maps_noise, at, 0);
}

fn glint_ndf_class_texel(layer: u32, at: vec2u, mip: u32) -> vec4u {
    bound_loads += 1u;
    if NDF_MAPS_LAYERED {
        if layer != 0u {
            return textureLoad(ndf_maps_coat_classes, at, mip);
        }
    }
    return textureLoad(ndf_maps_classes, at, mip);
}

fn glint_ndf_layers() -> GlintNdfLayers {
    return ndf_maps_layers;
}
