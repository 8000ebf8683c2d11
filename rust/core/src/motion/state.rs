//! The state of motion of a rigid body, and motions whose state is known at any time.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::error::{Error, MotionFault};
use crate::numerics::threads::{Halt, fill_blocks};

/// Attitude `R_NB` and angular velocity of B relative to N, components in B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// `q_NB`.
    pub attitude: UnitQuaternion<f64>,
    /// ω.
    pub omega: Vector3<f64>,
}

impl State {
    /// What stands where nothing was computed.
    #[must_use]
    #[inline]
    pub fn nan() -> Self {
        let nan = f64::NAN;
        Self {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(nan, nan, nan, nan)),
            omega: Vector3::repeat(nan),
        }
    }
}

/// All six degrees of freedom and their rates: a point of phase space. Beside them the states of what the body carries.
///
/// # Examples
///
/// ```
/// use polhode::motion::state::{Phase, State};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// let state = State { attitude: UnitQuaternion::identity(), omega: Vector3::new(0.0, 0.0, 3.0) };
/// let phase = Phase::in_place(&state);
/// assert!(phase.is_finite() && phase.position == Vector3::zeros());
/// assert_eq!(phase.state(), state);
/// // What stands where nothing was computed.
/// assert!(!Phase::nan().is_finite() && State::nan().omega.x.is_nan());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// `q_NB`.
    pub attitude: UnitQuaternion<f64>,
    /// ω of B relative to N, components in B.
    pub omega: Vector3<f64>,
    /// Of the reference point, in N.
    pub position: Vector3<f64>,
    /// Of the reference point, in N.
    pub velocity: Vector3<f64>,
    /// The states that the load has of its own, those of its parts one after the other; empty for most loads.
    pub internal_state: Box<[f64]>,
}

impl Phase {
    /// A body that turns in place: the reference point at rest at the origin of N.
    #[must_use]
    #[inline]
    pub fn in_place(state: &State) -> Self {
        Self {
            attitude: state.attitude,
            omega: state.omega,
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
            internal_state: Box::default(),
        }
    }

    /// The part that turns.
    #[must_use]
    #[inline]
    pub fn state(&self) -> State {
        State {
            attitude: self.attitude,
            omega: self.omega,
        }
    }

    /// What stands where nothing was computed.
    #[must_use]
    #[inline]
    pub fn nan() -> Self {
        let unknown = Vector3::repeat(f64::NAN);
        Self {
            position: unknown,
            velocity: unknown,
            ..Self::in_place(&State::nan())
        }
    }

    /// The numbers of the body, without those that the load has of its own, in the order x, y, z, w of the quaternion, ω, position, velocity.
    #[must_use]
    #[inline]
    pub fn numbers(&self) -> [f64; 13] {
        let (q, w, r, v) = (self.attitude, self.omega, self.position, self.velocity);
        [
            q.i, q.j, q.k, q.w, w.x, w.y, w.z, r.x, r.y, r.z, v.x, v.y, v.z,
        ]
    }

    /// Whether all its numbers are.
    #[must_use]
    #[inline]
    pub fn is_finite(&self) -> bool {
        (self.numbers().iter())
            .chain(&self.internal_state)
            .all(|x| x.is_finite())
    }
}

/// A motion in closed form: its state at any time costs the same.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::free::FreeMotion;
/// use polhode::motion::state::{ClosedForm, sample_many};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// // A box thrown with a hundred different spins, each at two times, on all cores.
/// let body = solids::cuboid(&[0.3, 0.2, 0.1], Amount::Mass(1.0))?;
/// let thrown = |k: i32| FreeMotion::of(&body, &Vector3::new(f64::from(k), 5.0, 0.0), &UnitQuaternion::identity());
/// let motions = (0..100).map(thrown).collect::<Result<Vec<_>, _>>()?;
/// let times = [0.0, 1.5];
/// let (mut attitudes, mut omegas) = (vec![[0.0; 4]; 200], vec![[0.0; 3]; 200]);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// sample_many(&motions, &times, &mut attitudes, &mut omegas, go_on).unwrap();
/// assert_eq!(omegas[2 * 7 + 1], <[f64; 3]>::from(motions[7].at(1.5).omega));
/// assert!(motions[7].reach() > 1e20);
/// # Ok::<(), polhode::Error>(())
/// ```
pub trait ClosedForm: Sync {
    /// The largest |t| at which the state is known: what multiplies the time is, to 2⁻⁹⁰ of itself. Beyond, states are NaN.
    fn reach(&self) -> f64;

    /// That |t| is within [`reach`](Self::reach), or not finite, which has no state.
    ///
    /// # Errors
    /// [`MotionFault::BeyondReach`].
    #[inline]
    fn reaches(&self, t: f64) -> Result<(), Error> {
        let reach = self.reach();
        if t.is_finite() && t.abs() > reach {
            return Err(MotionFault::BeyondReach { t, reach }.into());
        }
        Ok(())
    }

    /// Attitudes as (x, y, z, w) and ω at many times, on the calling thread; one of each for every time.
    fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]);
}

/// The states of many motions at many times, all times of the first motion first, on several threads when there are many;
/// quaternions as (x, y, z, w). Each state has the bits of [`ClosedForm::sample`].
///
/// About every 20 ms `watch` gets the fraction done; [`ControlFlow::Break`] ends the job.
///
/// # Errors
/// [`Halt::Stopped`] if `watch` said so; the states are then unspecified.
///
/// # Panics
/// If the number of attitudes or of angular velocities is not that of motions times that of times.
pub fn sample_many<M: ClosedForm>(
    motions: &[M],
    times: &[f64],
    attitudes: &mut [[f64; 4]],
    omegas: &mut [[f64; 3]],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(), Halt<Infallible>> {
    let count = motions.len() * times.len();
    assert_eq!(
        attitudes.len(),
        count,
        "an attitude for each motion and time"
    );
    assert_eq!(
        omegas.len(),
        count,
        "an angular velocity for each motion and time"
    );
    let mut blocks: Vec<_> = attitudes
        .chunks_mut(BLOCK)
        .zip(omegas.chunks_mut(BLOCK))
        .collect();
    fill_blocks(&mut blocks, 1, watch, |block, states| {
        for (attitudes, omegas) in states {
            let (mut at, mut done) = (block * BLOCK, 0);
            while done < attitudes.len() {
                let (row, first) = (at / times.len(), at % times.len());
                let span = (times.len() - first).min(attitudes.len() - done);
                motions[row].sample(
                    &times[first..first + span],
                    &mut attitudes[done..done + span],
                    &mut omegas[done..done + span],
                );
                at += span;
                done += span;
            }
        }
        Ok(())
    })
}

/// States that one thread computes at a time.
const BLOCK: usize = 4096;
