//! What a layer holds by its name, as renderers and painting programs name their layers.

/// What a layer holds by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The layer without a name.
    Unnamed,
    /// The whole picture.
    Beauty,
    /// Normals.
    Normals,
    /// Normals that are named as ones of another space than the tangent's, or of a filter.
    OtherNormals,
    /// Heights.
    Heights,
    /// Distances from the camera.
    Depth,
    /// Data that are neither light, normals nor heights.
    Data,
    /// Anything else: light of some kind, materials, names that say nothing.
    Other,
}

/// Names of the whole picture.
const BEAUTY: [&str; 18] = [
    "beauty",
    "combined",
    "composite",
    "rgba",
    "rgb",
    "color",
    "colour",
    "c",
    "ci",
    "final",
    "main",
    "image",
    "radiance",
    "hdr",
    "hdri",
    "default",
    "render",
    "master",
];
/// Names of normals, which may be ones of the tangent space.
const NORMALS: [&str; 19] = [
    "n",
    "nn",
    "normal",
    "normals",
    "nrm",
    "nrml",
    "nrmls",
    "norm",
    "nml",
    "nor",
    "normalmap",
    "normalsmap",
    "bumpnormal",
    "bumpnormals",
    "tangentnormal",
    "tangentnormals",
    "normaltangent",
    "tangentspacenormal",
    "tangentspacenormals",
];
/// Pieces of the names of other normals.
const NORMALS_PIECES: [&str; 1] = ["normal"];
const OTHER_NORMALS: [&str; 5] = ["ng", "ns", "wsn", "nworld", "ncamera"];
const HEIGHTS: [&str; 7] = ["height", "heights", "heightmap", "displacement", "disp", "bump", "elevation"];
const DEPTHS: [&str; 8] = ["z", "depth", "zdepth", "depthz", "mist", "zbuffer", "distance", "deep"];
const DATA: [&str; 34] = [
    "a",
    "alpha",
    "ao",
    "id",
    "ids",
    "p",
    "pos",
    "pref",
    "po",
    "uv",
    "uvs",
    "uvw",
    "st",
    "texcoord",
    "vector",
    "indexob",
    "indexma",
    "basecolor",
    "basecolour",
    "diffcol",
    "glosscol",
    "transcol",
    "subsurfacecol",
    "mask",
    "matte",
    "matid",
    "roughness",
    "metallic",
    "metalness",
    "coverage",
    "variance",
    "samples",
    "samplecount",
    "curvature",
];
/// Pieces that make any name one of data.
const DATA_PIECES: [&str; 15] = [
    "depth",
    "albedo",
    "occlusion",
    "crypto",
    "position",
    "velocity",
    "motion",
    "objectid",
    "materialid",
    "instanceid",
    "assetid",
    "primid",
    "texturecoord",
    "uvpass",
    "denoisingvariance",
];

impl Kind {
    /// The kind of a layer of this name; only what follows the last dot counts.
    pub fn of(name: &str) -> Kind {
        let last = name.rsplit('.').next().unwrap_or_default();
        let plain: String = last.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
        let stem = plain.trim_end_matches(|c: char| c.is_ascii_digit());
        let is = |names: &[&str]| names.contains(&stem) || names.contains(&plain.as_str());
        let has = |pieces: &[&str]| pieces.iter().any(|piece| plain.contains(piece));
        if name.is_empty() {
            Kind::Unnamed
        } else if is(&NORMALS) {
            Kind::Normals
        } else if is(&OTHER_NORMALS) || has(&NORMALS_PIECES) {
            Kind::OtherNormals
        } else if is(&HEIGHTS) {
            Kind::Heights
        } else if is(&DEPTHS) {
            Kind::Depth
        } else if is(&DATA) || has(&DATA_PIECES) {
            Kind::Data
        } else if is(&BEAUTY) {
            Kind::Beauty
        } else {
            Kind::Other
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_renderers_have_their_kind() {
        for (name, kind) in [
            ("", Kind::Unnamed),
            ("ViewLayer.Combined", Kind::Beauty),
            ("Composite.Combined", Kind::Beauty),
            ("rgba", Kind::Beauty),
            ("ViewLayer.Normal", Kind::Normals),
            ("N", Kind::Normals),
            ("VRayNormals", Kind::OtherNormals),
            ("nrm", Kind::Normals),
            ("Normal_01", Kind::Normals),
            ("worldNormal", Kind::OtherNormals),
            ("ViewLayer.Denoising Normal", Kind::OtherNormals),
            ("ViewLayer.Denoising Depth", Kind::Data),
            ("ViewLayer.Denoising Albedo", Kind::Data),
            ("ViewLayer.Depth", Kind::Depth),
            ("ViewLayer.CryptoObject00", Kind::Data),
            ("uCryptoAsset", Kind::Data),
            ("AO", Kind::Data),
            ("ViewLayer.DiffCol", Kind::Data),
            ("ViewLayer.IndexOB", Kind::Data),
            ("worldPosition", Kind::Data),
            ("motionvector", Kind::Data),
            ("displacement", Kind::Heights),
            ("diffuse", Kind::Other),
            ("ViewLayer.DiffDir", Kind::Other),
            ("specular", Kind::Other),
            ("ponder", Kind::Other),
        ] {
            assert_eq!(Kind::of(name), kind, "{name}");
        }
    }
}
