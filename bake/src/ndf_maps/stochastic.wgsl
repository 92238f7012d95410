// A surface of examples placed at random: whether a footprint sees sub-regions, places or shares of transforms. Xing et al. 2024,
// section 6.3; twin of glint-bake-core ndf_maps/surface.rs.

#import ndf_maps::classes
#import ndf_maps::probes

fn glint_ndf_stochastic(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let cells = glint_ndf_cells_around(material, footprint.mean);
    var ellipse = glint_ndf_ellipse(footprint, settings.reach);
    ellipse.mean = cells.mean;
    let region = 0.5 * material.cell_texels;
    let regions = 4.0 * GLINT_NDF_REACH * GLINT_NDF_REACH * ellipse.major * max(ellipse.minor, region) / (region * region);
    let many = regions > min(GLINT_NDF_MAX_REGIONS, f32(settings.max_terms));
    if ellipse.minor >= GLINT_NDF_CLASS_SIGMA_CELLS * material.cell_texels || many {
        return glint_ndf_classes(material, ellipse, cells, settings, s);
    }
    var tiles = GlintNdfRegions(GlintNdfSum(0.0, 0.0, 0.0), true);
    if settings.probes > 0u {
        // As the example of most texels sees it, so that those seen as boxes are few.
        var seen = ellipse;
        seen.major *= material.most_texels;
        seen.minor *= material.most_texels;
        if glint_ndf_detail(material, seen, settings).level >= 0 {
            return glint_ndf_probes(material, ellipse, cells, settings, s);
        }
    } else {
        tiles = glint_ndf_regions(material, ellipse, cells, settings, s, false, false);
    }
    var sum = tiles.sum;
    if tiles.boxes || !(sum.share > 0.0) {
        var at_point = !tiles.boxes;
        for (var k = 0; k < 2; k++) {
            sum = glint_ndf_add(sum, glint_ndf_regions(material, ellipse, cells, settings, s, true, at_point).sum);
            // None has a share: the place alone.
            if sum.share > 0.0 {
                break;
            }
            at_point = true;
        }
    }
    return sum;
}
