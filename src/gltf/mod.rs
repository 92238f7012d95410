//! glTF 2.0 files whose materials are rewritten: the JSON stays as it is written, byte for byte, but for the values that change.
//!
//! [`container`] has the chunks of GLB, [`json`] where values stand in the text and how they are changed there, [`document`] the part
//! that says which images are whose, [`source`] the bytes of images, [`uri`] the names of files. The viewer reads geometry by a reader of its own.

pub mod container;
pub mod document;
pub mod fault;
pub mod json;
pub mod source;
pub mod uri;
