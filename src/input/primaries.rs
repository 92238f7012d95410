//! Colour primaries of an image, and the matrix that takes its linear RGB to Rec. 709 with white at D65.
//!
//! Primaries and white as CIE xy chromaticities give RGB → XYZ: the columns are the primaries' XYZ, scaled so that (1, 1, 1)
//! is the white. Whites that differ are adapted by the linear Bradford transform, as ICC profiles do it, so that grey stays
//! grey. SMPTE RP 177-1993, section 3; Lindbloom, *Chromatic Adaptation*.

use glam::{DMat3, DVec3};

/// xy chromaticities of an image's red, green, blue and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Primaries {
    pub red: [f64; 2],
    pub green: [f64; 2],
    pub blue: [f64; 2],
    pub white: [f64; 2],
}

const D65: [f64; 2] = [0.3127, 0.3290];
/// White of the ACES spaces.
const ACES_WHITE: [f64; 2] = [0.32168, 0.33767];

const EQUAL_ENERGY: [f64; 2] = [1.0 / 3.0, 1.0 / 3.0];

/// Two chromaticities count as equal up to this: files round them to 3 to 5 digits.
const SAME: f64 = 2e-3;

/// Spaces that have a name.
const NAMED: [(&str, Primaries); 7] = [
    ("Rec. 709", Primaries::REC_709),
    ("ACES AP0", Primaries { red: [0.7347, 0.2653], green: [0.0, 1.0], blue: [0.0001, -0.077], white: ACES_WHITE }),
    (
        "ACES AP1 (ACEScg)",
        Primaries { red: [0.713, 0.293], green: [0.165, 0.83], blue: [0.128, 0.044], white: ACES_WHITE },
    ),
    ("Display P3", Primaries { red: [0.68, 0.32], green: [0.265, 0.69], blue: [0.15, 0.06], white: D65 }),
    ("Rec. 2020", Primaries { red: [0.708, 0.292], green: [0.17, 0.797], blue: [0.131, 0.046], white: D65 }),
    ("CIE XYZ", Primaries::XYZ),
    (
        "Radiance's own primaries",
        Primaries { red: [0.64, 0.33], green: [0.29, 0.6], blue: [0.15, 0.06], white: EQUAL_ENERGY },
    ),
];

impl Primaries {
    /// Rec. 709 and sRGB.
    pub const REC_709: Primaries = Primaries { red: [0.64, 0.33], green: [0.3, 0.6], blue: [0.15, 0.06], white: D65 };

    /// CIE XYZ as if it were RGB: white is where X, Y and Z are equal.
    pub const XYZ: Primaries = Primaries { red: [1.0, 0.0], green: [0.0, 1.0], blue: [0.0, 0.0], white: EQUAL_ENERGY };

    /// Whether colours are those of Rec. 709 as they are.
    pub fn is_rec_709(&self) -> bool {
        self.same(&Primaries::REC_709)
    }

    /// The space's name, or its chromaticities.
    pub fn name(&self) -> String {
        let named = NAMED.iter().find(|(_, primaries)| self.same(primaries));
        named.map_or_else(
            || {
                let [[rx, ry], [gx, gy], [bx, by], [wx, wy]] = self.points();
                format!("red ({rx}, {ry}), green ({gx}, {gy}), blue ({bx}, {by}), white ({wx}, {wy})")
            },
            |(name, _)| (*name).to_owned(),
        )
    }

    /// Linear RGB of these primaries → linear RGB of Rec. 709. `None` when they span no colours: points that are not
    /// finite, on one line, or a white that they cannot make.
    pub fn to_rec_709(self) -> Option<DMat3> {
        let to_xyz = self.to_xyz()?;
        let adapted = adaptation(xyz(self.white), xyz(D65));
        let matrix = Primaries::REC_709.to_xyz()?.inverse() * adapted * to_xyz;
        matrix.is_finite().then_some(matrix)
    }

    /// Linear RGB → XYZ, white with Y = 1.
    fn to_xyz(self) -> Option<DMat3> {
        if !self.points().iter().flatten().all(|c| c.is_finite()) || self.white[1].abs() < 1e-6 {
            return None;
        }
        // Columns with x + y + z = 1: a primary of y = 0, as XYZ's own, has no Y to divide by.
        let column = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
        let columns = DMat3::from_cols(column(self.red), column(self.green), column(self.blue));
        if columns.determinant().abs() < 1e-6 {
            return None;
        }
        let scale = columns.inverse() * xyz(self.white);
        scale.cmpgt(DVec3::ZERO).all().then(|| columns * DMat3::from_diagonal(scale))
    }

    fn points(&self) -> [[f64; 2]; 4] {
        [self.red, self.green, self.blue, self.white]
    }

    fn same(&self, other: &Primaries) -> bool {
        self.points().iter().flatten().zip(other.points().iter().flatten()).all(|(a, b)| (a - b).abs() <= SAME)
    }
}

/// XYZ with Y = 1 of a chromaticity.
fn xyz([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

/// The linear Bradford transform from one white to another.
fn adaptation(from: DVec3, to: DVec3) -> DMat3 {
    let cones = DMat3::from_cols(
        DVec3::new(0.8951, -0.7502, 0.0389),
        DVec3::new(0.2664, 1.7135, -0.0685),
        DVec3::new(-0.1614, 0.0367, 1.0296),
    );
    let ratio = (cones * to) / (cones * from);
    cones.inverse() * DMat3::from_diagonal(ratio) * cones
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> Primaries {
        NAMED.iter().find(|(n, _)| n.starts_with(name)).unwrap().1
    }

    #[test]
    fn white_stays_white() {
        for (name, primaries) in NAMED {
            let white = primaries.to_rec_709().unwrap() * DVec3::ONE;
            assert!((white - DVec3::ONE).abs().max_element() < 1e-9, "{name}: {white}");
        }
    }

    /// Published matrices: ITU-R BT.2087-0 (Rec. 2020 → Rec. 709) and ACES' AP1 → Rec. 709 with Bradford.
    #[test]
    fn matrices_are_the_published_ones() {
        let rows_2020 = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
        let rows_ap1 = [[1.70505, -0.62179, -0.08326], [-0.13026, 1.14080, -0.01055], [-0.02400, -0.12897, 1.15297]];
        for (name, rows, most) in [("Rec. 2020", rows_2020, 1e-4), ("ACES AP1", rows_ap1, 1e-4)] {
            let matrix = named(name).to_rec_709().unwrap();
            for (i, row) in rows.iter().enumerate() {
                for (j, expected) in row.iter().enumerate() {
                    let found = matrix.col(j)[i];
                    assert!((found - expected).abs() < most, "{name} [{i}][{j}]: {found}, expected {expected}");
                }
            }
        }
    }

    #[test]
    fn points_that_span_nothing_have_no_matrix() {
        let line = Primaries { red: [0.1, 0.1], green: [0.2, 0.2], blue: [0.3, 0.3], ..Primaries::REC_709 };
        let nan = Primaries { white: [f64::NAN, 0.3], ..Primaries::REC_709 };
        let dark = Primaries { white: [0.3, 0.0], ..Primaries::REC_709 };
        let outside = Primaries { white: [0.9, 0.05], ..Primaries::REC_709 };
        for primaries in [line, nan, dark, outside] {
            assert_eq!(primaries.to_rec_709(), None, "{primaries:?}");
        }
    }

    #[test]
    fn spaces_are_named() {
        let rounded = Primaries { red: [0.6400, 0.3300], white: [0.3127, 0.3290], ..Primaries::REC_709 };
        assert!(rounded.is_rec_709());
        assert_eq!(named("ACES AP1").name(), "ACES AP1 (ACEScg)");
        assert!(Primaries { red: [0.6, 0.3], ..Primaries::REC_709 }.name().starts_with("red (0.6, 0.3)"));
    }
}
