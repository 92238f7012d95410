//! KTX2 and DDS files, read back by other people's readers: every format, every shape, every byte.

use glint_formats::export::blocks::Blocks;
use glint_formats::export::{Texture, dds, ktx2, texel};
use glint_formats::{Resource, vk_format};

/// Bytes without a pattern that a misplaced image could hide in: a linear congruential generator's high bits.
fn bytes(count: usize) -> Vec<u8> {
    let mut state = 0x9e37_79b9u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    (0..count).map(|_| next()).collect()
}

fn formats() -> Vec<u32> {
    (0..1000).filter(|&code| vk_format::texel_bytes(code).is_some()).collect()
}

/// (width, height, layers, faces, mips): plain, odd with all mips, one row, an array, a cube with a part of its mips,
/// an array of cubes.
const SHAPES: [(u32, u32, u32, u32, u32); 6] =
    [(4, 3, 1, 1, 1), (5, 3, 1, 1, 3), (7, 1, 1, 1, 3), (3, 2, 3, 1, 2), (8, 8, 1, 6, 2), (4, 4, 2, 6, 3)];

fn every_texture(check: impl Fn(&Texture, &[u8])) {
    for vk_format in formats() {
        for (width, height, layers, faces, mips) in SHAPES {
            let resource = Resource::Texture { vk_format, width, height, layers, faces, mips };
            let payload = bytes(resource.byte_len().unwrap().unwrap() as usize);
            check(&Texture::of(&resource).unwrap(), &payload);
        }
    }
}

#[test]
fn ktx2_files_hold_the_payload() {
    every_texture(|texture, payload| {
        let file = ktx2::write(texture, payload, &[("KTXwriter", "test"), ("KTXorientation", "rd")]).unwrap();
        let reader = ::ktx2::Reader::new(&file[..]).unwrap_or_else(|e| panic!("{texture:?}: {e}"));
        let header = reader.header();
        assert_eq!(header.format.map(|f| f.value()), Some(texture.vk_format));
        assert_eq!((header.pixel_width, header.pixel_height, header.pixel_depth), (texture.width, texture.height, 0));
        assert_eq!(header.layer_count, if texture.layers > 1 { texture.layers } else { 0 });
        assert_eq!((header.face_count, header.level_count), (texture.faces, texture.mips));
        assert_eq!(header.supercompression_scheme, None);
        let metadata: Vec<_> = reader.key_value_data().collect();
        assert_eq!(metadata, [("KTXorientation", &b"rd\0"[..]), ("KTXwriter", b"test\0")]);
        let read: Vec<u8> = reader.levels().flat_map(|level| level.data.to_vec()).collect();
        assert!(read == payload, "{texture:?}");
    });
}

#[test]
fn ktx2_levels_are_aligned_and_nothing_but_zeros_lies_between() {
    every_texture(|texture, payload| {
        let file = ktx2::write(texture, payload, &[("key", "odd"), ("a", "")]).unwrap();
        let word = |at: usize| u64::from_le_bytes(file[at..at + 8].try_into().unwrap()) as usize;
        let dword = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        let mut end = dword(56) + dword(60);
        assert_eq!((dword(48), dword(56)), (80 + 24 * texture.mips as usize, dword(48) + dword(52)));
        for mip in (0..texture.mips as usize).rev() {
            let (offset, len) = (word(80 + 24 * mip), word(88 + 24 * mip));
            assert_eq!((offset % texture.texel_bytes(), offset % 4, word(96 + 24 * mip)), (0, 0, len));
            assert!(offset >= end && offset - end < texture.texel_bytes().max(4), "{texture:?}");
            assert!(file[end..offset].iter().all(|&byte| byte == 0));
            end = offset + len;
        }
        assert_eq!(file.len(), end.next_multiple_of(texture.texel_bytes().max(4)));
        assert!(file[end..].iter().all(|&byte| byte == 0));
    });
}

/// The ktx2 crate derives a descriptor from the format by itself.
#[test]
fn ktx2_descriptors_are_those_of_another_library() {
    for vk_format in formats() {
        let resource = Resource::Texture { vk_format, width: 1, height: 1, layers: 1, faces: 1, mips: 1 };
        let texture = Texture::of(&resource).unwrap();
        let file = ktx2::write(&texture, &bytes(texture.texel_bytes()), &[]).unwrap();
        let reader = ::ktx2::Reader::new(&file[..]).unwrap();
        let found = reader.basic_dfd().unwrap();
        let (expected, type_size) = ::ktx2::dfd::Basic::from_format(reader.header().format.unwrap()).unwrap();
        assert_eq!(found.to_vec(), expected.to_vec(), "VkFormat {vk_format}: {found:?}, {expected:?}");
        assert_eq!(reader.header().type_size, type_size, "VkFormat {vk_format}");
    }
}

#[test]
fn dds_files_hold_the_payload() {
    every_texture(|texture, payload| {
        let file = dds::write(texture, payload).unwrap();
        let read = ddsfile::Dds::read(&file[..]).unwrap_or_else(|e| panic!("{texture:?}: {e}"));
        assert_eq!((read.get_width(), read.get_height()), (texture.width, texture.height));
        assert_eq!(read.get_num_mipmap_levels(), texture.mips);
        assert_eq!(read.get_num_array_layers(), texture.layers * texture.faces);
        assert_eq!(read.get_dxgi_format().unwrap() as u32, dds::dxgi_format(texture.vk_format).unwrap());
        assert_eq!(read.get_bits_per_pixel(), Some(8 * texture.texel_bytes() as u32), "{texture:?}");
        let header = read.header10.as_ref().unwrap();
        assert_eq!(header.misc_flag == ddsfile::MiscFlag::TEXTURECUBE, texture.faces == 6);
        // A layer's face comes with all its mips: put back in the order of the pack.
        let mut back = vec![0; payload.len()];
        for (image, (layer, face)) in
            (0..texture.layers).flat_map(|layer| (0..texture.faces).map(move |face| (layer, face))).enumerate()
        {
            let mut rest = read.get_data(image as u32).unwrap();
            for mip in 0..texture.mips {
                let range = texture.image(mip, layer, face).range;
                let (texels, after) = rest.split_at(range.len());
                back[range].copy_from_slice(texels);
                rest = after;
            }
            assert!(rest.is_empty(), "{texture:?}");
        }
        assert!(back == payload, "{texture:?}");
    });
}

/// Names of the same bytes in both worlds, so that no format is mapped to a neighbour's number.
#[test]
fn dxgi_formats_have_the_same_components() {
    for vk_format in formats() {
        let name = vk_format::name(vk_format).unwrap();
        let dxgi = format!("{:?}", ddsfile::DxgiFormat::try_from(dds::dxgi_format(vk_format).unwrap()).unwrap());
        let expected = match name {
            "B10G11R11_UFLOAT_PACK32" => "R11G11B10_Float".to_owned(),
            "E5B9G9R9_UFLOAT_PACK32" => "R9G9B9E5_SharedExp".to_owned(),
            plain => plain.replace("SFLOAT", "Float").replace("UNORM", "UNorm").replace("SNORM", "SNorm"),
        };
        assert_eq!(dxgi.to_lowercase(), expected.to_lowercase());
    }
}

/// Sizes that are no multiples of a block's have whole blocks at their edges.
#[test]
fn textures_in_blocks_are_read_by_others() {
    use ddsfile::DxgiFormat::{BC4_UNorm, BC5_UNorm, BC7_UNorm};
    for (blocks, dxgi) in Blocks::ALL.into_iter().zip([BC4_UNorm, BC5_UNorm, BC7_UNorm]) {
        for (size, counts) in [((8, 8), vec![4, 1, 1, 1]), ((13, 5), vec![8, 2, 1, 1]), ((1, 9), vec![3, 1, 1, 1])] {
            let texture = Texture::in_blocks(blocks, size, 4);
            let lengths: Vec<usize> = counts.iter().map(|count| count * blocks.bytes() as usize).collect();
            let payload = bytes(lengths.iter().sum());
            for file in [ktx2::write(&texture, &payload, &[]), ktx2::write_zstd(&texture, &payload, &[])] {
                let file = file.unwrap();
                let reader = ::ktx2::Reader::new(&file[..]).unwrap_or_else(|e| panic!("{texture:?}: {e}"));
                let header = reader.header();
                assert_eq!(header.format.map(|format| format.value()), Some(blocks.vk_format()));
                let found: Vec<usize> = reader.levels().map(|level| level.uncompressed_byte_length as usize).collect();
                assert_eq!(found, lengths, "{texture:?}");
                let (expected, type_size) = ::ktx2::dfd::Basic::from_format(header.format.unwrap()).unwrap();
                assert_eq!(reader.basic_dfd().unwrap().to_vec(), expected.to_vec(), "{blocks:?}");
                assert_eq!(header.type_size, type_size);
                if header.supercompression_scheme.is_none() {
                    assert!(reader.levels().flat_map(|level| level.data.to_vec()).eq(payload.iter().copied()));
                }
            }
            let file = dds::write(&texture, &payload).unwrap();
            let read = ddsfile::Dds::read(&file[..]).unwrap_or_else(|e| panic!("{texture:?}: {e}"));
            assert_eq!((read.get_dxgi_format(), read.get_num_mipmap_levels()), (Some(dxgi), 4));
            assert_eq!((read.get_width(), read.get_height()), size);
            assert_eq!((read.header.pitch, read.header.linear_size), (None, Some(lengths[0] as u32)));
            assert!(read.get_data(0).unwrap() == payload);
        }
    }
}

#[test]
fn formats_of_other_programs_are_refused() {
    let resource = Resource::Texture { vk_format: 131, width: 4, height: 4, layers: 1, faces: 1, mips: 1 };
    assert_eq!(Texture::of(&resource), None);
    assert_eq!((texel::layout(131), dds::dxgi_format(131)), (None, None));
}
