//! The class `HeavyTop`: exact motions of heavy symmetric tops about a fixed point.
//!
//! | file | what it knows |
//! |---|---|
//! | `top` | the class, its states at any time |
//! | `constants` | what stays constant |
//! | `drawn` | pictures, which Python draws |

mod constants;
mod drawn;
mod top;

pub(crate) use top::PyHeavyTop;
