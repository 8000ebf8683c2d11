//! How a body moves: energies, momenta, Euler's equations, attitude, integration.
//!
//! | theorem | file |
//! |---|---|
//! | attitude `R_NB` as a quaternion, its rate ½ q∘ω | [`attitude`] |
//! | Euler angles, all twelve sequences (msl25) | [`euler_angles`] |
//! | kinetic energy in three parts (mln25) | [`kinetic_energy`] |
//! | angular momentum in three parts | [`angular_momentum`] |
//! | Euler's equations, forward and inverse (mln27) | [`euler_equations`] |
//! | what acts on the body | [`loads`] |
//! | motion under a load at the times asked for | [`mod@simulate`] |
//! | the steppers | [`integrate`] |

pub mod angular_momentum;
pub mod attitude;
pub mod euler_angles;
pub mod euler_equations;
pub mod integrate;
pub mod kinetic_energy;
pub mod loads;
pub mod simulate;
