//! The lobe of least L1 error: one normal and one GGX α in place of many facets, over views and lights.
//!
//! Half vectors are drawn from one wide lobe, each seen from one of several views; with dω_l = 4 (v·h) dω_h the sum of weighted
//! differences of radiance is ∫|L̂ − L| dω_l. The same offsets serve every texel, by a Kronecker sequence, so that the fit has no
//! noise from one texel to the next.
//!
//! α² is the least α² of the facets and a broadening on top of it. It is found by steps downhill from the broadening that variance
//! asks for, and a parabola through the last three. The normal is free: the mode may be nearer than the mean. It leaves the mean only
//! where that is worth [`WORTH`], so that smooth maps keep their mean normals.
//!
//! Additions, multiplications, divisions and square roots only, in a fixed order: the same bits on every machine.

use multiversion::multiversion;

pub(super) const LANES: usize = 16;
pub(super) type Lanes = [f32; LANES];
/// A vector of [`LANES`] half vectors, views or lights.
type Vectors = [Lanes; 3];

/// Polar angles of the views that a highlight is fitted for, in radians.
const VIEW_ANGLES: [f64; 4] = [0.0, 0.5, 0.9, 1.2];
/// Part of the error that a normal other than the mean has to save, or a stretched lobe.
pub(super) const WORTH: f32 = 0.01;
/// Error of the mode at a first look, as a part of that of the mean, from which on it is looked at no further.
const HOPELESS: f32 = 1.1;
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

/// A facet of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Facet {
    pub lobe: Lobe,
    /// Its part of the surface; those of all facets add up to 1.
    pub weight: f32,
}

/// Where half vectors lie in a GGX lobe of α = 1 around +Z, and the view that each is seen from.
#[derive(Clone, Debug)]
pub(super) struct Offsets(Vec<Offset>);

#[derive(Clone, Copy, Debug, Default)]
struct Offset {
    slope: [Lanes; 2],
    /// (1 + r²)², r the length of the slope.
    rarity: Lanes,
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
            let polar = VIEW_ANGLES[k % VIEW_ANGLES.len()];
            let (view_sin, view_cos) = libm::sincos(angle * std::f64::consts::TAU + t * 2.399_963_229_728_653);
            let view = [libm::sin(polar) * view_cos, libm::sin(polar) * view_sin, libm::cos(polar)];
            let (block, lane) = (&mut blocks[k / LANES], k % LANES);
            (block.slope[0][lane], block.slope[1][lane]) = ((r * cos) as f32, (r * sin) as f32);
            block.rarity[lane] = ((1.0 + r * r) * (1.0 + r * r)) as f32;
            for c in 0..3 {
                block.view[c][lane] = view[c] as f32;
            }
        }
        Offsets(blocks)
    }
}

/// Half vectors with their views and lights, and what the facets show there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Samples {
    pub half: Vectors,
    pub view: Vectors,
    /// 2 (v·h): light is that times half less view.
    pub twice: Lanes,
    /// 4 (v·h), which makes half vectors lights, over the density of half vectors, up to a factor.
    pub weight: Lanes,
    /// 2π times radiance.
    pub exact: Lanes,
}

/// Samples against a normal.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    cos2: Lanes,
    view: Lanes,
    light: Lanes,
}

impl Samples {
    /// (n·h)², n·l where it is lit, n·v.
    #[inline(always)]
    fn against(&self, [x, y, z]: [f32; 3], k: usize) -> (f32, f32, f32) {
        let c = x * self.half[0][k] + y * self.half[1][k] + z * self.half[2][k];
        let cv = x * self.view[0][k] + y * self.view[1][k] + z * self.view[2][k];
        let cl = (self.twice[k] * c - cv).max(0.0);
        (c * c, if cv > 0.0 { cl } else { 0.0 }, cv.max(1e-3))
    }
}

/// Memory that fits share, so that a texel allocates none.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    pub samples: Vec<Samples>,
    pub terms: Vec<Terms>,
    seen: Vec<Seen>,
}

/// The lobe nearest to the facets, and its error as a part of what they show. `begin` has their mean normal and an α² to begin at; none of them has a lesser α² than
/// `least`.
pub(super) fn nearest(
    facets: &[Facet],
    begin: Lobe,
    least: f32,
    offsets: &Offsets,
    scratch: &mut Scratch,
) -> (Lobe, f32) {
    let a = begin.a2.sqrt();
    place(begin.normal, [[a, 0.0], [0.0, a]], offsets, &mut scratch.samples);
    shine(facets, &mut scratch.samples, &mut scratch.terms);
    let (samples, seen) = (&scratch.samples, &mut scratch.seen);
    see(begin.normal, samples, seen);
    let at_mean = narrowed(begin, least, samples, seen);
    let mut best = at_mean;
    let mode = mode(samples, seen);
    if mode[2] > LEAST_Z {
        let begin = Lobe { normal: mode, a2: least + 0.25 * (at_mean.0.a2 - least) };
        if error_of(begin, samples) < HOPELESS * best.1 {
            see(mode, samples, seen);
            let at_mode = narrowed(begin, least, samples, seen);
            if at_mode.1 < best.1 {
                best = at_mode;
            }
        }
    }
    best = moved(best, samples);
    see(best.0.normal, samples, seen);
    best = narrowed(best.0, least, samples, seen);
    let (lobe, error) = if best.1 < (1.0 - WORTH) * at_mean.1 { best } else { at_mean };
    (lobe, error / whole(samples))
}

/// What the facets show, up to the factor of errors.
pub(super) fn whole(samples: &[Samples]) -> f32 {
    let mut sums = [0.0_f32; LANES];
    for of in samples {
        for k in 0..LANES {
            sums[k] += of.weight[k] * of.exact[k];
        }
    }
    sums.iter().sum::<f32>().max(f32::MIN_POSITIVE)
}

/// Factor of the broadening from one step of the search to the next.
const STEP: f32 = std::f32::consts::SQRT_2;
/// Steps of the normal, in widths of the lobe.
const TILTS: [f32; 2] = [0.5, 0.2];

/// The lobe of this normal with the least error, and the error.
fn narrowed(begin: Lobe, least: f32, samples: &[Samples], seen: &[Seen]) -> (Lobe, f32) {
    let at = |broadening: f32| (least + broadening).min(1.0);
    let (broadening, found) = descend(begin.a2 - least, |broadening| error(at(broadening), samples, seen));
    (Lobe { a2: at(broadening), ..begin }, found)
}

/// The broadening of the least error, and the error: steps downhill until three of them hold the least one, then the vertex of the
/// parabola through these.
pub(super) fn descend(begin: f32, error: impl Fn(f32) -> f32) -> (f32, f32) {
    let mut broadening = begin;
    let mut found = error(broadening);
    // Errors a step above and a step below.
    let mut sides = [error(broadening * STEP), 0.0];
    if sides[0] < found {
        while sides[0] < found {
            broadening *= STEP;
            (sides[1], found) = (found, sides[0]);
            sides[0] = error(broadening * STEP);
        }
    } else {
        sides[1] = error(broadening / STEP);
        while sides[1] < found {
            broadening /= STEP;
            (sides[0], found) = (found, sides[1]);
            sides[1] = error(broadening / STEP);
        }
    }
    // √2 to the power of the vertex, by its series.
    let u = 0.346_573_6 * vertex(sides[1], found, sides[0]);
    let between = broadening * (1.0 + u * (1.0 + u * (0.5 + u * (1.0 / 6.0))));
    let at_vertex = error(between);
    if at_vertex < found { (between, at_vertex) } else { (broadening, found) }
}

/// Where the parabola through values at −1, 0 and 1 is least, from −1 to 1; 0 where it has no least value.
fn vertex(before: f32, here: f32, after: f32) -> f32 {
    let curvature = before - 2.0 * here + after;
    if curvature > 0.0 { (0.5 * (before - after) / curvature).clamp(-1.0, 1.0) } else { 0.0 }
}

/// The lobe moved downhill across its normal, in steps of its width: to the vertices of parabolas along two axes, or to the best of
/// the points that these were laid through.
fn moved((mut at, mut found): (Lobe, f32), samples: &[Samples]) -> (Lobe, f32) {
    for step in TILTS {
        let r = at.a2.sqrt() * step;
        let from = at.normal;
        let middle = found;
        let mut try_at = |p: f32, q: f32| {
            let normal = tilted(from, r * p, r * q);
            if normal[2] < LEAST_Z {
                return f32::MAX;
            }
            let next = error_of(Lobe { normal, ..at }, samples);
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

/// The half vector where the facets are densest: away from grazing light, D is near to four times radiance and n·v.
fn mode(samples: &[Samples], seen: &[Seen]) -> [f32; 3] {
    let (mut most, mut at) = (-1.0, [0.0, 0.0, 1.0]);
    for (block, seen) in samples.iter().zip(seen) {
        for lane in 0..LANES {
            let density = block.exact[lane] * seen.view[lane];
            if density > most {
                (most, at) = (density, block.half.map(|component| component[lane]));
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

/// Half vectors of a lobe, whose slopes around a normal are those of α = 1 times a matrix. Their density is D (h·n): with r the
/// slope of α = 1 and c = h·n, π D (h·n) is 1/(c³ (1 + r²)²) over the matrix's determinant.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+avx"))]
pub(super) fn place(normal: [f32; 3], matrix: [[f32; 2]; 2], offsets: &Offsets, samples: &mut Vec<Samples>) {
    samples.resize(offsets.0.len(), Samples::default());
    let [x, y, z] = normal;
    let [[xx, xy], [yx, yy]] = matrix;
    let s = 1.0 / (1.0 + z);
    for (out, offset) in samples.iter_mut().zip(&offsets.0) {
        let Offset { slope, rarity, view } = *offset;
        let mut block = Samples { view, ..Samples::default() };
        for k in 0..LANES {
            let (p, q) = (xx * slope[0][k] + xy * slope[1][k], yx * slope[0][k] + yy * slope[1][k]);
            let along = (p * x + q * y) * s;
            let c2 = 1.0 / (1.0 + p * p + q * q);
            let c = c2.sqrt();
            let (hx, hy, hz) = ((x + p - x * along) * c, (y + q - y * along) * c, (z - p * x - q * y) * c);
            let twice = 2.0 * (hx * view[0][k] + hy * view[1][k] + hz * view[2][k]);
            let weight = twice.max(0.0) * (rarity[k] * (c2 * c));
            // Lights below the surface are none.
            block.weight[k] = if twice * hz - view[2][k] > 0.0 { weight } else { 0.0 };
            block.half[0][k] = hx;
            block.half[1][k] = hy;
            block.half[2][k] = hz;
            block.twice[k] = twice;
        }
        *out = block;
    }
}

/// What the facets show.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+avx"))]
pub(super) fn shine(facets: &[Facet], samples: &mut [Samples], terms: &mut Vec<Terms>) {
    terms.clear();
    for facet in facets {
        terms.push(Terms::of(facet));
    }
    for block in samples {
        let mut exact = [0.0_f32; LANES];
        for facet in terms.iter() {
            for k in 0..LANES {
                exact[k] += facet.radiance(block.against(facet.normal, k));
            }
        }
        block.exact = exact;
    }
}

/// A facet, and what is the same of it for all half vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms {
    normal: [f32; 3],
    /// α² times the weight.
    power: f32,
    /// 1 − α².
    rest: f32,
    a: f32,
    /// 2 − 2α.
    both: f32,
}

impl Terms {
    #[inline(always)]
    fn of(Facet { lobe, weight }: &Facet) -> Terms {
        let a = lobe.a2.sqrt();
        Terms { normal: lobe.normal, power: lobe.a2 * weight, rest: 1.0 - lobe.a2, a, both: 2.0 - 2.0 * a }
    }

    /// 2π times radiance. Smith's masking is that of Hammon 2017, without square roots: V = ½ / (2 (1 − α) (n·l) (n·v) +
    /// α (n·l + n·v)).
    #[inline(always)]
    fn radiance(&self, (cos2, light, view): (f32, f32, f32)) -> f32 {
        let t = 1.0 - self.rest * cos2;
        let masking = self.both * (light * view) + self.a * (light + view);
        light * (self.power / (t * t * masking))
    }
}

/// Samples against a normal.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+avx"))]
fn see(normal: [f32; 3], samples: &[Samples], seen: &mut Vec<Seen>) {
    seen.resize(samples.len(), Seen::default());
    for (of, seen) in samples.iter().zip(seen) {
        for k in 0..LANES {
            (seen.cos2[k], seen.light[k], seen.view[k]) = of.against(normal, k);
        }
    }
}

/// L1 error of a lobe of this α² around the normal that was seen, up to a factor that is the same for all.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+avx"))]
fn error(a2: f32, samples: &[Samples], seen: &[Seen]) -> f32 {
    let terms = Terms::of(&Facet { lobe: Lobe { normal: [0.0; 3], a2 }, weight: 1.0 });
    let mut sums = [0.0_f32; LANES];
    for (of, seen) in samples.iter().zip(seen) {
        for k in 0..LANES {
            let radiance = terms.radiance((seen.cos2[k], seen.light[k], seen.view[k]));
            sums[k] += of.weight[k] * (radiance - of.exact[k]).abs();
        }
    }
    sums.iter().sum()
}

/// The same of a lobe around any normal.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+avx"))]
fn error_of(lobe: Lobe, samples: &[Samples]) -> f32 {
    let terms = Terms::of(&Facet { lobe, weight: 1.0 });
    let mut sums = [0.0_f32; LANES];
    for of in samples {
        for k in 0..LANES {
            sums[k] += of.weight[k] * (terms.radiance(of.against(lobe.normal, k)) - of.exact[k]).abs();
        }
    }
    sums.iter().sum()
}
