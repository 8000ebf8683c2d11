//! The particles of one body: what they must be, and a point near them all.

use std::hint::select_unpredictable;

use nalgebra::Vector3;

use crate::error::{BodyFault, Error, finite, finite_of_body};

/// How many particles are asked for the point that the sums are taken about.
const SAMPLE: usize = 16;

/// The particles of one body.
#[derive(Clone, Copy, Debug)]
pub struct Particles<'a> {
    pub(crate) masses: &'a [f64],
    pub(crate) positions: &'a [[f64; 3]],
}

impl<'a> Particles<'a> {
    /// A mass for each position.
    ///
    /// # Panics
    /// When the slices differ in length.
    #[must_use]
    pub fn new(masses: &'a [f64], positions: &'a [[f64; 3]]) -> Self {
        assert_eq!(masses.len(), positions.len(), "one position for each mass");
        Self { masses, positions }
    }
}

/// The first particle that cannot be, where there is one.
pub(in crate::mass) fn check(Particles { masses, positions }: Particles<'_>) -> Result<(), Error> {
    for (index, (&mass, position)) in masses.iter().zip(positions).enumerate() {
        finite_of_body("masses", mass)?;
        if mass < 0.0 {
            return Err(BodyFault::NegativeMass { index, mass }.into());
        }
        for &x in position {
            finite("positions", x)?;
        }
    }
    let mass = masses.iter().fold(0.0, |sum, mass| sum + mass);
    if mass > 0.0 {
        Ok(())
    } else {
        Err(BodyFault::NoMass {
            count: masses.len(),
            mass,
        }
        .into())
    }
}

/// The centre of mass of a few particles spread over the list, of all when they are few: a point within or near the body,
/// so that nothing cancels wherever the body stands.
pub(in crate::mass) fn sample_center(
    Particles { masses, positions }: Particles<'_>,
) -> Vector3<f64> {
    let (count, stride) = (masses.len(), masses.len().div_ceil(SAMPLE).max(1));
    // From the heaviest of them, so that nothing cancels where another one is far away.
    let Some(base) = heaviest(masses, stride).or_else(|| heaviest(masses, 1)) else {
        return Vector3::zeros();
    };
    let base = Vector3::from(positions[base]);
    let (mut mass, mut first) = (0.0, Vector3::zeros());
    let mut i = 0;
    while i < count {
        mass += masses[i];
        first += (Vector3::from(positions[i]) - base) * masses[i];
        i += stride;
    }
    let center = base + first / mass;
    if center.iter().all(|x| x.is_finite()) {
        center
    } else {
        base
    }
}

/// Which of every `stride`-th mass is the largest, the last one of several; `None` where none is positive.
fn heaviest(masses: &[f64], stride: usize) -> Option<usize> {
    let (mut most, mut place) = (0.0, 0);
    let mut i = 0;
    while i < masses.len() {
        // Nobody can predict which one is heavier: a choice without a branch.
        place = select_unpredictable(masses[i] >= most, i, place);
        most = if masses[i] > most { masses[i] } else { most };
        i += stride;
    }
    (most > 0.0).then_some(place)
}
