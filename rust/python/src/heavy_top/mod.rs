//! The class `HeavyTop`: exact motions of heavy symmetric tops about a fixed point.
//!
//! | file | what it knows |
//! |---|---|
//! | `top` | the class, its states at any time |
//! | `constants` | what stays constant |

mod constants;
mod top;

pub(crate) use top::PyHeavyTop;
