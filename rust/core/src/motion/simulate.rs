//! The motion of a body under a load, sampled at the times asked for.

use nalgebra::{Quaternion, SVector, UnitQuaternion, Vector3};
use std::ops::ControlFlow;

use super::attitude::{from_axes, rate};
use super::euler_equations::EulerEquations;
use super::integrate::{Compensated, Dop853, System};
use super::loads::Torque;
use crate::error::{Error, all_finite, finite};

/// The tightest relative tolerance that float64 can serve.
pub const TIGHTEST: f64 = 10.0 * f64::EPSILON;

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
    pub fn nan() -> Self {
        let nan = f64::NAN;
        Self {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(nan, nan, nan, nan)),
            omega: Vector3::repeat(nan),
        }
    }
}

/// How accurate each step is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of the attitude in radians (half), and of ω relative to the largest |ω| so far.
    pub relative: f64,
    /// Of ω, added to the relative one.
    pub absolute: f64,
}

impl Tolerance {
    /// Checked tolerances.
    ///
    /// # Errors
    /// When `relative` is not within [`TIGHTEST`]..0.1 or `absolute` is negative.
    pub fn new(relative: f64, absolute: f64) -> Result<Self, Error> {
        finite("rtol", relative)?;
        finite("atol", absolute)?;
        if !(TIGHTEST..=0.1).contains(&relative) {
            let law = "between 2.3e-15 (ten units of rounding) and 0.1";
            return Err(Error::OutOfDomain {
                what: "rtol",
                law,
                value: relative,
            });
        }
        if absolute < 0.0 {
            return Err(Error::OutOfDomain {
                what: "atol",
                law: "zero or more",
                value: absolute,
            });
        }
        Ok(Self { relative, absolute })
    }
}

/// What an integration took.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Accepted steps.
    pub steps: u64,
    /// Evaluations of the equations of motion.
    pub evaluations: u64,
}

/// Where and why an integration ended early.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure<E> {
    /// The time that was reached.
    pub time: f64,
    /// The state at that time.
    pub state: State,
    /// Why.
    pub cause: Cause<E>,
}

/// Why an integration ended early.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause<E> {
    /// The watch asked for it.
    Stopped,
    /// The equations or the load failed.
    Failed(E),
}

/// Checks the output times of a simulation.
///
/// # Errors
/// When there is none, one is not finite, or they do not run strictly in one direction.
pub fn check_times(times: &[f64]) -> Result<(), Error> {
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else {
        return Err(Error::Empty { what: "t" });
    };
    all_finite("t", times)?;
    finite("the span of t", last - first)?;
    for (k, pair) in times.windows(2).enumerate() {
        let forward = if last > first {
            pair[1] > pair[0]
        } else {
            pair[1] < pair[0]
        };
        if !forward {
            return Err(Error::NotMonotone {
                index: k + 1,
                previous: pair[0],
                next: pair[1],
            });
        }
    }
    Ok(())
}

/// Solves `q̇ = ½ q∘ω`, `I ω̇ + ω×Iω = N` from `initial` at `times[0]` by DOP853, into one sample a time.
///
/// The state is integrated in principal axes with compensated increments, its quaternion put back to unit length after
/// each step. Samples between steps come from the dense output. `watch` is called with the fraction done after
/// each step and may stop the run. What was computed before a failure is in `samples`; the rest is left as it was.
///
/// # Errors
/// [`Failure`] with time, state and cause.
///
/// # Panics
/// When `samples` and `times` differ in length or there are no times; see [`check_times`].
pub fn simulate<T: Torque>(
    equations: &EulerEquations,
    initial: &State,
    times: &[f64],
    torque: &mut T,
    tolerance: Tolerance,
    samples: &mut [State],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Effort, Failure<T::Error>> {
    assert_eq!(samples.len(), times.len(), "one sample for each time");
    samples[0] = *initial;
    let (start, end) = (times[0], times[times.len() - 1]);
    if start == end {
        return Ok(Effort {
            steps: 0,
            evaluations: 0,
        });
    }
    let frame = Frame::of(equations);
    let mut motion = Motion {
        equations,
        frame,
        torque,
        tolerance,
        fastest: 0.0,
    };
    let fail = |time, state, cause| Failure { time, state, cause };
    let mut stepper = Dop853::new(&mut motion, start, end, frame.to_principal(initial))
        .map_err(|error| fail(start, *initial, Cause::Failed(error)))?;
    let mut next = 1;
    while !stepper.is_finished() {
        let now = |stepper: &Dop853<7>| (start + stepper.elapsed(), frame.to_body(stepper.state()));
        if let Err(error) = stepper.advance(&mut motion) {
            let (time, state) = now(&stepper);
            return Err(fail(time, state, Cause::Failed(error)));
        }
        let reached = stepper.elapsed();
        let within = |k: usize| k < times.len() && (times[k] - start).abs() < reached.abs();
        if within(next) {
            let dense = stepper.dense(&mut motion).map_err(|error| {
                let (time, state) = now(&stepper);
                fail(time, state, Cause::Failed(error))
            })?;
            while within(next) {
                samples[next] = frame.to_body(&dense.at(times[next] - start));
                next += 1;
            }
        }
        if next < times.len() && times[next] - start == reached {
            samples[next] = frame.to_body(stepper.state());
            next += 1;
        }
        if watch(reached / (end - start)).is_break() {
            let (time, state) = now(&stepper);
            return Err(fail(time, state, Cause::Stopped));
        }
    }
    Ok(Effort {
        steps: stepper.steps,
        evaluations: stepper.evaluations,
    })
}

/// The state of integration: (x, y, z, w) of `q_NP` and ω in P, P the principal axes.
type Y = SVector<f64, 7>;

/// The principal axes P as seen from B.
#[derive(Clone, Copy)]
struct Frame {
    q_bp: UnitQuaternion<f64>,
    axes: nalgebra::Matrix3<f64>,
}

impl Frame {
    fn of(equations: &EulerEquations) -> Self {
        Self {
            q_bp: from_axes(equations.axes()),
            axes: *equations.axes(),
        }
    }

    fn to_principal(self, state: &State) -> Y {
        let q = (state.attitude * self.q_bp).into_inner();
        let w = self.axes.tr_mul(&state.omega);
        Y::from([q.i, q.j, q.k, q.w, w.x, w.y, w.z])
    }

    fn to_body(self, y: &Y) -> State {
        State {
            attitude: UnitQuaternion::new_normalize(
                quaternion(y) * self.q_bp.conjugate().into_inner(),
            ),
            omega: self.axes * omega(y),
        }
    }
}

fn quaternion(y: &Y) -> Quaternion<f64> {
    Quaternion::new(y[3], y[0], y[1], y[2])
}

fn omega(y: &Y) -> Vector3<f64> {
    Vector3::new(y[4], y[5], y[6])
}

/// The equations of motion in principal axes.
struct Motion<'a, T> {
    equations: &'a EulerEquations,
    frame: Frame,
    torque: &'a mut T,
    tolerance: Tolerance,
    /// The largest |ω| of an accepted state so far.
    fastest: f64,
}

impl<T: Torque> System<7> for Motion<'_, T> {
    type Error = T::Error;

    fn derivative(&mut self, t: f64, y: &Y) -> Result<Y, T::Error> {
        let (q, w) = (quaternion(y), omega(y));
        let body = self.frame.to_body(y);
        let torque = self.torque.torque(t, &body.omega, &body.attitude)?;
        let acceleration = self
            .equations
            .principal_acceleration(&w, &self.frame.axes.tr_mul(&torque))?;
        let q_rate = rate(&q, &w);
        Ok(Y::from([
            q_rate.i,
            q_rate.j,
            q_rate.k,
            q_rate.w,
            acceleration.x,
            acceleration.y,
            acceleration.z,
        ]))
    }

    /// By the norms of attitude and ω, since single components pass through zero every turn.
    fn error_norm(&self, _: &Y, y_new: &Y, error: &Y) -> f64 {
        let attitude = quaternion(error).norm() / self.tolerance.relative;
        let allowed = self.tolerance.absolute
            + self.tolerance.relative * self.fastest.max(omega(y_new).norm());
        let spin = omega(error).norm();
        let spin = if spin == 0.0 { 0.0 } else { spin / allowed };
        if attitude.is_nan() || spin.is_nan() {
            f64::NAN
        } else {
            attitude.max(spin)
        }
    }

    fn accept(&mut self, y: &mut Compensated<7>) {
        self.fastest = self.fastest.max(omega(&y.value).norm());
        // |q|² − 1 with what rounding left out, halved: the first-order correction, exact where it is small.
        let (q, rest) = (quaternion(&y.value), quaternion(y.rest()));
        let excess = 0.5 * ((q.norm() - 1.0) * (q.norm() + 1.0) + 2.0 * q.dot(&rest));
        let mut correction = Y::zeros();
        for i in 0..4 {
            correction[i] = -excess * y.value[i];
        }
        *y = y.plus(&correction);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::RigidBody;
    use crate::motion::loads::{Frame as LoadFrame, Term};
    use nalgebra::Matrix3;

    const NO_LOAD: &[Term] = &[];

    fn watch(_: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn run(
        moments: [f64; 3],
        omega: Vector3<f64>,
        times: &[f64],
        load: &[Term],
        rtol: f64,
    ) -> Vec<State> {
        let body =
            RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0);
        let equations = EulerEquations::about(&body.expect("body"), &Vector3::zeros());
        let initial = State {
            attitude: UnitQuaternion::identity(),
            omega,
        };
        let mut samples = vec![State::nan(); times.len()];
        let tolerance = Tolerance::new(rtol, 0.0).expect("tolerance");
        simulate(
            &equations,
            &initial,
            times,
            &mut { load },
            tolerance,
            &mut samples,
            &mut watch,
        )
        .expect("smooth");
        samples
    }

    #[test]
    fn nasa_check_case_2() {
        // NASA/TM-2015-218675, case 2: slug ft² and deg/s; the exact rates at 30 s by a series in 25 digits.
        let moments = [0.001_894_220, 0.006_211_019, 0.007_194_665];
        let exact = Vector3::new(
            12.618_390_775_914_22,
            -17.397_474_761_611_39,
            31.119_588_886_944_34,
        );
        for (rtol, allowed) in [(1e-13, 1e-11), (1e-10, 1e-8)] {
            let omega = Vector3::new(10.0, 20.0, 30.0).map(f64::to_radians);
            let end = run(moments, omega, &[0.0, 30.0], NO_LOAD, rtol)[1]
                .omega
                .map(f64::to_degrees);
            assert!((end - exact).norm() < allowed, "{:e}", (end - exact).norm());
        }
    }

    #[test]
    fn symmetric_top_precesses_as_the_closed_form_says() {
        // I₁ = I₂ = I_t: ω_t turns with Ω = (I_s − I_t) ω_s / I_t in the body.
        let times: Vec<f64> = (0..=100).map(|k| 0.37 * f64::from(k)).collect();
        let (w_t, w_s) = (0.5, 2.0);
        for (t, state) in times.iter().zip(run(
            [1.0, 1.0, 1.6],
            Vector3::new(w_t, 0.0, w_s),
            &times,
            NO_LOAD,
            1e-13,
        )) {
            let angle = 0.6 * w_s * t;
            let exact = Vector3::new(w_t * angle.cos(), w_t * angle.sin(), w_s);
            assert!(
                (state.omega - exact).norm() < 1e-11,
                "{t} {:e}",
                (state.omega - exact).norm()
            );
        }
    }

    #[test]
    fn constant_space_torque_about_a_principal_axis_spins_up() {
        let load = [
            Term::constant_torque(&Vector3::new(0.0, 0.0, 3.0), LoadFrame::Space).expect("finite"),
        ];
        let end = run([1.0, 2.0, 2.5], Vector3::zeros(), &[0.0, 4.0], &load, 1e-12)[1];
        assert!((end.omega - Vector3::new(0.0, 0.0, 4.8)).norm() < 1e-11);
        assert!(
            end.attitude
                .angle_to(&UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 9.6))
                < 1e-10
        );
    }

    #[test]
    fn times_must_run_one_way() {
        assert!(check_times(&[0.0, 1.0, 0.5]).is_err() && check_times(&[]).is_err());
        assert!(check_times(&[2.0]).is_ok() && check_times(&[0.0, -1.0, -2.0]).is_ok());
    }
}
