//! What small changes at the start, of the body or of the load have become at a time: the derivatives of a motion.
//!
//! Every number of the equations carries its derivatives by the variables with it; Taylor series of numbers with derivatives
//! obey the same recurrences as those of numbers, and what comes out are the series of the motion and of the equations that
//! its derivatives obey, the linearised ones, with all that depends on the varied number. Steps are as long as the series
//! of both allow. Eight variables are varied at a time, each eight in a run of its own.
//!
//! | file | what it knows |
//! |---|---|
//! | `parameters` | the variables, in their order |
//! | `numbers` | series and vectors of numbers with derivatives |
//! | `motion` | a motion as series, and units |
//! | `inertia` | the tensor, the mass, the centre of mass |
//! | `acts`, `spline`, `orbit` | the recurrences of the terms of a load |
//! | `pace` | the length of a step |
//! | `columns` | state and derivatives at a time |
//! | `walk` | steps, outputs, breaks |
//!
//! Source: Hairer, Nørsett & Wanner, Solving ODEs I, §I.14; where a law changes its torque with the state, Filippov's rule for
//! derivatives ("saltation"), di Bernardo et al., Piecewise-smooth Dynamical Systems, §2.5.

mod acts;
mod columns;
mod inertia;
mod motion;
mod numbers;
mod orbit;
mod pace;
mod parameters;
mod spline;
#[cfg(test)]
mod tests;
mod walk;

use std::ops::ControlFlow;

use nalgebra::{Matrix6, Matrix6x3, Vector6};

use self::numbers::{Block, WIDTH};
use self::parameters::{ATTITUDE, CENTER, LOAD, MASS, MOMENTS, PRODUCTS, count};
use self::walk::Walk;
use crate::error::{Error, MotionFault};
use crate::motion::loads::Term;
use crate::motion::problem::Task;

/// Derivatives of (δ, ω) at a time: δ is a small rotation of the body from its attitude, `R → R exp(δ×)`, components in the body
/// frame as it stands at that time, ω likewise in the body frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// By (δ, ω) at the start.
    pub state: Matrix6<f64>,
    /// By the principal moments about the reference point, ascending, with axes, centre of mass and mass held. NaN, as are
    /// `products`, for a body with a zero moment, which has no neighbours on one side.
    pub moments: Matrix6x3<f64>,
    /// By the elements 23, 31, 12 of that tensor in its principal axes, which are minus products of inertia.
    pub products: Matrix6x3<f64>,
    /// By the centre of mass from the origin of B, with the tensor about the reference point held.
    pub center_of_mass: Matrix6x3<f64>,
    /// By the mass.
    pub mass: Vector6<f64>,
    /// By the numbers of the load's terms, one after the other, in the order of [`Term::parameters`].
    pub load: Vec<Vector6<f64>>,
}

/// The derivatives of the motion of `task` under `terms` at the times of the task; its method and tolerance do not matter.
///
/// `watch` gets the fraction done and may stop it.
///
/// # Errors
/// When a term cannot act, the motion cannot go on, [`MotionFault::NotFiniteDerivative`], or [`Error::Stopped`].
///
/// # Panics
/// When there are no times; see [`check_times`](crate::motion::problem::check_times).
pub fn variations(
    task: &Task<'_>,
    terms: &[Term],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Vec<Variation>, Error> {
    let numbers: usize = terms.iter().map(count).sum();
    let start = Variation {
        state: Matrix6::identity(),
        moments: Matrix6x3::zeros(),
        products: Matrix6x3::zeros(),
        center_of_mass: Matrix6x3::zeros(),
        mass: Vector6::zeros(),
        load: vec![Vector6::zeros(); numbers],
    };
    let mut found = vec![start; task.times.len()];
    let blocks = (LOAD + numbers).div_ceil(WIDTH);
    for index in 0..blocks {
        let block = Block {
            first: index * WIDTH,
        };
        let mut watch = |part| watch((index as f64 + part) / blocks as f64);
        let mut give = |k: usize, columns: &numbers::Columns| {
            for (column, slopes) in (block.first..LOAD + numbers).zip(columns) {
                found[k].set(column, slopes);
            }
        };
        Walk::new(task, terms, block).run(&mut give, &mut watch)?;
    }
    let has_neighbours = !task.euler.moments().contains(&0.0);
    for (variation, &time) in found.iter_mut().zip(task.times) {
        if !variation.is_finite(has_neighbours) {
            return Err(MotionFault::NotFiniteDerivative { time }.into());
        }
        if !has_neighbours {
            variation.moments.fill(f64::NAN);
            variation.products.fill(f64::NAN);
        }
    }
    Ok(found)
}

impl Variation {
    /// Whether all are numbers, those by the tensor among them where it has neighbours.
    fn is_finite(&self, has_neighbours: bool) -> bool {
        let of_tensor = self.moments.iter().chain(&self.products);
        let of_load = self.load.iter().flat_map(|slopes| slopes.iter());
        (self
            .state
            .iter()
            .chain(&self.center_of_mass)
            .chain(&self.mass))
        .chain(of_tensor.filter(|_| has_neighbours))
        .chain(of_load)
        .all(|x| x.is_finite())
    }

    fn set(&mut self, column: usize, slopes: &Vector6<f64>) {
        match column {
            ATTITUDE..MOMENTS => self.state.set_column(column, slopes),
            MOMENTS..PRODUCTS => self.moments.set_column(column - MOMENTS, slopes),
            PRODUCTS..CENTER => self.products.set_column(column - PRODUCTS, slopes),
            CENTER..MASS => self.center_of_mass.set_column(column - CENTER, slopes),
            MASS => self.mass = *slopes,
            _ => self.load[column - LOAD] = *slopes,
        }
    }
}
