//! Doubts of bodies of particles.

use super::composites::Sum;
use super::doubt::{Doubt, Tangent};
use super::variable::Variable;
use crate::mass::ten::Ten;

/// A number with the linear form of its doubts.
type Number<'a> = (f64, &'a [(Variable, f64)]);

/// The doubts of a body of particles, from mass and position of each: those of points put together.
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
/// let doubt = of_particles(atoms.into_iter());
/// let sigma = doubt.covariance_with(&doubt)[(5, 5)].sqrt();
/// assert!((sigma - 1e-22).abs() < 1e-36); // I = μ d² with μ = 1/2, so d σ
/// ```
#[must_use]
pub fn of_particles<'a>(
    particles: impl Iterator<Item = (Vec<Number<'a>>, Vec<Number<'a>>)> + Clone,
) -> Doubt {
    let value = |numbers: &[Number<'_>], k: usize| numbers[k].0;
    let points: Vec<Ten<f64>> = (particles.clone())
        .map(|(mass, position)| Ten {
            mass: value(&mass, 0),
            center: std::array::from_fn(|k| value(&position, k)),
            inertia: [0.0; 6],
        })
        .collect();
    let mut sum = Sum::of(Ten::together(points.iter().map(|point| (1.0, point))));
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
