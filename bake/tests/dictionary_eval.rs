//! The run-time twin against the f64 reference: hash, cells under the footprint, slope distribution.

use glam::{DVec2, Vec2, Vec3};
use glint_bake_core::dictionary::baked::Tables;
use glint_bake_core::dictionary::eval::{
    DictionaryMaterial, PixelFootprint, SlopeQuery, SlopeSum, TARGET_BECKMANN, TARGET_GGX, cell_rotation, cell_sdf,
    facet_level, level_sdf, log1p_over_x, patch_sdf, slope_query, smooth_sdf,
};
use glint_bake_core::dictionary::eval::{
    PIXEL_RADIUS2, RECONSTRUCTION_RADIUS2, cell_weight, level_window, pixel_footprint, row_span,
};
use glint_bake_core::dictionary::quality::max_cells;
use glint_bake_core::dictionary::{DictionaryOptions, bake, reference};
use glint_bake_core::footprint::PixelOnSurface;
use glint_bake_core::hash::{CellState, cell_state, draw_bits, uniform_from_bits};
use glint_bake_core::progress::Silent;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::HashSet;

fn uniform(rng: &mut Pcg64) -> f32 {
    (rng.next_u32() >> 8) as f32 / 16_777_216.0
}

fn material(target: u32) -> DictionaryMaterial {
    DictionaryMaterial {
        alpha: Vec2::splat(0.5),
        normal_target: target,
        density: 1e9,
        relative_area: 1.0,
        density_randomisation: 0.01,
        max_anisotropy: 4.0,
        seed: 7,
        colours: Vec::new(),
        mean_colour: Vec3::ONE,
    }
}

#[test]
fn the_twin_agrees_with_the_reference() {
    let options = DictionaryOptions { marginals: 64, ..Default::default() };
    let dictionary = bake(&options, &Silent).unwrap();
    let tables = dictionary.tables();
    let mut rows = Vec::new();
    for level in 0..options.levels {
        for i in 0..options.marginals {
            rows.push(dictionary.entries(level, i));
        }
    }
    let colours = vec![Vec3::new(1.0, 0.2, 0.1), Vec3::new(0.1, 0.9, 0.3), Vec3::new(0.4, 0.4, 1.0)];
    let mut rng = Pcg64::seed_from_u64(11);
    let (mut worst, mut lit) = (0.0f64, 0);
    for case in 0..3000 {
        let mut m = material(if case % 2 == 0 { TARGET_BECKMANN } else { TARGET_GGX });
        m.alpha = Vec2::new(0.05 + uniform(&mut rng), 0.05 + uniform(&mut rng));
        m.density = (uniform(&mut rng) * 40.0).exp();
        m.relative_area = if case % 3 == 0 { 0.4 } else { 1.0 };
        m.density_randomisation = 2.0 * uniform(&mut rng);
        m.max_anisotropy = 1.0 + 7.0 * uniform(&mut rng);
        m.seed = rng.next_u32();
        if case % 5 == 0 {
            m.colours = colours.clone();
            m.mean_colour = (colours[0] + colours[1] + colours[2]) / 3.0;
        }
        let size = (uniform(&mut rng) * 12.0 - 14.0).exp2();
        let mut direction = || (Vec2::new(uniform(&mut rng), uniform(&mut rng)) - 0.5) * size;
        let pixel = PixelOnSurface { position: direction() / size * 8.0, d_dx: direction(), d_dy: direction() };
        let slope = (Vec2::new(uniform(&mut rng), uniform(&mut rng)) - 0.5) * 2.5 * m.alpha;
        let fast = patch_sdf(&tables, &m, pixel, slope);
        let (sum, coverage) = reference::patch_sdf(&options, &rows, &m, pixel, slope.as_dvec2());
        let smooth = f64::from(smooth_sdf(&m, slope));
        for c in 0..3 {
            let error = (f64::from(fast.sdf[c]) - sum[c]).abs() / (sum[c] + 0.1 * smooth);
            worst = worst.max(error);
            assert!(error < 2e-3, "case {case} colour {c}: {} against {} ({m:?} {pixel:?})", fast.sdf[c], sum[c]);
        }
        assert!((f64::from(fast.coverage) - coverage).abs() < 1e-4, "case {case}: {} {coverage}", fast.coverage);
        assert!(fast.cells <= max_cells(m.max_anisotropy));
        lit += usize::from(sum[0] > 0.01 * smooth && fast.cells > 0);
    }
    assert!(lit > 1000, "only {lit} of 3000 cases had glints: the comparison says little");
    println!("worst relative difference to the reference: {worst:.2e}");
}

#[test]
fn every_cell_of_the_ellipse_is_visited_once_and_the_count_is_bounded() {
    let mut rng = Pcg64::seed_from_u64(5);
    let mut most = [0u32; 5];
    let ratios = [1.0f32, 2.0, 4.0, 8.0, 16.0];
    for case in 0..20_000 {
        let size = (uniform(&mut rng) * 20.0 - 4.0).exp2();
        let stretch = (uniform(&mut rng) * 10.0).exp2();
        let angle = uniform(&mut rng) * 6.3;
        let axis = Vec2::from_angle(angle);
        let ratio = ratios[case % 5];
        let footprint = pixel_footprint(axis * size * stretch, axis.perp() * size, ratio);
        let position = Vec2::new(uniform(&mut rng), uniform(&mut rng)) * 1000.0;
        let mut count = 0;
        for level in [footprint.lod.floor() as u32, footprint.lod.floor() as u32 + 1] {
            let window = level_window(footprint, position, level);
            let (mut visited, mut total) = (HashSet::new(), 0.0f64);
            for row in window.first_row..=window.last_row {
                let span = row_span(window, row);
                for column in span.first..=span.last {
                    assert!(visited.insert((column, row)));
                    total += f64::from(cell_weight(window, span, column));
                }
            }
            // The same from the ellipse's equation in f64, over all cells near it.
            let radius = |radius2: f32| {
                let scaled = f64::from(radius2) * (-2.0 * f64::from(level)).exp2();
                scaled.hypot(f64::from(RECONSTRUCTION_RADIUS2)).sqrt()
            };
            let (long, short) = (radius(footprint.major2), radius(footprint.minor2));
            let along = DVec2::from_angle(0.5 * f64::from(footprint.direction.y.atan2(footprint.direction.x)));
            let reach = long as i32 + 2;
            let mut everything = 0.0f64;
            for row in -reach..=reach {
                for column in -reach..=reach {
                    let d = DVec2::new(f64::from(column), f64::from(row)) + 0.5 - window.centre.as_dvec2();
                    let r2 = (along.dot(d) / long).powi(2) + (along.perp_dot(d) / short).powi(2);
                    everything += (1.0 - r2).max(0.0).powi(2);
                    assert!(r2 > 1.0 - 1e-4 || visited.contains(&(column, row)), "case {case}: r² {r2}");
                }
            }
            assert!(total > 0.05, "case {case}: no weight");
            assert!((total / everything - 1.0).abs() < 1e-4, "case {case}: {total} of {everything}");
            count += visited.len() as u32;
        }
        assert!(count <= max_cells(ratio), "case {case}: {count} cells, bound {}", max_cells(ratio));
        most[case % 5] = most[case % 5].max(count);
    }
    println!("most cells at anisotropy 1, 2, 4, 8, 16: {most:?}");
    for (most, ratio) in most.into_iter().zip(ratios) {
        assert!(
            5 * most > 2 * max_cells(ratio),
            "{most} cells at {ratio}: the bound {} is not tested",
            max_cells(ratio)
        );
    }
}

/// [`level_sdf`] without its early ways out.
fn every_cell(
    tables: &Tables,
    m: &DictionaryMaterial,
    footprint: PixelFootprint,
    position: Vec2,
    level: u32,
    query: &SlopeQuery,
) -> SlopeSum {
    let window = level_window(footprint, position, level);
    let (mut sdf, mut coverage, mut total, mut cells) = (Vec3::ZERO, 0.0, 0.0, 0);
    for row in window.first_row..=window.last_row {
        let span = row_span(window, row);
        for column in span.first..=span.last {
            let weight = cell_weight(window, span, column);
            let first = |index: i32| (index as u32) << level;
            let state = cell_state(first(window.base.x + column), first(window.base.y + row), m.seed);
            let cell = cell_sdf(tables, m, state, facet_level(tables, m, level), query);
            sdf += cell.sdf * weight;
            coverage += cell.covered * weight;
            total += weight;
            cells += 1;
        }
    }
    SlopeSum { sdf: sdf / total, coverage: coverage / total, cells }
}

#[test]
fn beyond_the_tables_no_cell_is_hashed_and_nothing_changes() {
    let tables = bake(&DictionaryOptions { marginals: 32, ..Default::default() }, &Silent).unwrap().tables();
    let mut rng = Pcg64::seed_from_u64(19);
    let (mut left_out, mut smooth) = (0, 0);
    for case in 0..20_000 {
        let mut m = material(if case % 2 == 0 { TARGET_BECKMANN } else { TARGET_GGX });
        m.alpha = Vec2::splat(0.02 + uniform(&mut rng));
        // Up to densities at which some cells, or all, are smooth.
        m.density = (uniform(&mut rng) * 80.0).exp2();
        m.density_randomisation = [0.0, 0.01, 2.0][case % 3];
        m.relative_area = if case % 7 == 0 { 0.5 } else { 1.0 };
        let size = (uniform(&mut rng) * 8.0).exp2();
        let footprint = pixel_footprint(Vec2::new(size, 0.3 * size), Vec2::new(0.0, 0.7 * size), 4.0);
        let position = Vec2::new(uniform(&mut rng), uniform(&mut rng)) * 1000.0;
        // Around √2 times the domain, in units of the material's roughness; GGX's map puts it farther.
        let mut radius =
            tables.domain / tables.alpha_dict * std::f32::consts::SQRT_2 * (0.999 + 0.003 * uniform(&mut rng));
        if m.normal_target == TARGET_GGX {
            radius = (radius * radius).exp_m1().sqrt();
        }
        let slope = Vec2::from_angle(uniform(&mut rng) * std::f32::consts::TAU) * radius * m.alpha;
        let query = slope_query(&tables, &m, slope);
        let level = footprint.lod as u32;
        let found = level_sdf(&tables, &m, footprint, position, level, &query);
        let expected = every_cell(&tables, &m, footprint, position, level, &query);
        // Where all cells are smooth none is visited either, and the mean of equal values is rounded otherwise.
        if found.cells > 0 || found.sdf == Vec3::ZERO {
            assert_eq!((found.sdf, found.coverage), (expected.sdf, expected.coverage), "case {case}: {m:?} {slope}");
        }
        left_out += u32::from(query.outside && found.cells == 0 && found.sdf == Vec3::ZERO);
        smooth += u32::from(query.outside && found.cells > 0 && found.sdf != Vec3::ZERO);
    }
    println!("{left_out} without a cell, {smooth} with smooth ones");
    assert!(left_out > 3000 && smooth > 100, "{left_out} {smooth}");
}

#[test]
fn anisotropy_is_clamped_by_widening_the_minor_axis() {
    let footprint = pixel_footprint(Vec2::new(6400.0, 0.0), Vec2::new(0.0, 6.4), 8.0);
    assert!((footprint.lod - 1600f32.log2()).abs() < 1e-3, "{footprint:?}");
    assert!((footprint.major2.sqrt() / footprint.minor2.sqrt() - 8.0).abs() < 1e-3);
    assert!(footprint.direction.abs_diff_eq(Vec2::X, 1e-6));
    let round = pixel_footprint(Vec2::new(3.0, 4.0), Vec2::new(-4.0, 3.0), 8.0);
    let radius2 = 25.0 * PIXEL_RADIUS2;
    assert!((round.major2 - radius2).abs() < 1e-4 && (round.minor2 - radius2).abs() < 1e-4);
}

#[test]
fn no_two_cells_share_a_state_and_no_cell_is_its_own_hash() {
    let mut seen = HashSet::new();
    for y in 0..1024u32 {
        for x in 0..1024u32 {
            let (x, y) = (x.wrapping_sub(512), y.wrapping_sub(512));
            let state = cell_state(x, y, 0);
            assert!(state != CellState { a: x, b: y }, "fixed point at {x} {y}");
            assert!(seen.insert((state.a, state.b)), "collision at {x} {y}");
        }
    }
    assert!(cell_state(1549, 0, 0) != cell_state(0, 1, 0));
    assert!(cell_state(3, 4, 0) != cell_state(3, 4, 1));
}

/// Random words of a cell: its draws, and after them its state's own, with the halves that marginals take first.
fn word(x: u32, y: u32, seed: u32, index: u32) -> u32 {
    let state = cell_state(x, y, seed);
    match index {
        7 => state.a,
        8 => state.b,
        9 => state.b << 16,
        draw => draw_bits(state, draw),
    }
}

#[test]
fn draws_are_uniform_below_one_and_unlike_those_of_neighbours_and_parents() {
    assert!(uniform_from_bits(u32::MAX) < 1.0);
    assert!(uniform_from_bits(0) == 0.0);
    let origin: HashSet<u32> = (0..7).map(|k| draw_bits(cell_state(0, 0, 0), k)).collect();
    assert_eq!(origin.len(), 7, "the draws of cell (0, 0) repeat");
    let n = 256u32;
    for level in [0u32, 3, 12] {
        for draw in 0..10 {
            let of = |x: u32, y: u32, index| f64::from(uniform_from_bits(word(x << level, y << level, 9, index))) - 0.5;
            let at = |x: u32, y: u32| of(x, y, draw);
            let mut histogram = [0f64; 64];
            let mut product = [0.0; 4];
            for y in 0..n {
                for x in 0..n {
                    let u = at(x, y);
                    histogram[((u + 0.5) * 64.0) as usize] += 1.0;
                    let next = of(x, y, (draw + 1) % 10);
                    for (k, other) in [at(x + 1, y), at(x, y + 1), at(x + 1, y + 1), next].into_iter().enumerate() {
                        product[k] += 12.0 * u * other / f64::from(n * n);
                    }
                }
            }
            let expected = f64::from(n * n) / 64.0;
            let chi2: f64 = histogram.iter().map(|c| (c - expected).powi(2) / expected).sum();
            // 63 degrees of freedom, 30 histograms: 115 is beyond 1 in 20 000 for one.
            assert!(chi2 < 115.0, "level {level} draw {draw}: χ² {chi2:.1}");
            // Standard deviation of a correlation over 65 536 pairs: 1/256.
            for (k, c) in product.into_iter().enumerate() {
                assert!(c.abs() < 5.0 / 256.0, "level {level} draw {draw} pair {k}: correlation {c:.4}");
            }
        }
    }
}

#[test]
fn rotations_are_cosines_and_sines_of_an_eighth_of_a_turn_either_way() {
    let mut worst = 0.0f64;
    for k in 0..=100_000u64 {
        let bits = (k * u64::from(u32::MAX) / 100_000) as u32;
        let angle = (f64::from(bits >> 8) / 16_777_216.0 - 0.5) * std::f64::consts::FRAC_PI_2;
        let turn = cell_rotation(bits).as_dvec2();
        worst = worst.max((turn.x - libm::cos(angle)).abs()).max((turn.y - libm::sin(angle)).abs());
    }
    println!("worst: {worst:.2e}");
    assert!(worst < 1.1e-5, "{worst}");
}

#[test]
fn one_bit_of_the_index_changes_half_the_bits_of_a_draw() {
    for bit in 0..32 {
        for draw in [0, 6, 7, 8] {
            let mut changed = 0;
            for k in 0..2000u32 {
                let (x, y) = (k.wrapping_mul(2_654_435_761), k);
                let before = word(x, y, 0, draw);
                changed += (before ^ word(x ^ (1 << bit), y, 0, draw)).count_ones();
                changed += (before ^ word(x, y ^ (1 << bit), 0, draw)).count_ones();
            }
            let share = f64::from(changed) / (2.0 * 2000.0 * 32.0);
            assert!((share - 0.5).abs() < 0.01, "bit {bit} draw {draw}: {share:.4}");
        }
    }
}

#[test]
fn the_logarithm_ratio_is_accurate() {
    for k in -60..80 {
        let x = (f64::from(k) * 0.25).exp2();
        let truth = libm::log1p(x) / x;
        let error = (f64::from(log1p_over_x(x as f32)) / truth - 1.0).abs();
        assert!(error < 4e-7, "x = {x}: {error:.1e}");
    }
    assert!((log1p_over_x(0.0) - 1.0).abs() < 1e-7);
}
