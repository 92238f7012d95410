//! Cells of facets: words that are uniform and do not depend on each other, and what a pixel keeps of its facets when it moves.

use glam::{Mat2, Vec2, Vec3};
use glint_bake_core::counting::query::{
    FootprintBox, angle_state, cell_bits, cell_words, facet_cell, facing_plane, footprint_area, footprint_box,
    footprint_facets,
};
use glint_bake_core::hash::CellState;
use glint_bake_core::rng::{ItemRng, Purpose};
use std::f32::consts::PI;

/// Largest distance of the distribution function of words in (0, 1) from that of uniform numbers.
fn distance_from_uniform(mut words: Vec<f64>) -> f64 {
    words.sort_by(f64::total_cmp);
    let count = words.len() as f64;
    words.iter().enumerate().map(|(i, u)| (u - (i as f64 + 0.5) / count).abs()).fold(0.0, f64::max)
}

#[test]
fn words_are_uniform_over_seeds_and_over_places() {
    const COUNT: u32 = 40_000;
    // Kolmogorov: 1.95 / √n is exceeded in 1 of 1000 cases.
    let most = 1.95 / f64::from(COUNT).sqrt();
    let round = FootprintBox { lod: 0.3, ratio: 0.0, turn: 0.0 };
    let long = FootprintBox { lod: -2.6, ratio: 3.4, turn: 1.7 };
    let word = |footprint, position, seed| f64::from(cell_words(facet_cell(footprint, position, seed), 4)[3]);
    for footprint in [round, long] {
        for position in [Vec2::ZERO, Vec2::new(0.31, 0.17), Vec2::new(-123.4, 9.1)] {
            let words = (0..COUNT).map(|seed| word(footprint, position, seed)).collect();
            let distance = distance_from_uniform(words);
            assert!(distance < most, "{footprint:?} {position}: {distance}, expected {most} at most");
        }
        let place = |k: u32| Vec2::new((k % 200) as f32, (k / 200) as f32) * 40.0;
        let distance = distance_from_uniform((0..COUNT).map(|k| word(footprint, place(k), 7)).collect());
        assert!(distance < most, "{footprint:?}: {distance} over places, expected {most} at most");
    }
}

/// Correlation of pairs of numbers in (0, 1), from the sum of the products of what they are off their means.
fn correlation(pairs: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for [a, b] in pairs {
        sum += 12.0 * (a - 0.5) * (b - 0.5);
        count += 1.0;
    }
    sum / count
}

#[test]
fn words_of_one_cell_and_of_its_neighbours_do_not_depend_on_each_other() {
    let footprint = FootprintBox { lod: 0.0, ratio: 2.0, turn: 0.0 };
    let words = |x: u32, y: u32| {
        cell_words(facet_cell(footprint, Vec2::new(4.0 * x as f32 + 2.0, y as f32 + 0.5), 3), 4).map(f64::from)
    };
    let places = || (0..200u32).flat_map(|x| (0..200u32).map(move |y| [x, y]));
    for (i, j) in [(0, 1), (0, 2), (1, 2), (2, 3)] {
        let found = correlation(places().map(|[x, y]| [words(x, y)[i], words(x, y)[j]]));
        assert!(found.abs() < 0.025, "words {i} and {j}: {found}");
    }
    for step in [[1, 0], [0, 1], [1, 1], [2, 0], [0, 2]] {
        let apart = [3 * step[0], 3 * step[1]];
        let found = correlation(places().map(|[x, y]| [words(x, y)[1], words(x + apart[0], y + apart[1])[1]]));
        assert!(found.abs() < 0.025, "{apart:?} cells apart: {found}");
    }
}

/// A pixel at random: place, and derivatives of a footprint `ratio` times as long as wide.
struct Pixel {
    place: Vec2,
    /// Unit vectors along and across.
    along: Vec2,
    edges: Vec2,
    screen_turn: f32,
}

impl Pixel {
    fn at_random(rng: &mut ItemRng, ratio: f32) -> Pixel {
        let width = (4.0 * rng.unit() as f32).exp2();
        Pixel {
            place: Vec2::new(rng.unit() as f32, rng.unit() as f32) * 5e5,
            along: Vec2::from_angle(PI * rng.unit() as f32),
            edges: Vec2::new(ratio * width, width),
            screen_turn: 2.0 * PI * rng.unit() as f32,
        }
    }

    /// The cell of the pixel that is moved by shares of its edges, whose edges are scaled, and which is turned.
    fn cell(&self, moved: Vec2, scale: Vec2, turn: f32) -> CellState {
        let place = self.place + self.along * (moved.x * self.edges.x) + self.along.perp() * (moved.y * self.edges.y);
        let along = Vec2::from_angle(turn).rotate(self.along);
        let edges = self.edges * scale;
        let turned = Mat2::from_angle(self.screen_turn);
        let of_screen = Mat2::from_cols(along * edges.x, along.perp() * edges.y) * turned;
        facet_cell(footprint_box(of_screen.x_axis, of_screen.y_axis), place, 11)
    }
}

/// Share of random pixels that keep their cell.
fn kept(ratio: f32, moved: Vec2, scale: Vec2, turn: f32) -> f64 {
    const COUNT: u32 = 100_000;
    let mut rng = ItemRng::new(5, Purpose::Test(77), ratio.to_bits());
    let same = |pixel: Pixel| pixel.cell(Vec2::ZERO, Vec2::ONE, 0.0) == pixel.cell(moved, scale, turn);
    (0..COUNT).filter(|_| same(Pixel::at_random(&mut rng, ratio))).count() as f64 / f64::from(COUNT)
}

/// Share of a box, `ratio` times as long as wide, that lies outside of itself after a turn.
fn lost_by_turning(ratio: f32, turn: f32) -> f64 {
    const STEPS: u32 = 1000;
    let place = |k: u32| (k as f32 + 0.5) / STEPS as f32 - 0.5;
    let outside = |k: u32| {
        let at = Vec2::from_angle(turn).rotate(Vec2::new(ratio * place(k / STEPS), place(k % STEPS)));
        at.x.abs() > 0.5 * ratio || at.y.abs() > 0.5
    };
    (0..STEPS * STEPS).filter(|k| outside(*k)).count() as f64 / f64::from(STEPS * STEPS)
}

/// Boxes keep ¾ of their facets when they move by a quarter of their length, and none when they move by all of it.
#[test]
fn what_a_pixel_keeps_follows_its_footprint_at_any_ratio() {
    println!(
        "ratio  kept: 1/4 along, 1/4 across, 1 along, 1 across  lost over boxes': zoom 1 %, stretch 1 %, turn 0.01, turn 1°"
    );
    for ratio in [1.0f32, 1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 11.3, 16.0, 22.6, 32.0] {
        let moved = |x, y| kept(ratio, Vec2::new(x, y), Vec2::ONE, 0.0);
        let scaled = |x, y| 1.0 - kept(ratio, Vec2::ZERO, Vec2::new(x, y), 0.0);
        let turned = |turn| (1.0 - kept(ratio, Vec2::ZERO, Vec2::ONE, turn)) / lost_by_turning(ratio, turn);
        let [along, across, next_along, next_across] =
            [moved(0.25, 0.0), moved(0.0, 0.25), moved(1.0, 0.0), moved(0.0, 1.0)];
        // A box that grows keeps its facets and gets others: of two pictures, both count.
        let zoomed = 2.0 * scaled(1.01, 1.01) / (1.01f64.powi(2) - 1.0);
        let stretched = 2.0 * scaled(1.01, 1.0) / 0.01;
        let [turned_little, turned_more] = [turned(0.01), turned(PI / 180.0)];
        println!(
            "{ratio:5.1}  {along:.3} {across:.3} {next_along:.3} {next_across:.3}  {zoomed:.2} {stretched:.2} {turned_little:.2} {turned_more:.2}"
        );
        let least = if ratio <= 16.0 && ratio.log2().fract() == 0.0 { 0.6 } else { 0.55 };
        assert!(along >= least && across >= 0.6, "{ratio}: {along} {across}");
        assert!(next_along <= 0.1 && next_across <= 0.1, "{ratio}: {next_along} {next_across}");
        assert!(zoomed <= 2.0, "{ratio}: a zoom changes {zoomed} times what boxes do");
        assert!(turned_little <= 2.0 && turned_more <= 2.0, "{ratio}: a turn {turned_little} {turned_more}");
        // More than twice what boxes do: the longer cell of another ratio has no facet of the shorter one.
        assert!(stretched <= 3.2, "{ratio}: a stretch changes {stretched} times what boxes do");
    }
}

/// Explicit facets that a light of a disk's shape is mirrored in stay lit while the disks of two directions overlap.
#[test]
fn facets_come_and_go_as_discs_of_light_overlap() {
    const COUNT: u32 = 40_000;
    for share in [0.1f32, 0.25, 0.5, 0.75, 1.0] {
        let same = |k: &u32| {
            let state = CellState { a: k.wrapping_mul(0x1234_5677), b: k.wrapping_mul(0x0765_4321) };
            let place = Vec2::from_angle(k.wrapping_mul(2_654_435_761) as f32 * 1e-9) * 3.0;
            let moved = place + Vec2::from_angle(*k as f32 * 0.7) * share;
            angle_state(state, place) == angle_state(state, moved)
        };
        let kept = (0..COUNT).filter(same).count() as f64 / f64::from(COUNT);
        // The cell's edge is the disk's diameter.
        let x = f64::from(share);
        let overlap = 2.0 / std::f64::consts::PI * (x.acos() - x * (1.0 - x * x).sqrt());
        println!("moved by {share} of the edge: kept {kept:.3}, discs overlap by {overlap:.3}");
        assert!((kept - overlap).abs() < 0.08, "{share}: {kept} {overlap}");
    }
}

#[test]
fn directions_of_no_width_leave_the_state_to_the_surface() {
    let state = CellState { a: 5, b: 77 };
    let here = angle_state(state, Vec2::ZERO);
    assert_eq!(here, angle_state(state, Vec2::new(1e-9, -1e-9)));
    assert_ne!(cell_bits(here, 0), cell_bits(angle_state(state, Vec2::new(1.0, 0.0)), 0));
}

/// A slanted surface takes each axis as often as the square of its normal says, and places keep theirs when the normal turns a little.
#[test]
fn surfaces_without_uv_take_the_axes_near_their_normal() {
    let mut rng = ItemRng::new(5, Purpose::Test(79), 0);
    let normal = Vec3::new(0.6, 0.0, 0.8);
    let other = Vec3::new(0.61, 0.0, (1.0f32 - 0.61 * 0.61).sqrt());
    let (mut across_x, mut changed) = (0, 0);
    const COUNT: u32 = 40_000;
    for _ in 0..COUNT {
        let place = Vec3::new(rng.unit() as f32, rng.unit() as f32, rng.unit() as f32) * 1e5;
        let seen = |normal| facing_plane(place, Vec3::Y, Vec3::new(0.8, 0.0, -0.6), normal, 3);
        let found = seen(normal);
        // Three fifths or four fifths of the area are seen across either axis.
        let in_plane = footprint_area(found.d_dx, found.d_dy) * found.area_ratio;
        assert!((in_plane - 1.0).abs() < 1e-5, "{in_plane}");
        across_x += u32::from(found.position == Vec2::new(place.y, place.z));
        changed += u32::from(found.seed != seen(other).seed);
    }
    let share = f64::from(across_x) / f64::from(COUNT);
    assert!((share - 0.36).abs() < 0.01, "{share}");
    assert!(f64::from(changed) / f64::from(COUNT) < 0.02, "{changed}");
    let plane = facing_plane(Vec3::new(1.0, 2.0, 3.0), Vec3::X, Vec3::Y, Vec3::Z, 3);
    assert_eq!((plane.position, plane.d_dx, plane.d_dy), (Vec2::new(1.0, 2.0), Vec2::X, Vec2::Y));
}

#[test]
fn footprints_without_area_have_no_facets_and_huge_ones_a_bounded_number() {
    let none = footprint_area(Vec2::X, Vec2::X);
    assert_eq!((none, footprint_facets(none, 1e9)), (0.0, 0.0));
    let huge = footprint_area(Vec2::splat(1e20), Vec2::new(-1e20, 1e20));
    assert_eq!(footprint_facets(huge, 1.0), 1e16);
    let nothing = footprint_box(Vec2::ZERO, Vec2::ZERO);
    assert!(nothing.lod == -24.0 && nothing.ratio >= 0.0 && nothing.ratio <= 6.0, "{nothing:?}");
    let needle = footprint_box(Vec2::X, Vec2::X);
    assert!((needle.ratio - 6.0).abs() < 0.2, "{needle:?}");
    for (dx, dy) in
        [(Vec2::splat(1e20), Vec2::new(-1e20, 1e20)), (Vec2::splat(f32::NAN), Vec2::X), (Vec2::ZERO, Vec2::Y * 1e-30)]
    {
        let words = cell_words(facet_cell(footprint_box(dx, dy), Vec2::splat(f32::MAX), 1), 16);
        assert!(words.iter().all(|word| (0.0..=1.0).contains(word)), "{dx} {dy}: {words:?}");
    }
}
