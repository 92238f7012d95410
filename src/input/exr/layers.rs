//! The layers of an EXR file: channels of one part whose names are the same up to the last dot.
//!
//! A layer is named by that prefix; in a file of several parts by the part's name and the prefix. Views (left and right eye)
//! are parts with a `view` attribute or, in one part, the last piece of a prefix that `multiView` lists.

use exr::meta::MetaData;
use std::collections::BTreeMap;

/// A channel of a layer.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    /// Index in the part.
    pub index: usize,
    /// Name after the last dot.
    pub name: String,
    /// What it is by its name.
    pub role: Role,
}

/// What a channel is by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    Red,
    Green,
    Blue,
    Alpha,
    X,
    Y,
    Z,
    /// RY or BY: chroma beside the luminance Y.
    Chroma,
    /// A height by name.
    Height,
    Other,
}

impl Role {
    fn of(name: &str) -> Role {
        match name.to_ascii_lowercase().as_str() {
            "r" | "red" => Role::Red,
            "g" | "green" => Role::Green,
            "b" | "blue" => Role::Blue,
            "a" | "alpha" => Role::Alpha,
            "x" => Role::X,
            "y" => Role::Y,
            "z" => Role::Z,
            "ry" | "by" => Role::Chroma,
            "height" | "h" | "displacement" | "disp" | "bump" => Role::Height,
            _ => Role::Other,
        }
    }
}

/// A layer.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    /// The part that it is of.
    pub part: usize,
    /// How `--layer` names it; empty for the unnamed one.
    pub name: String,
    /// The name without part of a view, which tells what the layer holds.
    pub meaning: String,
    /// The view that it is of.
    pub view: Option<String>,
    /// Its channels, colours and coordinates in their usual order.
    pub channels: Vec<Channel>,
}

impl Layer {
    /// The channel of a role.
    pub fn find(&self, role: Role) -> Option<usize> {
        self.channels.iter().find(|channel| channel.role == role).map(|channel| channel.index)
    }

    /// The channels of some roles, when all are there.
    pub fn all<const N: usize>(&self, roles: [Role; N]) -> Option<[usize; N]> {
        let found = roles.map(|role| self.find(role));
        found.iter().all(Option::is_some).then(|| found.map(Option::unwrap_or_default))
    }

    /// The only channel but for alpha.
    pub fn only(&self) -> Option<usize> {
        let mut channels = self.channels.iter().filter(|channel| channel.role != Role::Alpha);
        let first = channels.next()?;
        channels.next().is_none().then_some(first.index)
    }

    /// The layer in a sentence.
    pub fn title(&self) -> String {
        let view = self.view.as_ref().filter(|view| !self.name.contains(view.as_str()));
        let view = view.map(|view| format!(" of view {view}")).unwrap_or_default();
        if self.name.is_empty() { format!("the unnamed layer{view}") } else { format!("layer {}{view}", self.name) }
    }

    /// Names of some of its channels.
    pub fn names(&self, of: &[usize]) -> String {
        let name = |index: &usize| self.channels.iter().find(|channel| channel.index == *index);
        of.iter().filter_map(name).map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// The layer and its channels.
    pub fn listed(&self) -> String {
        let channels: Vec<_> = self.channels.iter().map(|channel| channel.name.as_str()).collect();
        let title = self.title();
        format!("{} ({})", title.strip_prefix("layer ").unwrap_or(&title), channels.join(", "))
    }
}

/// All layers, by part, the unnamed one of a part first.
pub(super) fn layers(meta: &MetaData) -> Vec<Layer> {
    let several = meta.headers.len() > 1;
    let mut layers = Vec::new();
    for (part, header) in meta.headers.iter().enumerate() {
        let attributes = &header.own_attributes;
        let part_name = attributes.layer_name.as_ref().filter(|_| several).map(ToString::to_string).unwrap_or_default();
        let part_view = attributes.view_name.as_ref().map(ToString::to_string);
        let views: Vec<String> = attributes.multi_view_names.iter().flatten().map(ToString::to_string).collect();
        let mut by_prefix: BTreeMap<String, Vec<Channel>> = BTreeMap::new();
        for (index, channel) in header.channels.list.iter().enumerate() {
            let full = channel.name.to_string();
            let (prefix, name) = full.rsplit_once('.').unwrap_or(("", &full));
            let channel = Channel { index, name: name.to_owned(), role: Role::of(name) };
            by_prefix.entry(prefix.to_owned()).or_default().push(channel);
        }
        for (prefix, mut channels) in by_prefix {
            channels.sort_by_key(|channel| channel.role);
            let name = joined(&part_name, &prefix);
            let (meaning, view) = match &part_view {
                Some(view) => (without_view(&name, view), Some(view.clone())),
                None => match views.iter().find(|view| ends_with_piece(&prefix, view)) {
                    Some(view) => (without_view(&name, view), Some(view.clone())),
                    None => (name.clone(), views.first().cloned()),
                },
            };
            layers.push(Layer { part, name, meaning, view, channels });
        }
    }
    layers
}

/// Names of part and prefix as one; many writers give both the same.
fn joined(part: &str, prefix: &str) -> String {
    match (part, prefix) {
        (part, "") => part.to_owned(),
        ("", prefix) => prefix.to_owned(),
        (part, prefix) if prefix == part || prefix.starts_with(&format!("{part}.")) => prefix.to_owned(),
        (part, prefix) => format!("{part}.{prefix}"),
    }
}

/// Whether the last piece of a dotted name is this.
fn ends_with_piece(name: &str, piece: &str) -> bool {
    name == piece || name.ends_with(&format!(".{piece}"))
}

/// A name without the view at its end.
fn without_view(name: &str, view: &str) -> String {
    match name.strip_suffix(view) {
        Some("") => String::new(),
        Some(rest) if rest.ends_with(['.', '_', '-']) => rest[..rest.len() - 1].to_owned(),
        _ => name.to_owned(),
    }
}
