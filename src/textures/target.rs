//! Engines, and what they expect of a material's textures: which channel holds what, which way green points, how roughness is
//! stored.

use clap::ValueEnum;
use glint_bake_core::textures::Axes;

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
    /// x and y of the direction of anisotropy.
    Along,
    Up,
    Strength,
    One,
}

/// What an engine takes the axes of anisotropic highlights from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AxesArg {
    /// the surface, as the code of KHR_materials_anisotropy, three.js, Filament and Bevy do
    Surface,
    /// the normal that it shades with
    Normal,
}

impl AxesArg {
    /// As the bake names them.
    pub fn axes(self) -> Axes {
        match self {
            AxesArg::Surface => Axes::Surface,
            AxesArg::Normal => Axes::Normal,
        }
    }
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

    /// α of the roughness and strength of anisotropy that make these α along and across the direction; none where the engine's way is not
    /// known.
    pub fn anisotropic(self, along: f32, across: f32) -> Option<(f32, f32)> {
        match self {
            // α_t = α + (1 − α) strength², α_b = α.
            Target::Gltf | Target::Bevy if across < 1.0 => {
                Some((across, ((along - across).max(0.0) / (1.0 - across)).sqrt()))
            }
            Target::Gltf | Target::Bevy => Some((across, 0.0)),
            // α_t = α (1 + strength), α_b = α (1 − strength).
            Target::Filament => Some((0.5 * (along + across), (along - across).max(0.0) / (along + across))),
            Target::Unreal | Target::Unity | Target::Godot | Target::Generic => None,
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
