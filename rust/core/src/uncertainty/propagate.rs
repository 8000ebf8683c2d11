//! How uncertainties follow through a function of bodies and numbers.

use super::linear_forms::Form;
use super::linear_uncertainty::{LinearUncertainty, Tangent};
use super::variable::{PROBES, Variable};
use crate::error::Error;
use crate::mass::inertial_parameters::{InertialParameters, Size};
use crate::numerics::jet::Jet;
use crate::numerics::second_order_dual::SecondOrderDual;

/// A function of bodies and numbers whose value is a body, written once for plain numbers and for numbers with derivatives.
pub trait BodyFunction {
    /// Its value.
    ///
    /// # Errors
    /// When a number is outside its domain.
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        bodies: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error>;
}

/// What goes into such a function: bodies and numbers, each with its uncertainties.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// Bodies.
    pub bodies: &'a [(InertialParameters<f64>, &'a LinearUncertainty)],
    /// Numbers.
    pub numbers: &'a [(f64, &'a [(Variable, f64)])],
}

/// Variables whose derivatives are found at a time.
const ABREAST: usize = 8;

/// The uncertainties of the body that `change` makes.
///
/// # Errors
/// Those of `change`.
pub fn propagate(change: &impl BodyFunction, from: Inputs<'_>) -> Result<LinearUncertainty, Error> {
    propagate_any(change, &from)
}

/// A [`BodyFunction`] of the two kinds of numbers that uncertainties need: what is done with them is compiled once for all changes.
trait AnyBodyFunction {
    fn of_jets(
        &self,
        bodies: &[InertialParameters<Jet<ABREAST>>],
        numbers: &[Jet<ABREAST>],
    ) -> Result<InertialParameters<Jet<ABREAST>>, Error>;

    fn of_duals(
        &self,
        bodies: &[InertialParameters<SecondOrderDual>],
        numbers: &[SecondOrderDual],
    ) -> Result<InertialParameters<SecondOrderDual>, Error>;
}

impl<C: BodyFunction> AnyBodyFunction for C {
    fn of_jets(
        &self,
        bodies: &[InertialParameters<Jet<ABREAST>>],
        numbers: &[Jet<ABREAST>],
    ) -> Result<InertialParameters<Jet<ABREAST>>, Error> {
        self.of(bodies, numbers)
    }

    fn of_duals(
        &self,
        bodies: &[InertialParameters<SecondOrderDual>],
        numbers: &[SecondOrderDual],
    ) -> Result<InertialParameters<SecondOrderDual>, Error> {
        self.of(bodies, numbers)
    }
}

fn propagate_any(
    change: &dyn AnyBodyFunction,
    from: &Inputs<'_>,
) -> Result<LinearUncertainty, Error> {
    let mut variables: Vec<Variable> = (from.bodies.iter())
        .flat_map(|(_, uncertainty)| uncertainty.tangents.iter().map(|(variable, _)| *variable))
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
    Ok(LinearUncertainty {
        tangents,
        second_order: second_order_terms(change, from)?,
    })
}

/// The bodies with their derivatives by some of the variables.
fn bodies_along(from: &Inputs<'_>, some: &[Variable]) -> Vec<InertialParameters<Jet<ABREAST>>> {
    let along = |(numbers, uncertainty): &(InertialParameters<f64>, &LinearUncertainty)| {
        let mut jets = numbers.map(Jet::constant).to_array();
        for (variable, tangent) in &uncertainty.tangents {
            if let Ok(k) = some.binary_search(variable) {
                for (jet, slope) in jets.iter_mut().zip(tangent.to_array()) {
                    jet.slopes[k] = slope;
                }
            }
        }
        InertialParameters::from_array(&jets)
    };
    from.bodies.iter().map(along).collect()
}

/// The numbers with theirs.
fn numbers_along(from: &Inputs<'_>, some: &[Variable]) -> Vec<Jet<ABREAST>> {
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
fn second_order_terms(
    change: &dyn AnyBodyFunction,
    from: &Inputs<'_>,
) -> Result<[Tangent; PROBES], Error> {
    let bodies: Vec<_> = from
        .bodies
        .iter()
        .map(|(numbers, uncertainty)| uncertainty.probes(numbers))
        .collect();
    let numbers: Vec<_> = from
        .numbers
        .iter()
        .map(|&(value, form)| line(value, form))
        .collect();
    let mut second_order = [Tangent::default(); PROBES];
    for (probe, curvature) in second_order.iter_mut().enumerate() {
        let bodies: Vec<_> = bodies.iter().map(|body| body[probe]).collect();
        let numbers: Vec<_> = numbers.iter().map(|number| number[probe]).collect();
        *curvature = change
            .of_duals(&bodies, &numbers)?
            .map(|number| number.curvature);
    }
    Ok(second_order)
}

/// A number with uncertainties along each probe: they are linear in the variables.
#[must_use]
pub(crate) fn line(value: f64, form: &[(Variable, f64)]) -> [SecondOrderDual; PROBES] {
    let mut along = [SecondOrderDual::constant(value); PROBES];
    for (variable, step) in form {
        for (number, length) in along.iter_mut().zip(variable.steps()) {
            number.slope += step * length;
        }
    }
    along
}

/// A form as uncertainties of a single one of the ten numbers, or of several by one form each: of a body that is given by them.
///
/// # Examples
///
/// ```
/// use polhode::uncertainty::propagate::directly;
/// use polhode::uncertainty::{Form, Source};
///
/// // The mass alone has a deviation, of 1 %.
/// let scales = Source::named("scales").variable(0);
/// let mut forms: [Form; 10] = Default::default();
/// forms[0] = vec![(scales, 0.01)];
/// let uncertainty = directly(&forms);
/// assert_eq!(uncertainty.tangents[0].1.mass, 0.01);
/// ```
#[must_use]
pub fn directly(forms: &[Form; 10]) -> LinearUncertainty {
    let tangents = (forms.iter().enumerate())
        .flat_map(|(place, form)| {
            form.iter().map(move |&(variable, step)| {
                let mut numbers = [0.0; 10];
                numbers[place] = step;
                (variable, Tangent::from_array(&numbers))
            })
        })
        .collect();
    LinearUncertainty::of(tangents, [Tangent::default(); PROBES])
}
