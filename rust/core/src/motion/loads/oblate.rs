//! The orbit about an oblate attractor.

use std::sync::{PoisonError, RwLock};

use nalgebra::Vector3;

use super::kepler::Orbit;
use crate::error::{Error, all_finite, finite};

/// The order of the series of a piece.
const ORDER: usize = 24;
/// How far series are made and kept.
const MOST_REVOLUTIONS: f64 = 3e4;
/// What the last terms of a series are at the end of its piece, relative to the distance.
const LAST: f64 = 1e-18;

/// `r̈ = −μ r/r³ − (3/2) μ J₂ R²/r⁵ ((1 − 5 s²) r + 2 (r·p) p)` with the pole p of the attractor, its radius R and `s = r·p/r`.
///
/// The motion is a chain of Taylor series, each as long as it converges well, which grows as far as it is asked for and
/// is kept: a revolution of a circle takes about ten of them.
/// Source: Vallado, Fundamentals of Astrodynamics and Applications, §8.6.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::{Oblate, kepler::Orbit};
/// use polhode::nalgebra::Vector3;
///
/// // A satellite of the earth over the poles: J₂ shortens the pull above them.
/// let (mu, j2, earth) = (3.986_004_418e14_f64, 1.082_63e-3, 6.378_137e6);
/// let r = 7e6;
/// let orbit = Orbit::new(mu, &(Vector3::x() * r), &(Vector3::z() * (mu / r).sqrt()))?;
/// let orbit = Oblate::new(&orbit, j2, earth, &Vector3::z())?;
/// assert_eq!(orbit.pole(), &Vector3::z());
/// assert!((orbit.bulge() / (j2 * earth * earth) - 1.0).abs() < 1e-15);
/// let share = orbit.bulge() / (r * r);
/// let pull = |direction: Vector3<f64>| orbit.acceleration(&(direction * r)).norm() / (mu / (r * r));
/// assert!((pull(Vector3::x()) - (1.0 + 1.5 * share)).abs() < 1e-12);
/// assert!((pull(Vector3::z()) - (1.0 - 3.0 * share)).abs() < 1e-12);
/// // A day is known; a hundred years would be too many series to keep.
/// assert!(orbit.check(86_400.0).is_ok() && orbit.check(100.0 * 3.2e7).is_err());
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Debug)]
pub struct Oblate {
    /// The Kepler orbit through the state at the epoch.
    orbit: Orbit,
    /// J₂ R², in units of its length.
    bulge: f64,
    pole: Vector3<f64>,
    /// Forward and backward from the epoch.
    tracks: [RwLock<Vec<Piece>>; 2],
}

/// A series of the position around a time; the times in the units of the orbit, the series in units of its own.
#[derive(Clone, Debug)]
struct Piece {
    from: f64,
    to: f64,
    /// The units of length and time of the series.
    length: f64,
    time: f64,
    position: [Vector3<f64>; ORDER + 1],
}

impl PartialEq for Oblate {
    fn eq(&self, other: &Self) -> bool {
        (self.orbit, self.bulge, self.pole) == (other.orbit, other.bulge, other.pole)
    }
}

impl Oblate {
    /// The orbit through the state that `orbit` has at its epoch.
    ///
    /// # Errors
    /// For numbers that are not finite, a radius that is not positive, a pole without direction.
    pub fn new(orbit: &Orbit, j2: f64, radius: f64, pole: &Vector3<f64>) -> Result<Self, Error> {
        let pole = checked_pole(j2, radius, pole)?;
        let (length, _) = orbit.units();
        let scaled = radius / length;
        let bulge = j2 * scaled * scaled;
        finite("j2 radius² over the square of the distance", bulge)?;
        Ok(Self {
            orbit: *orbit,
            bulge,
            pole,
            tracks: [RwLock::new(Vec::new()), RwLock::new(Vec::new())],
        })
    }

    /// μ.
    #[must_use]
    pub fn mu(&self) -> f64 {
        self.orbit.mu()
    }

    /// `J₂ R²`.
    #[must_use]
    pub fn bulge(&self) -> f64 {
        let (length, _) = self.orbit.units();
        self.bulge * length * length
    }

    /// The pole, a unit vector.
    #[must_use]
    pub fn pole(&self) -> &Vector3<f64> {
        &self.pole
    }

    /// The acceleration at a position.
    #[must_use]
    pub fn acceleration(&self, position: &Vector3<f64>) -> Vector3<f64> {
        let distance = position.norm();
        let n = position / distance;
        let (s, part) = (n.dot(&self.pole), 1.5 * self.bulge() / distance / distance);
        let pull = self.mu() / distance / distance;
        -(n * (1.0 + part * (1.0 - 5.0 * s * s)) + self.pole * (2.0 * part * s)) * pull
    }

    /// That its series, which are kept, are not too many until a time after the state it was given with.
    ///
    /// # Errors
    /// [`Error::OutOfDomain`] after more than 30 000 revolutions.
    pub fn check(&self, elapsed: f64) -> Result<(), Error> {
        if elapsed.abs() <= MOST_REVOLUTIONS * self.period() {
            return Ok(());
        }
        Err(Error::OutOfDomain {
            what: "the time from the epoch of an orbit about an oblate attractor",
            law: "at most 30 000 revolutions (give its state at a later epoch)",
            value: elapsed,
        })
    }

    /// About the time of a revolution, by the energy, which the bulge may make negative; infinite for an orbit without end.
    fn period(&self) -> f64 {
        let ((length, time), mu) = (self.orbit.units(), self.orbit.scaled_mu());
        let (r, v) = self.orbit.at(0.0);
        let (r, v) = (r / length, v * (time / length));
        let distance = r.norm();
        let s = r.dot(&self.pole) / distance;
        let part = 0.5 * self.bulge / distance / distance * (3.0 * s * s - 1.0);
        let bound = 2.0 * mu / distance * (1.0 - part) - v.norm_squared();
        if bound > 0.0 {
            std::f64::consts::TAU * mu / bound / bound.sqrt() * time
        } else {
            f64::INFINITY
        }
    }

    /// Position and velocity at a time after the state the orbit was given with; not numbers where it has fallen into the attractor.
    #[must_use]
    pub fn at(&self, elapsed: f64) -> (Vector3<f64>, Vector3<f64>) {
        let (length, time) = self.orbit.units();
        let t = elapsed / time;
        if t == 0.0 || !t.is_finite() {
            return self.orbit.at(elapsed);
        }
        let track = &self.tracks[usize::from(t < 0.0)];
        let known = track.read().unwrap_or_else(PoisonError::into_inner);
        let [r, v] = if let Some(state) = state(&known, t) {
            state
        } else {
            drop(known);
            let mut pieces = track.write().unwrap_or_else(PoisonError::into_inner);
            self.grow(&mut pieces, t);
            state(&pieces, t).unwrap_or([Vector3::repeat(f64::NAN); 2])
        };
        (r * length, v * (length / time))
    }

    /// Adds pieces until the time `t`.
    fn grow(&self, pieces: &mut Vec<Piece>, t: f64) {
        let mut now = if let Some(last) = pieces.last() {
            (last.to, last.at(last.to))
        } else {
            let (length, time) = self.orbit.units();
            let (r, v) = self.orbit.at(0.0);
            (0.0, [r / length, v * (time / length)])
        };
        while now.0.abs() < t.abs() {
            let piece = self.piece(now.0, now.1, t.signum());
            if piece.to == piece.from || !piece.to.is_finite() {
                return; // into the attractor
            }
            now = (piece.to, piece.at(piece.to));
            pieces.push(piece);
        }
    }

    /// The series around a state, and how long it is.
    fn piece(&self, from: f64, [r, v]: [Vector3<f64>; 2], sense: f64) -> Piece {
        // Units near its own, so that no term leaves the range of float64.
        let mu = self.orbit.scaled_mu();
        let distance = r.norm();
        let free = (distance / mu).sqrt() * distance;
        let length = distance.log2().round().exp2();
        let time = free.min(distance / v.norm()).log2().round().exp2();
        let (mu, bulge) = (
            mu / length * (time / length) * (time / length),
            self.bulge / length / length,
        );
        let k = 1.5 * mu * bulge;
        let (r, v) = (r / length, v * (time / length));
        let mut position = [Vector3::zeros(); ORDER + 1];
        (position[0], position[1]) = (r, v);
        let zero = [0.0; ORDER + 1];
        let (mut square, mut height, mut height_square) = (zero, zero, zero);
        let (mut third, mut fifth, mut seventh) = (zero, zero, zero);
        let (mut pull, mut lift) = (zero, zero);
        for n in 0..ORDER - 1 {
            square[n] = (0..=n).map(|i| position[i].dot(&position[n - i])).sum();
            height[n] = position[n].dot(&self.pole);
            height_square[n] = product(&height, &height, n);
            for (series, power) in [(&mut third, -1.5), (&mut fifth, -2.5), (&mut seventh, -3.5)] {
                series[n] = power_coefficient(&square, series, power, n);
            }
            // r̈ = −r (μ/r³ + k/r⁵ − 5k z²/r⁷) − p 2k z/r⁵.
            pull[n] = mu * third[n] + k * (fifth[n] - 5.0 * product(&height_square, &seventh, n));
            lift[n] = 2.0 * k * product(&height, &fifth, n);
            let toward: Vector3<f64> = (0..=n).map(|i| position[i] * pull[n - i]).sum();
            let acceleration = -toward - self.pole * lift[n];
            position[n + 2] = acceleration / ((n + 1) * (n + 2)) as f64;
        }
        let reach = |n: usize| (LAST * r.norm() / position[n].norm()).powf(1.0 / n as f64);
        let step = reach(ORDER).min(reach(ORDER - 1)) * time;
        Piece {
            from,
            to: from + sense * step,
            length,
            time,
            position,
        }
    }
}

impl Piece {
    /// Position and velocity at a time.
    fn at(&self, t: f64) -> [Vector3<f64>; 2] {
        let x = (t - self.from) / self.time;
        let (mut r, mut v) = (Vector3::zeros(), Vector3::zeros());
        for n in (0..=ORDER).rev() {
            v = v * x + r;
            r = r * x + self.position[n];
        }
        [r * self.length, v * (self.length / self.time)]
    }
}

/// What the torque of an oblate attractor knows of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bulge {
    /// `J₂ R²`.
    pub(super) size: f64,
    /// A unit vector.
    pub(super) pole: Vector3<f64>,
}

impl Bulge {
    /// # Errors
    /// As [`Oblate::new`].
    pub(super) fn new(j2: f64, radius: f64, pole: &Vector3<f64>) -> Result<Self, Error> {
        let pole = checked_pole(j2, radius, pole)?;
        let size = j2 * radius * radius;
        finite("j2 radius²", size)?;
        Ok(Self { size, pole })
    }
}

/// The pole as a unit vector, beside numbers that are those of an attractor.
fn checked_pole(j2: f64, radius: f64, pole: &Vector3<f64>) -> Result<Vector3<f64>, Error> {
    finite("j2", j2)?;
    finite("radius", radius)?;
    all_finite("pole", pole)?;
    if radius <= 0.0 {
        return Err(Error::OutOfDomain {
            what: "radius",
            law: "positive",
            value: radius,
        });
    }
    (pole / pole.amax())
        .try_normalize(0.0)
        .filter(|_| pole.amax() > 0.0)
        .ok_or(Error::NoDirection { what: "pole" })
}

/// The state at a time, where the pieces reach that far.
fn state(pieces: &[Piece], t: f64) -> Option<[Vector3<f64>; 2]> {
    let index = pieces.partition_point(|piece| piece.to.abs() < t.abs());
    pieces.get(index).map(|piece| piece.at(t))
}

/// Coefficient n of a product of series.
fn product(a: &[f64], b: &[f64], n: usize) -> f64 {
    (0..=n).map(|i| a[i] * b[n - i]).sum()
}

/// Coefficient n of a power of a series, from those before it.
fn power_coefficient(base: &[f64], before: &[f64], power: f64, n: usize) -> f64 {
    if n == 0 {
        return base[0].powf(power);
    }
    let sum: f64 = (1..=n)
        .map(|k| (k as f64 * power - (n - k) as f64) * base[k] * before[n - k])
        .sum();
    sum / (n as f64 * base[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn orbit() -> Orbit {
        let (r, v) = (
            Vector3::new(7.0e6, 1.0e6, -5.0e5),
            Vector3::new(-900.0, 6500.0, 4200.0),
        );
        Orbit::new(3.986_004_418e14, &r, &v).expect("an ellipse")
    }

    #[test]
    fn without_bulge_it_is_kepler_s() {
        let round = Oblate::new(&orbit(), 0.0, 6.4e6, &Vector3::z()).expect("a pole");
        for t in [1.0, 5e3, 6e5, -1e4, -3e3, 0.0] {
            let (r, v) = round.at(t);
            let (r0, v0) = orbit().at(t);
            let revolutions = 1.0 + f64::abs(t) / 6e3;
            assert!((r - r0).norm() < 2e-14 * revolutions * r0.norm(), "{t}");
            assert!((v - v0).norm() < 2e-14 * revolutions * v0.norm(), "{t}");
        }
    }

    #[test]
    fn energy_and_momentum_about_the_pole_stay() {
        let pole = Vector3::new(0.1, -0.2, 1.0).normalize();
        let (j2, radius) = (1.082_63e-3, 6.378_137e6);
        let oblate = Oblate::new(&orbit(), j2, radius, &pole).expect("a pole");
        let invariants = |t: f64| {
            let (r, v) = oblate.at(t);
            let (distance, mu) = (r.norm(), oblate.mu());
            let s = r.dot(&pole) / distance;
            let shape = 1.0 - j2 * (radius / distance).powi(2) * 0.5 * (3.0 * s * s - 1.0);
            [
                0.5 * v.norm_squared() - mu / distance * shape,
                r.cross(&v).dot(&pole),
            ]
        };
        let [energy, spin] = invariants(0.0);
        for t in [3e3, 1e5, 1e6, -2e5] {
            let [now, turns] = invariants(t);
            assert!(
                (now / energy - 1.0).abs() < 1e-12,
                "{t} {}",
                now / energy - 1.0
            );
            assert!((turns / spin - 1.0).abs() < 1e-12, "{t}");
        }
        // The same whatever was asked before.
        let again = Oblate::new(&orbit(), j2, radius, &pole).expect("a pole");
        assert_eq!(again.at(1e5), oblate.at(1e5));
    }

    /// A revolution takes `2π μ/(−2E)^{3/2}`, E the energy with the term of J₂ in it.
    #[test]
    fn the_limit_is_in_revolutions_by_the_energy() {
        let (mu, distance, speed, j2, radius) = (4.0, 2.0, 1.2, 0.3, 1.5);
        for sine in [0.0, 0.5, 1.0_f64] {
            let place = Vector3::new((1.0 - sine * sine).sqrt(), 0.0, sine) * distance;
            let orbit = Orbit::new(mu, &place, &Vector3::new(0.0, speed, 0.0)).expect("an ellipse");
            let oblate = Oblate::new(&orbit, j2, radius, &Vector3::z()).expect("a pole");
            let legendre = 0.5 * (3.0 * sine * sine - 1.0);
            let shape = 1.0 - j2 * f64::powi(radius / distance, 2) * legendre;
            let energy = 0.5 * speed * speed - mu / distance * shape;
            let revolution = std::f64::consts::TAU * mu / (-2.0 * energy).powf(1.5);
            for sense in [1.0, -1.0] {
                assert!(
                    oblate.check(sense * 29_999.0 * revolution).is_ok(),
                    "{sine}"
                );
                assert!(
                    oblate.check(sense * 30_001.0 * revolution).is_err(),
                    "{sine}"
                );
            }
        }
    }
}
