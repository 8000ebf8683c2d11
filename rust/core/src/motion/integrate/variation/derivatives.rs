//! The derivatives of a motion at the times of a task, put together from runs of eight variables each.

use std::ops::{ControlFlow, Range};

use nalgebra::{Matrix6, Matrix6x3, Quaternion, Vector3, Vector6};

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
    /// By the states that the load has of its own at the start, each with the others held.
    pub own: Vec<Vector6<f64>>,
    /// The derivatives of these states, by all of that in this order.
    pub of_own: Vec<Vec<f64>>,
    /// Those of the states at the start by ω there, of states that begin with it and are not given. By ω the others hold them.
    pub begins: Vec<Vector3<f64>>,
}

/// The derivatives of the motion of `task` under `terms` at the times of the task; its method and tolerance do not matter.
///
/// `given` tells of each state of the load whether it is what the task says, whatever the numbers of the load are; the states that
/// it leaves out are what the load begins with.
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
        let mut tell = |k: usize, state: &[Varied; 7], own: &[Varied]| {
            for (column, slopes) in (block.first..all).zip(columns(state)) {
                if k > 0 {
                    found[k].set(column, &slopes);
                }
                for (row, own) in found[k].of_own.iter_mut().zip(own) {
                    row[column] = own.slopes[column - block.first];
                }
            }
        };
        run_varied(task, terms, block, &mut tell, &mut watch)?;
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
    /// Whether all are numbers, those by the tensor among them where it has neighbours.
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

    /// Lets the states of the load begin as they do: by the numbers of the load, unless they are given.
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

    /// Lets a state at the start follow from the numbers of the load from `first` on; one that is known can be nothing else.
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

    /// The derivative of number `row` of (δ, ω) and the states of the load by what stands in a column: the start of (δ, ω), the
    /// moments, products, centre of mass and mass, the numbers of the load, the start of its states.
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
