//! Doubts of bodies of particles.

use super::composites::together;
use super::doubt::{Doubt, Tangent};
use super::variable::{PROBES, Variable};
use crate::mass::ten::Ten;

/// A number with the linear form of its doubts.
type Number<'a> = (f64, &'a [(Variable, f64)]);

/// The doubts of a body of particles, from mass and position of each: those of points put together.
#[must_use]
pub fn of_particles<'a>(
    particles: impl Iterator<Item = (Vec<Number<'a>>, Vec<Number<'a>>)>,
) -> Doubt {
    let points: Vec<(Ten<f64>, Doubt)> = particles
        .map(|(mass, position)| {
            let numbers: Vec<_> = [mass, position].concat();
            let mut values = [0.0; 10];
            let mut tangents = Vec::new();
            for (place, (value, form)) in numbers.iter().enumerate() {
                values[place] = *value;
                for &(variable, step) in *form {
                    let mut change = [0.0; 10];
                    change[place] = step;
                    tangents.push((variable, Tangent::from_array(&change)));
                }
            }
            (
                Ten::from_array(&values),
                Doubt::of(tangents, [Tangent::default(); PROBES]),
            )
        })
        .collect();
    let parts: Vec<_> = points
        .iter()
        .map(|(point, doubt)| (1.0, *point, doubt))
        .collect();
    together(&parts)
}
