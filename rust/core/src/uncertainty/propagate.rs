//! How doubts follow through a function of bodies and numbers.

use super::doubt::{Doubt, Tangent};
use super::given::Form;
use super::variable::{PROBES, Variable};
use crate::error::Error;
use crate::mass::ten::{Size, Ten};
use crate::numerics::jet::Jet;
use crate::numerics::parabola::Parabola;

/// A function of bodies and numbers whose value is a body, written once for plain numbers and for numbers with derivatives.
pub trait Change {
    /// Its value.
    ///
    /// # Errors
    /// When a number is outside its domain.
    fn of<X: Size<Body = Ten<X>>>(&self, bodies: &[Ten<X>], numbers: &[X])
    -> Result<Ten<X>, Error>;
}

/// What goes into such a function: bodies and numbers, each with its doubts.
#[derive(Clone, Copy, Debug)]
pub struct Follow<'a> {
    /// Bodies.
    pub bodies: &'a [(Ten<f64>, &'a Doubt)],
    /// Numbers.
    pub numbers: &'a [(f64, &'a [(Variable, f64)])],
}

/// Variables whose derivatives are found at a time.
const ABREAST: usize = 8;

/// The doubts of the body that `change` makes.
///
/// # Errors
/// Those of `change`.
pub fn follow(change: &impl Change, from: Follow<'_>) -> Result<Doubt, Error> {
    follow_any(change, &from)
}

/// A [`Change`] of the two kinds of numbers that doubts need: what is done with them is compiled once for all changes.
trait AnyChange {
    fn of_jets(
        &self,
        bodies: &[Ten<Jet<ABREAST>>],
        numbers: &[Jet<ABREAST>],
    ) -> Result<Ten<Jet<ABREAST>>, Error>;

    fn of_parabolas(
        &self,
        bodies: &[Ten<Parabola>],
        numbers: &[Parabola],
    ) -> Result<Ten<Parabola>, Error>;
}

impl<C: Change> AnyChange for C {
    fn of_jets(
        &self,
        bodies: &[Ten<Jet<ABREAST>>],
        numbers: &[Jet<ABREAST>],
    ) -> Result<Ten<Jet<ABREAST>>, Error> {
        self.of(bodies, numbers)
    }

    fn of_parabolas(
        &self,
        bodies: &[Ten<Parabola>],
        numbers: &[Parabola],
    ) -> Result<Ten<Parabola>, Error> {
        self.of(bodies, numbers)
    }
}

fn follow_any(change: &dyn AnyChange, from: &Follow<'_>) -> Result<Doubt, Error> {
    let mut variables: Vec<Variable> = (from.bodies.iter())
        .flat_map(|(_, doubt)| doubt.tangents.iter().map(|(variable, _)| *variable))
        .chain(
            from.numbers
                .iter()
                .flat_map(|(_, form)| form.iter().map(|(variable, _)| *variable)),
        )
        .collect();
    variables.sort_unstable();
    variables.dedup();
    let mut tangents = Vec::with_capacity(variables.len());
    for some in variables.chunks(ABREAST) {
        let found = change.of_jets(&bodies_along(from, some), &numbers_along(from, some))?;
        for (k, variable) in some.iter().enumerate() {
            tangents.push((*variable, found.map(|number| number.slopes[k])));
        }
    }
    Ok(Doubt {
        tangents,
        bends: bends(change, from)?,
    })
}

/// The bodies with their derivatives by some of the variables.
fn bodies_along(from: &Follow<'_>, some: &[Variable]) -> Vec<Ten<Jet<ABREAST>>> {
    let along = |(numbers, doubt): &(Ten<f64>, &Doubt)| {
        let mut jets = numbers.map(Jet::constant).to_array();
        for (variable, tangent) in &doubt.tangents {
            if let Ok(k) = some.binary_search(variable) {
                for (jet, slope) in jets.iter_mut().zip(tangent.to_array()) {
                    jet.slopes[k] = slope;
                }
            }
        }
        Ten::from_array(&jets)
    };
    from.bodies.iter().map(along).collect()
}

/// The numbers with theirs.
fn numbers_along(from: &Follow<'_>, some: &[Variable]) -> Vec<Jet<ABREAST>> {
    let along = |(value, form): &(f64, &[(Variable, f64)])| {
        let mut jet = Jet::constant(*value);
        for (variable, step) in *form {
            if let Ok(k) = some.binary_search(variable) {
                jet.slopes[k] = *step;
            }
        }
        jet
    };
    from.numbers.iter().map(along).collect()
}

/// The second-order terms along the probes.
fn bends(change: &dyn AnyChange, from: &Follow<'_>) -> Result<[Tangent; PROBES], Error> {
    let bodies: Vec<_> = from
        .bodies
        .iter()
        .map(|(numbers, doubt)| doubt.probes(numbers))
        .collect();
    let numbers: Vec<_> = from
        .numbers
        .iter()
        .map(|&(value, form)| line(value, form))
        .collect();
    let mut bends = [Tangent::default(); PROBES];
    for (probe, bend) in bends.iter_mut().enumerate() {
        let bodies: Vec<_> = bodies.iter().map(|body| body[probe]).collect();
        let numbers: Vec<_> = numbers.iter().map(|number| number[probe]).collect();
        *bend = change
            .of_parabolas(&bodies, &numbers)?
            .map(|number| number.bend);
    }
    Ok(bends)
}

/// A number with doubts along each probe: they are linear in the variables.
#[must_use]
pub(crate) fn line(value: f64, form: &[(Variable, f64)]) -> [Parabola; PROBES] {
    let mut along = [Parabola::constant(value); PROBES];
    for (variable, step) in form {
        for (number, length) in along.iter_mut().zip(variable.steps()) {
            number.slope += step * length;
        }
    }
    along
}

/// A form as doubts of a single one of the ten numbers, or of several by one form each: of a body that is given by them.
///
/// # Examples
///
/// ```
/// use polhode::uncertainty::follow::directly;
/// use polhode::uncertainty::{Form, Source};
///
/// // The mass alone has a deviation, of 1 %.
/// let scales = Source::named("scales").variable(0);
/// let mut forms: [Form; 10] = Default::default();
/// forms[0] = vec![(scales, 0.01)];
/// let doubt = directly(&forms);
/// assert_eq!(doubt.tangents[0].1.mass, 0.01);
/// ```
#[must_use]
pub fn directly(forms: &[Form; 10]) -> Doubt {
    let tangents = (forms.iter().enumerate())
        .flat_map(|(place, form)| {
            form.iter().map(move |&(variable, step)| {
                let mut numbers = [0.0; 10];
                numbers[place] = step;
                (variable, Tangent::from_array(&numbers))
            })
        })
        .collect();
    Doubt::of(tangents, [Tangent::default(); PROBES])
}
