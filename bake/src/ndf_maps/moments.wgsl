// Mean and covariance of the projected normals under a footprint on NDF maps, from the moments that are baked of every node. Twin of
// moments.rs, which has the reasons.

#import moments
#import ndf_maps::query

// Baked moments of a node, two an element of the table of nodes after the nodes themselves.
fn glint_ndf_node_moments(material: GlintNdfMaterial, node: u32) -> GlintMoments {
    let element = glint_ndf_node(material.layer, material.moments + node / 2u);
    let record = select(element.xy, element.zw, (node & 1u) == 1u);
    let roots = vec2f(f32(record.y & 0x7ffu), f32((record.y >> 11u) & 0x7ffu)) / 2047.0;
    let deviations = roots * roots;
    let correlation = f32(record.y >> 22u) * (2.0 / 1023.0) - 1.0;
    return GlintMoments(
        unpack2x16snorm(record.x),
        vec3f(deviations.x * deviations.x, correlation * deviations.x * deviations.y, deviations.y * deviations.y),
    );
}

// Moments of projected normals in the example as a palette entry shows them; `normal_to_local` by rows.
fn glint_ndf_turned_moments(local: GlintMoments, normal_to_local: vec4f) -> GlintMoments {
    let m = vec4f(normal_to_local.w, -normal_to_local.y, -normal_to_local.z, normal_to_local.x)
        / glint_windows_determinant(normal_to_local);
    let xx = local.covariance.x;
    let xy = local.covariance.y;
    let yy = local.covariance.z;
    return GlintMoments(
        glint_windows_apply(m, local.mean),
        vec3f(
            m.x * m.x * xx + 2.0 * m.x * m.y * xy + m.y * m.y * yy,
            m.x * m.z * xx + (m.x * m.w + m.y * m.z) * xy + m.y * m.w * yy,
            m.z * m.z * xx + 2.0 * m.z * m.w * xy + m.w * m.w * yy,
        ),
    );
}

// Adds what an ellipse in the example sees, `weight` together: the map's normals while all of it is narrower than the finest windows,
// and windows around its probes.
fn glint_ndf_add_moments(
    material: GlintNdfMaterial,
    local: GlintWindowsEllipse,
    weight: f32,
    normal: vec4f,
    sums: ptr<function, GlintMomentSums>,
) {
    let in_patches = glint_ndf_patches_share(local.major, material.finest_variance);
    if in_patches > 0.0 {
        // Four places, sqrt 2 standard deviations away along the axes, have the moments of a Gaussian up to the third.
        let lobe = material.intrinsic_roughness * material.intrinsic_roughness;
        let along = local.axis * (1.41421356 * local.major);
        let across = vec2f(-local.axis.y, local.axis.x) * (1.41421356 * local.minor);
        for (var k = 0u; k < 4u; k++) {
            let step = select(along, across, k > 1u) * select(1.0, -1.0, (k & 1u) == 1u);
            let own = GlintMoments(glint_ndf_normal(material, local.mean + step), vec3f(lobe, 0.0, lobe));
            glint_moments_add(sums, 0.25 * weight * in_patches, glint_ndf_turned_moments(own, normal));
        }
    }
    if in_patches < 1.0 {
        let probes = glint_ndf_probes(local);
        let blend = glint_ndf_blend(material, probes.variance);
        var k = 0.0;
        for (var i = 0; i < 2 * GLINT_NDF_MAX_PROBES; i++) {
            let seen = glint_ndf_weight(probes, k);
            if seen <= 0.0 {
                break;
            }
            let place = local.mean + local.axis * (k * probes.step);
            for (var coarser = 0u; coarser < 2u; coarser++) {
                let share = select(1.0 - blend.coarser, blend.coarser, coarser == 1u);
                if share > 0.0 {
                    let found = glint_ndf_corners(material, blend.level + coarser, place);
                    let part = weight * (1.0 - in_patches) * seen / probes.total * share;
                    for (var corner = 0u; corner < 3u; corner++) {
                        let moments = glint_ndf_node_moments(material, found.nodes[corner]);
                        glint_moments_add(sums, part * found.shares[corner], glint_ndf_turned_moments(moments, normal));
                    }
                }
            }
            k = glint_ndf_next_probe(k);
        }
    }
}

// Adds what a footprint sees of a surface of examples placed at random.
fn glint_ndf_stochastic_moments(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    sums: ptr<function, GlintMomentSums>,
) {
    let cells = glint_ndf_cells_around(material, footprint.mean);
    var seen = glint_windows_shortened(glint_windows_ellipse(footprint), settings.max_ratio);
    seen.mean = cells.mean;
    let size = seen.minor * material.most_texels / f32(max(material.size.x, material.size.y));
    let in_shares = glint_ndf_ramp(size, GLINT_NDF_SHARES_FROM);
    let in_owners = 1.0 - glint_ndf_ramp(size, GLINT_NDF_OWNERS_UNTIL);
    var shares = GlintNdfShares(array<vec4f, 4>(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0)));
    if in_shares > 0.0 {
        glint_ndf_probed_shares(material, seen, cells, in_shares, &shares);
    }
    if in_owners > 0.0 {
        let variance = seen.major * seen.minor;
        var owners = glint_ndf_owners_at(material, cells, seen.mean, variance);
        for (var o = 0u; o < 4u; o++) {
            let owner = owners[o];
            if owner.weight > 0.0 {
                let at = material.palette_records + 2u * owner.class_index;
                let position = bitcast<vec4f>(glint_ndf_record(material.layer, at));
                let normal = bitcast<vec4f>(glint_ndf_record(material.layer, at + 1u));
                var from_centre = seen;
                from_centre.mean += glint_ndf_pull(owner, variance) - owner.centre;
                let local = glint_windows_transformed(from_centre, position, owner.offset);
                if in_shares > 0.0 {
                    glint_ndf_add_share(&shares, owner.class_index, -in_shares * in_owners * owner.weight);
                }
                glint_ndf_add_moments(material, local, in_owners * owner.weight, normal, sums);
            }
        }
    }
    if in_shares > 0.0 {
        let whole = glint_ndf_node_moments(material, glint_ndf_record(material.layer, material.levels - 1u).z);
        for (var k = 0u; k < material.palette; k++) {
            let share = shares.groups[k / 4u][k % 4u];
            if share != 0.0 {
                let normal = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * k + 1u));
                glint_moments_add(sums, share, glint_ndf_turned_moments(whole, normal));
            }
        }
    }
}

// Mean and covariance of the projected normals that a footprint (surface texels) sees, their lobes with them.
fn glint_ndf_moments(material: GlintNdfMaterial, footprint: GlintFootprint, settings: GlintNdfSettings) -> GlintMoments {
    var sums = GlintMomentSums(vec2f(0.0), vec3f(0.0));
    if material.cells == 0u {
        let position = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records));
        let normal = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 1u));
        let within = glint_ndf_tiled_place(material, position, footprint.mean);
        let transformed = glint_windows_transformed(glint_windows_ellipse(footprint), position, within);
        let seen = glint_windows_shortened(transformed, settings.max_ratio);
        glint_ndf_add_moments(material, seen, 1.0, normal, &sums);
    } else {
        glint_ndf_stochastic_moments(material, footprint, settings, &sums);
    }
    return glint_moments_whole(sums, material.intrinsic_roughness * material.intrinsic_roughness);
}
