//! Where the members of WGSL structs lie, for hosts that fill buffers.

use naga::TypeInner;

/// Members of a struct in their order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructLayout {
    /// Name and offset in bytes of each member.
    pub members: Vec<(String, u32)>,
    /// Bytes of the struct, its padding counted.
    pub size: u32,
}

/// Layout of the struct `name` of a program, given as WGSL.
///
/// # Errors
/// What naga finds wrong with the text, or that it has no such struct.
pub fn layout(source: &str, name: &str) -> Result<StructLayout, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let named = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let Some((_, naga::Type { inner: TypeInner::Struct { members, span }, .. })) = named else {
        return Err(format!("the program has no struct {name}"));
    };
    let members = members.iter().map(|member| (member.name.clone().unwrap_or_default(), member.offset)).collect();
    Ok(StructLayout { members, size: *span })
}

/// Fails unless a `#[repr(C)]` struct has the fields of a struct of a WGSL program at the same offsets, and its size:
/// `assert_same_layout!(source, "GlintLobesMap", MapUniform, width, height)`.
#[macro_export]
macro_rules! assert_same_layout {
    ($source:expr, $wgsl:literal, $rust:ty, $($field:ident),* $(,)?) => {
        let members = [$((stringify!($field).to_owned(), std::mem::offset_of!($rust, $field) as u32)),*].to_vec();
        let size = size_of::<$rust>() as u32;
        assert_eq!($crate::layout::layout($source, $wgsl).unwrap(), $crate::layout::StructLayout { members, size });
    };
}

#[cfg(test)]
mod tests {
    use super::layout;

    #[test]
    fn members_lie_where_wgsl_aligns_them() {
        let found =
            layout("struct S { a: f32, b: vec3f, c: vec2u } @group(0) @binding(0) var<uniform> s: S;", "S").unwrap();
        assert_eq!(found.members, [("a".to_owned(), 0), ("b".to_owned(), 16), ("c".to_owned(), 32)]);
        assert_eq!(found.size, 48);
        assert!(layout("struct S { a: f32 }", "T").unwrap_err().contains("no struct T"));
        assert!(layout("struct S {", "S").is_err());
    }
}
