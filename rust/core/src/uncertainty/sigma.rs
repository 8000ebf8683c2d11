//! Standard deviations of what a body has, and where the first order is not enough for them.
//!
//! With `I = V diag(I_k) Vᵀ` and a change `W = Vᵀ δI V` of the tensor in its principal axes, to first order `δI_k = W_kk`, and
//! the axes turn by the small rotation φ about themselves with `[φ]×_ij = W_ij/(I_j − I_i)`.
//!
//! Of a number with the terms l, e and c of first, second and third order the variance is
//! `E[l²] + var(e) + 2 E[l c] + …` for normal draws: the first order is right within a percent as long as what follows stays
//! below two percent of it, here less a margin for what is not seen. Moments that are about to change places have no such
//! expansion: their gap has to be wide beside its own deviation.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::body_functions::TensorAbout;
use super::linear_uncertainty::LinearUncertainty;
use super::propagate::{Inputs, propagate};
use super::variable::PROBES;
use crate::error::Error;
use crate::mass::body::RigidBody;
use crate::mass::inertial_parameters::{ELEMENTS, InertialParameters, place};
use crate::principal::derivative::DEGENERATE_RTOL;
use crate::principal::{PrincipalAxes, principal_axes};

/// Least gap between moments for them to be linear, and for the axes: in deviations of the gap.
const GAPS: [f64; 2] = [2.0, 3.5];

/// An angle of more than this deviation, in radians, says nothing of where an axis is.
const ANYWHERE: f64 = 1.0;

/// Standard deviations of a body's numbers, and whether each is linear enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigma {
    /// Of the ten numbers.
    pub numbers: [f64; 10],
    /// Of the principal moments.
    pub moments: [f64; 3],
    /// Of the radii of gyration.
    pub radii: [f64; 3],
    /// Of the axes: of the small rotations about each of them, in radians; NaN where the axes are not determined.
    pub axes: [f64; 3],
    /// Whether the first order is enough for each of the ten numbers.
    pub is_linear: [bool; 10],
    /// For each of the moments.
    pub moments_are_linear: [bool; 3],
    /// For each of the radii.
    pub radii_are_linear: [bool; 3],
    /// For each of the angles.
    pub axes_are_linear: [bool; 3],
}

/// Standard deviations of mass, centre and tensor, of the principal moments and axes about C, and of the radii of gyration.
#[must_use]
pub fn sigma(body: &RigidBody, uncertainty: &LinearUncertainty) -> Sigma {
    of(
        &InertialParameters::of(body),
        &body.principal(),
        uncertainty,
    )
}

/// As [`sigma`], with tensor, moments, axes and radii about a point of the body frame.
///
/// # Errors
/// Those of [`propagate`]; a point is in the domain of every body, so that there are none.
pub fn sigma_about(
    body: &RigidBody,
    uncertainty: &LinearUncertainty,
    point: &Vector3<f64>,
) -> Result<Sigma, Error> {
    let numbers = InertialParameters::of(body);
    let from = Inputs {
        bodies: &[(numbers, uncertainty)],
        numbers: &[],
    };
    let uncertainty = propagate(&TensorAbout((*point).into()), from)?;
    let about = InertialParameters {
        inertia: numbers.about((*point).into()),
        ..numbers
    };
    Ok(of(&about, &body.principal_about(point), &uncertainty))
}

/// Of ten numbers with the principal moments and axes of their tensor.
fn of(
    numbers: &InertialParameters<f64>,
    principal: &PrincipalAxes,
    uncertainty: &LinearUncertainty,
) -> Sigma {
    let largest = principal.moments[2];
    let BodyTerms {
        own,
        moments,
        angles,
        radii,
        higher,
        to_second_order,
    } = BodyTerms::of(numbers, principal, uncertainty);
    let gaps: [Gap; 3] = std::array::from_fn(|k| {
        let (i, j) = across(k);
        Gap {
            width: principal.moments[j] - principal.moments[i],
            deviation: {
                let deviation = higher.gap(k).sqrt();
                if deviation > ROUNDING * largest {
                    deviation
                } else {
                    0.0
                }
            },
        }
    });
    // Where two moments may change places, the other two angles are about other axes.
    let none_changes = gaps.iter().all(|gap| gap.is_wide(GAPS[0]));
    let beside = |k: usize| [(k + 1) % 3, (k + 2) % 3];
    let stays = |k: usize| beside(k).iter().all(|&axis| gaps[axis].is_wide(GAPS[0]));
    let is_apart = gaps.map(|gap| gap.width > DEGENERATE_RTOL * largest);
    // A moment that is zero has no deviation but rounding. Where it has no second order either it is zero for ever, and so is
    // its radius of gyration; else the radius leaves zero by the first order of a length, which has no derivative there.
    let is_zero = |k: usize| {
        let deviation = moments[k].deviation();
        deviation >= principal.moments[k] && deviation <= ROUNDING * largest
    };
    // Neither order moves it: what is left of a body that is only turned is beyond them.
    let rests = |k: usize| {
        let moved = moments[k].first.max(to_second_order[k].mean_square());
        moved.sqrt() <= ROUNDING * largest
    };
    let radius = (largest / numbers.mass).sqrt() + Vector3::from(numbers.center).norm();
    let size = |k: usize| match k {
        0 => numbers.mass,
        1..4 => radius,
        _ => largest,
    };
    Sigma {
        numbers: own.map(Terms::deviation),
        moments: moments.map(Terms::deviation),
        radii: std::array::from_fn(|k| match (is_zero(k), rests(k)) {
            (true, true) => 0.0,
            (true, false) => f64::NAN,
            (false, _) => radii[k].deviation(),
        }),
        axes: std::array::from_fn(|k| {
            let sigma = angles[k].deviation();
            let is_determined = is_apart[k] && sigma < ANYWHERE;
            if is_determined { sigma } else { f64::NAN }
        }),
        is_linear: std::array::from_fn(|k| own[k].is_linear(size(k))),
        moments_are_linear: std::array::from_fn(|k| {
            stays(k) && (rests(k) || moments[k].is_linear(largest))
        }),
        radii_are_linear: std::array::from_fn(|k| {
            let rests = rests(k) && (is_zero(k) || radii[k].deviation() <= ROUNDING * radius);
            stays(k) && (rests || (!is_zero(k) && radii[k].is_linear(radius)))
        }),
        axes_are_linear: std::array::from_fn(|k| {
            is_apart[k] && none_changes && gaps[k].is_wide(GAPS[1]) && angles[k].is_linear(1.0)
        }),
    }
}

/// The gap between two moments.
#[derive(Clone, Copy)]
struct Gap {
    width: f64,
    deviation: f64,
}

impl Gap {
    fn is_wide(self, deviations: f64) -> bool {
        self.width >= deviations * self.deviation
    }
}

// Terms of first, second and third order of all numbers that have deviations.
//
// What the change of the tensor does by itself to moments and axes has a closed form, `Higher`. The rest, above all the
// second-order terms of the ten numbers, is found along the probes, by a step forward and one back: as the variance of an
// even term over the probes, less that of its closed part.

/// Largest part of a variance that the first order may lack: by a percent of the deviation at most, with a margin.
const LACKING: f64 = 0.015;

/// Relative to the size of what is deviated from: smaller terms are rounding.
pub(super) const ROUNDING: f64 = 1e-13;

/// The size of twice the mean of the first- times the third-order term of numbers whose third order is not computed, in mean
/// squares of their second order: 4/3 for a body that is turned, of which `x → x cos θ` and `y → x sin θ`, and
/// 4/3 · (n − 2)/(n − 1) for the power n of a length. A quotient, n = −1, has 2: for it the terms beside the first order are 4/3 of
/// what is taken here, and with [`LACKING`] still less than two percent.
const CUBIC: f64 = 4.0 / 3.0;

/// Mass, centre and tensor among the ten numbers: the numbers of each turn into one another.
const BLOCKS: [std::ops::Range<usize>; 3] = [0..1, 1..4, 4..10];

/// Beside a closed part of an even term: the rest, by its variance, with which the closed part still helps.
const REST: f64 = 0.25;

/// Of the ten numbers of a body, its principal moments, the angles of its axes, and its radii of gyration.
pub(super) struct BodyTerms {
    pub(super) own: [Terms; 10],
    pub(super) moments: [Terms; 3],
    pub(super) angles: [Terms; 3],
    pub(super) radii: [Terms; 3],
    pub(super) higher: Higher,
    /// Of each moment, what its second order comes to along the probes.
    pub(super) to_second_order: [Spread; 3],
}

impl BodyTerms {
    /// Of ten numbers with the principal moments and axes of their tensor.
    pub(super) fn of(
        numbers: &InertialParameters<f64>,
        principal: &PrincipalAxes,
        uncertainty: &LinearUncertainty,
    ) -> Self {
        let lengths = (principal.moments).map(|moment| (moment / numbers.mass).sqrt());
        // Of a radius k: `δk = m (k²)′/(2 m k)`.
        let of_radius = lengths.map(|k| {
            if k > 0.0 {
                0.5 / (numbers.mass * k)
            } else {
                0.0
            }
        });
        let mut own = [Terms::default(); 10];
        let [mut moments, mut angles, mut radii] = [[Terms::default(); 3]; 3];
        let mut higher = Higher::new(principal.moments, lengths);
        for (_, change) in &uncertainty.tangents {
            add(&mut own, change.to_array());
            let turned = TensorStep::of(principal, &change.tensor());
            add(&mut moments, turned.moments());
            add(&mut angles, turned.angles());
            let of_mass = |k: usize| turned.change[(k, k)] - lengths[k].powi(2) * change.mass;
            add(
                &mut radii,
                std::array::from_fn(|k| of_radius[k] * of_mass(k)),
            );
            higher.add(&turned.change, change.mass);
        }
        let mut terms = Self {
            own,
            moments,
            angles,
            radii,
            higher,
            to_second_order: [Spread::default(); 3],
        };
        terms.look_along_probes(numbers, principal, (lengths, of_radius), uncertainty);
        terms
    }

    /// Finds the even terms, and takes the odd ones from their closed form.
    fn look_along_probes(
        &mut self,
        numbers: &InertialParameters<f64>,
        principal: &PrincipalAxes,
        (lengths, of_radius): ([f64; 3], [f64; 3]),
        uncertainty: &LinearUncertainty,
    ) {
        let higher = &self.higher;
        let seconds: [(Second, Second); 3] =
            std::array::from_fn(|k| (higher.second_of_moment(k), higher.second_of_angle(k)));
        let mut second_order = [Even::default(); 10];
        let mut evens = [[Even::default(); 3]; 3];
        for (slope, curvature) in uncertainty.slopes().iter().zip(&uncertainty.second_order) {
            for (even, curvature) in second_order.iter_mut().zip(curvature.to_array()) {
                even.add(curvature, 0.0);
            }
            let ends = [1.0, -1.0].map(|sign| {
                let tensor = numbers.tensor() + slope.tensor() * sign + curvature.tensor();
                let mass = numbers.mass + slope.mass * sign + curvature.mass;
                StepChange::from(principal, lengths, &principal_axes(&tensor), mass)
            });
            let change = TensorStep::of(principal, &slope.tensor()).change;
            let bend_of_moments = TensorStep::of(principal, &curvature.tensor()).moments();
            for (k, (moment, angle)) in seconds.iter().enumerate() {
                let mean =
                    |of: fn(&StepChange) -> [f64; 3]| 0.5 * (of(&ends[0])[k] + of(&ends[1])[k]);
                let closed = moment.of(&change);
                self.to_second_order[k].add(closed + bend_of_moments[k]);
                evens[0][k].add(mean(|end| end.moments), closed);
                evens[1][k].add(mean(|end| end.angles), angle.of(&change));
                evens[2][k].add(mean(|end| end.radii), of_radius[k] * closed);
            }
        }
        for (own, curvature) in self.own.iter_mut().zip(&second_order) {
            own.even = curvature.variance(0.0);
        }
        for block in BLOCKS {
            let weight = |k: usize| if k < 7 { 1.0 } else { 2.0 }; // beside the diagonal each stands twice
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
                block.clone().map(|k| weight(k) * of(k)).sum()
            };
            let bent = sum(&|k| second_order[k].all.mean_square()) / sum(&|k| self.own[k].first);
            for own in &mut self.own[block] {
                own.unseen = if own.first > 0.0 {
                    CUBIC * bent * own.first
                } else {
                    0.0
                };
            }
        }
        for (k, (moment, angle)) in seconds.iter().enumerate() {
            let (closed, square) = (higher.variance(moment), of_radius[k].powi(2));
            self.moments[k].even = evens[0][k].variance(closed);
            self.moments[k].odd = higher.of_moment(k);
            self.angles[k].even = evens[1][k].variance(higher.variance(angle));
            self.angles[k].odd = higher.of_angle(k);
            self.radii[k].even = evens[2][k].variance(square * closed);
            self.radii[k].odd = square * higher.of_radius(k);
            let all = [
                &mut self.moments[k],
                &mut self.angles[k],
                &mut self.radii[k],
            ];
            for (terms, even) in all.into_iter().zip(&evens) {
                terms.unseen = CUBIC * even[k].unseen_variance();
            }
        }
    }
}

/// Variance to first order, that of even terms, and twice the mean of first- times third-order terms.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Terms {
    pub(super) first: f64,
    pub(super) even: f64,
    pub(super) odd: f64,
    /// What nothing here sees of the third order, by its size: see [`CUBIC`].
    pub(super) unseen: f64,
}

impl Terms {
    /// The standard deviation, to first order.
    pub(super) fn deviation(self) -> f64 {
        self.first.sqrt()
    }

    /// Whether it is enough, for a number of this size.
    pub(super) fn is_linear(self, size: f64) -> bool {
        let noise = ROUNDING * size;
        // A deviation that is rounding has no part in a mean of products.
        let (odd, unseen) = if self.first > noise * noise {
            (self.odd, self.unseen)
        } else {
            (0.0, 0.0)
        };
        (self.even + odd).abs() + unseen <= LACKING * self.first + noise * noise
    }
}

fn add<const N: usize>(sums: &mut [Terms; N], terms: [f64; N]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        sum.first += term * term;
    }
}

/// An even term along the probes, and the part of it that has a closed form.
#[derive(Clone, Copy, Debug, Default)]
struct Even {
    all: Spread,
    closed: Spread,
    rest: Spread,
}

impl Even {
    fn add(&mut self, term: f64, closed: f64) {
        self.all.add(term);
        self.closed.add(closed);
        self.rest.add(term - closed);
    }

    /// The mean square of what has no closed form, as far as the closed part does not undo it.
    fn unseen_variance(&self) -> f64 {
        self.all.mean_square().min(self.rest.mean_square())
    }

    /// The variance of the term, where that of its closed part is this.
    ///
    /// The closed part helps where it is nearly all there is. Where second-order terms undo it, as for a body that is only turned, what the
    /// probes miss of both is as large as either: there the term alone is the better witness.
    fn variance(&self, closed: f64) -> f64 {
        let all = self.all.variance();
        let corrected = closed + (all - self.closed.variance());
        if corrected >= 0.0 && self.rest.variance() < REST * all {
            corrected
        } else {
            all
        }
    }
}

/// Sums of a term over the probes, and of its square.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spread {
    sum: f64,
    squares: f64,
}

impl Spread {
    fn add(&mut self, term: f64) {
        self.sum += term;
        self.squares += term * term;
    }

    pub(super) fn mean_square(&self) -> f64 {
        self.squares / PROBES as f64
    }

    fn variance(&self) -> f64 {
        let mean = self.sum / PROBES as f64;
        self.mean_square() - mean * mean
    }
}

// Terms of higher order of principal moments and axes, and what they do to variances.
//
// A tensor in its principal axes is `diag(I_k) + W`, W linear in normal variables. By perturbation theory, with
// `g_kj = I_k − I_j`, a moment has the terms
//
// - `e_k = Σ_j w_kj²/g_kj`,
// - `c_k = Σ_jm w_kj w_jm w_mk/(g_kj g_km) − w_kk Σ_j w_kj²/g_kj²`, over j, m ≠ k,
//
// and the angle between two axes i, j, beside the third axis k,
//
// - `e_ij = [(w_ii − w_jj) w_ij/g_ji + ½ w_ik w_kj (1/g_jk − 1/g_ki)]/g_ji`,
// - `c_ij = w_ij (Δ² − ⁴⁄₃ w_ij²)/g_ji³` with `Δ = w_jj − w_ii`: that of `½ atan(2 w/(g + Δ))`, of the two alone. What the
//   third axis adds is smaller where this matters, at a narrow gap.
//
// Means of four normal variables are sums of products of their covariances (Isserlis, Biometrika 12, 1918).

/// An element of W by its place among the six; from six on, what radii of gyration depend on.
type Row = usize;

/// A product of two elements of W, with a factor.
type Product = (f64, Row, Row);

/// A sum of products of two elements of W: a term of second order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Second([Product; 3]);

impl Second {
    /// Its value for one W.
    pub(super) fn of(&self, change: &Matrix3<f64>) -> f64 {
        self.0
            .iter()
            .map(|&(factor, a, b)| factor * change[ELEMENTS[a]] * change[ELEMENTS[b]])
            .sum()
    }
}

/// The covariance of the elements of W, and of `m (k²)′ = W_kk − k² δm` for the three radii of gyration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Higher {
    moments: [f64; 3],
    radii: [f64; 3],
    covariance: SMatrix<f64, 9, 9>,
    /// The variances of the gaps across each axis, with what turns the two moments into one another: by themselves, since as
    /// differences of covariances they would be rounding where moments stay equal.
    gaps: [f64; 3],
}

/// The two moments across an axis, in ascending order.
pub(super) const fn across(axis: usize) -> (usize, usize) {
    [(1, 2), (0, 2), (0, 1)][axis]
}

impl Higher {
    /// Of a body with these moments and radii of gyration, without uncertainties yet.
    pub(super) fn new(moments: [f64; 3], radii: [f64; 3]) -> Self {
        Self {
            moments,
            radii,
            covariance: SMatrix::zeros(),
            gaps: [0.0; 3],
        }
    }

    /// Adds what one variable does to the tensor and to the mass.
    pub(super) fn add(&mut self, change: &Matrix3<f64>, mass: f64) {
        for (k, gap) in self.gaps.iter_mut().enumerate() {
            let (i, j) = across(k);
            let difference = change[(j, j)] - change[(i, i)];
            *gap += difference * difference + 4.0 * change[(i, j)] * change[(i, j)];
        }
        let rows: [f64; 9] = std::array::from_fn(|row| match row {
            0..6 => change[ELEMENTS[row]],
            _ => change[(row - 6, row - 6)] - self.radii[row - 6].powi(2) * mass,
        });
        for (i, a) in rows.iter().enumerate() {
            for (j, b) in rows.iter().enumerate() {
                self.covariance[(i, j)] += a * b;
            }
        }
    }

    /// `E[a b]`.
    fn two(&self, a: Row, b: Row) -> f64 {
        self.covariance[(a, b)]
    }

    /// `E[a b c d]`.
    fn four(&self, [a, b, c, d]: [Row; 4]) -> f64 {
        self.two(a, b) * self.two(c, d)
            + self.two(a, c) * self.two(b, d)
            + self.two(a, d) * self.two(b, c)
    }

    /// The variance of the gap between the two moments across an axis, with what turns them into one another.
    pub(super) fn gap(&self, k: usize) -> f64 {
        self.gaps[k]
    }

    /// `1/(I_i − I_j)`; zero between equal moments, which are told by their gap.
    fn over(&self, i: usize, j: usize) -> f64 {
        let gap = self.moments[i] - self.moments[j];
        if gap.abs() > DEGENERATE_RTOL * self.moments[2] {
            1.0 / gap
        } else {
            0.0
        }
    }

    /// The second-order term of moment k.
    pub(super) fn second_of_moment(&self, k: usize) -> Second {
        let product = |j: usize| (self.over(k, j), place(k, j), place(k, j));
        Second([product((k + 1) % 3), product((k + 2) % 3), (0.0, 0, 0)])
    }

    /// Of the angle about axis k.
    pub(super) fn second_of_angle(&self, k: usize) -> Second {
        let (i, j) = across(k);
        let over = self.over(j, i);
        let beside = 0.5 * over * (self.over(j, k) - self.over(k, i));
        Second([
            (over * over, place(i, i), place(i, j)),
            (-over * over, place(j, j), place(i, j)),
            (beside, place(i, k), place(k, j)),
        ])
    }

    /// The variance of a second-order term.
    pub(super) fn variance(&self, term: &Second) -> f64 {
        let mut variance = 0.0;
        for &(f, a, b) in &term.0 {
            for &(g, c, d) in &term.0 {
                variance +=
                    f * g * (self.two(a, c) * self.two(b, d) + self.two(a, d) * self.two(b, c));
            }
        }
        variance
    }

    /// Twice the mean of the first- times the third-order term of moment k.
    pub(super) fn of_moment(&self, k: usize) -> f64 {
        self.of_moment_with(k, place(k, k))
    }

    /// Of radius of gyration k, times `4 m² k²`.
    pub(super) fn of_radius(&self, k: usize) -> f64 {
        self.of_moment_with(k, 6 + k)
    }

    fn of_moment_with(&self, k: usize, first: Row) -> f64 {
        let others = [(k + 1) % 3, (k + 2) % 3];
        let mut sum = 0.0;
        for j in others {
            let w = place(k, j);
            sum -= self.over(k, j).powi(2) * self.four([first, place(k, k), w, w]);
            for m in others {
                let over = self.over(k, j) * self.over(k, m);
                sum += over * self.four([first, w, place(j, m), place(m, k)]);
            }
        }
        2.0 * sum
    }

    /// Of the angle about axis k, in the sense of [`Self::second_of_angle`].
    pub(super) fn of_angle(&self, k: usize) -> f64 {
        let (i, j) = across(k);
        let (a, b, w) = (place(i, i), place(j, j), place(i, j));
        let squares =
            self.four([w, w, a, a]) + self.four([w, w, b, b]) - 2.0 * self.four([w, w, a, b]);
        let over = self.over(j, i);
        2.0 * over.powi(4) * (squares - 4.0 / 3.0 * self.four([w, w, w, w]))
    }
}

// What a change of the tensor makes of moments, axes and radii of gyration: to first order, and after a whole step.

/// A change of a tensor, in its principal axes.
pub(super) struct TensorStep {
    /// W.
    pub(super) change: Matrix3<f64>,
    /// `I_k`.
    moments: [f64; 3],
}

impl TensorStep {
    pub(super) fn of(principal: &PrincipalAxes, change: &Matrix3<f64>) -> Self {
        Self {
            change: principal.axes.tr_mul(&(change * principal.axes)),
            moments: principal.moments,
        }
    }

    pub(super) fn moments(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.change[(k, k)])
    }

    /// φ; zero about an axis between equal moments, where there is none.
    pub(super) fn angles(&self) -> [f64; 3] {
        let turn = |i: usize, j: usize| {
            let gap = self.moments[j] - self.moments[i];
            if gap.abs() > DEGENERATE_RTOL * self.moments[2] {
                self.change[(i, j)] / gap
            } else {
                0.0
            }
        };
        [turn(2, 1), turn(0, 2), turn(1, 0)]
    }
}

/// What moments and axes have become after a step.
pub(super) struct StepChange {
    /// By how much the moments are others.
    pub(super) moments: [f64; 3],
    /// And the radii of gyration; NaN where a body has none.
    pub(super) radii: [f64; 3],
    /// The rotation of the axes, about themselves.
    pub(super) angles: [f64; 3],
}

impl StepChange {
    pub(super) fn from(
        start: &PrincipalAxes,
        radii: [f64; 3],
        end: &PrincipalAxes,
        mass: f64,
    ) -> Self {
        let mut turn = start.axes.tr_mul(&end.axes);
        // Axes have no sense: each is taken as near as it can be, and the last one right-handed.
        for k in 0..2 {
            if turn[(k, k)] < 0.0 {
                turn.column_mut(k).neg_mut();
            }
        }
        let third = turn.column(0).cross(&turn.column(1));
        turn.set_column(2, &third);
        Self {
            moments: std::array::from_fn(|k| end.moments[k] - start.moments[k]),
            radii: std::array::from_fn(|k| {
                let square = end.moments[k] / mass;
                if radii[k] > 0.0 {
                    square.sqrt() - radii[k]
                } else {
                    0.0
                }
            }),
            angles: rotation_vector(&turn).into(),
        }
    }
}

/// The rotation vector of a rotation, to the last digits of small angles too.
fn rotation_vector(turn: &Matrix3<f64>) -> Vector3<f64> {
    let twice_sine = Vector3::new(
        turn[(2, 1)] - turn[(1, 2)],
        turn[(0, 2)] - turn[(2, 0)],
        turn[(1, 0)] - turn[(0, 1)],
    );
    let size = twice_sine.norm();
    let angle = size.atan2(turn.trace() - 1.0);
    twice_sine * if size > 0.0 { angle / size } else { 0.5 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Rotation3};

    use crate::mass::body::RigidBody;
    use crate::principal::principal_axes;
    use crate::uncertainty::Source;

    fn body(moments: [f64; 3]) -> RigidBody {
        RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)
            .expect("body")
    }

    /// One variable, by which the tensor's elements change so.
    fn uncertainty(elements: [f64; 6]) -> LinearUncertainty {
        let change = InertialParameters {
            inertia: elements,
            ..InertialParameters::default()
        };
        LinearUncertainty {
            tangents: vec![(Source::named("one").variable(0), change)],
            ..LinearUncertainty::default()
        }
    }

    #[test]
    fn axes_between_equal_moments_are_not_determined() {
        let uncertainty = uncertainty([1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let top = sigma(&body([1.0, 2.0, 2.0]), &uncertainty);
        assert!(top.axes[0].is_nan() && top.axes[1] == 0.0 && top.axes[2] == 0.0);
        assert_eq!(top.axes_are_linear, [false, true, true]);
        // The two moments that are equal stay so: they are as linear as the other.
        assert_eq!(
            (top.moments, top.moments_are_linear),
            ([1e-3, 0.0, 0.0], [true; 3])
        );
        let apart = sigma(&body([1.0, 2.0, 2.1]), &uncertainty);
        assert_eq!((apart.axes, apart.axes_are_linear), ([0.0; 3], [true; 3]));
    }

    #[test]
    fn moments_that_may_change_places_are_told_on_both_sides_of_the_limit() {
        let uncertainty = uncertainty([0.0, 0.0, 0.01, 0.0, 0.0, 0.0]);
        for (gap, moments) in [(0.99 * GAPS[0], false), (1.01 * GAPS[0], true)] {
            let found = sigma(&body([1.0, 1.5, 1.5 + 0.01 * gap]), &uncertainty);
            assert_eq!(found.moments_are_linear, [true, moments, moments]);
            assert_eq!(found.axes_are_linear, [false, moments, moments]);
        }
        for (gap, axes) in [(0.99 * GAPS[1], false), (1.01 * GAPS[1], true)] {
            let found = sigma(&body([1.0, 1.5, 1.5 + 0.01 * gap]), &uncertainty);
            assert_eq!(found.axes_are_linear, [axes, true, true]);
        }
    }

    #[test]
    fn what_is_linear_is_told_on_both_sides_of_the_limits() {
        let terms = |even: f64, odd: f64| Terms {
            first: 1.0,
            even,
            odd,
            unseen: 0.0,
        };
        for (near, is_linear) in [(0.99, true), (1.01, false)] {
            assert_eq!(terms(near * LACKING, 0.0).is_linear(1.0), is_linear);
            assert_eq!(terms(0.0, -near * LACKING).is_linear(1.0), is_linear);
            assert_eq!(
                terms(0.5 * near * LACKING, 0.5 * near * LACKING).is_linear(1.0),
                is_linear
            );
            let unseen = Terms {
                unseen: 0.5 * near * LACKING,
                ..terms(-0.5 * near * LACKING, 0.0)
            };
            assert_eq!(unseen.is_linear(1.0), is_linear);
            let none = Terms {
                first: 0.0,
                ..terms((near * ROUNDING).powi(2), 0.0)
            };
            assert_eq!(none.is_linear(1.0), is_linear);
        }
    }

    #[test]
    fn even_terms_are_seen_by_the_better_witness() {
        let of = |terms: &dyn Fn(f64) -> (f64, f64)| {
            let mut even = Even::default();
            for probe in 0..PROBES {
                let (all, closed) = terms(probe as f64);
                even.add(all, closed);
            }
            even.variance(7.0)
        };
        // A closed term and nothing else: its variance.
        assert_eq!(of(&|x| (x, x)), 7.0);
        // A closed term that the rest undoes: none.
        assert_eq!(of(&|x| (0.0, x)), 0.0);
        // The rest alone: its own, about its mean.
        let alone = of(&|x| (1.0 + x % 2.0, 0.0));
        assert_eq!(alone, 0.25);
        // What is more than the closed one: 1.21 − 1 of what the probes see.
        let seen = ((PROBES * PROBES) as f64 - 1.0) / 12.0;
        assert!((of(&|x| (1.1 * x, x)) - (7.0 + 0.21 * seen)).abs() < 1e-12);
        assert!(of(&|x| (x * f64::NAN, x)).is_nan());
        // Both sides of `REST`: the rest of c x beside x is (c − 1)²/c² of it.
        for (c, is_corrected) in [(1.99, true), (2.01, false)] {
            let corrected = 7.0 + (c * c - 1.0) * seen;
            let found = of(&|x| (c * x, x));
            assert_eq!((found - corrected).abs() < 1e-12, is_corrected);
        }
    }

    const MOMENTS: [f64; 3] = [2.0, 3.0, 4.5];

    /// One variable z: every element is a multiple of it, and E[z⁴] = 3.
    fn one() -> (Matrix3<f64>, Higher) {
        let change = Matrix3::new(0.3, 0.2, 0.1, 0.2, -0.4, 0.25, 0.1, 0.25, 0.2);
        let mut higher = Higher::new(MOMENTS, [1.0; 3]);
        higher.add(&change, 0.1);
        (change, higher)
    }

    #[test]
    fn terms_of_moments_and_angles_are_those_of_a_line() {
        let (change, higher) = one();
        let h = 0.01;
        let at = |s: f64| {
            principal_axes(&(Matrix3::from_diagonal(&MOMENTS.into()) + change * s)).moments
        };
        let [far, near, back, beyond] = [2.0 * h, h, -h, -2.0 * h].map(at);
        for k in 0..3 {
            let cubic = (far[k] - 2.0 * near[k] + 2.0 * back[k] - beyond[k]) / (12.0 * h * h * h);
            let expected = 2.0 * 3.0 * change[(k, k)] * cubic;
            let found = higher.of_moment(k);
            assert!(
                (found - expected).abs() < 2e-3 * expected.abs(),
                "{found} {expected}"
            );
            let of_radius = expected * (change[(k, k)] - 0.1) / change[(k, k)];
            assert!((higher.of_radius(k) - of_radius).abs() < 2e-3 * of_radius.abs());
        }
        // Two axes alone.
        let change = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.0, 0.2, 0.3);
        let mut higher = Higher::new(MOMENTS, [1.0; 3]);
        higher.add(&change, 0.1);
        let (w, delta, g) = (0.2, 0.2, 1.5);
        let cubic = w * (delta * delta - 4.0 / 3.0 * w * w) / (g * g * g);
        assert!((higher.of_angle(0) - 6.0 * w / g * cubic).abs() < 1e-15);
        assert!((higher.gap(0) - (delta * delta + 4.0 * w * w)).abs() < 1e-15);
        assert_eq!([higher.of_angle(1), higher.of_angle(2)], [0.0; 2]);
    }

    #[test]
    fn second_order_terms_are_those_of_differences() {
        let (change, higher) = one();
        let h = 1e-3;
        let at = |s: f64| principal_axes(&(Matrix3::from_diagonal(&MOMENTS.into()) + change * s));
        let [above, here, below] = [h, 0.0, -h].map(at);
        let turn = |end: &PrincipalAxes| {
            let turn = here.axes.tr_mul(&end.axes);
            Rotation3::from_matrix_unchecked(turn).scaled_axis()
        };
        let (forth, back) = (turn(&above), turn(&below));
        for k in 0..3 {
            let moment =
                (above.moments[k] - 2.0 * here.moments[k] + below.moments[k]) / (2.0 * h * h);
            let second = higher.second_of_moment(k);
            assert!((second.of(&change) - moment).abs() < 1e-5);
            // One variable: var(z²) = 2.
            let variance = higher.variance(&second);
            assert!((variance - 2.0 * second.of(&change).powi(2)).abs() < 1e-15);
            // An angle about axis 2 turns axis 1 into axis 3 backwards.
            let sign = if k == 1 { 1.0 } else { -1.0 };
            let angle = sign * (forth[k] + back[k]) / (2.0 * h * h);
            let found = higher.second_of_angle(k).of(&change);
            assert!((found - angle).abs() < 1e-4, "{k} {found} {angle}");
        }
    }

    #[test]
    fn equal_moments_have_none() {
        let mut higher = Higher::new([1.0, 2.0, 2.0], [1.0; 3]);
        higher.add(&Matrix3::from_element(0.1), 0.0);
        assert_eq!(higher.of_angle(0), 0.0);
        assert!(higher.of_moment(1).is_finite());
    }

    #[test]
    fn first_order_is_that_of_differences() {
        let principal = body([2.0, 3.0, 4.0]).principal();
        let slope = Matrix3::new(0.5, -0.3, 0.7, -0.3, 0.2, 0.4, 0.7, 0.4, -0.6);
        let first = TensorStep::of(&principal, &slope);
        let h = 1e-4;
        let tensor = Matrix3::from_diagonal(&Vector3::from(principal.moments));
        let [above, below] = [h, -h].map(|h| {
            StepChange::from(
                &principal,
                [1.0; 3],
                &principal_axes(&(tensor + slope * h)),
                1.0,
            )
        });
        for k in 0..3 {
            let moment = (above.moments[k] - below.moments[k]) / (2.0 * h);
            let angle = (above.angles[k] - below.angles[k]) / (2.0 * h);
            assert!(
                (moment - first.moments()[k]).abs() < 1e-7
                    && (angle - first.angles()[k]).abs() < 1e-7
            );
        }
    }

    #[test]
    fn rotation_vectors_come_back() {
        for size in [0.0, 1e-300, 1e-17, 1e-8, 0.1, 1.5, 3.0] {
            let vector = Vector3::new(0.6, -0.48, 0.64) * size;
            let found = rotation_vector(Rotation3::new(vector).matrix());
            assert!(
                (found - vector).norm() <= 1e-15 + 1e-15 * size,
                "{size} {found}"
            );
        }
    }
}
