//! Plans for a scene: of every material, only what its footprints can see, in the fewest bytes that keep an error.
//!
//! Each material is baked with several options, as drafts of that very map, and each draft is measured against the
//! reference at the footprints of the scene. The cheapest one within the error is taken. When all of them together
//! exceed the byte budget, or an error cannot be met, the plan is the nearest that is possible, and says so.

mod choose;
mod drafts;
mod measure;
mod text;

pub use choose::{Chosen, PackDrafts, Plan};
pub use drafts::{Alternative, Planned, plan};
pub use measure::{Measured, measure};
