//! Parameter sections as data. A new kind of parameters adds its row here, and glint-info and exports have its fields.

use glint_formats::{FourCc, Pack, area_light, dictionary, environment, lobes, ndf_maps, params, synthesis};
use serde::Serialize;

/// One row a kind of parameters: the kind, the name of its variant, the type of its value.
macro_rules! kinds {
    ($($kind:path => $name:ident($value:ty),)*) => {
        /// The value of a parameter section. In JSON it is its fields, named as in docs/FORMAT.md.
        #[derive(Debug, Serialize)]
        #[serde(untagged)]
        #[allow(missing_docs)] // The types say it.
        pub enum Value {
            $($name(Box<$value>),)*
        }

        impl Value {
            /// Decodes the payload of a kind; `None` when the kind is not known or the payload is not one.
            fn decode(kind: FourCc, payload: &[u8]) -> Option<Value> {
                $(if kind == $kind {
                    return params::decode(payload).ok().map(|value| Value::$name(Box::new(value)));
                })*
                None
            }
        }
    };
}

kinds! {
    ndf_maps::PARAMS => NdfMaps(ndf_maps::NdfMapsParams),
    ndf_maps::PLACEMENT => Placement(ndf_maps::PlacementParams),
    ndf_maps::LAYERS => Layers(ndf_maps::LayeredMaterial),
    dictionary::PARAMS => Dictionary(dictionary::DictionaryParams),
    environment::PARAMS => Environment(environment::EnvironmentParams),
    area_light::PARAMS => AreaLight(area_light::AreaLightParams),
    lobes::PARAMS => Lobes(lobes::LobesParams),
    synthesis::PARAMS => Synthesis(synthesis::SynthesisParams),
}

/// One parameter section.
#[derive(Debug, Serialize)]
pub struct ParametersInfo {
    /// What the section is.
    pub kind: FourCc,
    /// Name in the pack.
    pub name: String,
    /// Its value.
    pub value: Value,
}

impl ParametersInfo {
    /// Every parameter section of a sound pack whose kind is known, but for provenance, which stands by itself.
    pub fn all_of(pack: &Pack) -> Vec<ParametersInfo> {
        let decode = |entry: &glint_formats::SectionEntry| {
            let value = Value::decode(entry.kind, &pack.payload(entry).ok()?)?;
            Some(ParametersInfo { kind: entry.kind, name: entry.name.clone(), value })
        };
        pack.sections().iter().filter_map(decode).collect()
    }
}
