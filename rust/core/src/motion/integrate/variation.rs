//! The derivatives of a motion: effects at a later time of small changes of the start, of the body, or of the load.
//!
//! Every number of the equations carries its derivatives by the variables, through the series of [`taylor`](super::taylor). A run
//! computes the derivatives by eight variables.
//!
//! Source: Hairer, Nørsett & Wanner, Solving ODEs I, §I.14; where a law changes its torque with the state, Filippov's rule for
//! derivatives ("saltation"), di Bernardo et al., Piecewise-smooth Dynamical Systems, §2.5.

use std::ops::{ControlFlow, Range};

use nalgebra::{Matrix6, Matrix6x3, Quaternion, Vector3, Vector6};

use super::taylor::solve_variational;
use crate::error::{Error, MotionFault};
use crate::motion::loads::Term;
use crate::motion::loads::variables::{
    ATTITUDE, Block, CENTER, LOAD, MASS, MOMENTS, PRODUCTS, VariationJet, WIDTH,
};
use crate::motion::problem::{Task, check_times};

/// Derivatives of (δ, ω) at a time. δ is a small rotation of the body from its attitude, `R → R exp(δ×)`; its components and those of ω
/// are in the body frame at that time.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// By (δ, ω) at the start.
    pub state: Matrix6<f64>,
    /// By the principal moments about the reference point, ascending, with constant axes, centre of mass and mass. NaN, like `products`,
    /// for a body with a zero moment, which has neighbours on one side only.
    pub moments: Matrix6x3<f64>,
    /// By the elements 23, 31, 12 of that tensor in its principal axes, which are minus products of inertia.
    pub products: Matrix6x3<f64>,
    /// By the centre of mass from the origin of B, with a constant tensor about the reference point.
    pub center_of_mass: Matrix6x3<f64>,
    /// By the mass.
    pub mass: Vector6<f64>,
    /// By the numbers of the load's terms, one after the other, in the order of [`Term::parameters`].
    pub load: Vec<Vector6<f64>>,
    /// By the states of the load at the start, each with the others constant.
    pub own: Vec<Vector6<f64>>,
    /// The derivatives of these states, by all of that in this order.
    pub of_own: Vec<Vec<f64>>,
    /// The derivatives of the initial states of the load by the initial ω, for states that depend on it and are not given. Derivatives by
    /// ω elsewhere are at constant states.
    pub begins: Vec<Vector3<f64>>,
}

/// Compute the derivatives of the motion of `task` under `terms` at the times of the task; its method and tolerance do not matter.
///
/// `given` is true for each state of the load that the task gives, independent of the numbers of the load. The other states begin with
/// the values that follow from the load.
///
/// `watch` gets the fraction done and may stop it.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::RigidBody;
/// use polhode::motion::integrate::variation::{Variation, variations};
/// use polhode::motion::loads::Term;
/// use polhode::motion::simulate::{Method, Phase, State, Task, Tolerance};
/// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
///
/// // How ω of a freely turning body after 3 s depends on what it began with, and on a torque that may act.
/// let body = RigidBody::from_principal(1.0, &[1.0, 2.0, 2.5], &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
/// let state = State { attitude: UnitQuaternion::identity(), omega: Vector3::new(0.0, 0.0, 1.0) };
/// let tolerance = Tolerance::new(1e-12, 0.0)?;
/// let task = Task::free(&body, Phase::in_place(&state), &[0.0, 3.0], Method::Taylor, tolerance);
/// let torque = [Term::constant_torque(&Vector3::zeros(), polhode::motion::loads::Frame::Body)?];
/// let found = variations(&task, &torque, &[], &mut |_| ControlFlow::Continue(()))?;
/// let Variation { state, moments, load, .. } = &found[1];
/// // About axis 3 the rate goes on as it is, and grows by t/I₃ with the torque about it; its phase by t.
/// assert!((state[(5, 5)] - 1.0).abs() < 1e-14 && (state[(2, 5)] - 3.0).abs() < 1e-13);
/// assert!((load[2][5] - 3.0 / 2.5).abs() < 1e-13);
/// assert!(moments[(5, 2)].abs() < 1e-14); // without a torque whatever the moment
/// assert_eq!(found[1].slope(5, Variation::COLUMNS[0].start + 5), state[(5, 5)]);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the times do not run one way, a term cannot act, the motion cannot go on, [`MotionFault::NoSeries`], [`MotionFault::NotFiniteDerivative`], or
/// [`Error::Stopped`].
pub fn variations(
    task: &Task<'_>,
    terms: &[Term],
    given: &[bool],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Vec<Variation>, Error> {
    check_times(task.times)?;
    let is_known = |term: &Term| term.traits(task.body_at_point.pivoted).has_series;
    if !terms.iter().all(is_known) {
        return Err(MotionFault::NoSeries.into());
    }
    let task = &(task.clone()).with_carried(terms.iter().filter_map(Term::carried))?;
    let states = task.initial.internal_state.len();
    let numbers: usize = terms.iter().map(Term::count).sum();
    let start = Variation {
        state: Matrix6::identity(),
        moments: Matrix6x3::zeros(),
        products: Matrix6x3::zeros(),
        center_of_mass: Matrix6x3::zeros(),
        mass: Vector6::zeros(),
        load: vec![Vector6::zeros(); numbers],
        own: vec![Vector6::zeros(); states],
        of_own: vec![vec![0.0; LOAD + numbers + states]; states],
        begins: vec![Vector3::zeros(); states],
    };
    let mut found = vec![start; task.times.len()];
    let all = LOAD + numbers + states;
    let blocks = all.div_ceil(WIDTH);
    for index in 0..blocks {
        let block = Block {
            first: index * WIDTH,
        };
        let mut watch = |part| watch((index as f64 + part) / blocks as f64);
        let mut record = |k: usize, state: &[VariationJet; 7], own: &[VariationJet]| {
            for (column, slopes) in (block.first..all).zip(columns(state)) {
                if k > 0 {
                    found[k].set(column, &slopes);
                }
                for (row, own) in found[k].of_own.iter_mut().zip(own) {
                    row[column] = own.slopes[column - block.first];
                }
            }
        };
        solve_variational(task, terms, block, &mut record, &mut watch)?;
    }
    for (state, row) in found[0].of_own.iter_mut().enumerate() {
        row[LOAD + numbers..].fill(0.0);
        row[LOAD + numbers + state] = 1.0; // but for rounding in principal axes
    }
    for variation in &mut found {
        variation.begin(task, terms, given);
    }
    let has_neighbours = !task.euler.moments().contains(&0.0);
    for (variation, &time) in found.iter_mut().zip(task.times) {
        if !variation.is_finite(has_neighbours) {
            return Err(MotionFault::NotFiniteDerivative { time }.into());
        }
        if !has_neighbours {
            variation.moments.fill(f64::NAN);
            variation.products.fill(f64::NAN);
            for row in &mut variation.of_own {
                row[MOMENTS..CENTER].fill(f64::NAN);
            }
        }
    }
    Ok(found)
}

impl Variation {
    /// Return whether all are finite; those by the tensor count only if it has neighbours.
    fn is_finite(&self, has_neighbours: bool) -> bool {
        let of_tensor = self.moments.iter().chain(&self.products);
        let of_load = (self.load.iter().chain(&self.own)).flat_map(|slopes| slopes.iter());
        let tensor = if has_neighbours { CENTER } else { MOMENTS };
        let of_own =
            (self.of_own.iter()).flat_map(|row| row[..MOMENTS].iter().chain(&row[tensor..]));
        (self
            .state
            .iter()
            .chain(&self.center_of_mass)
            .chain(&self.mass))
        .chain(of_tensor.filter(|_| has_neighbours))
        .chain(of_load)
        .chain(of_own)
        .all(|x| x.is_finite())
    }

    fn set(&mut self, column: usize, slopes: &Vector6<f64>) {
        match column {
            ATTITUDE..MOMENTS => self.state.set_column(column, slopes),
            MOMENTS..PRODUCTS => self.moments.set_column(column - MOMENTS, slopes),
            PRODUCTS..CENTER => self.products.set_column(column - PRODUCTS, slopes),
            CENTER..MASS => self.center_of_mass.set_column(column - CENTER, slopes),
            MASS => self.mass = *slopes,
            _ => match (column - LOAD).checked_sub(self.load.len()) {
                None => self.load[column - LOAD] = *slopes,
                Some(state) => self.own[state] = *slopes,
            },
        }
    }

    /// Apply the dependence of the initial states on the numbers of the load, except for states that are given.
    fn begin(&mut self, task: &Task<'_>, terms: &[Term], given: &[bool]) {
        let (mut state, mut number) = (0, 0);
        for term in terms {
            let carried = term.carried().into_iter();
            for carried in carried.filter(|carried| carried.count() > 0) {
                let beginning = carried.beginning(task.times[0], &task.initial.omega);
                for (by_omega, by_numbers) in beginning {
                    let is_known = carried.is_known();
                    if is_known || !given.get(state).is_some_and(|&given| given) {
                        self.begins[state] = by_omega;
                        self.follow(state, number, &by_numbers, is_known);
                    }
                    state += 1;
                }
            }
            number += term.count();
        }
    }

    /// Apply the dependence of an initial state on the numbers of the load from `first` on. A state that is known has no derivative of its
    /// own.
    fn follow(&mut self, state: usize, first: usize, by_numbers: &[f64], is_known: bool) {
        let column = LOAD + self.load.len() + state;
        for (number, &slope) in (first..).zip(by_numbers) {
            self.load[number] += self.own[state] * slope;
            for row in &mut self.of_own {
                row[LOAD + number] += row[column] * slope;
            }
        }
        if is_known {
            self.own[state].fill(0.0);
            for row in &mut self.of_own {
                row[column] = 0.0;
            }
        }
    }

    /// The columns of [`Self::slope`] by the start of (δ, ω), and by the moments, the products, the centre of mass and the mass.
    pub const COLUMNS: [Range<usize>; 5] = [
        ATTITUDE..MOMENTS,
        MOMENTS..PRODUCTS,
        PRODUCTS..CENTER,
        CENTER..MASS,
        MASS..LOAD,
    ];

    /// Return the derivative of number `row` of (δ, ω) and the states of the load by the number of a column. The columns are the initial
    /// (δ, ω), the moments, products, centre of mass and mass, the numbers of the load, and its initial states.
    #[must_use]
    pub fn slope(&self, row: usize, column: usize) -> f64 {
        if let Some(state) = row.checked_sub(MOMENTS) {
            return self.of_own[state][column];
        }
        match column {
            ATTITUDE..MOMENTS => self.state[(row, column)],
            MOMENTS..PRODUCTS => self.moments[(row, column - MOMENTS)],
            PRODUCTS..CENTER => self.products[(row, column - PRODUCTS)],
            CENTER..MASS => self.center_of_mass[(row, column - CENTER)],
            MASS => self.mass[row],
            _ => match (column - LOAD).checked_sub(self.load.len()) {
                None => self.load[column - LOAD][row],
                Some(state) => self.own[state][row],
            },
        }
    }
}

/// Compute the derivatives of (δ, ω) by the variables of a block: `δ = 2 vec(q⁻¹∘dq)`.
fn columns(state: &[VariationJet; 7]) -> [Vector6<f64>; WIDTH] {
    let [.., x, y, z, w] = state;
    let at = Quaternion::new(w.value, x.value, y.value, z.value);
    let twice = 2.0 / at.norm_squared();
    std::array::from_fn(|n| {
        let [p, q, r, x, y, z, w] = state.map(|number| number.slopes[n]);
        let tilt = (at.conjugate() * Quaternion::new(w, x, y, z)).imag() * twice;
        Vector6::new(tilt.x, tilt.y, tilt.z, p, q, r)
    })
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use nalgebra::{Matrix3, Matrix6, Quaternion, UnitQuaternion, Vector3};

    use super::*;
    use crate::error::MotionFault;
    use crate::mass::RigidBody;
    use crate::motion::free::FreeMotion;
    use crate::motion::loads::{Feedback, Frame, GravityGradient, Term};
    use crate::motion::problem::{Method, Task, Tolerance};
    use crate::motion::state::{Phase, State};

    fn body(moments: [f64; 3]) -> RigidBody {
        let body =
            RigidBody::from_principal(2.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0);
        body.expect("body")
    }

    fn attitude() -> UnitQuaternion<f64> {
        UnitQuaternion::new_normalize(Quaternion::new(0.7, 0.3, -0.2, 0.4))
    }

    fn vary(body: &RigidBody, start: &State, times: &[f64], terms: &[Term]) -> Vec<Variation> {
        let tolerance = Tolerance::new(1e-10, 0.0).expect("tolerance");
        let task = Task::free(
            body,
            Phase::in_place(start),
            times,
            Method::Taylor,
            tolerance,
        );
        variations(&task, terms, &[], &mut |_| ControlFlow::Continue(())).expect("goes on")
    }

    #[test]
    fn a_free_body() {
        let start = State {
            attitude: attitude(),
            omega: Vector3::new(0.3, 0.2, 1.1),
        };
        for moments in [[1.0, 2.0, 2.5], [2.0, 2.0, 2.5], [2.0, 2.0, 2.0]] {
            let body = body(moments);
            let motion = FreeMotion::of(&body, &start.omega, &start.attitude).expect("motion");
            for t in [60.0, -7.0] {
                let (found, exact) = (
                    &vary(&body, &start, &[0.0, t], &[])[1],
                    motion.sensitivity(t),
                );
                let size = exact.state.norm();
                assert!(
                    (found.state - exact.state).norm() < 1e-13 * size,
                    "{moments:?} {t}"
                );
                assert!((found.moments - exact.moments).norm() < 1e-13 * exact.moments.norm());
                assert_eq!(found.mass.norm(), 0.0);
            }
        }
    }

    #[test]
    fn two_spans_make_one() {
        let gradient = GravityGradient::new(
            1.0,
            &Vector3::new(1.0, 0.25, 0.125),
            &Vector3::new(-0.125, 1.125, 0.25),
            Some(-0.5),
        );
        let feedback = Feedback::new(
            &Matrix3::from_diagonal_element(0.3),
            &Matrix3::from_diagonal_element(0.01),
            &UnitQuaternion::identity(),
        );
        let terms = [
            Term::GravityGradient(gradient.expect("orbit")),
            Term::Feedback(feedback.expect("finite")),
            Term::constant_torque(&Vector3::new(0.05, 0.0, 0.1), Frame::Space).expect("finite"),
        ];
        let start = State {
            attitude: attitude(),
            omega: Vector3::new(0.3, 0.2, 1.1),
        };
        let body = body([1.0, 2.0, 2.5]);
        let tolerance = Tolerance::new(1e-14, 0.0).expect("tolerance");
        let task = Task::free(
            &body,
            Phase::in_place(&start),
            &[0.0, 4.0],
            Method::Taylor,
            tolerance,
        );
        let mut watch = |_: f64| ControlFlow::Continue(());
        let run = crate::motion::integrate::taylor::solve_one(&task, &terms, &mut watch);
        let middle = run.phase.state();
        let whole = vary(&body, &start, &[0.0, 4.0, 20.0], &terms);
        let late = &vary(&body, &middle, &[4.0, 20.0], &terms)[1];
        let size = late.state.norm() * whole[1].state.norm();
        assert!((late.state * whole[1].state - whole[2].state).norm() < 1e-12 * size);
        for k in 0..whole[1].load.len() {
            let together = late.state * whole[1].load[k] + late.load[k];
            let error = (together - whole[2].load[k]).norm();
            assert!(
                error < 1e-12 * (size + late.load[k].norm()),
                "{k} {error:e}"
            );
        }
        assert_eq!(whole[0].state, Matrix6::identity());
    }

    #[test]
    fn an_orbit_known_many_revolutions_ago() {
        // The epoch moved along the orbit by one revolution: the same motion, and derivatives that differ by the change of the period.
        let orbit = |epoch: f64| {
            let (r, v) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0));
            Term::GravityGradient(GravityGradient::new(1.0, &r, &v, Some(epoch)).expect("orbit"))
        };
        let start = State {
            attitude: attitude(),
            omega: Vector3::new(0.3, 0.2, 1.1),
        };
        let body = body([1.0, 2.0, 2.5]);
        let slopes = |epoch: f64| {
            vary(&body, &start, &[0.0, 3.0], &[orbit(epoch)])[1]
                .load
                .clone()
        };
        let turn = std::f64::consts::TAU;
        let (near, once, often) = (
            slopes(-0.3),
            slopes(-0.3 - turn),
            slopes(-0.3 - 1000.0 * turn),
        );
        for k in 0..near.len() {
            let (one, many) = (once[k] - near[k], often[k] - near[k]);
            assert!(
                (many - one * 1000.0).norm() < 1e-10 * (1.0 + many.norm()),
                "{k}"
            );
        }
        // A circle of unit radius and speed: T = 2π μ/(2μ − 1)^{3/2} by μ is −4π; later phases have the derivative of a shifted
        // epoch, found from the speeds along the orbit.
        let by_phase = near[2] * 1.0 - near[4] * 1.0;
        let expected = by_phase * (2.0 * turn);
        assert!((once[0] - near[0] - expected).norm() < 1e-11 * (1.0 + expected.norm()));
    }

    #[test]
    fn derivatives_beyond_all_numbers_are_refused() {
        // Backward in time damping drives: ∂ω(t)/∂ω(0) = exp(−2 t/I).
        let body = body([1.0, 1.0, 1.0]);
        let damping = crate::motion::loads::Damping {
            linear: Matrix3::identity() * 2.0,
            quadratic: Matrix3::zeros(),
        };
        let start = State {
            attitude: attitude(),
            omega: Vector3::zeros(),
        };
        let terms = [Term::Damping(damping)];
        let there = &vary(&body, &start, &[0.0, -350.0], &terms)[1];
        assert!((there.state[(3, 3)] / 700.0_f64.exp() - 1.0).abs() < 1e-11);
        let tolerance = Tolerance::new(1e-10, 0.0).expect("tolerance");
        let times = [0.0, -350.0, -360.0];
        let task = Task::free(
            &body,
            Phase::in_place(&start),
            &times,
            Method::Taylor,
            tolerance,
        );
        let beyond = variations(&task, &terms, &[], &mut |_| ControlFlow::Continue(()));
        assert_eq!(
            beyond,
            Err(MotionFault::NotFiniteDerivative { time: -360.0 }.into())
        );
    }
}
