//! Bodies of more particles than fit into memory: chunk by chunk, on one machine or on many.
//!
//! | file | idea |
//! |---|---|
//! | `sums.rs` | particles as they come, and the body of all of them |
//! | `pieces.rs` | what was added between two numbers, and which pieces become one |
//! | `moments.rs` | what is kept of a chunk: moments in double-double, and how two of them merge |
//! | `bytes.rs` | an accumulator as bytes, to be stored or sent |
//!
//! Every particle has a number, its place in the whole. Whole blocks of 4096 are summed as they come and merged pairwise
//! like the digits of a binary counter; the particles of a block that is not complete yet are kept. So the result has the
//! same bits however the particles are cut into chunks and in whatever order the chunks come, and memory grows with the
//! logarithm of their number.

mod bytes;
mod moments;
mod pieces;
mod sums;

pub use sums::MassAccumulator;
