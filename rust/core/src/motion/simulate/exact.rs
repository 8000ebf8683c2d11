//! Free bodies in closed form, as runs.

use std::ops::ControlFlow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::stepper::{Carry, Span, Stepper};
use super::{Effort, End, Run, Task};
use crate::error::Error;
use crate::motion::free::FreeMotion;
use crate::motion::state::{Phase, State};

/// States between two looks at the watch.
const PATIENCE: usize = 4096;
/// Parts of a turn at whose ends events are looked for.
const PARTS_OF_A_TURN: f64 = 16.0;

/// The run of a free body without events.
pub(super) fn solve<E: From<Error>>(
    task: &Task<'_>,
    run: &mut Run<E>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<End<E>, E> {
    let closed = Closed::new(task, &task.initial)?;
    let start = task.times[0];
    let elapsed: Vec<f64> = task.times.iter().map(|t| t - start).collect();
    let count = elapsed.len();
    let room = count.min(PATIENCE);
    let (mut attitudes, mut omegas) = (vec![[0.0; 4]; room], vec![[0.0; 3]; room]);
    for from in (1..count).step_by(PATIENCE) {
        let times = &elapsed[from..count.min(from + PATIENCE)];
        let (attitudes, omegas) = (&mut attitudes[..times.len()], &mut omegas[..times.len()]);
        closed.motion.sample(times, attitudes, omegas);
        let samples = run.samples[from..].iter_mut();
        for (((sample, &t), &[x, y, z, w]), &omega) in
            samples.zip(times).zip(&*attitudes).zip(&*omegas)
        {
            *sample = closed.placed(
                t,
                State {
                    attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
                    omega: Vector3::from(omega),
                },
            );
        }
        let last = from + times.len() - 1;
        (run.time, run.phase) = (task.times[last], run.samples[last]);
        if watch(last as f64 / count as f64).is_break() {
            return Ok(End::Stopped);
        }
    }
    Ok(End::Complete)
}

/// A free body and the uniform motion of its centre of mass.
struct Closed {
    motion: FreeMotion,
    position: Vector3<f64>,
    velocity: Vector3<f64>,
}

impl Closed {
    fn new(task: &Task<'_>, phase: &Phase) -> Result<Self, Error> {
        Ok(Self {
            motion: FreeMotion::of(task.body, &phase.omega, &phase.attitude)?,
            position: phase.position,
            velocity: phase.velocity,
        })
    }

    fn placed(&self, elapsed: f64, state: State) -> Phase {
        Phase {
            attitude: state.attitude,
            omega: state.omega,
            position: self.position + self.velocity * elapsed,
            velocity: self.velocity,
        }
    }

    fn at(&self, elapsed: f64) -> Phase {
        self.placed(elapsed, self.motion.at(elapsed))
    }
}

/// Steps of part of a turn, for runs that look for events.
pub(super) struct Exact<E> {
    closed: Closed,
    length: f64,
    step: f64,
    elapsed: f64,
    steps: u64,
    error: std::marker::PhantomData<E>,
}

impl<E: From<Error>> Exact<E> {
    pub(super) fn new(task: &Task<'_>, span: &Span) -> Result<Self, E> {
        let length = span.to - span.from;
        let turn = std::f64::consts::TAU / span.phase.omega.norm();
        let step = (turn / PARTS_OF_A_TURN).min(length.abs()).copysign(length);
        Ok(Self {
            closed: Closed::new(task, &span.phase)?,
            length,
            step,
            elapsed: 0.0,
            steps: 0,
            error: std::marker::PhantomData,
        })
    }
}

impl<E: From<Error>> Stepper for Exact<E> {
    type Error = E;

    fn elapsed(&self) -> f64 {
        self.elapsed
    }

    fn phase(&self) -> Phase {
        self.closed.at(self.elapsed)
    }

    fn advance(&mut self) -> Result<(), E> {
        self.steps += 1;
        let next = self.steps as f64 * self.step;
        if next == self.elapsed {
            return Err(Error::StepTooSmall {
                time: self.elapsed,
                step: self.step,
            }
            .into());
        }
        self.elapsed = if next.abs() >= self.length.abs() {
            self.length
        } else {
            next
        };
        Ok(())
    }

    fn within(&mut self, elapsed: f64) -> Result<Phase, E> {
        Ok(self.closed.at(elapsed))
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
}
