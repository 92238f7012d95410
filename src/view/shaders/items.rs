//! Text that naga has written, taken apart into what it declares.

use crate::declared::is_word;

/// One declaration, whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// Its name; empty for lines that declare nothing, such as those for the preprocessor.
    pub name: String,
    /// Whether it is a function.
    pub is_function: bool,
    /// Its lines, with line ends.
    pub text: String,
}

impl Item {
    /// The names that stand in it, its own among them.
    pub fn words(&self) -> impl Iterator<Item = &str> {
        self.text.split(|c: char| !is_word(c)).filter(|word| !word.is_empty())
    }

    /// A function up to its body, as a declaration.
    pub fn prototype(&self) -> String {
        let head = self.text.split_once('{').map_or(self.text.as_str(), |parts| parts.0);
        let lines: Vec<&str> = head.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        format!("{};\n", lines.join(" ").replace("( ", "(").replace(" )", ")"))
    }
}

/// The declarations of a text in their order.
pub fn items(text: &str) -> Vec<Item> {
    let mut found = Vec::new();
    let mut open = String::new();
    let mut depth = 0i32;
    for line in text.lines() {
        if open.is_empty() && (line.trim().is_empty() || line.starts_with("//")) {
            continue;
        }
        open.push_str(line);
        open.push('\n');
        depth += line.matches(['{', '(']).count() as i32 - line.matches(['}', ')']).count() as i32;
        let ends = line.starts_with('#') || line.ends_with(';') || line.ends_with('}');
        if depth == 0 && ends {
            found.push(item(std::mem::take(&mut open)));
        }
    }
    assert!(open.is_empty(), "naga's text ends within {open}");
    found
}

fn item(text: String) -> Item {
    let (name, is_function) = name(&text);
    Item { name, is_function, text }
}

/// Name of a declaration, and whether it is a function.
fn name(text: &str) -> (String, bool) {
    let last_word = |text: &str| text.trim_end().rsplit(|c: char| !is_word(c)).next().unwrap_or("").to_owned();
    let without_arrays = |text: &str| text.split('[').next().unwrap_or("").to_owned();
    // Attributes of a function stand on lines of their own.
    let start = text.find('\n').filter(|_| text.starts_with('[')).map_or(0, |end| end + 1);
    let text = &text[start..];
    let first = text.lines().next().unwrap_or("");
    if first.starts_with('#') || first.starts_with("using ") || first.starts_with("layout(local_size") {
        return (String::new(), false);
    }
    if let Some(rest) = first.strip_prefix("struct ").or_else(|| first.strip_prefix("cbuffer ")) {
        return (rest.split(|c: char| !is_word(c)).next().unwrap_or("").to_owned(), false);
    }
    if first.starts_with("layout(") {
        // `layout(...) uniform Block { Type name; };` and `layout(...) uniform sampler2D name;`
        let inside = first.rsplit('{').next().unwrap_or(first);
        return (last_word(&without_arrays(inside.split(';').next().unwrap_or(inside))), false);
    }
    // Of Metal's `metal::float4` the colons are no end.
    let first = first.replace("::", "_");
    let head = first.split(['=', '{', ';', ':']).next().unwrap_or(&first);
    match head.split_once('(') {
        Some((before, _)) => (last_word(before), true),
        None => (last_word(&without_arrays(head)), false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declarations_of_every_language_are_found() {
        let text = "#version 450 core\nlayout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;\nstruct A {\n    float b;\n};\n\
            static const float4 C[2] = { (0.0).xxxx, (1.0).xxxx };\nconst vec2 D = vec2(1.0, 2.0);\ncbuffer e : register(b0, space1) { A e; }\n\
            Texture2D<float4> f : register(t2, space1);\nlayout(binding = 0) uniform sampler2D g;\n\
            layout(std430, binding = 2) readonly buffer H_block { uint h[]; };\ntypedef metal::float4 i[1];\n\
            static bool j = false;\nfloat k(\n    float a,\n    float b\n) {\n    return a;\n}\n\n[numthreads(64, 1, 1)]\n\
            void main(uint3 id : SV_DispatchThreadID)\n{\n}\n";
        let found = items(text);
        let names: Vec<&str> = found.iter().map(|item| item.name.as_str()).collect();
        assert_eq!(names, ["", "", "A", "C", "D", "e", "f", "g", "h", "i", "j", "k", "main"]);
        let functions: Vec<&str> =
            found.iter().filter(|item| item.is_function).map(|item| item.name.as_str()).collect();
        assert_eq!(functions, ["k", "main"]);
        assert_eq!(found[11].prototype(), "float k(float a, float b);\n");
    }
}
