//! Doubts of bodies put together, where parts may be many: each part's doubts go into the whole by themselves.
//!
//! With `d_k = C_k − C`, to first order
//!
//! - `δm = Σ δm_k`,
//! - `δC = Σ (δm_k d_k + m_k δC_k)/m`,
//! - `δI = Σ δI_k + δm_k (d_k² 1 − d_k d_kᵀ) + m_k (2 d_k·δC_k 1 − δC_k d_kᵀ − d_k δC_kᵀ)`,
//!
//! where δC itself drops out of δI, since `Σ m_k d_k = 0`. To second order, along a line on which the parts move by
//! `(δm_k, δC_k, δI_k) ε + (β…) ε²`, the same of the β and, with `F = Σ (δm_k d_k + m_k δC_k)`,
//!
//! - C bends by `Σ δm_k δC_k/m − F Σ δm_k/m²`,
//! - I bends by `Σ [m_k (δC_k² 1 − δC_k δC_kᵀ) + δm_k (2 d_k·δC_k 1 − δC_k d_kᵀ − d_k δC_kᵀ)] − (F² 1 − F Fᵀ)/m`.

use super::doubt::{Doubt, Tangent, plus, slopes};
use super::variable::{PROBES, Variable};
use crate::mass::ten::Ten;

/// The doubts of bodies put together, each with the sign +1, or −1 where it is taken out.
#[must_use]
pub fn together(parts: &[(f64, Ten<f64>, &Doubt)]) -> Doubt {
    let mut sum = Sum::of(Ten::together(
        parts.iter().map(|(sign, part, _)| (*sign, part)),
    ));
    for (sign, part, doubt) in parts {
        sum.add(*sign, part, &doubt.tangents, Some(&doubt.bends));
    }
    sum.finish()
}

/// The doubts of a whole, part by part.
pub(super) struct Sum {
    whole: Ten<f64>,
    tangents: Vec<(Variable, Tangent)>,
    bends: [Tangent; PROBES],
    /// Σ δm and F along each of the probes.
    first: [(f64, [f64; 3]); PROBES],
}

impl Sum {
    /// Of a whole with these numbers, without parts yet.
    pub(super) fn of(whole: Ten<f64>) -> Self {
        Self {
            whole,
            tangents: Vec::new(),
            bends: [Tangent::default(); PROBES],
            first: [(0.0, [0.0; 3]); PROBES],
        }
    }

    /// Adds a part, with the second-order terms that it has of its own.
    pub(super) fn add(
        &mut self,
        sign: f64,
        part: &Ten<f64>,
        tangents: &[(Variable, Tangent)],
        bends: Option<&[Tangent; PROBES]>,
    ) {
        let share = Share::of(sign, part, &self.whole);
        self.tangents.extend(
            tangents
                .iter()
                .map(|(variable, change)| (*variable, share.take(change))),
        );
        for (probe, slope) in slopes(tangents).iter().enumerate() {
            let sum = &mut self.bends[probe];
            *sum = plus(sum, &share.bend(slope));
            if let Some(bends) = bends {
                *sum = plus(sum, &share.take(&bends[probe]));
            }
            let (mass, F) = &mut self.first[probe];
            *mass += sign * slope.mass;
            for (k, F) in F.iter_mut().enumerate() {
                *F += sign * (slope.mass * share.d[k] + part.mass * slope.center[k]);
            }
        }
    }

    /// The doubts of all that was added.
    pub(super) fn finish(mut self) -> Doubt {
        let over = 1.0 / self.whole.mass;
        for (bend, (mass, F)) in self.bends.iter_mut().zip(self.first) {
            for (place, F) in bend.center.iter_mut().zip(F) {
                *place -= F * mass * over * over;
            }
            for (element, less) in bend.inertia.iter_mut().zip(moved(F, F, 0.5 * over)) {
                *element -= less;
            }
        }
        Doubt::of(self.tangents, self.bends)
    }
}

/// `factor (2 a·b 1 − a bᵀ − b aᵀ)`, by elements.
fn moved([x, y, z]: [f64; 3], [a, b, c]: [f64; 3], factor: f64) -> [f64; 6] {
    let (xx, yy, zz) = (2.0 * x * a, 2.0 * y * b, 2.0 * z * c);
    let cross = |x: f64, y: f64, a: f64, b: f64| -(x * b + y * a);
    [
        yy + zz,
        xx + zz,
        xx + yy,
        cross(x, y, a, b),
        cross(x, z, a, c),
        cross(y, z, b, c),
    ]
    .map(|element| factor * element)
}

/// What a part does to the whole.
struct Share {
    sign: f64,
    mass: f64,
    d: [f64; 3],
    over: f64,
    /// `d² 1 − d dᵀ`.
    lever: [f64; 6],
}

impl Share {
    fn of(sign: f64, part: &Ten<f64>, whole: &Ten<f64>) -> Self {
        let d = std::array::from_fn(|k| part.center[k] - whole.center[k]);
        Self {
            sign,
            mass: part.mass,
            d,
            over: sign / whole.mass,
            lever: moved(d, d, 0.5),
        }
    }

    /// The whole's change by a change of the part, to first order.
    fn take(&self, change: &Tangent) -> Tangent {
        let by_place = moved(self.d, change.center, self.mass);
        let arm = |k: usize| change.mass * self.lever[k] + by_place[k];
        Tangent {
            mass: self.sign * change.mass,
            center: std::array::from_fn(|k| {
                self.over * (change.mass * self.d[k] + self.mass * change.center[k])
            }),
            inertia: std::array::from_fn(|k| self.sign * (change.inertia[k] + arm(k))),
        }
    }

    /// What the squares of a change of the part add to second order.
    fn bend(&self, change: &Tangent) -> Tangent {
        let by_both = moved(self.d, change.center, change.mass);
        let by_place = moved(change.center, change.center, 0.5 * self.mass);
        Tangent {
            mass: 0.0,
            center: change.center.map(|c| self.over * change.mass * c),
            inertia: std::array::from_fn(|k| self.sign * (by_both[k] + by_place[k])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::mass::ten::Size;
    use crate::uncertainty::{Change, Follow, Given, Source, follow, follow::directly};

    /// Two bodies put together, or one taken out of the other, by the general way.
    struct Both(f64);

    impl Change for Both {
        fn of<X: Size<Body = Ten<X>>>(&self, bodies: &[Ten<X>], _: &[X]) -> Result<Ten<X>, Error> {
            Ok(Ten::together(
                [(1.0, &bodies[0]), (self.0, &bodies[1])].into_iter(),
            ))
        }
    }

    #[test]
    fn parts_by_themselves_are_what_the_sum_is_by_derivatives() {
        let doubt = |seed: u32| {
            let sigma: Vec<f64> = (0..10)
                .map(|k| 0.01 * f64::from((7 * k + seed) % 5 + 1))
                .collect();
            let given =
                Given::independent(&sigma, Source::named(&seed.to_string())).expect("sigmas");
            directly(&given.forms.try_into().expect("ten"))
        };
        let big = Ten::from_array(&[9.0, 1.0, -2.0, 0.5, 20.0, 25.0, 30.0, 1.0, -2.0, 0.3]);
        let small = Ten::from_array(&[2.0, 0.7, -1.0, 0.9, 1.0, 1.5, 2.0, 0.1, 0.2, -0.1]);
        for sign in [1.0, -1.0] {
            let (a, b) = (doubt(1), doubt(2));
            let found = together(&[(1.0, big, &a), (sign, small, &b)]);
            let bodies = &[(big, &a), (small, &b)];
            let expected = follow(
                &Both(sign),
                Follow {
                    bodies,
                    numbers: &[],
                },
            )
            .expect("sum");
            let close = |x: &Tangent, y: &Tangent| {
                for (x, y) in x.to_array().into_iter().zip(y.to_array()) {
                    assert!((x - y).abs() < 1e-14, "{x} {y}");
                }
            };
            assert_eq!(found.tangents.len(), 20);
            for (x, y) in found.tangents.iter().zip(&expected.tangents) {
                assert_eq!(x.0, y.0);
                close(&x.1, &y.1);
            }
            found
                .bends
                .iter()
                .zip(&expected.bends)
                .for_each(|(x, y)| close(x, y));
            // Taken out and put back it is as it was, and every bit of the part's doubt is gone.
            let rest = Ten::together([(1.0, &big), (sign, &small)].into_iter());
            let back = together(&[(1.0, rest, &found), (-sign, small, &b)]);
            for (_, change) in back
                .tangents
                .iter()
                .filter(|(v, _)| b.tangents.iter().any(|(w, _)| w == v))
            {
                assert!(change.to_array().iter().all(|x| x.abs() < 1e-15));
            }
        }
    }
}
