//! Tables of flags for docs/CLI.md, from the one definition of the flags.
//!
//! A page has its prose by hand, and a part for each command that begins with `<!-- flags of COMMAND -->` and ends with
//! `<!-- end of flags -->`. What lies between is written anew.

use crate::exit::{Exit, Failure};
use clap::builder::PossibleValue;
use clap::{Arg, ArgAction, Command};

/// Name of the page.
pub const FILE: &str = "CLI.md";
/// What a part begins and ends with.
const BEGIN: (&str, &str) = ("<!-- flags of ", " -->");
const END: &str = "<!-- end of flags -->";
/// Name of the part with the flags that all commands have, and the heading that they have in the help.
const ALL: &str = "all programs";
const COMMON: &str = "Common options";

/// The page with every part written anew; everything else stays as it is.
///
/// # Errors
/// Bad input, when a part has no end or is of a command that there is not.
pub fn renew(page: &str, programs: &[Command]) -> Result<String, Failure> {
    let bad = |what: String| Failure::new(Exit::BadInput, format!("{FILE}: {what}"));
    let mut out = String::new();
    let mut rest = page;
    while let Some(start) = rest.find(BEGIN.0) {
        let name_at = start + BEGIN.0.len();
        let name_end = rest[name_at..].find(BEGIN.1).ok_or_else(|| bad(format!("expected {BEGIN:?}")))? + name_at;
        let name = &rest[name_at..name_end];
        let body = name_end + BEGIN.1.len();
        let end =
            rest[body..].find(END).ok_or_else(|| bad(format!("expected {END} after the flags of {name}")))? + body;
        let tables = tables_of(name, programs).ok_or_else(|| bad(format!("there is no command {name}")))?;
        out.push_str(&rest[..body]);
        out.push('\n');
        out.push_str(&tables);
        rest = &rest[end..];
    }
    out.push_str(rest);
    Ok(out)
}

/// A page of nothing but the tables, a chapter a command.
pub fn page(programs: &[Command]) -> String {
    let mut chapters = Vec::new();
    for program in programs {
        let subcommands = program.get_subcommands().filter(|command| command.get_name() != "help");
        chapters.extend(subcommands.map(|command| format!("{} {}", program.get_name(), command.get_name())));
        chapters.push(program.get_name().to_owned());
    }
    chapters.push(ALL.to_owned());
    let chapter = |name: String| {
        let tables = tables_of(&name, programs).filter(|tables| !tables.is_empty())?;
        Some(format!("## {name}\n\n{}{name}{}\n{tables}{END}\n", BEGIN.0, BEGIN.1))
    };
    format!("# Flags\n\n{}", chapters.into_iter().filter_map(chapter).collect::<Vec<_>>().join("\n"))
}

/// The tables of a command: one a heading of its help, in that order.
fn tables_of(name: &str, programs: &[Command]) -> Option<String> {
    let mut args: Vec<&Arg> = if name == ALL {
        programs.first()?.get_arguments().filter(|arg| arg.get_help_heading() == Some(COMMON)).collect()
    } else {
        let mut parts = name.split(' ');
        let program = parts.next().and_then(|name| programs.iter().find(|program| program.get_name() == name))?;
        let command = parts.next().map_or(Some(program), |name| program.find_subcommand(name))?;
        command.get_arguments().filter(|arg| arg.get_help_heading() != Some(COMMON)).collect()
    };
    args.retain(|arg| !["help", "version"].contains(&arg.get_id().as_str()));
    let mut headings: Vec<Option<&str>> = Vec::new();
    for arg in &args {
        if !headings.contains(&arg.get_help_heading()) {
            headings.push(arg.get_help_heading());
        }
    }
    headings.sort_by_key(|heading| heading.is_some());
    let mut tables = Vec::new();
    for heading in headings {
        let title = match heading {
            Some(heading) if heading != COMMON => format!("{heading}:\n\n"),
            _ => String::new(),
        };
        let rows = args.iter().filter(|arg| arg.get_help_heading() == heading).map(|arg| row(arg));
        tables.push(format!("{title}| flag | meaning | default |\n| --- | --- | --- |\n{}", rows.collect::<String>()));
    }
    Some(tables.join("\n"))
}

/// A flag, or what a command takes without one, as a row.
fn row(arg: &Arg) -> String {
    let value =
        arg.get_value_names().unwrap_or_default().iter().map(|name| name.as_str()).collect::<Vec<_>>().join(" ");
    let many = matches!(arg.get_action(), ArgAction::Append) && arg.is_positional();
    let long = arg.get_long().map(|long| match takes_value(arg) {
        true => format!("`--{long} {value}`"),
        false => format!("`--{long}`"),
    });
    let short = arg.get_short().map(|short| format!("`-{short}`"));
    let name = match (short, long) {
        (Some(short), Some(long)) => format!("{short}, {long}"),
        (short, long) => short.or(long).unwrap_or_else(|| format!("`{value}{}`", if many { "…" } else { "" })),
    };
    let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    // The first paragraph of a help has no full stop.
    let paragraph = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").trim_end_matches('.').to_owned();
    let (first, rest) = help.split_once("\n\n").unwrap_or((&help, ""));
    let (first, default) = split_default(&paragraph(first));
    let rest = rest.split("\n\n").map(paragraph).filter(|text| !text.is_empty());
    let meaning = [first].into_iter().chain(rest).collect::<Vec<_>>().join(". ");
    let default = default.unwrap_or_else(|| {
        let values: Vec<_> = arg.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
        if arg.is_positional() || takes_value(arg) { values.join(",") } else { "off".to_owned() }
    });
    let meaning = format!("{}{}", code(&meaning), choices(arg));
    let cell = |text: &str| text.replace('|', "\\|");
    format!("| {} | {} | {} |\n", cell(&name), cell(&meaning), cell(&code(&default))).replace("|  |", "| |")
}

fn takes_value(arg: &Arg) -> bool {
    arg.get_action().takes_values()
}

/// A meaning and the default that it names as `[default: …]`.
fn split_default(help: &str) -> (String, Option<String>) {
    const MARK: &str = "[default: ";
    let Some(start) = help.find(MARK) else { return (help.to_owned(), None) };
    let Some(end) = help[start..].find(']') else { return (help.to_owned(), None) };
    let (before, after) = (help[..start].trim_end(), &help[start + end + 1..]);
    (format!("{before}{after}"), Some(help[start + MARK.len()..start + end].to_owned()))
}

/// The values that a flag chooses from, with what they mean.
fn choices(arg: &Arg) -> String {
    let values: Vec<PossibleValue> = arg.get_possible_values().into_iter().filter(|v| !v.is_hide_set()).collect();
    if values.is_empty() || arg.is_hide_possible_values_set() || !takes_value(arg) {
        return String::new();
    }
    let value = |value: &PossibleValue| match value.get_help() {
        Some(help) => format!("`{}`: {}", value.get_name(), code(&help.to_string())),
        None => format!("`{}`", value.get_name()),
    };
    let separator = if values.iter().any(|value| value.get_help().is_some()) { "; " } else { ", " };
    format!(". {}", values.iter().map(value).collect::<Vec<_>>().join(separator))
}

/// Text with every flag in it as code, with the value that follows it when that is one.
fn code(text: &str) -> String {
    let mut out: Vec<String> = Vec::new();
    for word in text.split(' ') {
        let bare = word.trim_end_matches([',', '.', ';', ':', ')']);
        let start = bare.find("--").filter(|start| bare[..*start].chars().all(|c| c == '('));
        out.push(match start {
            Some(start) if bare.len() > start + 2 => {
                format!("{}`{}`{}", &bare[..start], &bare[start..], &word[bare.len()..])
            }
            _ => word.to_owned(),
        });
    }
    out.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn programs() -> [Command; 1] {
        let many = Arg::new("maps").value_name("MAP").action(ArgAction::Append).help("Maps").required(true);
        let error =
            Arg::new("error").long("max-error").value_name("E").help("Error; fails the bake [default: by --preset]");
        let kind = Arg::new("kind").long("kind").short('k').help("Kind").value_parser(["a", "b"]).default_value("a");
        let loud = Arg::new("loud").long("loud").action(ArgAction::SetTrue).help("Or A|B").help_heading("Run");
        let loud = loud.long_help("Or A|B\n\nMore of\nit.");
        let common = Arg::new("quiet").long("quiet").action(ArgAction::SetTrue).help("Say less").help_heading(COMMON);
        let bake = Command::new("bake").args([many, error, loud, kind.value_name("KIND")]);
        [Command::new("glint").arg(common).subcommand(bake)]
    }

    const BAKE: &str = "| flag | meaning | default |\n| --- | --- | --- |\n| `MAP…` | Maps | |\n\
        | `--max-error E` | Error; fails the bake | by `--preset` |\n| `-k`, `--kind KIND` | Kind. `a`, `b` | a |\n\n\
        Run:\n\n| flag | meaning | default |\n| --- | --- | --- |\n| `--loud` | Or A\\|B. More of it | off |\n";

    #[test]
    fn a_part_is_written_anew_and_prose_stays() {
        let page = "# Page\n<!-- flags of glint bake -->\nold\n<!-- end of flags -->\nprose\n\
            <!-- flags of all programs --><!-- end of flags -->\n";
        let expected = format!(
            "# Page\n<!-- flags of glint bake -->\n{BAKE}<!-- end of flags -->\nprose\n<!-- flags of all programs -->\n\
             | flag | meaning | default |\n| --- | --- | --- |\n| `--quiet` | Say less | off |\n<!-- end of flags -->\n"
        );
        let renewed = renew(page, &programs()).unwrap();
        assert_eq!(renewed, expected);
        assert_eq!(renew(&renewed, &programs()).unwrap(), expected);
    }

    #[test]
    fn a_page_of_tables_renews_to_itself() {
        let page = page(&programs());
        assert!(
            page.contains(&format!("## glint bake\n\n<!-- flags of glint bake -->\n{BAKE}<!-- end of flags -->\n"))
        );
        assert_eq!(renew(&page, &programs()).unwrap(), page);
    }

    #[test]
    fn parts_that_are_not_what_they_should_be_are_named() {
        let problem = |page: &str| renew(page, &programs()).unwrap_err().message;
        assert!(problem("<!-- flags of glint brew --><!-- end of flags -->").contains("no command glint brew"));
        assert!(problem("<!-- flags of glint bake -->").contains("after the flags of glint bake"));
    }
}
