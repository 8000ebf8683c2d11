//! A density in a unit of its own, its values possible ones.

use crate::error::{BodyFault, Error};
use crate::numerics::power_of_two::{exponent, halves};

/// A density in units of the first one found, a power of two.
pub(super) struct Scaled<F> {
    density: F,
    pub(super) power: i32,
    is_known: bool,
}

impl<F> Scaled<F> {
    pub(super) fn of(density: F) -> Self {
        Self {
            density,
            power: 0,
            is_known: false,
        }
    }

    /// The densities at these points, possible ones.
    pub(super) fn at<P, E>(
        &mut self,
        points: &[P],
        place: impl Fn(&P) -> [f64; 3],
    ) -> Result<Vec<f64>, E>
    where
        E: From<Error>,
        F: FnMut(&[P], &mut [f64]) -> Result<(), E>,
    {
        let mut densities = vec![0.0; points.len()];
        (self.density)(points, &mut densities)?;
        for (point, &value) in points.iter().zip(&densities) {
            if !(value.is_finite() && value >= 0.0) {
                let point = place(point);
                return Err(Error::from(BodyFault::ImpossibleDensity { point, value }).into());
            }
        }
        let densest = densities.iter().fold(0.0, |most: f64, &rho| most.max(rho));
        if !self.is_known && densest > 0.0 {
            (self.power, self.is_known) = (exponent(densest), true);
        }
        let [a, b] = halves(-self.power);
        for density in &mut densities {
            *density = *density * a * b;
        }
        Ok(densities)
    }
}
