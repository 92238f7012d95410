//! Where on the normal map a vertex lies: the set of uv that a material's textures name, and KHR_texture_transform.

use super::document::{Material, TextureInfo, TextureTransform};
use glam::{Affine2, Mat2, Vec2};

/// A set of uv and what is done to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// n of the attribute TEXCOORD_n.
    pub set: u32,
    transform: TextureTransform,
}

impl Place {
    /// The first set, as it is.
    pub const PLAIN: Place = Place {
        set: 0,
        transform: TextureTransform { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None },
    };

    fn of(texture: &TextureInfo) -> Place {
        let transform = texture.extensions.transform.unwrap_or_default();
        let set = transform.tex_coord.unwrap_or(texture.tex_coord);
        Place { set, transform: TextureTransform { tex_coord: None, ..transform } }
    }

    /// uv on the texture: scaled, then rotated counter-clockwise as one sees it (v is down), then moved.
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        let TextureTransform { offset, rotation, scale, .. } = self.transform;
        let (sin, cos) = rotation.sin_cos();
        let turn = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
        turn * (Vec2::from(scale) * uv) + Vec2::from(offset)
    }

    /// The same as a matrix.
    pub fn affine(&self) -> Affine2 {
        let [u, v] = [Vec2::X, Vec2::Y].map(|axis| self.apply(axis) - self.apply(Vec2::ZERO));
        Affine2::from_cols(u, v, self.apply(Vec2::ZERO))
    }

    /// Whether the directions of u and v on the surface change.
    pub fn turns(&self) -> bool {
        self.transform.rotation != 0.0 || self.transform.scale.iter().any(|&scale| scale < 0.0)
    }
}

/// What a material says about uv, and what the user should know of it.
///
/// The normal texture's place counts. Without one, uv are as they are; but uv that are stored as integers (`quantised`) have
/// no size of their own, only through the transforms of textures, so that of the other textures is taken where they agree.
pub(super) fn place(material: Option<&Material>, quantised: bool) -> (Place, Option<String>) {
    let Some(material) = material else { return (Place::PLAIN, None) };
    if let Some(texture) = &material.normal_texture {
        return (Place::of(texture), None);
    }
    let colour = &material.pbr_metallic_roughness;
    let others: Vec<Place> = [
        &colour.base_color_texture,
        &colour.metallic_roughness_texture,
        &material.occlusion_texture,
        &material.emissive_texture,
    ]
    .into_iter()
    .flatten()
    .map(Place::of)
    .collect();
    let Some(&first) = others.first() else { return (Place::PLAIN, None) };
    let name = match &material.name {
        Some(name) => format!("material '{name}'"),
        None => "a material without a name".to_owned(),
    };
    let agree = others.iter().all(|other| *other == first);
    if agree && first == Place::PLAIN {
        return (Place::PLAIN, None);
    }
    if agree && quantised {
        return (first, Some(format!("{name} has no normal texture: uv are those of its other textures")));
    }
    let note = format!("{name} has no normal texture: uv are TEXCOORD_0 as it is, not those of its other textures");
    (Place::PLAIN, Some(note))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(offset: [f32; 2], rotation: f32, scale: [f32; 2]) -> Place {
        Place { set: 0, transform: TextureTransform { offset, rotation, scale, tex_coord: None } }
    }

    /// The extension's own examples: the lower left quarter of the image turned, and v upside down.
    #[test]
    fn the_examples_of_the_extension() {
        let quarter = info([0.0, 1.0], std::f32::consts::FRAC_PI_2, [0.5, 0.5]);
        for (uv, expected) in [([0.0, 0.0], [0.0, 1.0]), ([1.0, 0.0], [0.0, 0.5]), ([0.0, 1.0], [0.5, 1.0])] {
            let found = quarter.apply(uv.into());
            assert!(found.distance(expected.into()) < 1e-6, "{uv:?}: {found}");
        }
        let flipped = info([0.0, 1.0], 0.0, [1.0, -1.0]);
        assert_eq!(flipped.apply(Vec2::new(0.25, 0.25)), Vec2::new(0.25, 0.75));
        assert!(quarter.turns() && flipped.turns() && !info([3.0, 4.0], 0.0, [16.0, 2.0]).turns());
    }

    /// Scale comes first, then the turn, then the offset: any other order gives another place.
    #[test]
    fn the_order_is_scale_turn_offset() {
        let found = info([10.0, 20.0], std::f32::consts::FRAC_PI_2, [2.0, 3.0]).apply(Vec2::new(1.0, 1.0));
        assert!(found.distance(Vec2::new(13.0, 18.0)) < 1e-5, "{found}");
    }

    #[test]
    fn the_normal_texture_counts_and_others_where_integers_have_no_size() {
        let of = |json: &str| serde_json::from_str::<Material>(json).unwrap();
        let scaled = r#"{"extensions":{"KHR_texture_transform":{"scale":[4,4]}}}"#;
        let normal = of(&format!(r#"{{"normalTexture":{scaled},"emissiveTexture":{{"texCoord":1}}}}"#));
        assert_eq!(place(Some(&normal), false), (info([0.0; 2], 0.0, [4.0; 2]), None));
        let colour = of(&format!(r#"{{"name":"Red","pbrMetallicRoughness":{{"baseColorTexture":{scaled}}}}}"#));
        let (found, note) = place(Some(&colour), false);
        assert!(found == Place::PLAIN && note.unwrap().contains("'Red'"));
        let (found, note) = place(Some(&colour), true);
        assert!(found == info([0.0; 2], 0.0, [4.0; 2]) && note.unwrap().contains("'Red'"));
        let both = of(&format!(r#"{{"emissiveTexture":{{}},"pbrMetallicRoughness":{{"baseColorTexture":{scaled}}}}}"#));
        let (found, note) = place(Some(&both), true);
        assert!(found == Place::PLAIN && note.unwrap().contains("without a name"));
        assert_eq!(place(Some(&of(r#"{"emissiveTexture":{}}"#)), true), (Place::PLAIN, None));
        let own = of(r#"{"normalTexture":{"texCoord":1,"extensions":{"KHR_texture_transform":{"texCoord":0}}}}"#);
        assert_eq!(place(Some(&own), false), (Place::PLAIN, None));
        let kept = of(r#"{"normalTexture":{"texCoord":1,"extensions":{"KHR_texture_transform":{"offset":[1,1]}}}}"#);
        assert_eq!(place(Some(&kept), false).0.set, 1);
        assert_eq!(place(None, true), (Place::PLAIN, None));
    }
}
