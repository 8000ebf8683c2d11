//! The state of motion of a rigid body.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

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
    /// The internal states of the load, those of its parts one after the other; empty for most loads.
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

    /// The numbers of the body, without the internal states of the load, in the order x, y, z, w of the quaternion, ω, position, velocity.
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
