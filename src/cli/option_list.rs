//! Options by the long names of their flags, with values as the flags take them: what provenance records and plans say.

use super::values::name_of;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display, Formatter};

/// Options in order.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OptionList(Vec<(String, String)>);

impl OptionList {
    /// Adds an option whose text is how it is typed.
    pub fn push(&mut self, flag: &str, value: impl ToString) {
        self.0.push((flag.to_owned(), value.to_string()));
    }

    /// Adds an option that is one of a few named values.
    pub fn push_choice(&mut self, flag: &str, value: &impl ValueEnum) {
        self.push(flag, name_of(value));
    }

    /// Adds all of another list.
    pub fn extend(&mut self, other: OptionList) {
        self.0.extend(other.0);
    }

    /// Names and values.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(flag, value)| (flag.as_str(), value.as_str()))
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Each option as it is typed.
    pub fn flags(&self) -> impl Iterator<Item = String> {
        self.iter().map(|(flag, value)| typed(flag, value))
    }

    /// Names and values, for provenance.
    pub fn into_pairs(self) -> Vec<(String, String)> {
        self.0
    }
}

impl Display for OptionList {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("as the project says");
        }
        f.write_str(&self.flags().collect::<Vec<_>>().join(" "))
    }
}

/// A flag as it is typed; without a value when that is empty.
pub fn typed(flag: &str, value: &str) -> String {
    if value.is_empty() { format!("--{flag}") } else { format!("--{flag}={value}") }
}
