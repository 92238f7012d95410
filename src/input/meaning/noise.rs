//! What a lossy codec did to a map, told from the lengths that it left.
//!
//! The encoder's input had unit length (to ½ step of 8 bits); the codec adds an error e to each vector n. To first order
//! |n + e| = 1 + e·n, so that the lengths show the component of e along n, and nothing else is known of the original. The
//! codec rounds brightness and two differences of colour, which reach all three channels in like measure, so the two
//! components across n, which turn the normal, have about the deviation τ of the one along it. The slope is (x, y)/z: turned
//! by a small angle in the plane of the tilt it moves by 1/z² a radian, across it by 1/z. So slopes have noise of
//!
//!   σ = τ √⟨(1/z⁴ + 1/z²)/2⟩.
//!
//! Taken from a sample of the texels, it is right within a factor of two, as a test holds for maps of four kinds; detail that
//! the codec dropped altogether leaves no trace in the lengths, so that a nearly flat map of fine noise is told too little. Maps
//! that were filtered before they were compressed have scattered lengths too, and are told too much.
//!
//! Roughness hides noise that it is twice as wide as: √(1 + ¼) widens a lobe by an eighth.

/// z below which a slope is not followed any further: the horizon would outweigh all else.
const STEEPEST: f64 = 0.2;

/// Roughness that hides noise, in widths of the noise.
const HIDES: f64 = 2.0;

/// Standard deviation of slopes that a codec caused; None where there are no vectors.
pub(super) fn slope_noise(vectors: impl Iterator<Item = [f32; 3]>) -> Option<f64> {
    let (mut count, mut sum, mut squares, mut slopes) = (0.0, 0.0, 0.0, 0.0);
    for vector in vectors.filter(|vector| vector.iter().all(|c| c.is_finite())) {
        let [x, y, z] = vector.map(f64::from);
        let length = (x * x + y * y + z * z).sqrt();
        let z = (z / length).max(STEEPEST);
        count += 1.0;
        // About 1, so that the difference of squares keeps its digits.
        sum += length - 1.0;
        squares += (length - 1.0).powi(2);
        let square = 1.0 / (z * z);
        slopes += (square * square + square) / 2.0;
    }
    let variance: f64 = squares / count - (sum / count).powi(2);
    (count > 0.0).then(|| (variance.max(0.0) * slopes / count).sqrt())
}

/// Says what is known.
pub(super) fn note(codec: &str, two: bool, vectors: impl Iterator<Item = [f32; 3]>) -> String {
    let noise = if two { None } else { slope_noise(vectors) };
    match noise {
        Some(noise) => format!(
            "{codec} is lossy: lengths scatter as noise of about {noise:.3} in slope would make them; roughness below {:.3} \
             would show it",
            HIDES * noise
        ),
        None => format!("{codec} is lossy; two channels have no lengths that would show its noise"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::synthetic::MATERIALS;
    use image::codecs::jpeg::JpegEncoder;
    use image::{ImageFormat, RgbImage};

    fn vectors(image: &RgbImage) -> Vec<[f32; 3]> {
        image.pixels().map(|p| p.0.map(|v| v as f32 / 127.5 - 1.0)).collect()
    }

    fn true_noise(before: &[[f32; 3]], after: &[[f32; 3]]) -> f64 {
        let slope = |[x, y, z]: [f32; 3]| [f64::from(x / z), f64::from(y / z)];
        let pairs = before.iter().zip(after).map(|(&a, &b)| (slope(a), slope(b)));
        let square: f64 = pairs.map(|(a, b)| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sum();
        (square / 2.0 / before.len() as f64).sqrt()
    }

    #[test]
    fn estimate_is_within_a_factor_of_two() {
        for (name, material) in MATERIALS {
            let clean = material(256, 256, 1);
            for quality in [50, 75, 95] {
                let mut bytes = Vec::new();
                JpegEncoder::new_with_quality(&mut bytes, quality).encode_image(&clean).unwrap();
                let lossy = image::load_from_memory_with_format(&bytes, ImageFormat::Jpeg).unwrap().into_rgb8();
                let (before, after) = (vectors(&clean), vectors(&lossy));
                let (estimate, truth) = (slope_noise(after.iter().copied()).unwrap(), true_noise(&before, &after));
                println!("{name} at quality {quality}: noise {truth:.4}, estimated {estimate:.4}");
                assert!((0.5..=2.0).contains(&(estimate / truth)), "{name} {quality}: {estimate} for {truth}");
            }
        }
    }

    #[test]
    fn clean_maps_have_the_noise_of_rounding() {
        let clean = vectors(&MATERIALS[0].1(64, 64, 1));
        assert!(slope_noise(clean.into_iter()).unwrap() < 0.005);
        assert_eq!(slope_noise(std::iter::empty()), None);
    }
}
