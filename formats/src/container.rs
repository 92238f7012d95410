//! placeholder
/// Four bytes that name a section kind.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct FourCc(pub [u8; 4]);
