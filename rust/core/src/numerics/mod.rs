//! The numerics under the theory: what a page of mechanics takes for granted.
//!
//! | module | what it gives |
//! |---|---|
//! | [`lane`] | one formula for one number or several side by side |
//! | [`structure_of_arrays`] | one formula over a stack, a block of rows at a time |
//! | [`dispatch`] | the widest lanes of the machine at hand, chosen at run time |
//! | [`tree_sum`] | sums whose bits do not depend on how the work is cut |
//! | [`double_double`] | error-free sums and products |
//! | [`quad_double`] | four times the precision, where differences decide |
//! | [`expansion`] | sums and determinants without any rounding |
//! | [`complex`] | complex numbers of such precisions |
//! | [`twofold`] | numbers of twice the precision in kernels |
//! | [`number`] | one algorithm for doubles and for numbers of twice the precision |
//! | [`power_of_two`] | scales that keep all digits |
//! | [`power_series`] | formulas as Taylor series in time |
//! | [`split_vector`] | differences, scalar products and determinants that survive cancellation |
//! | [`elliptic`] | elliptic integrals by means and duplication |
//! | [`theta`] | Jacobi's functions and the phase of Θ |
//! | [`quaternion`] | products and rotations |
//! | [`turns`] | phases without their whole turns, sines, exponentials in lanes |
//! | [`jacobi`] | Jacobi's functions of one number, Carlson's integral of the second kind |
//! | [`jet`] | numbers with their derivatives |
//! | `assign` | `+=` and its like, by `+` and its like |
//! | [`second_order_dual`] | numbers to second order along a line |
//! | [`cholesky`] | factors of covariances, also of semidefinite ones |
//! | [`quadrature`] | adaptive integrals over boxes, with their errors |
//! | [`sign_changes`] | all places in an interval at which a polynomial changes its sign |
//! | `stored_form` | values as `serde` stores them |
//! | [`threads`] | large stacks on all cores, with progress and Ctrl-C |
//! | [`eigen3`] | eigenvalues and eigenvectors of symmetric 3×3 matrices |
//!
//! Same bits everywhere: a row's result does not depend on its neighbours, on the width of the lanes, on the
//! number of threads, nor on which machine with fused multiply-add computes it.

mod assign;
pub(crate) mod cholesky;
pub(crate) mod complex;
pub(crate) mod dispatch;
pub(crate) mod double_double;
pub(crate) mod eigen3;
pub(crate) mod elliptic;
pub(crate) mod expansion;
pub(crate) mod jacobi;
pub(crate) mod jet;
pub(crate) mod lane;
pub(crate) mod number;
pub(crate) mod power_of_two;
pub(crate) mod power_series;
pub(crate) mod quad_double;
pub(crate) mod quadrature;
pub(crate) mod quaternion;
pub(crate) mod second_order_dual;
pub(crate) mod sign_changes;
pub(crate) mod split_vector;
#[cfg(feature = "serde")]
pub(crate) mod stored_form;
pub(crate) mod structure_of_arrays;
pub(crate) mod theta;
pub(crate) mod threads;
pub(crate) mod tree_sum;
pub(crate) mod turns;
pub(crate) mod twofold;
