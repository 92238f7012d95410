//! Changes of a JSON text that leave the rest of it as it is written: order, spaces, how numbers are spelled.

use super::fault::Fault;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;
use std::ops::Range;

/// Where a value stands in the text, in bytes.
pub type Span = Range<usize>;

/// Keys and values of an object in their order.
struct Members<'a>(Vec<(String, &'a RawValue)>);

impl<'de: 'a, 'a> Deserialize<'de> for Members<'a> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Members<'a>, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Members<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Members<'de>, A::Error> {
                let mut all = Vec::new();
                while let Some(entry) = map.next_entry::<String, &'de RawValue>()? {
                    all.push(entry);
                }
                Ok(Members(all))
            }
        }
        from.deserialize_map(InOrder)
    }
}

/// The object or array that stands in `text` at a span.
#[derive(Clone, Copy)]
pub struct Text<'a>(pub &'a str);

impl Text<'_> {
    /// The whole text as a value.
    pub fn whole(&self) -> Span {
        0..self.0.len()
    }

    /// Keys and places of the values of an object.
    ///
    /// # Errors
    /// Bad, where there is no object.
    pub fn members(&self, at: &Span) -> Result<Vec<(String, Span)>, Fault> {
        let Members(all) = serde_json::from_str(&self.0[at.clone()]).map_err(|error| self.fault(&error))?;
        Ok(all.into_iter().map(|(key, value)| (key, self.span(value))).collect())
    }

    /// The place of an object's value, if there is one of this key.
    ///
    /// # Errors
    /// Bad, where there is no object.
    pub fn member(&self, at: &Span, key: &str) -> Result<Option<Span>, Fault> {
        Ok(self.members(at)?.into_iter().find(|(other, _)| other == key).map(|(_, span)| span))
    }

    /// Places of the elements of an array.
    ///
    /// # Errors
    /// Bad, where there is no array.
    pub fn elements(&self, at: &Span) -> Result<Vec<Span>, Fault> {
        let all: Vec<&RawValue> = serde_json::from_str(&self.0[at.clone()]).map_err(|error| self.fault(&error))?;
        Ok(all.into_iter().map(|value| self.span(value)).collect())
    }

    /// Elements of an array of the whole text; none where it has no such key.
    ///
    /// # Errors
    /// Bad, where there is no object, or no array in it.
    pub fn list(&self, key: &str) -> Result<Vec<Span>, Fault> {
        self.member(&self.whole(), key)?.map_or(Ok(Vec::new()), |span| self.elements(&span))
    }

    fn span(&self, value: &RawValue) -> Span {
        // A raw value is borrowed from the text.
        let start = value.get().as_ptr() as usize - self.0.as_ptr() as usize;
        start..start + value.get().len()
    }

    fn fault(&self, error: &serde_json::Error) -> Fault {
        Fault::bad(format!("its JSON is not that of glTF: {error}; export it anew"))
    }
}

/// Changes to make, all at places of the text as it was.
#[derive(Default)]
pub struct Edits {
    all: Vec<(Span, String)>,
}

impl Edits {
    /// Puts another value in place of one.
    pub fn replace(&mut self, at: Span, value: String) {
        self.all.push((at, value));
    }

    /// Gives members of an object these values; those that are not there yet come last. Once an object.
    ///
    /// # Errors
    /// Bad, where there is no object.
    pub fn set(&mut self, text: Text<'_>, at: &Span, values: &[(&str, String)]) -> Result<(), Fault> {
        let members = text.members(at)?;
        let mut new = Vec::new();
        for (key, value) in values {
            match members.iter().find(|(other, _)| other == key) {
                Some((_, span)) => self.replace(span.clone(), value.clone()),
                None => new.push(format!("\"{key}\":{value}")),
            }
        }
        self.insert(at, members.last().map(|(_, span)| span), &new);
        Ok(())
    }

    /// Adds elements to an array. Once an array.
    ///
    /// # Errors
    /// Bad, where there is no array.
    pub fn push(&mut self, text: Text<'_>, at: &Span, values: &[String]) -> Result<(), Fault> {
        let elements = text.elements(at)?;
        self.insert(at, elements.last(), values);
        Ok(())
    }

    fn insert(&mut self, at: &Span, last: Option<&Span>, new: &[String]) {
        if new.is_empty() {
            return;
        }
        match last {
            Some(last) => self.all.push((last.end..last.end, format!(",{}", new.join(",")))),
            None => self.all.push((at.start + 1..at.start + 1, new.join(","))),
        }
    }

    /// The text with all changes.
    pub fn apply(mut self, text: &str) -> String {
        // What is added after a value comes after a change of it; both begin at different bytes.
        self.all.sort_by_key(|(span, _)| (span.start, span.end));
        let mut out = String::with_capacity(text.len());
        let mut at = 0;
        for (span, value) in &self.all {
            out.push_str(&text[at..span.start]);
            out.push_str(value);
            at = span.end;
        }
        out.push_str(&text[at..]);
        out
    }
}

/// A text as a JSON string.
pub fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_changed_changes() {
        let text = "{ \"b\" : 1.50e0,\n \"a\":[ {\"x\" :1}, {} ] , \"c\":[ ]}\n";
        let t = Text(text);
        let mut edits = Edits::default();
        let list = t.list("a").unwrap();
        edits.set(t, &list[0], &[("x", "2".into()), ("y", "3".into()), ("z", "4".into())]).unwrap();
        edits.set(t, &list[1], &[("y", "5".into()), ("z", "6".into())]).unwrap();
        let places = ["a", "c"].map(|key| t.member(&t.whole(), key).unwrap().unwrap());
        edits.push(t, &places[0], &["7".into()]).unwrap();
        edits.push(t, &places[1], &["8".into(), "9".into()]).unwrap();
        edits.set(t, &t.whole(), &[("d", quoted("\"é"))]).unwrap();
        assert_eq!(
            edits.apply(text),
            "{ \"b\" : 1.50e0,\n \"a\":[ {\"x\" :2,\"y\":3,\"z\":4}, {\"y\":5,\"z\":6},7 ] , \"c\":[8,9 ],\"d\":\"\\\"é\"}\n"
        );
        assert_eq!(Edits::default().apply(text), text);
        assert!(t.elements(&list[0]).is_err() && t.members(&places[1]).is_err() && Text("[").list("a").is_err());
        assert_eq!(t.list("none").unwrap(), []);
    }
}
