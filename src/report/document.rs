//! What a report is made into: one Markdown page with its plots beside it.

use super::settings::Settings;
use super::table::Table;
use crate::cli::git_hash;
use crate::plot::Figure;

/// Whole-program optimisation of this build, for the timings.
const LTO: &str = match option_env!("CARGO_PROFILE_RELEASE_LTO") {
    Some(lto) => lto,
    None => "as in Cargo.toml",
};

/// A page and its plots.
pub struct Document {
    name: &'static str,
    text: String,
    plots: Vec<(String, String)>,
    headline: Option<String>,
}

impl Document {
    /// A page that begins with its title, the command that writes it, and the build that did.
    pub fn new(name: &'static str, title: &str, settings: &Settings) -> Document {
        let mut document = Document { name, text: format!("# {title}\n"), plots: Vec::new(), headline: None };
        document.paragraph(format!("Written by `{}`; do not edit. {}", settings.command(name), build()));
        if settings.quick {
            document.paragraph("A quick look with few samples: its numbers are no measurement.");
        }
        document
    }

    /// Adds a heading of a level from 2 on.
    pub fn heading(&mut self, level: usize, text: &str) {
        self.block(&format!("{} {text}\n", "#".repeat(level)));
    }

    /// Adds a paragraph or a list.
    pub fn paragraph(&mut self, text: impl AsRef<str>) {
        self.block(&format!("{}\n", text.as_ref().trim_end()));
    }

    /// Adds a table.
    pub fn table(&mut self, table: &Table) {
        self.block(table.text());
    }

    /// Adds a plot. Its file is named after the report, and after `part` where there are several.
    pub fn plot(&mut self, part: &str, caption: &str, figure: &Figure) {
        let file = match part {
            "" => format!("{}.svg", self.name),
            part => format!("{}-{part}.svg", self.name),
        };
        self.paragraph(format!("![{caption}]({file})"));
        self.plots.push((file, figure.to_svg()));
    }

    /// Adds the sentence that sums the report up, which the README may quote.
    pub fn headline(&mut self, text: &str) {
        self.paragraph(text);
        self.headline = Some(text.to_owned());
    }

    /// The headline, if the report has one.
    pub fn quoted(&self) -> Option<&str> {
        self.headline.as_deref()
    }

    /// Files by name: the plots, then the page.
    pub fn files(&self) -> impl Iterator<Item = (String, &str)> {
        let plots = self.plots.iter().map(|(file, svg)| (file.clone(), svg.as_str()));
        plots.chain([(format!("{}.md", self.name), self.text.as_str())])
    }

    fn block(&mut self, text: &str) {
        self.text.push('\n');
        self.text.push_str(text);
    }
}

/// The program that measured.
fn build() -> String {
    let commit = match git_hash() {
        "" => "of an unknown commit",
        hash => &format!("of commit {hash}"),
    };
    let profile = match cfg!(debug_assertions) {
        true => "development build, the library optimised".to_owned(),
        false => format!("release build, link-time optimisation {LTO}"),
    };
    format!("Version {} {commit}, {profile}.", env!("CARGO_PKG_VERSION"))
}
