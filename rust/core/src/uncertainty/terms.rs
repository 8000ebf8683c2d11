//! Terms of first, second and third order of all that deviations are told of.
//!
//! What the tensor's change does by itself to moments and axes, `higher` has in closed form; what else there is, bends of the
//! ten numbers above all, is seen along the probes, by a step forward and one back: as the probes' variance of an even term,
//! less that of its closed part.

use super::doubt::Doubt;
use super::higher::{Higher, Second};
use super::stepped::{Stepped, Turned};
use super::variable::PROBES;
use crate::mass::ten::Ten;
use crate::principal::{PrincipalAxes, principal_axes};

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
    pub(super) fn of(numbers: &Ten<f64>, principal: &PrincipalAxes, doubt: &Doubt) -> Self {
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
        for (_, change) in &doubt.tangents {
            add(&mut own, change.to_array());
            let turned = Turned::of(principal, &change.tensor());
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
        terms.look_along_probes(numbers, principal, (lengths, of_radius), doubt);
        terms
    }

    /// Finds the even terms, and takes the odd ones from their closed form.
    fn look_along_probes(
        &mut self,
        numbers: &Ten<f64>,
        principal: &PrincipalAxes,
        (lengths, of_radius): ([f64; 3], [f64; 3]),
        doubt: &Doubt,
    ) {
        let higher = &self.higher;
        let seconds: [(Second, Second); 3] =
            std::array::from_fn(|k| (higher.second_of_moment(k), higher.second_of_angle(k)));
        let mut bends = [Even::default(); 10];
        let mut evens = [[Even::default(); 3]; 3];
        for (slope, bend) in doubt.slopes().iter().zip(&doubt.bends) {
            for (even, bend) in bends.iter_mut().zip(bend.to_array()) {
                even.add(bend, 0.0);
            }
            let ends = [1.0, -1.0].map(|sign| {
                let tensor = numbers.tensor() + slope.tensor() * sign + bend.tensor();
                let mass = numbers.mass + slope.mass * sign + bend.mass;
                Stepped::from(principal, lengths, &principal_axes(&tensor), mass)
            });
            let change = Turned::of(principal, &slope.tensor()).change;
            let bend_of_moments = Turned::of(principal, &bend.tensor()).moments();
            for (k, (moment, angle)) in seconds.iter().enumerate() {
                let mean = |of: fn(&Stepped) -> [f64; 3]| 0.5 * (of(&ends[0])[k] + of(&ends[1])[k]);
                let closed = moment.of(&change);
                self.to_second_order[k].add(closed + bend_of_moments[k]);
                evens[0][k].add(mean(|end| end.moments), closed);
                evens[1][k].add(mean(|end| end.angles), angle.of(&change));
                evens[2][k].add(mean(|end| end.radii), of_radius[k] * closed);
            }
        }
        for (own, bend) in self.own.iter_mut().zip(&bends) {
            own.even = bend.variance(0.0);
        }
        for block in BLOCKS {
            let weight = |k: usize| if k < 7 { 1.0 } else { 2.0 }; // beside the diagonal each stands twice
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
                block.clone().map(|k| weight(k) * of(k)).sum()
            };
            let bent = sum(&|k| bends[k].all.mean_square()) / sum(&|k| self.own[k].first);
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
                terms.unseen = CUBIC * even[k].unseen();
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
    fn unseen(&self) -> f64 {
        self.all.mean_square().min(self.rest.mean_square())
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
