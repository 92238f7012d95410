//! How WGSL lays a struct out: for tests that hold a struct of Rust, which is copied into a buffer as it is, against it.

use crate::compose;

/// Offsets of the members of a struct, in their order, and its size; none where the files have no such struct.
///
/// # Panics
/// If `files` are no valid WGSL: they are constants of this workspace.
pub fn layout(files: &[&str], name: &str) -> Option<(Vec<(String, usize)>, usize)> {
    let module = naga::front::wgsl::parse_str(&compose(files)).unwrap_or_else(|error| panic!("{files:?}: {error}"));
    let (_, ty) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name))?;
    let naga::TypeInner::Struct { members, span } = &ty.inner else { return None };
    let offsets = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect();
    Some((offsets, *span as usize))
}

/// Asserts that a struct of Rust has the fields, offsets and size of one in WGSL, of files that are a whole program: `assert_layout!(["hash"], "GlintCellState",
/// CellState: a, b)`. All fields of both are named.
#[macro_export]
macro_rules! assert_layout {
    ($files:expr, $wgsl:literal, $rust:ty: $($field:ident),* $(,)?) => {
        let (members, size) = $crate::layout::layout(&$files, $wgsl).unwrap_or_else(|| panic!("there is no {}", $wgsl));
        let offsets = [$((stringify!($field).to_owned(), ::std::mem::offset_of!($rust, $field))),*];
        assert_eq!(members, offsets, "{}", $wgsl);
        assert_eq!(size, ::std::mem::size_of::<$rust>(), "{}", $wgsl);
    };
}
