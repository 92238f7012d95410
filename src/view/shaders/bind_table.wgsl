// Tables as textures, as packs hold them: element `index` is at column index mod 1024 of row index / 1024.

fn bind_table_place(index: u32) -> vec2u {
    return vec2u(index & 1023u, index >> 10u);
}
