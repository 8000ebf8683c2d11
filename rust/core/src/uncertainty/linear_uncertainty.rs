//! What a body carries of its uncertainties.

use nalgebra::SMatrix;

use super::variable::{PROBES, Variable};
use crate::mass::inertial_parameters::InertialParameters;
use crate::numerics::second_order_dual::SecondOrderDual;

/// A change of the ten numbers.
pub type Tangent = InertialParameters<f64>;

/// The covariance of ten numbers with ten.
pub type Covariance = SMatrix<f64, 10, 10>;

/// The uncertainties of one body.
///
/// # Examples
///
/// ```
/// use polhode::uncertainty::linear_uncertainty::{Covariance, slopes};
/// use polhode::uncertainty::{LinearUncertainty, PROBES, Source, Tangent};
///
/// // A body whose mass is known to 2 g, and nothing else of it is uncertain.
/// let scales = Source::named("scales").variable(0);
/// let tangent = Tangent { mass: 0.002, ..Tangent::default() };
/// let uncertainty = LinearUncertainty::of(vec![(scales, tangent)], [Tangent::default(); PROBES]);
/// let covariance: Covariance = uncertainty.covariance_with(&uncertainty);
/// assert!((covariance[(0, 0)] - 4e-6).abs() < 1e-20);
/// // Along the probes the mass goes up and down: on average by its deviation.
/// assert_eq!(uncertainty.slopes(), slopes(&uncertainty.tangents));
/// let square: f64 = uncertainty.slopes().iter().map(|slope| slope.mass.powi(2)).sum();
/// assert!((square / PROBES as f64 - 4e-6).abs() < 1e-18);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LinearUncertainty {
    /// What one standard deviation of each variable does to the body's ten numbers, to first order; in the order of the
    /// variables.
    pub tangents: Vec<(Variable, Tangent)>,
    /// The second-order term along each of the probes.
    pub second_order: [Tangent; PROBES],
}

impl Default for LinearUncertainty {
    fn default() -> Self {
        Self {
            tangents: Vec::new(),
            second_order: [Tangent::default(); PROBES],
        }
    }
}

impl LinearUncertainty {
    /// From tangents in any order, of which those of one variable add up.
    #[must_use]
    pub fn of(mut tangents: Vec<(Variable, Tangent)>, second_order: [Tangent; PROBES]) -> Self {
        tangents.sort_by_key(|(variable, _)| *variable);
        tangents.dedup_by(|(next, more), (variable, sum)| {
            if next != variable {
                return false;
            }
            *sum = plus(sum, more);
            true
        });
        Self {
            tangents,
            second_order,
        }
    }

    /// Covariance of the numbers of one body with those of another: of what both depend on.
    #[must_use]
    pub fn covariance_with(&self, other: &Self) -> Covariance {
        let mut sum = Covariance::zeros();
        let mut others = other.tangents.iter().peekable();
        for (variable, tangent) in &self.tangents {
            while others.next_if(|(own, _)| own < variable).is_some() {}
            if let Some((_, its)) = others.next_if(|(own, _)| own == variable) {
                let (a, b) = (tangent.to_array(), its.to_array());
                for (i, a) in a.iter().enumerate() {
                    for (j, b) in b.iter().enumerate() {
                        sum[(i, j)] += a * b;
                    }
                }
            }
        }
        sum
    }

    /// The first-order terms along each probe.
    #[must_use]
    pub fn slopes(&self) -> [Tangent; PROBES] {
        slopes(&self.tangents)
    }

    /// The ten numbers along each probe, to second order.
    #[must_use]
    pub(crate) fn probes(
        &self,
        numbers: &InertialParameters<f64>,
    ) -> [InertialParameters<SecondOrderDual>; PROBES] {
        let (slopes, numbers) = (self.slopes(), numbers.to_array());
        std::array::from_fn(|probe| {
            let (slopes, second_order) = (
                slopes[probe].to_array(),
                self.second_order[probe].to_array(),
            );
            InertialParameters::from_array(&std::array::from_fn(|k| SecondOrderDual {
                value: numbers[k],
                slope: slopes[k],
                curvature: second_order[k],
            }))
        })
    }

    /// The uncertainties after a linear map of the ten numbers.
    #[must_use]
    pub fn map(&self, linear: impl Fn(&Tangent) -> Tangent) -> Self {
        Self {
            tangents: (self.tangents.iter())
                .map(|(variable, change)| (*variable, linear(change)))
                .collect(),
            second_order: self.second_order.map(|curvature| linear(&curvature)),
        }
    }
}

/// What tangents come to along each of the probes.
#[must_use]
pub fn slopes(tangents: &[(Variable, Tangent)]) -> [Tangent; PROBES] {
    let mut slopes = [[0.0; 10]; PROBES];
    for (variable, tangent) in tangents {
        let tangent = tangent.to_array();
        for (slope, step) in slopes.iter_mut().zip(variable.steps()) {
            for (sum, t) in slope.iter_mut().zip(tangent) {
                *sum += step * t;
            }
        }
    }
    slopes.map(|slope| Tangent::from_array(&slope))
}

/// The sum of two changes.
#[must_use]
pub fn plus(a: &Tangent, b: &Tangent) -> Tangent {
    Tangent {
        mass: a.mass + b.mass,
        center: std::array::from_fn(|k| a.center[k] + b.center[k]),
        inertia: std::array::from_fn(|k| a.inertia[k] + b.inertia[k]),
    }
}
