//! The periods of a gyrostat: of its motion, or of a steady rotation and of the oscillations about it.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::internal_momentum::Gyrostat;
use super::mode::Mode;
use super::motion::GyrostatMotion;
use crate::error::Error;
use crate::motion::free::Periods;
use crate::numerics::power_of_two::{exponent, times_power_of_two};

impl GyrostatMotion {
    /// The periods of the motion, which is one of `gyrostat`: of a steady rotation `turn`, and `wobble` if it is stable; of
    /// any other motion `rotation`. The mean rates about L are known but for whole turns: they and `precession` are NaN.
    ///
    /// At L = 0 the body turns with a small L at rest in space, which in the body goes round once a turn.
    ///
    /// # Errors
    /// Those of [`Gyrostat::equilibria`], for a steady rotation.
    ///
    /// ```
    /// use polhode::RigidBody;
    /// use polhode::motion::gyrostat::{Gyrostat, InternalMomentum};
    /// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
    ///
    /// let body = RigidBody::from_principal(1.0, &[1.0, 2.0, 2.5], &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
    /// let gyrostat = Gyrostat::of(&body, &InternalMomentum::of(&Vector3::new(0.0, 3.0, 0.0))?)?;
    /// let motion = gyrostat.free_motion(&Vector3::y(), &UnitQuaternion::identity())?;
    /// let periods = motion.periods(&gyrostat)?;
    /// assert!((periods.turn - std::f64::consts::TAU).abs() < 1e-15);
    /// assert!(periods.wobble > 0.0 && periods.rotation.is_nan()); // stable: the momentum inside is large
    /// # Ok::<(), polhode::Error>(())
    /// ```
    pub fn periods(&self, gyrostat: &Gyrostat) -> Result<Periods, Error> {
        if self.mode != Mode::Steady {
            return Ok(Periods {
                rotation: self.period.rounded(),
                ..Periods::NONE
            });
        }
        let size = |vector: &Vector3<f64>| {
            let unit = exponent(vector.amax());
            times_power_of_two(vector.map(|x| times_power_of_two(x, -unit)).norm(), unit)
        };
        let rate = size(&self.initial.omega);
        let along = self.angular_momentum_in_body();
        let momentum = size(&along);
        let squared = if momentum > 0.0 {
            let unit = along / along.amax();
            let near = |direction: &[f64; 3]| Vector3::from(*direction).dot(&unit);
            let found = gyrostat.equilibria(momentum, &self.initial.omega)?.found;
            (found.iter())
                .max_by(|x, y| near(&x.direction).total_cmp(&near(&y.direction)))
                .map_or(f64::NAN, |here| here.squared_rate)
        } else {
            rate * rate
        };
        Ok(Periods {
            turn: TAU / rate,
            wobble: if squared > 0.0 {
                TAU / squared.sqrt()
            } else {
                f64::NAN
            },
            ..Periods::NONE
        })
    }
}
