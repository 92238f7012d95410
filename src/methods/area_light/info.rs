//! One area-light material, as numbers.

use crate::methods::contents::Item;
use crate::quantities::kib;
use glam::Vec2;
use glint_bake_core::area_light::baked::Maps;
use glint_bake_core::area_light::eval::fetch;
use glint_bake_core::area_light::sections;
use glint_formats::Pack;
use glint_formats::Wrap;
use glint_formats::area_light::{MeasuredError, NormalStorage};
use glint_formats::container::full_mip_count;
use serde::Serialize;
use std::fmt::Write;

/// One area-light material.
#[derive(Debug, Serialize)]
pub struct AreaLightInfo {
    /// Name in the pack.
    pub name: String,
    /// Width of the map in texels.
    pub width: u32,
    /// Height of the map in texels.
    pub height: u32,
    /// What lies beyond the edge: `repeat` or `clamp`.
    pub wrap: &'static str,
    /// Mips.
    pub mips: u32,
    /// GGX roughness α of the surface itself.
    pub base_roughness: f32,
    /// `f16` or `snorm8`.
    pub storage: &'static str,
    /// Whether roughness by direction is stored.
    pub anisotropic: bool,
    /// Bytes of normals and roughness once decompressed.
    pub map_bytes: u64,
    /// Bytes of the LTC tables once decompressed.
    pub table_bytes: u64,
    /// The whole map, as the last mip has it.
    pub top: WholeMap,
    /// Error as the bake measured it.
    pub measured: MeasuredError,
}

/// The normals of a whole map.
#[derive(Debug, Serialize)]
pub struct WholeMap {
    /// Length of the mean normal.
    pub length: f32,
    /// Meso roughness α.
    pub alpha: f32,
    /// The same along the direction in which normals vary most.
    pub alpha_major: f32,
    /// And across it.
    pub alpha_minor: f32,
}

impl AreaLightInfo {
    /// Describes every area-light material of a sound pack.
    pub fn all_of(pack: &Pack) -> Vec<AreaLightInfo> {
        sections::materials(pack).into_iter().filter_map(|name| AreaLightInfo::of(pack, name)).collect()
    }

    fn of(pack: &Pack, name: &str) -> Option<AreaLightInfo> {
        let material = sections::from_pack(pack, name).ok()?;
        let params = &material.params;
        let (width, height) = (params.width as f32, params.height as f32);
        let top = fetch(&Maps::new(&material), 0.5 * Vec2::new(width, height), 2.0 * width.max(height));
        Some(AreaLightInfo {
            name: name.to_owned(),
            width: params.width,
            height: params.height,
            wrap: match params.wrap {
                Wrap::Repeat => "repeat",
                Wrap::Clamp => "clamp",
            },
            mips: full_mip_count(params.width, params.height),
            base_roughness: params.base_roughness,
            storage: match params.storage {
                NormalStorage::F16 => "f16",
                NormalStorage::Snorm8 => "snorm8",
            },
            anisotropic: params.anisotropic,
            map_bytes: (material.normals.len() + material.roughness.len()) as u64,
            table_bytes: material.tables.to_bytes().len() as u64,
            top: WholeMap {
                length: top.length,
                alpha: top.alpha,
                alpha_major: top.by_direction.major,
                alpha_minor: top.by_direction.minor,
            },
            measured: params.measured,
        })
    }

    /// Size and error on one line.
    fn size_and_error(&self) -> String {
        let MeasuredError { normal_angle, roughness, table_mean } = self.measured;
        format!(
            "{} × {} texels, {} mips, {} and tables {}, normals within {normal_angle:.1e} rad, roughness within \
             {roughness:.1e}, LTC {:.1} % from GGX on average",
            self.width,
            self.height,
            self.mips,
            kib(self.map_bytes),
            kib(self.table_bytes),
            100.0 * table_mean
        )
    }
}

impl Item for AreaLightInfo {
    fn name(&self) -> &str {
        &self.name
    }

    fn accuracy_line(&self) -> Option<String> {
        Some(self.size_and_error())
    }

    fn to_text(&self) -> String {
        let mut out = String::new();
        let kind = if self.anisotropic { "anisotropic" } else { "isotropic" };
        // Writing to a string cannot fail.
        let _ = writeln!(out, "area light material \"{}\"", self.name);
        let _ =
            writeln!(out, "  map          {} × {} texels, {}, {} mips", self.width, self.height, self.wrap, self.mips);
        let _ = writeln!(out, "  roughness    base α {}, meso {kind}", self.base_roughness);
        let _ = writeln!(
            out,
            "  storage      {}, {} and tables {}",
            self.storage,
            kib(self.map_bytes),
            kib(self.table_bytes)
        );
        let top = &self.top;
        let _ = writeln!(
            out,
            "  whole map    mean normal {:.4} long, meso α {:.4} ({:.4} along, {:.4} across)",
            top.length, top.alpha, top.alpha_major, top.alpha_minor
        );
        let _ = writeln!(out, "  normals      {:.1e} rad at most from exact", self.measured.normal_angle);
        let _ = writeln!(out, "  meso α       {:.1e} at most from exact", self.measured.roughness);
        let _ = writeln!(out, "  LTC tables   {:.2} % from GGX on average", 100.0 * self.measured.table_mean);
        out
    }
}
