//! Transfer functions: from a stored value to a linear one, both 0…1.

use crate::srgb;

/// Samples of a curve that is kept as a table.
const SAMPLES: usize = 1024;

/// Curves closer than this everywhere are the same one; profiles keep their numbers to about a hundredth of that.
const SAME: f32 = 0.003;

/// How stored values are decoded.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Transfer {
    /// They are linear.
    Linear,
    /// The curve of sRGB.
    Srgb,
    /// `v ^ exponent`.
    Power(f32),
    /// Any other curve, sampled evenly.
    Table(Vec<f32>),
    /// A curve that could not be read, or that only a display undoes (PQ, HLG).
    Unknown,
}

impl Transfer {
    /// The curve that a function draws.
    pub fn of(curve: impl Fn(f32) -> f32) -> Transfer {
        let samples: Vec<f32> = (0..=SAMPLES).map(|i| curve(i as f32 / SAMPLES as f32)).collect();
        let is = |other: &Transfer| {
            let close = |(i, v): (usize, &f32)| (other.decode(i as f32 / SAMPLES as f32) - v).abs() < SAME;
            samples.iter().enumerate().all(close)
        };
        match [Transfer::Linear, Transfer::Srgb].into_iter().find(is) {
            Some(known) => known,
            None if samples.iter().all(|v| v.is_finite()) => Transfer::Table(samples),
            None => Transfer::Unknown,
        }
    }

    /// The linear value of a stored one; NaN stays NaN, and what is not known stays as it is.
    pub fn decode(&self, v: f32) -> f32 {
        match self {
            Transfer::Linear | Transfer::Unknown => v,
            Transfer::Srgb => srgb::decode(v),
            Transfer::Power(exponent) => v.max(0.0).powf(*exponent),
            Transfer::Table(_) if v.is_nan() => v,
            Transfer::Table(samples) => {
                let at = v.clamp(0.0, 1.0) * SAMPLES as f32;
                let below = (at as usize).min(SAMPLES - 1);
                let part = at - below as f32;
                samples[below] * (1.0 - part) + samples[below + 1] * part
            }
        }
    }

    /// By its number among the transfer characteristics of ITU-T H.273, which cICP chunks name.
    pub fn of_h273(number: u8) -> Transfer {
        match number {
            // BT.709, BT.601 and both depths of BT.2020 share their curve.
            1 | 6 | 14 | 15 => {
                Transfer::of(|v| if v < 0.081 { v / 4.5 } else { ((v + 0.099) / 1.099).powf(1.0 / 0.45) })
            }
            4 => Transfer::Power(2.2),
            5 => Transfer::Power(2.8),
            8 => Transfer::Linear,
            13 => Transfer::Srgb,
            _ => Transfer::Unknown,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_known_by_their_shape() {
        assert_eq!(Transfer::of(|v| v), Transfer::Linear);
        assert_eq!(Transfer::of(|v| Transfer::Srgb.decode(v)), Transfer::Srgb);
        assert_eq!(Transfer::of(|_| f32::NAN), Transfer::Unknown);
        let square = Transfer::of(|v| v * v);
        assert!(matches!(square, Transfer::Table(_)));
        for v in [0.0, 0.1, 0.5, 0.777, 1.0] {
            assert!((square.decode(v) - v * v).abs() < 1e-6, "{v}");
        }
    }

    #[test]
    fn srgb_has_its_values_and_numbers_of_h273_their_curves() {
        for (stored, linear) in [(0.0, 0.0), (0.04, 0.003096), (0.5, 0.214041), (1.0, 1.0)] {
            assert!((Transfer::Srgb.decode(stored) - linear).abs() < 1e-5, "{stored}");
        }
        assert_eq!(Transfer::of_h273(8), Transfer::Linear);
        assert_eq!(Transfer::of_h273(13), Transfer::Srgb);
        assert_eq!(Transfer::of_h273(16), Transfer::Unknown);
        assert!((Transfer::of_h273(1).decode(0.5) - 0.2599).abs() < 1e-3);
    }
}
