//! Standard deviations of what a body has, and where the first order is not enough for them.
//!
//! With `I = V diag(I_k) Vᵀ` and a change `W = Vᵀ δI V` of the tensor in its principal axes, to first order `δI_k = W_kk`, and
//! the axes turn by the small rotation φ about themselves with `[φ]×_ij = W_ij/(I_j − I_i)`.
//!
//! Of a number with the terms l, e and c of first, second and third order the variance is
//! `E[l²] + var(e) + 2 E[l c] + …` for normal draws: the first order is right within a percent as long as what follows stays
//! below two percent of it, here less a margin for what is not seen. What the tensor's change does by itself, `higher` has in
//! closed form; what else there is, bends of the ten numbers above all, is seen along the probes, by a step forward and one
//! back: as the probes' variance of e, less that of its closed part. Moments that are about to change places have no such
//! expansion: their gap has to be wide beside its own deviation.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::changes::TensorAbout;
use super::doubt::Doubt;
use super::follow::{Follow, follow};
use super::higher::{Higher, Second, across};
use super::variable::PROBES;
use crate::error::Error;
use crate::mass::body::RigidBody;
use crate::mass::ten::Ten;
use crate::principal::derivative::DEGENERATE_RTOL;
use crate::principal::{PrincipalAxes, principal_axes};

/// Largest part of a variance that the first order may lack: by a percent of the deviation at most, with a margin.
const LACKING: f64 = 0.015;
/// Least gap between moments for them to be linear, and for the axes: in deviations of the gap.
const GAPS: [f64; 2] = [2.0, 3.5];
/// Relative to the size of what is deviated from: smaller terms are rounding.
const ROUNDING: f64 = 1e-13;
/// Beside a closed part of an even term: the rest, by its variance, with which the closed part still helps.
const REST: f64 = 0.25;
/// An angle of more than this deviation, in radians, says nothing of where an axis is.
const ANYWHERE: f64 = 1.0;

/// Standard deviations of a body's numbers, and whether each is linear enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
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
pub fn deviations(body: &RigidBody, doubt: &Doubt) -> Deviations {
    of(&Ten::of(body), &body.principal(), doubt)
}

/// As [`deviations`], with tensor, moments, axes and radii about a point of the body frame.
///
/// # Errors
/// None: those of [`follow`], which has none here.
pub fn deviations_about(
    body: &RigidBody,
    doubt: &Doubt,
    point: &Vector3<f64>,
) -> Result<Deviations, Error> {
    let numbers = Ten::of(body);
    let from = Follow {
        bodies: &[(numbers, doubt)],
        numbers: &[],
    };
    let doubt = follow(&TensorAbout((*point).into()), from)?;
    let about = Ten {
        inertia: numbers.about((*point).into()),
        ..numbers
    };
    Ok(of(&about, &body.principal_about(point), &doubt))
}

/// Of ten numbers with the principal moments and axes of their tensor.
fn of(numbers: &Ten<f64>, principal: &PrincipalAxes, doubt: &Doubt) -> Deviations {
    let largest = principal.moments[2];
    let radii = (principal.moments).map(|moment| (moment / numbers.mass).sqrt());
    // Of a radius k: `δk = m (k²)′/(2 m k)`.
    let of_radius = radii.map(|k| {
        if k > 0.0 {
            0.5 / (numbers.mass * k)
        } else {
            0.0
        }
    });
    let mut own = [Terms::default(); 10];
    let [mut moments, mut angles, mut lengths] = [[Terms::default(); 3]; 3];
    let mut higher = Higher::new(principal.moments, radii);
    for (_, change) in &doubt.tangents {
        add(&mut own, change.to_array());
        let turned = Turned::of(principal, &change.tensor());
        add(&mut moments, turned.moments());
        add(&mut angles, turned.angles());
        let of_mass = |k: usize| turned.change[(k, k)] - radii[k].powi(2) * change.mass;
        add(
            &mut lengths,
            std::array::from_fn(|k| of_radius[k] * of_mass(k)),
        );
        higher.add(&turned.change, change.mass);
    }
    let seconds: [(Second, Second); 3] =
        std::array::from_fn(|k| (higher.second_of_moment(k), higher.second_of_angle(k)));
    let mut bends = [Even::default(); 10];
    let mut evens = [[Even::default(); 3]; 3];
    let mut to_second_order = [Spread::default(); 3];
    for (slope, bend) in doubt.slopes().iter().zip(&doubt.bends) {
        for (even, bend) in bends.iter_mut().zip(bend.to_array()) {
            even.add(bend, 0.0);
        }
        let ends = [1.0, -1.0].map(|sign| {
            let tensor = numbers.tensor() + slope.tensor() * sign + bend.tensor();
            let mass = numbers.mass + slope.mass * sign + bend.mass;
            Stepped::from(principal, radii, &principal_axes(&tensor), mass)
        });
        let change = Turned::of(principal, &slope.tensor()).change;
        let bend_of_moments = Turned::of(principal, &bend.tensor()).moments();
        for (k, (moment, angle)) in seconds.iter().enumerate() {
            let mean = |of: fn(&Stepped) -> [f64; 3]| 0.5 * (of(&ends[0])[k] + of(&ends[1])[k]);
            let closed = moment.of(&change);
            to_second_order[k].add(closed + bend_of_moments[k]);
            evens[0][k].add(mean(|end| end.moments), closed);
            evens[1][k].add(mean(|end| end.angles), angle.of(&change));
            evens[2][k].add(mean(|end| end.radii), of_radius[k] * closed);
        }
    }
    for (own, bend) in own.iter_mut().zip(bends) {
        own.even = bend.variance(0.0);
    }
    for (k, (moment, angle)) in seconds.iter().enumerate() {
        let (closed, square) = (higher.variance(moment), of_radius[k].powi(2));
        moments[k].even = evens[0][k].variance(closed);
        moments[k].odd = higher.of_moment(k);
        angles[k].even = evens[1][k].variance(higher.variance(angle));
        angles[k].odd = higher.of_angle(k);
        lengths[k].even = evens[2][k].variance(square * closed);
        lengths[k].odd = square * higher.of_radius(k);
    }
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
    let is_zero_for_ever =
        |k: usize| is_zero(k) && to_second_order[k].mean_square().sqrt() <= ROUNDING * largest;
    let radius = (largest / numbers.mass).sqrt() + Vector3::from(numbers.center).norm();
    let size = |k: usize| match k {
        0 => numbers.mass,
        1..4 => radius,
        _ => largest,
    };
    Deviations {
        numbers: own.map(Terms::deviation),
        moments: moments.map(Terms::deviation),
        radii: std::array::from_fn(|k| match (is_zero(k), is_zero_for_ever(k)) {
            (true, true) => 0.0,
            (true, false) => f64::NAN,
            (false, _) => lengths[k].deviation(),
        }),
        axes: std::array::from_fn(|k| {
            let sigma = angles[k].deviation();
            let is_determined = is_apart[k] && sigma < ANYWHERE;
            if is_determined { sigma } else { f64::NAN }
        }),
        is_linear: std::array::from_fn(|k| own[k].is_linear(size(k))),
        moments_are_linear: std::array::from_fn(|k| {
            stays(k) && (is_zero_for_ever(k) || moments[k].is_linear(largest))
        }),
        radii_are_linear: std::array::from_fn(|k| {
            stays(k) && (is_zero_for_ever(k) || (!is_zero(k) && lengths[k].is_linear(radius)))
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

/// Variance to first order, that of even terms, and twice the mean of first- times third-order terms.
#[derive(Clone, Copy, Debug, Default)]
struct Terms {
    first: f64,
    even: f64,
    odd: f64,
}

impl Terms {
    /// The standard deviation, to first order.
    fn deviation(self) -> f64 {
        self.first.sqrt()
    }

    /// Whether it is enough, for a number of this size.
    fn is_linear(self, size: f64) -> bool {
        let noise = ROUNDING * size;
        // A deviation that is rounding has no part in a mean of products.
        let odd = if self.first > noise * noise {
            self.odd
        } else {
            0.0
        };
        (self.even + odd).abs() <= LACKING * self.first + noise * noise
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

    /// The variance of the term, where that of its closed part is this.
    ///
    /// The closed part helps where it is nearly all there is. Where bends undo it, as for a body that is only turned, what the
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
struct Spread {
    sum: f64,
    squares: f64,
}

impl Spread {
    fn add(&mut self, term: f64) {
        self.sum += term;
        self.squares += term * term;
    }

    fn mean_square(&self) -> f64 {
        self.squares / PROBES as f64
    }

    fn variance(&self) -> f64 {
        let mean = self.sum / PROBES as f64;
        self.mean_square() - mean * mean
    }
}

/// A change of a tensor, in its principal axes.
struct Turned {
    /// W.
    change: Matrix3<f64>,
    /// `I_k`.
    moments: [f64; 3],
}

impl Turned {
    fn of(principal: &PrincipalAxes, change: &Matrix3<f64>) -> Self {
        Self {
            change: principal.axes.tr_mul(&(change * principal.axes)),
            moments: principal.moments,
        }
    }

    fn moments(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.change[(k, k)])
    }

    /// φ; zero about an axis between equal moments, where there is none.
    fn angles(&self) -> [f64; 3] {
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
struct Stepped {
    /// By how much the moments are others.
    moments: [f64; 3],
    /// And the radii of gyration; NaN where a body has none.
    radii: [f64; 3],
    /// The rotation of the axes, about themselves.
    angles: [f64; 3],
}

impl Stepped {
    fn from(start: &PrincipalAxes, radii: [f64; 3], end: &PrincipalAxes, mass: f64) -> Self {
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
            angles: Rotation3::from_matrix_unchecked(turn).scaled_axis().into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uncertainty::Source;

    fn body(moments: [f64; 3]) -> RigidBody {
        RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)
            .expect("body")
    }

    /// One variable, by which the tensor's elements change so.
    fn doubt(elements: [f64; 6]) -> Doubt {
        let change = Ten {
            inertia: elements,
            ..Ten::default()
        };
        Doubt {
            tangents: vec![(Source::named("one").variable(0), change)],
            ..Doubt::default()
        }
    }

    #[test]
    fn first_order_is_that_of_differences() {
        let principal = body([2.0, 3.0, 4.0]).principal();
        let slope = Matrix3::new(0.5, -0.3, 0.7, -0.3, 0.2, 0.4, 0.7, 0.4, -0.6);
        let first = Turned::of(&principal, &slope);
        let h = 1e-4;
        let tensor = Matrix3::from_diagonal(&Vector3::from(principal.moments));
        let [above, below] = [h, -h].map(|h| {
            Stepped::from(
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
    fn axes_between_equal_moments_are_not_determined() {
        let doubt = doubt([1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let top = deviations(&body([1.0, 2.0, 2.0]), &doubt);
        assert!(top.axes[0].is_nan() && top.axes[1] == 0.0 && top.axes[2] == 0.0);
        assert_eq!(top.axes_are_linear, [false, true, true]);
        // The two moments that are equal stay so: they are as linear as the other.
        assert_eq!(
            (top.moments, top.moments_are_linear),
            ([1e-3, 0.0, 0.0], [true; 3])
        );
        let apart = deviations(&body([1.0, 2.0, 2.1]), &doubt);
        assert_eq!((apart.axes, apart.axes_are_linear), ([0.0; 3], [true; 3]));
    }

    #[test]
    fn moments_that_may_change_places_are_told_on_both_sides_of_the_limit() {
        let doubt = doubt([0.0, 0.0, 0.01, 0.0, 0.0, 0.0]);
        for (gap, moments) in [(0.99 * GAPS[0], false), (1.01 * GAPS[0], true)] {
            let found = deviations(&body([1.0, 1.5, 1.5 + 0.01 * gap]), &doubt);
            assert_eq!(found.moments_are_linear, [true, moments, moments]);
            assert_eq!(found.axes_are_linear, [false, moments, moments]);
        }
        for (gap, axes) in [(0.99 * GAPS[1], false), (1.01 * GAPS[1], true)] {
            let found = deviations(&body([1.0, 1.5, 1.5 + 0.01 * gap]), &doubt);
            assert_eq!(found.axes_are_linear, [axes, true, true]);
        }
    }

    #[test]
    fn what_is_linear_is_told_on_both_sides_of_the_limits() {
        let terms = |even: f64, odd: f64| Terms {
            first: 1.0,
            even,
            odd,
        };
        for (near, is_linear) in [(0.99, true), (1.01, false)] {
            assert_eq!(terms(near * LACKING, 0.0).is_linear(1.0), is_linear);
            assert_eq!(terms(0.0, -near * LACKING).is_linear(1.0), is_linear);
            assert_eq!(
                terms(0.5 * near * LACKING, 0.5 * near * LACKING).is_linear(1.0),
                is_linear
            );
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
    }
}
