//! The derivatives of a motion at the times of a task, put together from runs of eight variables each.

use std::ops::ControlFlow;

use nalgebra::{Matrix6, Matrix6x3, Quaternion, Vector6};

use crate::error::{Error, MotionFault};
use crate::motion::integrate::taylor::run_varied;
use crate::motion::loads::Term;
use crate::motion::loads::variables::{
    ATTITUDE, Block, CENTER, LOAD, MASS, MOMENTS, PRODUCTS, Varied, WIDTH,
};
use crate::motion::problem::{Task, check_times};

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
/// When the times do not run one way, a term cannot act, the motion cannot go on, [`MotionFault::NoSeries`], [`MotionFault::NotFiniteDerivative`], or
/// [`Error::Stopped`].
pub fn variations(
    task: &Task<'_>,
    terms: &[Term],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Vec<Variation>, Error> {
    check_times(task.times)?;
    let is_known = |term: &Term| term.character(task.subject.pivoted).has_series && term.own() == 0;
    if !terms.iter().all(is_known) {
        return Err(MotionFault::NoSeries.into());
    }
    let numbers: usize = terms.iter().map(Term::count).sum();
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
        let mut tell = |k: usize, state: &[Varied; 7]| {
            for (column, slopes) in (block.first..LOAD + numbers).zip(columns(state)) {
                found[k].set(column, &slopes);
            }
        };
        run_varied(task, terms, block, &mut tell, &mut watch)?;
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

/// The derivatives of (δ, ω) by the variables of a block: `δ = 2 vec(q⁻¹∘dq)`.
fn columns(state: &[Varied; 7]) -> [Vector6<f64>; WIDTH] {
    let [.., x, y, z, w] = state;
    let at = Quaternion::new(w.value, x.value, y.value, z.value);
    let twice = 2.0 / at.norm_squared();
    std::array::from_fn(|n| {
        let [p, q, r, x, y, z, w] = state.map(|number| number.slopes[n]);
        let tilt = (at.conjugate() * Quaternion::new(w, x, y, z)).imag() * twice;
        Vector6::new(tilt.x, tilt.y, tilt.z, p, q, r)
    })
}
