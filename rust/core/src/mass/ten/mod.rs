//! The ten numbers of a body, in numbers of any kind: so that what a body depends on can be followed through.
//!
//! | what | file |
//! |---|---|
//! | mass, centre and tensor, moved and put together | `numbers` |
//! | what a shape is made of when its lengths carry derivatives | `size` |

mod numbers;
mod size;

pub use numbers::{ELEMENTS, Ten, place};
pub use size::Size;
