//! Attributes that change what pixels mean: each is applied, noted or refused, by one rule for maps and environments.

use super::fault::Fault;
use super::header::File;
use crate::input::error::InputError;
use crate::input::primaries::Primaries;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, Chromaticities, EnvironmentMap, IntegerBounds};
use exr::meta::header::Header;
use glam::DMat3;
use glint_formats::Wrap;
use std::path::Path;

/// What the pixels are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Subject {
    /// Normals or heights, with what lies beyond the edge.
    Map(Wrap),
    /// Radiance of all directions.
    Environment,
}

/// Looks at the attributes of a part; gives the matrix to Rec. 709, when radiance needs one.
pub(super) fn check(
    path: &Path,
    file: &File<'_>,
    part: usize,
    subject: Subject,
    notes: &mut Vec<String>,
) -> Result<Option<DMat3>, InputError> {
    let header = &file.meta.headers[part];
    check_windows(header).and_then(|()| check_projection(header, subject, notes)).map_err(|fault| fault.of(path))?;
    let aspect = header.shared_attributes.pixel_aspect;
    if aspect != 1.0 {
        notes.push(format!("the header names a pixel aspect ratio of {aspect}; texels are taken as square"));
    }
    note_views(header, notes);
    // Attributes of the whole file may stand in its first header only.
    let colours = header.shared_attributes.chromaticities.or(file.meta.headers[0].shared_attributes.chromaticities);
    match subject {
        Subject::Map(wrap) => {
            note_wrap(header, wrap, notes);
            if let Some(name) = colours.map(primaries).filter(|p| !p.is_rec_709()).map(|p| p.name()) {
                notes.push(format!("the header names primaries of {name}; ignored, a map holds no colours"));
            }
            Ok(None)
        }
        Subject::Environment => {
            note_luminance(header, notes);
            to_rec_709(header, colours, notes).map_err(|fault| fault.of(path))
        }
    }
}

/// The whole picture must be there, where it belongs.
fn check_windows(header: &Header) -> Result<(), Fault> {
    let (data, display) = (header.data_window(), header.shared_attributes.display_window);
    if data == display {
        return Ok(());
    }
    Err(Fault::Unsupported(format!(
        "the data window {} is not the display window {}, so that the pixels are a part of a picture or shifted in it; \
         export it uncropped, with equal windows",
        window(data),
        window(display)
    )))
}

fn window(bounds: IntegerBounds) -> String {
    let (Vec2(left, top), Vec2(right, bottom)) = (bounds.position, bounds.max());
    format!("({left}, {top}) to ({right}, {bottom}) of {} × {}", bounds.size.0, bounds.size.1)
}

/// An environment must be a panorama; a map is none.
fn check_projection(header: &Header, subject: Subject, notes: &mut Vec<String>) -> Result<(), Fault> {
    match (header.own_attributes.environment_map, subject) {
        (Some(EnvironmentMap::Cube), _) => Err(Fault::Unsupported(
            "the picture is the faces of a cube (envmap attribute), which are not read; convert it to an equirectangular \
             (latitude-longitude) panorama"
                .into(),
        )),
        (Some(EnvironmentMap::LatitudeLongitude), Subject::Map(_)) => {
            notes.push("the header says that the picture is a panorama of an environment (envmap attribute)".into());
            Ok(())
        }
        _ => Ok(()),
    }
}

fn note_views(header: &Header, notes: &mut Vec<String>) {
    let attributes = &header.own_attributes;
    if let Some(view) = &attributes.view_name {
        notes.push(format!("the picture is the view {view} of several"));
    } else if let Some(views) = attributes.multi_view_names.as_ref().filter(|views| views.len() > 1) {
        let names: Vec<_> = views.iter().map(ToString::to_string).collect();
        notes.push(format!(
            "the picture has the views {}; layers without a view are of {}",
            names.join(", "),
            names[0]
        ));
    }
}

/// What a renderer says lies beyond the edge.
fn note_wrap(header: &Header, wrap: Wrap, notes: &mut Vec<String>) {
    let Some(modes) = header.own_attributes.wrap_mode_name.as_ref().map(ToString::to_string) else { return };
    let (typed, fits) = match wrap {
        Wrap::Repeat => ("repeat", ["periodic", "periodic,periodic", "repeat"]),
        Wrap::Clamp => ("clamp", ["clamp", "clamp,clamp", "black"]),
    };
    if !fits.contains(&modes.as_str()) {
        notes.push(format!("the header names the wrap modes {modes}; --wrap {typed} holds"));
    }
}

/// Scales and neutrals that are for viewing.
fn note_luminance(header: &Header, notes: &mut Vec<String>) {
    let attributes = &header.own_attributes;
    if let Some(white) = attributes.white_luminance {
        notes.push(format!(
            "the header names a luminance of {white} cd/m² for white; radiance is taken as it is stored"
        ));
    }
    if let Some(Vec2(x, y)) = attributes.adopted_neutral {
        notes.push(format!("the header names a neutral of ({x}, {y}); radiance is taken without balancing it"));
    }
}

/// The matrix for colours of other primaries.
fn to_rec_709(
    header: &Header,
    colours: Option<Chromaticities>,
    notes: &mut Vec<String>,
) -> Result<Option<DMat3>, Fault> {
    let Some(found) = colours.map(primaries) else {
        note_colour_space(header, notes);
        return Ok(None);
    };
    if found.is_rec_709() {
        return Ok(None);
    }
    let name = found.name();
    let Some(matrix) = found.to_rec_709() else {
        return Err(Fault::Bad(format!(
            "its chromaticities make no colours: {name}; expected three primaries around their white: correct the \
             attribute, or export it in Rec. 709"
        )));
    };
    notes.push(format!("colours have the primaries of {name}; converted to Rec. 709"));
    Ok(Some(matrix))
}

/// Other names of colour spaces, which writers give without chromaticities.
fn note_colour_space(header: &Header, notes: &mut Vec<String>) {
    const KEYS: [&str; 3] = ["colorInteropID", "oiio:ColorSpace", "acesImageContainerFlag"];
    const REC_709: [&str; 7] =
        ["lin_rec709", "lin_rec709_scene", "lin_srgb", "linear", "scene_linear", "lin_rec709_display", "unknown"];
    for (key, value) in header.own_attributes.other.iter().chain(&header.shared_attributes.other) {
        let key = key.to_string();
        if !KEYS.contains(&key.as_str()) {
            continue;
        }
        let said = match value {
            AttributeValue::Text(text) => text.to_string(),
            AttributeValue::I32(1) => "ACES2065-1".to_owned(),
            _ => continue,
        };
        if !REC_709.contains(&said.to_lowercase().as_str()) {
            notes.push(format!(
                "the header names the colour space {said} ({key}) but no chromaticities; taken as linear Rec. 709, which \
                 is not what it says"
            ));
        }
    }
}

fn primaries(of: Chromaticities) -> Primaries {
    // Through text, so that 0.64 stays 0.64 and does not gain the digits of a float.
    let digits = |value: f32| value.to_string().parse().unwrap_or(f64::from(value));
    let point = |Vec2(x, y): Vec2<f32>| [digits(x), digits(y)];
    Primaries { red: point(of.red), green: point(of.green), blue: point(of.blue), white: point(of.white) }
}
