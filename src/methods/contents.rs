//! What a pack holds of a method, as data: items with numbers, and the kinds of parameter sections.

use glint_formats::{FourCc, Pack, SectionEntry, params};
use serde::de::DeserializeOwned;
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::fmt::Debug;

/// A material, an environment, or whatever else a method puts into a pack. Its JSON is that of its fields.
pub trait Item: erased_serde::Serialize + Debug {
    /// Name in the pack.
    fn name(&self) -> &str;

    /// Size and error on one line, which a bake prints; none of what has neither.
    fn accuracy_line(&self) -> Option<String>;

    /// The part of the text report that is about this item, each line with its end.
    fn to_text(&self) -> String;
}

erased_serde::serialize_trait_object!(Item);

/// Items of one sort, under the name that they have in the JSON of glint-info.
#[derive(Debug)]
pub struct Field {
    /// Name of the field.
    pub name: &'static str,
    /// What the pack holds, in the order of its sections.
    pub items: Vec<Box<dyn Item>>,
}

impl Field {
    /// A field with what `find` finds in a pack; empty without one.
    pub fn new<T: Item + 'static>(name: &'static str, pack: Option<&Pack>, find: fn(&Pack) -> Vec<T>) -> Field {
        let items = pack.map_or(Vec::new(), find);
        Field { name, items: items.into_iter().map(|item| Box::new(item) as Box<dyn Item>).collect() }
    }
}

/// Fields of all methods, one after another; as JSON a field each.
#[derive(Debug)]
pub struct Contents(pub Vec<Field>);

impl Contents {
    /// All items, in order.
    pub fn items(&self) -> impl Iterator<Item = &dyn Item> {
        self.0.iter().flat_map(|field| field.items.iter().map(|item| &**item))
    }
}

impl Serialize for Contents {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for field in &self.0 {
            map.serialize_entry(field.name, &field.items)?;
        }
        map.end()
    }
}

/// The value of a parameter section. In JSON it is its fields, named as in docs/FORMAT.md.
pub type Parameters = Box<dyn erased_serde::Serialize>;

/// A kind of parameter section and how its payload is read.
pub struct ParameterKind {
    /// The kind.
    pub kind: FourCc,
    /// Its value; `None` when the payload is not one.
    pub decode: fn(&[u8]) -> Option<Parameters>,
}

impl ParameterKind {
    /// Sections of this kind that hold a `T`.
    pub const fn of<T: DeserializeOwned + Serialize + 'static>(kind: FourCc) -> ParameterKind {
        ParameterKind { kind, decode: |payload| Some(Box::new(params::decode::<T>(payload).ok()?)) }
    }
}

/// The values of all sections of a kind, each with its section, in the order of the pack.
pub fn decode_all<T: DeserializeOwned>(pack: &Pack, kind: FourCc) -> Vec<(&SectionEntry, T)> {
    let entries = pack.sections().iter().filter(|entry| entry.kind == kind);
    entries.filter_map(|entry| Some((entry, params::decode(&pack.payload(entry).ok()?).ok()?))).collect()
}
