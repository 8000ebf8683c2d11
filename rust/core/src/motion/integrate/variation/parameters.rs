//! The variables: which derivatives there are, and in which order.

use crate::motion::loads::Term;

/// The columns of a small rotation at the start, of ω at the start.
pub(super) const ATTITUDE: usize = 0;
pub(super) const RATES: usize = 3;
/// Of the principal moments, ascending, and of the elements 23, 31, 12 of the tensor in principal axes.
pub(super) const MOMENTS: usize = 6;
pub(super) const PRODUCTS: usize = 9;
/// Of the centre of mass and of the mass.
pub(super) const CENTER: usize = 12;
pub(super) const MASS: usize = 15;
/// Of the numbers of the load, term by term.
pub(super) const LOAD: usize = 16;

/// Numbers of a term of a load, under the name and with the shape that they have where the term is made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// The name.
    pub name: &'static str,
    /// How many in each direction; in C order.
    pub shape: Vec<usize>,
}

impl Parameter {
    /// How many numbers they are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.shape.iter().product()
    }
}

/// The numbers of a term.
///
/// A target of a feedback has three: a small rotation of it, `R → R exp(δ×)`. Numbers that were multiplied by a factor are those
/// after it; that of a gravity gradient stays as it is.
#[must_use]
pub fn parameters(term: &Term) -> Vec<Parameter> {
    let list = |parts: &[(&'static str, &[usize])]| {
        let part = |&(name, shape): &(&'static str, &[usize])| Parameter {
            name,
            shape: shape.to_vec(),
        };
        parts.iter().map(part).collect()
    };
    match term {
        Term::ConstantTorque { .. } | Term::ConstantForce { point: None, .. } => {
            list(&[("vector", &[3])])
        }
        Term::ConstantForce { .. } => list(&[("vector", &[3]), ("point", &[3])]),
        Term::UniformGravity { .. } => list(&[("gravity", &[3])]),
        Term::GravityGradient(_) => list(&[("mu", &[]), ("position", &[3]), ("velocity", &[3])]),
        Term::Damping(_) => list(&[("matrix", &[3, 3]), ("quadratic", &[3, 3])]),
        Term::Sampled(sampled) => list(&[("torque", &[sampled.knots().len(), 3])]),
        Term::Feedback(_) => list(&[("K", &[3, 3]), ("D", &[3, 3]), ("target", &[3])]),
        Term::Scheduled { term, .. } => parameters(term),
    }
}

/// How many numbers a term has.
pub(super) fn count(term: &Term) -> usize {
    parameters(term).iter().map(Parameter::count).sum()
}
