//! Uncertainties of bodies put together, where parts may be many: each part's uncertainties go into the whole by themselves.
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
//! - the second-order term of C is `Σ δm_k δC_k/m − F Σ δm_k/m²`,
//! - that of I is `Σ [m_k (δC_k² 1 − δC_k δC_kᵀ) + δm_k (2 d_k·δC_k 1 − δC_k d_kᵀ − d_k δC_kᵀ)] − (F² 1 − F Fᵀ)/m`.

use super::linear_uncertainty::{LinearUncertainty, Tangent, plus, slopes};
use super::variable::{PROBES, Variable};
use crate::mass::inertial_parameters::InertialParameters;

/// The uncertainties of bodies put together, each with the sign +1, or −1 where it is taken out.
#[must_use]
pub fn together(parts: &[(f64, InertialParameters<f64>, &LinearUncertainty)]) -> LinearUncertainty {
    let mut sum = Sum::of(InertialParameters::together(
        parts.iter().map(|(sign, part, _)| (*sign, part)),
    ));
    for (sign, part, uncertainty) in parts {
        sum.add(
            *sign,
            part,
            &uncertainty.tangents,
            Some(&uncertainty.second_order),
        );
    }
    sum.finish()
}

/// The uncertainties of a whole, part by part.
pub(super) struct Sum {
    whole: InertialParameters<f64>,
    tangents: Vec<(Variable, Tangent)>,
    second_order: [Tangent; PROBES],
    /// Σ δm and F along each of the probes.
    first: [(f64, [f64; 3]); PROBES],
}

impl Sum {
    /// Of a whole with these numbers, without parts yet.
    pub(super) fn of(whole: InertialParameters<f64>) -> Self {
        Self {
            whole,
            tangents: Vec::new(),
            second_order: [Tangent::default(); PROBES],
            first: [(0.0, [0.0; 3]); PROBES],
        }
    }

    /// Adds a part, with the second-order terms that it has of its own.
    pub(super) fn add(
        &mut self,
        sign: f64,
        part: &InertialParameters<f64>,
        tangents: &[(Variable, Tangent)],
        second_order: Option<&[Tangent; PROBES]>,
    ) {
        let share = Share::of(sign, part, &self.whole);
        self.tangents.extend(
            tangents
                .iter()
                .map(|(variable, change)| (*variable, share.take(change))),
        );
        for (probe, slope) in slopes(tangents).iter().enumerate() {
            let sum = &mut self.second_order[probe];
            *sum = plus(sum, &share.curvature(slope));
            if let Some(second_order) = second_order {
                *sum = plus(sum, &share.take(&second_order[probe]));
            }
            let (mass, F) = &mut self.first[probe];
            *mass += sign * slope.mass;
            for (k, F) in F.iter_mut().enumerate() {
                *F += sign * (slope.mass * share.d[k] + part.mass * slope.center[k]);
            }
        }
    }

    /// The uncertainties of all that was added.
    pub(super) fn finish(mut self) -> LinearUncertainty {
        let over = 1.0 / self.whole.mass;
        for (curvature, (mass, F)) in self.second_order.iter_mut().zip(self.first) {
            for (place, F) in curvature.center.iter_mut().zip(F) {
                *place -= F * mass * over * over;
            }
            for (element, less) in
                curvature
                    .inertia
                    .iter_mut()
                    .zip(shift_products(F, F, 0.5 * over))
            {
                *element -= less;
            }
        }
        LinearUncertainty::of(self.tangents, self.second_order)
    }
}

/// `factor (2 a·b 1 − a bᵀ − b aᵀ)`, by elements.
fn shift_products([x, y, z]: [f64; 3], [a, b, c]: [f64; 3], factor: f64) -> [f64; 6] {
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
    fn of(sign: f64, part: &InertialParameters<f64>, whole: &InertialParameters<f64>) -> Self {
        let d = std::array::from_fn(|k| part.center[k] - whole.center[k]);
        Self {
            sign,
            mass: part.mass,
            d,
            over: sign / whole.mass,
            lever: shift_products(d, d, 0.5),
        }
    }

    /// The whole's change by a change of the part, to first order.
    fn take(&self, change: &Tangent) -> Tangent {
        let by_place = shift_products(self.d, change.center, self.mass);
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
    fn curvature(&self, change: &Tangent) -> Tangent {
        let by_both = shift_products(self.d, change.center, change.mass);
        let by_place = shift_products(change.center, change.center, 0.5 * self.mass);
        Tangent {
            mass: 0.0,
            center: change.center.map(|c| self.over * change.mass * c),
            inertia: std::array::from_fn(|k| self.sign * (by_both[k] + by_place[k])),
        }
    }
}

// Uncertainties of bodies of particles.

/// A number with the linear form of its uncertainties.
type Number<'a> = (f64, &'a [(Variable, f64)]);

/// The uncertainties of a body of particles, from mass and position of each: those of points put together.
///
/// # Examples
///
/// ```
/// use polhode::uncertainty::{Form, Source, of_particles};
///
/// // Two atoms, the bond between them known to 1 pm.
/// let bond: Form = vec![(Source::named("bond").variable(0), 1e-12)];
/// let atoms = [0.0, 1e-10].map(|x| {
///     let form = if x > 0.0 { bond.as_slice() } else { &[] };
///     (vec![(1.0, [].as_slice())], vec![(x, form), (0.0, &[]), (0.0, &[])])
/// });
/// let uncertainty = of_particles(atoms.into_iter());
/// let sigma = uncertainty.covariance_with(&uncertainty)[(5, 5)].sqrt();
/// assert!((sigma - 1e-22).abs() < 1e-36); // I = μ d² with μ = 1/2, so d σ
/// ```
#[must_use]
pub fn of_particles<'a>(
    particles: impl Iterator<Item = (Vec<Number<'a>>, Vec<Number<'a>>)> + Clone,
) -> LinearUncertainty {
    let value = |numbers: &[Number<'_>], k: usize| numbers[k].0;
    let points: Vec<InertialParameters<f64>> = (particles.clone())
        .map(|(mass, position)| InertialParameters {
            mass: value(&mass, 0),
            center: std::array::from_fn(|k| value(&position, k)),
            inertia: [0.0; 6],
        })
        .collect();
    let mut sum = Sum::of(InertialParameters::together(
        points.iter().map(|point| (1.0, point)),
    ));
    let mut tangents = Vec::new();
    for ((mass, position), point) in particles.zip(&points) {
        tangents.clear();
        for (place, (_, form)) in mass.iter().chain(&position).enumerate() {
            for &(variable, step) in *form {
                let mut change = [0.0; 10];
                change[place] = step;
                tangents.push((variable, Tangent::from_array(&change)));
            }
        }
        sum.add(1.0, point, &tangents, None);
    }
    sum.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::mass::inertial_parameters::Size;
    use crate::uncertainty::propagate::{directly, propagate};
    use crate::uncertainty::{BodyFunction, Inputs, LinearForms, Source};

    /// Two bodies put together, or one taken out of the other, by the general way.
    struct Both(f64);

    impl BodyFunction for Both {
        fn of<X: Size<Body = InertialParameters<X>>>(
            &self,
            bodies: &[InertialParameters<X>],
            _: &[X],
        ) -> Result<InertialParameters<X>, Error> {
            Ok(InertialParameters::together(
                [(1.0, &bodies[0]), (self.0, &bodies[1])].into_iter(),
            ))
        }
    }

    #[test]
    fn parts_by_themselves_are_what_the_sum_is_by_derivatives() {
        let uncertainty = |seed: u32| {
            let sigma: Vec<f64> = (0..10)
                .map(|k| 0.01 * f64::from((7 * k + seed) % 5 + 1))
                .collect();
            let given =
                LinearForms::independent(&sigma, Source::named(&seed.to_string())).expect("sigmas");
            directly(&given.forms.try_into().expect("ten"))
        };
        let big = InertialParameters::from_array(&[
            9.0, 1.0, -2.0, 0.5, 20.0, 25.0, 30.0, 1.0, -2.0, 0.3,
        ]);
        let small =
            InertialParameters::from_array(&[2.0, 0.7, -1.0, 0.9, 1.0, 1.5, 2.0, 0.1, 0.2, -0.1]);
        for sign in [1.0, -1.0] {
            let (a, b) = (uncertainty(1), uncertainty(2));
            let found = together(&[(1.0, big, &a), (sign, small, &b)]);
            let bodies = &[(big, &a), (small, &b)];
            let expected = propagate(
                &Both(sign),
                Inputs {
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
                .second_order
                .iter()
                .zip(&expected.second_order)
                .for_each(|(x, y)| close(x, y));
            // Taken out and put back it is as it was, and every bit of the part's uncertainty is gone.
            let rest = InertialParameters::together([(1.0, &big), (sign, &small)].into_iter());
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
