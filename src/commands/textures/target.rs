//! Engines, and what they expect of a material's textures: which channel holds what, which way green points, how roughness is
//! stored.

use clap::ValueEnum;

/// Engines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// glTF 2.0: occlusion, roughness, metallic in red, green, blue; +Y up
    Gltf,
    /// as glTF
    Filament,
    /// occlusion, roughness, metallic in red, green, blue; +Y down
    Unreal,
    /// HDRP's mask map: metallic, occlusion, detail, smoothness; +Y up
    Unity,
    /// ORM material: occlusion, roughness, metallic in red, green, blue; +Y up
    Godot,
    /// as glTF
    Bevy,
    /// a file for each of roughness, occlusion and metallic; +Y up
    Generic,
}

/// How roughness is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Stored {
    /// the square root of GGX's α, as all of these engines have it
    Perceptual,
    /// GGX's α
    Alpha,
    /// 1 − perceptual roughness: smoothness, glossiness
    Smoothness,
}

/// What a channel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    Roughness,
    Occlusion,
    Metallic,
    One,
}

impl Target {
    /// Whether green points down.
    pub fn green_down(self) -> bool {
        self == Target::Unreal
    }

    /// How roughness is stored.
    pub fn stored(self) -> Stored {
        match self {
            Target::Unity => Stored::Smoothness,
            _ => Stored::Perceptual,
        }
    }

    /// Files beside the normals: how their names end, and their channels.
    pub fn files(self) -> &'static [(&'static str, &'static [Channel])] {
        use Channel::{Metallic, Occlusion, One, Roughness};
        match self {
            Target::Gltf | Target::Filament | Target::Unreal | Target::Godot | Target::Bevy => {
                &[("orm", &[Occlusion, Roughness, Metallic, One])]
            }
            Target::Unity => &[("mask", &[Metallic, Occlusion, One, Roughness])],
            Target::Generic => &[("roughness", &[Roughness]), ("occlusion", &[Occlusion]), ("metallic", &[Metallic])],
        }
    }
}

impl Stored {
    /// A stored value of a GGX α.
    pub fn of_alpha(self, alpha: f32) -> f32 {
        match self {
            Stored::Perceptual => alpha.sqrt(),
            Stored::Alpha => alpha,
            Stored::Smoothness => 1.0 - alpha.sqrt(),
        }
    }
}
