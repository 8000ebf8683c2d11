//! Doubts of bodies of particles.

use super::composites::Sum;
use super::doubt::{Doubt, Tangent};
use super::variable::Variable;
use crate::mass::ten::Ten;

/// A number with the linear form of its doubts.
type Number<'a> = (f64, &'a [(Variable, f64)]);

/// The doubts of a body of particles, from mass and position of each: those of points put together.
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
