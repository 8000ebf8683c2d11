//! Threads for large stacks: scoped, so that nothing outlives the call, and without a global pool, which
//! would not survive `fork`.
//!
//! The work is cut into blocks that never depend on the number of threads, so neither do the bits of the
//! results. The calling thread starts on the blocks by itself; only a job that is not over after a
//! millisecond is shared with others, and from then on the calling thread serves `watch`: progress and Ctrl-C.

mod blocks;
mod crew;
mod halt;
mod settings;

pub(crate) use blocks::each_watched;
pub use blocks::fill_blocks;
pub(crate) use crew::locked;
pub use halt::{Halt, Watch};
pub use settings::{set_thread_limit, set_watch_interval, thread_count};
