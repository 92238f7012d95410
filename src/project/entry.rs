//! Keys of a project file with their values and places.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A key with its value and its place in the file.
#[derive(Clone, Copy)]
pub struct Entry<'a> {
    /// The key.
    pub key: &'a str,
    /// The value.
    pub value: &'a DeValue<'a>,
    /// Byte at which the key begins.
    pub at: usize,
}

/// Keys of a table in the order of the file.
pub fn entries<'a>(table: &'a DeTable<'a>) -> Vec<Entry<'a>> {
    let entry = |(key, value): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
        let name: &'a std::borrow::Cow<'a, str> = key.get_ref();
        Entry { key: name.as_ref(), value: value.get_ref(), at: key.span().start }
    };
    let mut all: Vec<Entry<'a>> = table.iter().map(entry).collect();
    all.sort_by_key(|entry| entry.at);
    all
}

/// A finite number.
pub fn number(value: &DeValue<'_>) -> Option<f64> {
    let text = match value {
        DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
        DeValue::Float(number) => number.as_str(),
        _ => return None,
    };
    text.parse().ok().filter(|v: &f64| v.is_finite())
}
