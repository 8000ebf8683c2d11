//! Euler angles: all twelve sequences, intrinsic and extrinsic (msl25), and their rates (msl26).
//!
//! | what | file |
//! |---|---|
//! | three axes to turn about, and their names | `sequence` |
//! | angles of an attitude, both ways | `angles` |
//! | their rates and the angular velocity, both ways | `rates` |

mod angles;
mod rates;
mod sequence;

pub use angles::SINGULAR;
pub use sequence::Sequence;
