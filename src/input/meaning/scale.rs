//! Are stored values 0…1 or −1…1? Whole numbers are 0…1, as a shader reads them; floats are told from the data.

use crate::input::pixels::{Stored, Values};

/// The range that stored values stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scale {
    /// 0…1, decoded as 2v − 1.
    Unsigned,
    /// −1…1, used as they are.
    Signed,
}

impl Scale {
    /// A file that stores −1…1 has negative x or y, or else (all but flat) has them near 0 on average, where 0…1 has
    /// them near ½. Texels that are exactly 0 are no normals on either scale, and not asked.
    pub fn of(values: &Values, stored: &Stored, notes: &mut Vec<String>) -> Scale {
        if stored.bits.is_some() {
            return Scale::Unsigned;
        }
        let (mut texels, mut negative, mut sum) = (0u64, 0u64, 0.0f64);
        for [r, g, b, _] in values.texels().filter(|texel| texel[..3] != [0.0; 3]) {
            texels += 1;
            negative += u64::from(r.min(g) < -0.01 || b < -0.01);
            sum += f64::from(r) + f64::from(g);
        }
        let mean = sum / 2.0 / texels as f64;
        if negative as f64 > 0.001 * texels as f64 || mean < 0.25 {
            notes.push("float values are −1…1; used as they are".into());
            return Scale::Signed;
        }
        notes.push("float values are 0…1; decoded as 2v − 1".into());
        Scale::Unsigned
    }

    /// A stored value as a component of a vector.
    pub fn signed(self, v: f32) -> f32 {
        match self {
            Scale::Unsigned => 2.0 * v - 1.0,
            Scale::Signed => v,
        }
    }
}
