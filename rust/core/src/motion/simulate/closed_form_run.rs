//! Free bodies and heavy symmetric tops in closed form, as runs.

use std::ops::ControlFlow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::plan::{closed_top, gravity_alone};
use super::stepper::{Carry, Dense, Span, Stepper};
use crate::error::{Error, MotionFault};
use crate::motion::closed_form::ClosedForm;
use crate::motion::free::FreeMotion;
use crate::motion::heavy_top::HeavyTop;
use crate::motion::loads::{LawSwitch, Term};
use crate::motion::problem::{Effort, End, Run, Task};
use crate::motion::state::{Phase, State};
use crate::numerics::power_of_two::{exponent, length, times_power_of_two};

/// States between two looks at the watch.
const PATIENCE: usize = 4096;
/// Parts of a turn at whose ends events are looked for.
const PARTS_OF_A_TURN: f64 = 6.0;

/// The run under `terms`, without events.
pub(super) fn solve<E: From<Error>>(
    task: &Task<'_>,
    terms: &[Term],
    run: &mut Run<E>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<End<E>, E> {
    let closed = Closed::new(task, terms, &task.initial)?;
    let (start, last) = (task.times[0], task.times[task.times.len() - 1]);
    closed.reaches(start, last - start)?;
    // A top's attitude counts to its last bit, and may be a unit quaternion to rounding alone.
    run.samples[0].attitude = UnitQuaternion::new_normalize(task.initial.attitude.into_inner());
    let elapsed: Vec<f64> = task.times.iter().map(|t| t - start).collect();
    let count = elapsed.len();
    let room = count.min(PATIENCE);
    let (mut attitudes, mut omegas) = (vec![[0.0; 4]; room], vec![[0.0; 3]; room]);
    for from in (1..count).step_by(PATIENCE) {
        let times = &elapsed[from..count.min(from + PATIENCE)];
        let (attitudes, omegas) = (&mut attitudes[..times.len()], &mut omegas[..times.len()]);
        closed.sample(times, attitudes, omegas);
        let states = times.iter().zip(&*attitudes).zip(&*omegas);
        run.samples
            .extend(states.map(|((&t, &[x, y, z, w]), &omega)| {
                let state = State {
                    attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
                    omega: Vector3::from(omega),
                };
                closed.phase_of(t, state)
            }));
        let last = from + times.len() - 1;
        (run.time, run.phase) = (task.times[last], run.samples[last].clone());
        if watch(last as f64 / count as f64).is_break() {
            return Ok(End::Stopped);
        }
    }
    Ok(End::Complete)
}

/// A body that turns as a closed form says, and the uniform motion of its reference point.
struct Closed {
    motion: ClosedMotion,
    /// What the angular speed does not exceed by much.
    fastest: f64,
    position: Vector3<f64>,
    velocity: Vector3<f64>,
}

/// The closed form.
enum ClosedMotion {
    Free(FreeMotion),
    Top(HeavyTop),
}

impl Closed {
    fn new(task: &Task<'_>, terms: &[Term], phase: &Phase) -> Result<Self, Error> {
        let Phase {
            attitude, omega, ..
        } = phase;
        let (motion, fastest) = if task.body_at_point.pivoted {
            let top = closed_top(task.body)?;
            let gravity = gravity_alone(terms).unwrap_or_default();
            // ½ I_t ω_t² grows by 2 m g l at most: from the highest point to the lowest.
            let fall = top.mass_moment * length(&gravity) / top.transverse;
            let unit = exponent(omega.amax().max(fall.sqrt()));
            let scaled = omega.map(|rate| times_power_of_two(rate, -unit));
            let squares = scaled.norm_squared() + 4.0 * times_power_of_two(fall, -2 * unit);
            let fastest = times_power_of_two(squares.sqrt(), unit);
            let motion = HeavyTop::of(&top, omega, attitude, &gravity)?;
            (ClosedMotion::Top(motion), fastest)
        } else {
            let motion = FreeMotion::of(task.body, omega, attitude)?;
            (ClosedMotion::Free(motion), length(omega))
        };
        Ok(Self {
            motion,
            fastest,
            position: phase.position,
            velocity: phase.velocity,
        })
    }

    fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
        match &self.motion {
            ClosedMotion::Free(motion) => motion.sample(times, attitudes, omegas),
            ClosedMotion::Top(motion) => motion.sample(times, attitudes, omegas),
        }
    }

    /// That the states are known from `start` until this long after it.
    fn reaches(&self, start: f64, elapsed: f64) -> Result<(), Error> {
        match &self.motion {
            ClosedMotion::Free(motion) => motion.reaches(elapsed)?,
            ClosedMotion::Top(motion) => motion.reaches(elapsed)?,
        }
        if self.place(elapsed).iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        let time = start + elapsed;
        Err(Error::Motion(MotionFault::NotFiniteMotion { time }))
    }

    fn place(&self, elapsed: f64) -> Vector3<f64> {
        self.position + self.velocity * elapsed
    }

    fn phase_of(&self, elapsed: f64, state: State) -> Phase {
        Phase {
            attitude: state.attitude,
            omega: state.omega,
            position: self.place(elapsed),
            velocity: self.velocity,
            internal_state: Box::default(),
        }
    }

    fn at(&self, elapsed: f64) -> Phase {
        let state = match &self.motion {
            ClosedMotion::Free(motion) => motion.at(elapsed),
            ClosedMotion::Top(motion) => motion.at(elapsed),
        };
        self.phase_of(elapsed, state)
    }
}

/// Steps of part of a turn, for runs that look for events.
pub(super) struct ClosedFormRun<E> {
    closed: Closed,
    length: f64,
    step: f64,
    elapsed: f64,
    steps: u64,
    error: std::marker::PhantomData<E>,
}

impl<E: From<Error>> ClosedFormRun<E> {
    pub(super) fn new(task: &Task<'_>, span: &Span, terms: Option<&[Term]>) -> Result<Self, E> {
        let closed = Closed::new(task, terms.unwrap_or_default(), &span.phase)?;
        let length = span.to - span.from;
        closed.reaches(span.from, length)?;
        let turn = std::f64::consts::TAU / closed.fastest;
        let step = (turn / PARTS_OF_A_TURN).min(length.abs()).copysign(length);
        Ok(Self {
            closed,
            length,
            step,
            elapsed: 0.0,
            steps: 0,
            error: std::marker::PhantomData,
        })
    }
}

impl<E: From<Error>> Dense for ClosedFormRun<E> {
    type Error = E;

    fn elapsed(&self) -> f64 {
        self.elapsed
    }

    fn phase(&self) -> Phase {
        self.closed.at(self.elapsed)
    }

    fn within(&mut self, elapsed: f64) -> Result<Phase, E> {
        Ok(self.closed.at(elapsed))
    }
}

impl<E: From<Error>> Stepper for ClosedFormRun<E> {
    fn advance(&mut self) -> Result<(), E> {
        self.steps += 1;
        let next = self.steps as f64 * self.step;
        if next == self.elapsed {
            return Err(Error::Motion(MotionFault::StepTooSmall {
                time: self.elapsed,
                step: self.step,
            })
            .into());
        }
        self.elapsed = if next.abs() >= self.length.abs() {
            self.length
        } else {
            next
        };
        Ok(())
    }

    fn effort(&self) -> Effort {
        Effort {
            steps: self.steps,
            evaluations: 0,
        }
    }

    fn carry(&self) -> Carry {
        Carry::default()
    }

    fn law_switches(&self) -> Vec<LawSwitch> {
        Vec::new()
    }
}
