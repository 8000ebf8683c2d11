//! Principal moments and axes to twice the precision, and to four times.

mod finest;
mod principal;
mod vectors;

pub use finest::Finest;
pub use principal::RefinedPrincipal;
pub use vectors::Vector;
