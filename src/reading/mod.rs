//! How files are read that anyone may hand over: standard input and pipes once and within a limit, text without its byte
//! order mark, and by which name what was read is known.

mod name;
mod stream;
mod text;

pub use name::{file_name, recorded_name};
pub use stream::{ReadError, check_readable, check_regular, is_standard, is_stream, read, read_at_most};
pub use text::{MOST_TEXT, text};
