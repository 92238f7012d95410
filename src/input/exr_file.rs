//! OpenEXR through the exr crate: half or float channels named R, G, B or X, Y, Z.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::*;

use super::error::InputError;
use super::limits::check_size;
use super::options::{Channels, InputOptions};
use super::pixels::{Pixels, Stored, Values};

/// Fewest bytes a chunk takes in a file: its entry in the offset table, its position and its length.
const BYTES_PER_CHUNK: u64 = 16;

/// Decodes the first layer of an EXR file.
pub(super) fn decode(
    path: &std::path::Path,
    bytes: &[u8],
    options: &InputOptions,
) -> std::result::Result<Pixels, InputError> {
    let image = first_layer(path, bytes, options)?;
    let layer = &image.layer_data;
    let channels = &layer.channel_data.list;
    let (width, height) = (layer.size.width() as u32, layer.size.height() as u32);
    let values = if options.height.is_some() {
        Values::Grey(one_channel(path, channels)?)
    } else {
        Values::Rgb(three_channels(path, channels, options.channels.unwrap_or_default())?)
    };
    Ok(Pixels { width, height, values, stored: Stored::default() })
}

/// Decodes the first layer of an EXR file as linear RGB radiance; one channel is grey.
pub(super) fn decode_radiance(
    path: &std::path::Path,
    bytes: &[u8],
    options: &InputOptions,
) -> std::result::Result<(u32, u32, Vec<[f32; 3]>), InputError> {
    let image = first_layer(path, bytes, options)?;
    let layer = &image.layer_data;
    let channels = &layer.channel_data.list;
    let window = image.attributes.display_window.size;
    if window != layer.size {
        return Err(InputError::unsupported(
            path,
            format!(
                "the pixels are a part of {} × {} of an image of {} × {}; expected a whole panorama: export it uncropped",
                layer.size.width(),
                layer.size.height(),
                window.width(),
                window.height()
            ),
        ));
    }
    let find = |letter: &str| channels.iter().find(|c| short_name(c).eq_ignore_ascii_case(letter));
    let (red, green, blue) = match (find("R"), find("G"), find("B"), channels.as_slice()) {
        (Some(red), Some(green), Some(blue), _) => (red, green, blue),
        (None, None, None, [grey]) => (grey, grey, grey),
        _ => {
            return Err(InputError::bad(
                path,
                format!("expected channels R, G, B, or a single one, found {}", names(channels)),
            ));
        }
    };
    let values = |channel: &AnyChannel<FlatSamples>| channel.sample_data.values_as_f32().collect::<Vec<f32>>();
    let (red, green, blue) = (values(red), values(green), values(blue));
    let pixels = (0..red.len()).map(|i| [red[i], green[i], blue[i]]).collect();
    Ok((layer.size.width() as u32, layer.size.height() as u32, pixels))
}

/// Reads the first layer, whose channels have a value for every texel.
fn first_layer(
    path: &Path,
    bytes: &[u8],
    options: &InputOptions,
) -> std::result::Result<Image<Layer<AnyChannels<FlatSamples>>>, InputError> {
    check_header(path, bytes, options)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        // On other threads a panic of the decoder could not be caught: their pool ends the process.
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| from_exr(path, e))?;
    let channels = &image.layer_data.channel_data.list;
    if let Some(odd) = channels.iter().find(|c| c.sampling != Vec2(1, 1)) {
        return Err(InputError::unsupported(
            path,
            format!("channel {} is subsampled; expected one value a texel: export it unsubsampled", odd.name),
        ));
    }
    Ok(image)
}

/// Looks at the sizes that the header claims, before anything is allocated for them.
fn check_header(path: &Path, bytes: &[u8], options: &InputOptions) -> std::result::Result<(), InputError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| from_exr(path, e))?;
    for header in &meta.headers {
        let size = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        let texel = header.channels.list.iter().map(|c| c.sample_type.bytes_per_sample() as u64).sum();
        check_size(path, size, texel, options.max_memory)?;
        if header.chunk_count as u64 * BYTES_PER_CHUNK > bytes.len() as u64 {
            return Err(cut_off(path));
        }
    }
    Ok(())
}

/// Normals by channel name, whatever the layer is called: R, G, B or X, Y, Z.
fn three_channels(
    path: &Path,
    channels: &[AnyChannel<FlatSamples>],
    which: Channels,
) -> std::result::Result<Vec<[f32; 3]>, InputError> {
    let find = |letter: &str| channels.iter().find(|c| short_name(c).eq_ignore_ascii_case(letter));
    let found = [["R", "G", "B"], ["X", "Y", "Z"]].iter().find_map(|[x, y, z]| Some((find(x)?, find(y)?, find(z))));
    match (found, which) {
        (Some((x, y, Some(z))), Channels::Xyz) => Ok(x
            .sample_data
            .values_as_f32()
            .zip(y.sample_data.values_as_f32())
            .zip(z.sample_data.values_as_f32())
            .map(|((x, y), z)| [x, y, z])
            .collect()),
        (Some((x, y, _)), Channels::Xy | Channels::Yx) => {
            Ok(x.sample_data.values_as_f32().zip(y.sample_data.values_as_f32()).map(|(x, y)| [x, y, 0.0]).collect())
        }
        _ => Err(InputError::bad(
            path,
            format!(
                "expected channels R, G, B or X, Y, Z (two of them with --channels xy), found {}; for a height map give \
                 --height SCALE",
                names(channels)
            ),
        )),
    }
}

/// The only channel, or the one called Y (luminance), Z (depth) or height.
fn one_channel(path: &Path, channels: &[AnyChannel<FlatSamples>]) -> std::result::Result<Vec<f32>, InputError> {
    let named =
        |c: &&AnyChannel<FlatSamples>| ["y", "z", "height"].contains(&short_name(c).to_ascii_lowercase().as_str());
    let channel = match channels {
        [only] => Some(only),
        several => several.iter().find(named),
    };
    channel.map(|c| c.sample_data.values_as_f32().collect()).ok_or_else(|| {
        InputError::bad(
            path,
            format!("--height expects one channel, or one called Y, Z or height; found {}", names(channels)),
        )
    })
}

/// The name without its layer: "normal.X" is X.
fn short_name(channel: &AnyChannel<FlatSamples>) -> String {
    let name = channel.name.to_string();
    name.rsplit('.').next().unwrap_or_default().to_owned()
}

fn names(channels: &[AnyChannel<FlatSamples>]) -> String {
    channels.iter().map(|c| c.name.to_string()).collect::<Vec<_>>().join(", ")
}

fn cut_off(path: &Path) -> InputError {
    InputError::bad(path, "the file is cut off: it ends before the image does; copy or export it again")
}

fn from_exr(path: &Path, error: Error) -> InputError {
    match error {
        Error::NotSupported(what) => InputError::unsupported(path, format!("{what}; export it as scan lines with ZIP")),
        Error::Io(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => cut_off(path),
        other => InputError::bad(path, format!("the EXR is damaged: {other}; copy or export it again")),
    }
}
