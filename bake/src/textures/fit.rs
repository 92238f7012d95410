//! The lobe of least L1 error: one normal and one GGX α in place of many facets, over views and lights.
//!
//! Half vectors are drawn where the facets reflect, a quarter of them from a wide lobe, each seen from one of several views; with
//! dω_l = 4 (v·h) dω_h the sum of weighted differences of radiance is ∫|L̂ − L| dω_l. The same offsets serve every texel, by a
//! Kronecker sequence, so that the fit has no noise from one texel to the next.
//!
//! α² is the least α² of the facets and a broadening on top of it. It is found by steps downhill from the broadening that variance
//! asks for, and a parabola through the last three. Where facets spread far for the width of their lobes, the normal is free: the
//! mode may be nearer than the mean. It leaves the mean only where that is worth [`WORTH`], so that smooth maps keep their mean
//! normals.
//!
//! Additions, multiplications, divisions and square roots only, in a fixed order: the same bits on every machine.

use multiversion::multiversion;

const LANES: usize = 8;
type Lanes = [f32; LANES];
/// A vector of [`LANES`] half vectors, views or lights.
type Vectors = [Lanes; 3];

/// Polar angles of the views that a highlight is fitted for, in radians.
const VIEW_ANGLES: [f64; 4] = [0.0, 0.5, 0.9, 1.2];
/// Part of the error that a normal other than the mean has to save.
const WORTH: f32 = 0.02;
/// Least z of a free normal.
const LEAST_Z: f32 = 0.05;

/// A lobe: a facet, or what stands for many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lobe {
    /// Unit normal with z ≥ 0.
    pub normal: [f32; 3],
    /// α².
    pub a2: f32,
}

/// Where half vectors lie in a GGX lobe of α = 1 around +Z, and the view that each is seen from.
#[derive(Clone, Debug)]
pub(super) struct Offsets(Vec<Offset>);

#[derive(Clone, Copy, Debug, Default)]
struct Offset {
    slope: [Lanes; 2],
    view: Vectors,
}

impl Offsets {
    /// `count` slopes, a multiple of 32.
    pub fn new(count: usize) -> Offsets {
        let mut blocks = vec![Offset::default(); count / LANES];
        for k in 0..count {
            let t = k as f64 + 0.5;
            let (u, angle) = ((t * 0.754_877_666_246_692_7).fract(), (t * 0.569_840_290_998_053_2).fract());
            // The share of GGX within the tangent r is r²/(r² + α²).
            let r = (u / (1.0 - u)).sqrt();
            let (sin, cos) = libm::sincos(angle * std::f64::consts::TAU);
            let polar = VIEW_ANGLES[((t * 0.618_033_988_749_894_8).fract() * VIEW_ANGLES.len() as f64) as usize];
            let (view_sin, view_cos) = libm::sincos(t * 2.399_963_229_728_653);
            let view = [libm::sin(polar) * view_cos, libm::sin(polar) * view_sin, libm::cos(polar)];
            let (block, lane) = (&mut blocks[k / LANES], k % LANES);
            (block.slope[0][lane], block.slope[1][lane]) = ((r * cos) as f32, (r * sin) as f32);
            for c in 0..3 {
                block.view[c][lane] = view[c] as f32;
            }
        }
        Offsets(blocks)
    }
}

/// Half vectors with their views and lights, and what the facets show there.
#[derive(Clone, Copy, Debug, Default)]
struct Samples {
    half: Vectors,
    view: Vectors,
    light: Vectors,
    /// 4 (v·h), which makes half vectors lights, up to a factor; later over the density of half vectors.
    weight: Lanes,
    /// π D (h·n), the mean of all facets.
    density: Lanes,
    /// 2π times radiance.
    exact: Lanes,
}

/// Samples against a normal.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    sin2: Lanes,
    cos2: Lanes,
    view: Lanes,
    light: Lanes,
}

/// Memory that fits share, so that a texel allocates none.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    samples: Vec<Samples>,
    seen: Vec<Seen>,
}

/// The lobe nearest to the facets. `begin` has their mean normal and an α² to begin at; none of them has a lesser α² than
/// `least`. `is_free`: the normal too is looked for.
pub(super) fn nearest(
    facets: &[Lobe],
    begin: Lobe,
    least: f32,
    is_free: bool,
    offsets: &Offsets,
    scratch: &mut Scratch,
) -> Lobe {
    let wide = Lobe { a2: (2.0 * begin.a2).min(1.0), ..begin };
    place(facets, wide, offsets, &mut scratch.samples);
    shine(facets, wide, &mut scratch.samples);
    let (samples, seen) = (&scratch.samples, &mut scratch.seen);
    see(begin.normal, samples, seen);
    let at_mean = narrowed(begin, least, samples, seen);
    if !is_free {
        return at_mean.0;
    }
    let mut best = at_mean;
    let mode = mode(samples);
    if mode[2] > LEAST_Z {
        see(mode, samples, seen);
        let begin = Lobe { normal: mode, a2: least + 0.25 * (at_mean.0.a2 - least) };
        let at_mode = narrowed(begin, least, samples, seen);
        if at_mode.1 < best.1 {
            best = at_mode;
        }
    }
    best = moved(best, samples, seen);
    see(best.0.normal, samples, seen);
    best = narrowed(best.0, least, samples, seen);
    if best.1 < (1.0 - WORTH) * at_mean.1 { best.0 } else { at_mean.0 }
}

/// Factor of the broadening from one step of the search to the next.
const STEP: f32 = std::f32::consts::SQRT_2;
/// Steps of the normal, in widths of the lobe.
const TILTS: [f32; 2] = [0.5, 0.2];

/// The lobe of this normal with the least error, and the error: steps downhill until three of them hold the least one, then the
/// vertex of the parabola through these.
fn narrowed(begin: Lobe, least: f32, samples: &[Samples], seen: &[Seen]) -> (Lobe, f32) {
    let at = |broadening: f32| (least + broadening).min(1.0);
    let mut broadening = begin.a2 - least;
    let mut found = error(at(broadening), samples, seen);
    // Errors a step above and a step below.
    let mut sides = [error(at(broadening * STEP), samples, seen), 0.0];
    if sides[0] < found {
        while sides[0] < found {
            broadening *= STEP;
            (sides[1], found) = (found, sides[0]);
            sides[0] = error(at(broadening * STEP), samples, seen);
        }
    } else {
        sides[1] = error(at(broadening / STEP), samples, seen);
        while sides[1] < found {
            broadening /= STEP;
            (sides[0], found) = (found, sides[1]);
            sides[1] = error(at(broadening / STEP), samples, seen);
        }
    }
    // √2 to the power of the vertex, by its series.
    let u = 0.346_573_6 * vertex(sides[1], found, sides[0]);
    let between = at(broadening * (1.0 + u * (1.0 + u * (0.5 + u * (1.0 / 6.0)))));
    let error = error(between, samples, seen);
    if error < found { (Lobe { a2: between, ..begin }, error) } else { (Lobe { a2: at(broadening), ..begin }, found) }
}

/// Where the parabola through values at −1, 0 and 1 is least, from −1 to 1; 0 where it has no least value.
fn vertex(before: f32, here: f32, after: f32) -> f32 {
    let curvature = before - 2.0 * here + after;
    if curvature > 0.0 { (0.5 * (before - after) / curvature).clamp(-1.0, 1.0) } else { 0.0 }
}

/// The lobe moved downhill across its normal, in steps of its width: to the vertices of parabolas along two axes, or to the best of
/// the points that these were laid through.
fn moved((mut at, mut found): (Lobe, f32), samples: &[Samples], seen: &mut Vec<Seen>) -> (Lobe, f32) {
    for step in TILTS {
        let r = at.a2.sqrt() * step;
        let from = at.normal;
        let middle = found;
        let mut try_at = |p: f32, q: f32| {
            let normal = tilted(from, r * p, r * q);
            if normal[2] < LEAST_Z {
                return f32::MAX;
            }
            see(normal, samples, seen);
            let next = error(at.a2, samples, seen);
            if next < found {
                (at.normal, found) = (normal, next);
            }
            next
        };
        let [right, left, up, down] = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)].map(|(p, q)| try_at(p, q));
        let (p, q) = (vertex(left, middle, right), vertex(down, middle, up));
        if p != 0.0 || q != 0.0 {
            try_at(p, q);
        }
    }
    (at, found)
}

/// The half vector where the facets are densest.
fn mode(samples: &[Samples]) -> [f32; 3] {
    let (mut most, mut at) = (-1.0, [0.0, 0.0, 1.0]);
    for block in samples {
        for lane in 0..LANES {
            if block.density[lane] > most {
                (most, at) = (block.density[lane], block.half.map(|component| component[lane]));
            }
        }
    }
    at
}

/// A direction of the slope (p, q) in the frame around a unit vector with z ≥ 0, by Rodrigues' formula.
#[inline(always)]
fn tilted([x, y, z]: [f32; 3], p: f32, q: f32) -> [f32; 3] {
    let s = 1.0 / (1.0 + z);
    let along = (p * x + q * y) * s;
    let scale = 1.0 / (1.0 + p * p + q * q).sqrt();
    [(x + p - x * along) * scale, (y + q - y * along) * scale, (z - p * x - q * y) * scale]
}

/// Three quarters of the half vectors lie in the lobes of the facets, evenly among them, the others in the wide one.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn place(facets: &[Lobe], wide: Lobe, offsets: &Offsets, samples: &mut Vec<Samples>) {
    samples.clear();
    let of_facets = offsets.0.len() * 3 / 4 * LANES;
    for (block, offset) in offsets.0.iter().enumerate() {
        let (mut normal, mut a) = ([[0.0_f32; LANES]; 3], [0.0_f32; LANES]);
        for lane in 0..LANES {
            let k = block * LANES + lane;
            let lobe = if k < of_facets { facets[k * facets.len() / of_facets] } else { wide };
            for c in 0..3 {
                normal[c][lane] = lobe.normal[c];
            }
            a[lane] = lobe.a2;
        }
        let mut out = Samples { view: offset.view, ..Samples::default() };
        for k in 0..LANES {
            let a = a[k].sqrt();
            let half =
                tilted([normal[0][k], normal[1][k], normal[2][k]], a * offset.slope[0][k], a * offset.slope[1][k]);
            let [vx, vy, vz] = [offset.view[0][k], offset.view[1][k], offset.view[2][k]];
            let cos = half[0] * vx + half[1] * vy + half[2] * vz;
            (out.half[0][k], out.half[1][k], out.half[2][k]) = (half[0], half[1], half[2]);
            let twice = 2.0 * cos;
            let light = [twice * half[0] - vx, twice * half[1] - vy, twice * half[2] - vz];
            (out.light[0][k], out.light[1][k], out.light[2][k]) = (light[0], light[1], light[2]);
            // Lights below the surface are none.
            out.weight[k] = if cos > 0.0 && light[2] > 0.0 { cos } else { 0.0 };
        }
        samples.push(out);
    }
}

/// What the facets show, and the weights.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn shine(facets: &[Lobe], wide: Lobe, samples: &mut [Samples]) {
    let share = 1.0 / facets.len() as f32;
    for block in samples {
        let (mut density, mut exact) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        for facet in facets {
            add_facet(*facet, block, &mut density, &mut exact);
        }
        let (mut of_wide, mut unused) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        add_facet(wide, block, &mut of_wide, &mut unused);
        for k in 0..LANES {
            block.density[k] = density[k] * share;
            block.exact[k] = exact[k] * share;
            block.weight[k] /= 0.75 * block.density[k] + 0.25 * of_wide[k];
        }
    }
}

/// Adds π D (h·n) and 2π times the radiance of a facet. Smith's masking is that of Hammon 2017, without square roots: V = ½ /
/// (2 (1 − α) (n·l) (n·v) + α (n·l + n·v)).
#[inline(always)]
fn add_facet(facet: Lobe, of: &Samples, density: &mut Lanes, exact: &mut Lanes) {
    let ([x, y, z], a2) = (facet.normal, facet.a2);
    let a = a2.sqrt();
    let both = 2.0 - 2.0 * a;
    for k in 0..LANES {
        let (dx, dy, dz) = (of.half[0][k] - x, of.half[1][k] - y, of.half[2][k] - z);
        let d2 = dx * dx + dy * dy + dz * dz;
        let c = (1.0 - 0.5 * d2).max(0.0);
        // sin² from the distance: 1 − cos² would lose it near the peak.
        let t = d2 * (1.0 - 0.25 * d2) + a2 * (c * c);
        let cv = x * of.view[0][k] + y * of.view[1][k] + z * of.view[2][k];
        let cl = (x * of.light[0][k] + y * of.light[1][k] + z * of.light[2][k]).max(0.0);
        let lit = if cv > 0.0 { cl } else { 0.0 };
        let cv = cv.max(1e-3);
        let masking = both * (cl * cv) + a * (cl + cv);
        let d = a2 / (t * t * masking);
        density[k] += d * masking * c;
        exact[k] += d * lit;
    }
}

/// Samples against a normal.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn see([x, y, z]: [f32; 3], samples: &[Samples], seen: &mut Vec<Seen>) {
    seen.resize(samples.len(), Seen::default());
    for (of, seen) in samples.iter().zip(seen) {
        for k in 0..LANES {
            let (dx, dy, dz) = (of.half[0][k] - x, of.half[1][k] - y, of.half[2][k] - z);
            let d2 = dx * dx + dy * dy + dz * dz;
            let c = (1.0 - 0.5 * d2).max(0.0);
            let cv = x * of.view[0][k] + y * of.view[1][k] + z * of.view[2][k];
            let cl = (x * of.light[0][k] + y * of.light[1][k] + z * of.light[2][k]).max(0.0);
            seen.sin2[k] = d2 * (1.0 - 0.25 * d2);
            seen.cos2[k] = c * c;
            seen.light[k] = if cv > 0.0 { cl } else { 0.0 };
            seen.view[k] = cv.max(1e-3);
        }
    }
}

/// L1 error of a lobe of this α² around the normal that was seen, up to a factor that is the same for all.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn error(a2: f32, samples: &[Samples], seen: &[Seen]) -> f32 {
    let a = a2.sqrt();
    let both = 2.0 - 2.0 * a;
    let mut sums = [0.0_f32; LANES];
    for (of, seen) in samples.iter().zip(seen) {
        for k in 0..LANES {
            let t = seen.sin2[k] + a2 * seen.cos2[k];
            let masking = both * (seen.light[k] * seen.view[k]) + a * (seen.light[k] + seen.view[k]);
            sums[k] += of.weight[k] * (a2 * seen.light[k] / (t * t * masking) - of.exact[k]).abs();
        }
    }
    sums.iter().sum()
}
