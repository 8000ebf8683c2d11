//! Work on all cores and in the widest lanes of the machine: limits for the whole process, progress, Ctrl-C.
//!
//! A job that takes longer than a millisecond is shared among threads. Bits of results depend neither on their number nor on the
//! width of the lanes.
//!
//! ```
//! use std::num::NonZeroUsize;
//! use std::ops::ControlFlow;
//! use std::time::Duration;
//! use polhode::parallel::{Halt, Level, Watch, fill_blocks, level, set_level, set_thread_limit, set_watch_interval, thread_count};
//!
//! set_thread_limit(NonZeroUsize::new(1));
//! assert_eq!(thread_count(), 1);
//! assert!(Level::best().is_available()); // the widest instruction set of this machine, which is taken
//! set_level(Level::Baseline);
//! assert_eq!(level(), Level::Baseline);
//!
//! // A watch gets the fraction done; here it ends the job at the first look.
//! set_watch_interval(Duration::ZERO);
//! let watch: &mut Watch<'_> = &mut |_| ControlFlow::Break(());
//! let squares = &mut [0; 100];
//! let stopped = fill_blocks(squares, 10, watch, |first, block| {
//!     for (i, square) in block.iter_mut().enumerate() {
//!         *square = (first + i).pow(2);
//!     }
//!     Ok::<(), polhode::Error>(())
//! });
//! assert_eq!(stopped, Err(Halt::Stopped));
//! ```

pub use crate::numerics::dispatch::{Level, level, set_level};
pub use crate::numerics::threads::{
    Halt, Watch, fill_blocks, set_thread_limit, set_watch_interval, thread_count,
};
