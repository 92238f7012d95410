//! Which channels are read: those of one layer of one part, by what is needed.
//!
//! Every set of channels that could be meant has a rank by its layer's name; the best is taken. Several that are equally
//! good are no choice: the layers are listed, and `--layer` chooses. Data of another meaning are never taken unasked.

use super::fault::Fault;
use super::layers::{Layer, Role, layers};
use super::names::Kind;
use exr::meta::MetaData;

/// What channels are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Need {
    /// Normals of three channels.
    Normals,
    /// The same, with alpha where it is there.
    NormalsAndAlpha,
    /// x and y of normals.
    TwoChannels,
    /// x and y of normals, one of them in alpha.
    WithAlpha,
    /// One channel of heights, or three that should be the same.
    Height,
    /// Three channels of radiance, or one.
    Radiance,
}

/// The channels to read.
#[derive(Debug)]
pub(super) struct Choice {
    pub part: usize,
    pub channels: Set,
}

/// Indices of channels in their part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Set {
    One([usize; 1]),
    Two([usize; 2]),
    Three([usize; 3]),
    Four([usize; 4]),
}

impl Set {
    fn as_slice(&self) -> &[usize] {
        match self {
            Set::One(one) => one,
            Set::Two(two) => two,
            Set::Three(three) => three,
            Set::Four(four) => four,
        }
    }
}

/// Channels of a layer that could be meant.
struct Candidate<'a> {
    layer: &'a Layer,
    channels: Set,
    /// How good; the smallest is best. None where only `--layer` can mean it.
    rank: Option<u8>,
}

const RGB: [Role; 3] = [Role::Red, Role::Green, Role::Blue];
const XYZ: [Role; 3] = [Role::X, Role::Y, Role::Z];

/// Chooses the channels; `asked` is the layer that `--layer` names.
pub(super) fn choose(
    meta: &MetaData,
    need: Need,
    asked: Option<&str>,
    notes: &mut Vec<String>,
) -> Result<Choice, Fault> {
    let layers = layers(meta);
    let looked_at: Vec<&Layer> = match asked {
        None => layers.iter().collect(),
        Some(name) => vec![named(&layers, name)?],
    };
    let is_only = layers.len() == 1;
    let mut candidates: Vec<Candidate<'_>> =
        looked_at.iter().flat_map(|layer| need.candidates(layer, is_only)).collect();
    if asked.is_none() {
        candidates.retain(|candidate| candidate.rank.is_some());
    }
    // Stable: channels of one layer stay in the order of preference.
    candidates.sort_by_key(|candidate| candidate.rank.unwrap_or(u8::MAX));
    let Some(best) = candidates.first() else { return Err(none(&looked_at, need, layers.len())) };
    if asked.is_none() {
        let rivals: Vec<_> = candidates.iter().filter(|other| other.rank == best.rank).collect();
        check_rivals(best, &rivals, &layers, need)?;
        notes.extend(taken(best, &layers));
    }
    if matches!(need, Need::Normals | Need::NormalsAndAlpha | Need::TwoChannels | Need::WithAlpha)
        && Kind::of(&best.layer.meaning) == Kind::OtherNormals
    {
        notes.push(format!(
            "{} may hold normals of the world's or the camera's space by its name; a map needs those of the tangent space",
            best.layer.title()
        ));
    }
    Ok(Choice { part: best.layer.part, channels: best.channels })
}

/// The layer of a name.
fn named<'a>(layers: &'a [Layer], name: &str) -> Result<&'a Layer, Fault> {
    let exact: Vec<_> = layers.iter().filter(|layer| layer.name == name).collect();
    let same = |layer: &&Layer| layer.name.to_lowercase() == name.to_lowercase();
    let found = if exact.is_empty() { layers.iter().filter(same).collect() } else { exact };
    match *found {
        [layer] => Ok(layer),
        [] => Err(Fault::Bad(format!("--layer: there is no layer {name:?}; the file has {}", list(layers)))),
        _ => Err(Fault::Bad(format!(
            "--layer: several layers are called {name:?}; rename them. The file has {}",
            list(layers)
        ))),
    }
}

/// Several layers that are equally good are refused, unless they are views of one.
fn check_rivals(best: &Candidate<'_>, rivals: &[&Candidate<'_>], layers: &[Layer], need: Need) -> Result<(), Fault> {
    let elsewhere =
        |rival: &&&Candidate<'_>| rival.layer.name != best.layer.name || rival.layer.part != best.layer.part;
    let views = |rival: &&Candidate<'_>| {
        rival.layer.meaning == best.layer.meaning && rival.layer.view.is_some() && rival.layer.view != best.layer.view
    };
    let others: Vec<_> = rivals.iter().filter(elsewhere).collect();
    if others.iter().all(|rival| views(rival)) {
        return Ok(());
    }
    Err(Fault::Bad(format!(
        "several layers could hold {}: {}; choose one with --layer NAME. The file has {}",
        need.what(),
        rivals.iter().map(|rival| rival.layer.title()).collect::<Vec<_>>().join(", "),
        list(layers)
    )))
}

/// A note of what was taken, when there is more.
fn taken(best: &Candidate<'_>, layers: &[Layer]) -> Option<String> {
    let layer = best.layer;
    let names = layer.names(best.channels.as_slice());
    let left: Vec<usize> = layer
        .channels
        .iter()
        .filter(|channel| channel.role != Role::Alpha && !best.channels.as_slice().contains(&channel.index))
        .map(|channel| channel.index)
        .collect();
    if layers.len() > 1 {
        let others = layers.iter().filter(|other| (other.part, &other.name) != (layer.part, &layer.name));
        let (title, others) = (layer.title(), list(others));
        return Some(format!("reads {names} of {title}; the file also has {others}; --layer NAME chooses"));
    }
    (!left.is_empty()).then(|| format!("reads {names} and leaves out {}", layer.names(&left)))
}

/// Nothing fits.
fn none(layers: &[&Layer], need: Need, in_file: usize) -> Fault {
    if let Some(layer) = layers.iter().find(|layer| layer.find(Role::Chroma).is_some()) {
        return Fault::Unsupported(format!(
            "{} is luminance and chroma, which are not read; export it as RGB",
            layer.listed()
        ));
    }
    let choose = if layers.len() < in_file || in_file == 1 { "" } else { "; --layer NAME takes any of them" };
    Fault::Bad(format!("{}, found {}{choose}", need.expected(), list(layers.iter().copied())))
}

fn list<'a>(layers: impl IntoIterator<Item = &'a Layer>) -> String {
    layers.into_iter().map(Layer::listed).collect::<Vec<_>>().join("; ")
}

impl Need {
    fn what(self) -> &'static str {
        match self {
            Need::Normals | Need::NormalsAndAlpha | Need::TwoChannels | Need::WithAlpha => "the normals",
            Need::Height => "the heights",
            Need::Radiance => "the radiance",
        }
    }

    fn expected(self) -> &'static str {
        match self {
            Need::Normals | Need::NormalsAndAlpha => {
                "expected a layer of normals with channels R, G, B or X, Y, Z (two of them with --channels xy; for a \
                 height map give --height SCALE)"
            }
            Need::TwoChannels => "expected a layer of normals with channels R, G or X, Y",
            Need::WithAlpha => "expected a layer of normals with channels R, G, B, A for these --channels",
            Need::Height => "--height expects one channel, or one called Y, Z or height, or grey in R, G, B",
            Need::Radiance => "expected a layer of colours with channels R, G, B, or a single one",
        }
    }

    /// What could be meant of a layer, the likeliest first. `is_only`: the file has no other layer.
    fn candidates(self, layer: &Layer, is_only: bool) -> Vec<Candidate<'_>> {
        let kind = Kind::of(&layer.meaning);
        let found = match self {
            Need::Normals => normals(layer, kind, |layer, roles| layer.all(roles).map(Set::Three)),
            Need::NormalsAndAlpha => normals(layer, kind, |layer, roles| {
                let [x, y, z] = roles;
                let with_alpha = layer.all([x, y, z, Role::Alpha]).map(Set::Four);
                with_alpha.or_else(|| layer.all(roles).map(Set::Three))
            }),
            Need::TwoChannels => normals(layer, kind, |layer, [x, y, _]| layer.all([x, y]).map(Set::Two)),
            Need::WithAlpha => {
                normals(layer, kind, |layer, [x, y, z]| layer.all([x, y, z, Role::Alpha]).map(Set::Four))
            }
            Need::Height => heights(layer, kind, is_only),
            Need::Radiance => radiance(layer, kind, is_only),
        };
        let candidate = |(channels, rank)| Candidate { layer, channels, rank };
        found.into_iter().map(candidate).collect()
    }
}

type Found = Vec<(Set, Option<u8>)>;

/// Layers of normals come before a picture; bare X, Y, Z are normals too.
fn normals(layer: &Layer, kind: Kind, set: impl Fn(&Layer, [Role; 3]) -> Option<Set>) -> Found {
    let rank = |bare: u8| match kind {
        Kind::Normals => Some(0),
        Kind::OtherNormals => Some(1),
        Kind::Unnamed => Some(bare),
        Kind::Beauty | Kind::Other => Some(3),
        Kind::Heights | Kind::Depth | Kind::Data => None,
    };
    let sets = [(set(layer, XYZ), rank(0)), (set(layer, RGB), rank(2))];
    sets.into_iter().filter_map(|(channels, rank)| Some((channels?, rank))).collect()
}

/// A picture; one channel is grey when it is luminance, or all that there is.
fn radiance(layer: &Layer, kind: Kind, is_only: bool) -> Found {
    let rank = match kind {
        Kind::Unnamed => Some(0),
        Kind::Beauty => Some(1),
        Kind::Other => Some(2),
        Kind::Normals | Kind::OtherNormals | Kind::Heights | Kind::Depth | Kind::Data => None,
    };
    if let Some(rgb) = layer.all(RGB) {
        return vec![(Set::Three(rgb), rank)];
    }
    let Some(grey) = layer.only() else { return Vec::new() };
    let role = layer.channels.iter().find(|channel| channel.index == grey).map(|channel| (channel.role, &channel.name));
    let is_light = match role {
        Some((Role::Y, _)) => kind == Kind::Unnamed || kind == Kind::Beauty || is_only,
        Some((Role::Red | Role::Green | Role::Blue, _)) => is_only,
        Some((Role::Other, name)) => is_only && matches!(Kind::of(name), Kind::Beauty | Kind::Other),
        _ => false,
    };
    vec![(Set::One([grey]), rank.filter(|_| is_light).map(|_| 3))]
}

/// Layers and channels of heights by name, then luminance, depth, grey in three channels, and whatever is alone.
fn heights(layer: &Layer, kind: Kind, is_only: bool) -> Found {
    let is_vector = layer.find(Role::X).is_some();
    let scalar = |role| layer.find(role).filter(|_| !is_vector);
    let by_kind = |unnamed: u8, other: u8| match kind {
        Kind::Heights => Some(0),
        Kind::Unnamed => Some(unnamed),
        Kind::Beauty | Kind::Other => Some(other),
        Kind::Depth => Some(2),
        Kind::Normals | Kind::OtherNormals | Kind::Data => None,
    };
    let one = |channel: Option<usize>, rank| channel.map(|channel| (Set::One([channel]), rank));
    let sets = [
        one(layer.find(Role::Height), by_kind(0, 0)),
        one(scalar(Role::Y), by_kind(1, 4)),
        one(scalar(Role::Z), by_kind(2, 4)),
        layer.all(RGB).map(|rgb| (Set::Three(rgb), by_kind(3, 5).filter(|_| kind != Kind::Depth))),
        one(layer.only(), if is_only { Some(4) } else { by_kind(4, 5) }),
    ];
    sets.into_iter().flatten().collect()
}
