//! What a WGSL file of the library declares, with the comments that stand above it: translation loses both files and comments.

use glint_bake_core::shaders::Shader;

/// Something that a file declares at its top level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Declared {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// The comment above it, a line an element, without `// `.
    pub comment: Vec<String>,
    /// The declaration in one line: of a function its signature, of a struct its name alone.
    pub text: String,
    /// Members of a struct with the comments above them.
    pub members: Vec<(String, Vec<String>)>,
}

/// What is declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A function.
    Function,
    /// A struct.
    Struct,
    /// A constant, be it one of the pipeline.
    Constant,
    /// A variable: a resource, or one of the invocation.
    Variable,
}

/// The declarations of a file in their order.
pub fn declared(shader: &Shader) -> Vec<Declared> {
    let mut found: Vec<Declared> = Vec::new();
    let mut comment = Vec::new();
    let mut lines = shader.source.lines();
    while let Some(line) = lines.next() {
        if let Some(text) = line.strip_prefix("//") {
            comment.push(text.trim_start().to_owned());
            continue;
        }
        if line.starts_with('@') && !line.contains(" var") {
            // An attribute of the function below.
            continue;
        }
        if let Some((kind, name)) = declaration(line) {
            let mut one = Declared {
                name,
                kind,
                comment: std::mem::take(&mut comment),
                text: line.to_owned(),
                members: Vec::new(),
            };
            match kind {
                Kind::Struct => one.members = members(&mut lines),
                Kind::Function => {
                    while !one.text.ends_with('{') {
                        let next =
                            lines.next().unwrap_or_else(|| panic!("{} has no body in {}", one.name, shader.name));
                        let open = one.text.ends_with('(');
                        one.text = format!("{}{}{}", one.text, if open { "" } else { " " }, next.trim());
                    }
                    one.text = one.text.trim_end_matches('{').trim_end().replace(", )", ")");
                }
                Kind::Constant | Kind::Variable => {}
            }
            found.push(one);
        }
        comment.clear();
    }
    found
}

/// Kind and name of what a line at the top level declares.
fn declaration(line: &str) -> Option<(Kind, String)> {
    let (kind, rest) = if let Some(rest) = line.strip_prefix("fn ") {
        (Kind::Function, rest)
    } else if let Some(rest) = line.strip_prefix("struct ") {
        (Kind::Struct, rest)
    } else if let Some(rest) = line.strip_prefix("const ").or_else(|| line.strip_prefix("override ")) {
        (Kind::Constant, rest)
    } else if line.starts_with("var") {
        (Kind::Variable, line.split_once(' ')?.1)
    } else if line.starts_with("@group(") {
        let after = line.split_once(" var")?.1;
        // `var<storage, read> name`: past what is in angle brackets.
        (
            Kind::Variable,
            after.strip_prefix('<').map_or(after, |rest| rest.split_once('>').map_or(rest, |parts| parts.1)),
        )
    } else {
        return None;
    };
    let name = rest.trim_start().split(|c: char| !is_word(c)).next()?;
    Some((kind, name.to_owned()))
}

fn members<'a>(lines: &mut impl Iterator<Item = &'a str>) -> Vec<(String, Vec<String>)> {
    let (mut found, mut comment) = (Vec::new(), Vec::new());
    for line in lines.take_while(|line| *line != "}") {
        let line = line.trim();
        if let Some(text) = line.strip_prefix("//") {
            comment.push(text.trim_start().to_owned());
        } else if let Some((before, _)) = line.split_once(": ") {
            let name = before.rsplit(' ').next().unwrap_or(before);
            found.push((name.to_owned(), std::mem::take(&mut comment)));
        }
    }
    found
}

/// Whether a character may stand in a name.
pub fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// The first paragraph of a file: what it is.
pub fn head(shader: &Shader) -> Vec<&'static str> {
    shader
        .source
        .lines()
        .take_while(|line| line.starts_with("//"))
        .map(|line| line[2..].strip_prefix(' ').unwrap_or(""))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declarations_have_their_comments() {
        let source = "// The file.\n\n#import hash\n\n// A pixel.\nstruct P {\n    // Where.\n    @align(16) at: vec2f,\n    n: u32,\n}\n\n\
            // Section X.\n@group(1) @binding(0) var<storage, read> table: array<u32>;\nconst A: f32 = 1.0;\n\n// Adds.\nfn add(\n    \
            a: f32,\n    b: f32,\n) -> f32 {\n    // Inside.\n    return a + b;\n}\n\n// Starts.\n@compute @workgroup_size(64)\nfn main() {\n}\n";
        let found = declared(&Shader { name: "x", source });
        let names: Vec<(&str, Kind)> = found.iter().map(|one| (one.name.as_str(), one.kind)).collect();
        use Kind::{Constant, Function, Struct, Variable};
        assert_eq!(names, [("P", Struct), ("table", Variable), ("A", Constant), ("add", Function), ("main", Function)]);
        let comments: Vec<&str> =
            found.iter().map(|one| one.comment.first().map_or("", |line| line.as_str())).collect();
        assert_eq!(comments, ["A pixel.", "Section X.", "", "Adds.", "Starts."]);
        assert_eq!(found[0].members, [("at".to_owned(), vec!["Where.".to_owned()]), ("n".to_owned(), Vec::new())]);
        assert_eq!(found[3].text, "fn add(a: f32, b: f32) -> f32");
    }
}
