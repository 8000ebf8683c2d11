//! How a body moves: energies, momenta, Euler's equations, attitude, integration.
//!
//! | theorem | file |
//! |---|---|
//! | velocity and acceleration of any point, rates in moving frames (mln24, mln27) | [`kinematics`] |
//! | attitude `R_NB` as a quaternion, its rate ½ q∘ω | [`attitude`] |
//! | rates along the rows of a record, and what they integrate to (msl26) | [`rates`] |
//! | Euler angles, all twelve sequences, and their rates (msl25, msl26) | [`euler_angles`] |
//! | kinetic energy in three parts (mln25) | [`kinetic_energy`] |
//! | angular momentum in three parts | [`angular_momentum`] |
//! | Euler's equations, forward and inverse (mln27) | [`euler_equations`] |
//! | the force in a pivot (mln24) | [`mod@pivot_reaction`] |
//! | steady spins and whether they are stable | [`stability`] |
//! | free motion of any body, exact at any time, and what it tells | [`free`] |
//! | a body with constant momentum inside, exact at any time; its steady rotations | [`gyrostat`] |
//! | torque-free symmetric top: body cone and space cone | [`mod@free_precession`] |
//! | what internal dissipation does to its nutation | [`mod@nutation_damping`] |
//! | symmetric top in a uniform field: steady precession, sleeping | [`heavy_top`] |
//! | a body that rolls on a plane | [`rolling`] |
//! | the body that fits a log of its motion | [`identification`] |
//! | attitude, ω, position and velocity together | [`state`] |
//! | motions in closed form: states at one time and at many | [`closed_form`] |
//! | what acts on the body | [`loads`] |
//! | what is asked of a method, and what it gives | `problem` |
//! | motion under a load at the times asked for | [`mod@simulate`] |
//! | the steppers | [`integrate`] |

pub mod angular_momentum;
pub mod attitude;
pub mod closed_form;
pub mod euler_angles;
pub mod euler_equations;
pub mod free;
pub mod free_precession;
pub mod gyrostat;
pub mod heavy_top;
pub mod identification;
pub mod integrate;
pub mod kinematics;
pub mod kinetic_energy;
pub mod loads;
pub mod nutation_damping;
pub mod pivot_reaction;
pub(crate) mod problem;
pub mod rates;
pub mod rolling;
pub mod simulate;
pub mod stability;
pub mod state;
