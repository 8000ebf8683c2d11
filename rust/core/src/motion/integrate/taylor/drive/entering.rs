//! A motion into a lane, its unit, its end.

use super::lanes::{ActiveMotion, Job, Lanes, Stop, effort};
use super::stops::next_stop;
use crate::error::Error;
use crate::motion::integrate::taylor::batch::Batch;
use crate::motion::integrate::taylor::course::{AuxiliaryState, PiecewiseEquations};
use crate::motion::integrate::taylor::linear_terms::LinearTerms;
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::series::Series;
use crate::motion::problem::End;
use crate::motion::state::Phase;
use crate::numerics::number::{Number, Real};

impl<'a, L, S, const B: usize, const R: usize> Lanes<'a, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
{
    /// The next motion into an empty lane, or none for ever.
    #[inline(never)]
    pub(super) fn load_next(
        &mut self,
        row: usize,
        jobs: &mut dyn Iterator<Item = Job<'a, L::Real>>,
    ) {
        let Some(job) = jobs.next() else {
            return self.clear(row);
        };
        let start = job.equations.start();
        for i in 0..7 {
            self.state.value[i].put(row, start[i]);
            self.state.rest[i].set(row, 0.0);
        }
        if let Some(translation) = &mut self.translation {
            let Phase {
                position: r,
                velocity: v,
                ..
            } = job.equations.initial();
            translation.set(row, &[r.x, r.y, r.z, v.x, v.y, v.z]);
        }
        if let Some(internal_states) = &mut self.internal_states {
            internal_states.set(row, &job.equations.internal_states_at_start());
        }
        self.nonlinear.restart(row);
        self.now[row] = (0.0, 0.0);
        self.direction[row] = job.equations.direction();
        self.fastest[row] = 0.0;
        self.motions[row] = Some(ActiveMotion {
            job,
            stop: Stop::Output,
            steps: 0,
            switches_without_step: 0,
        });
        self.enter_segment(row);
    }

    /// Takes the unit of rates, the field and the next stop of a motion.
    pub(super) fn enter_segment(&mut self, row: usize) {
        let state = self.state.now(row);
        let Some(motion) = &mut self.motions[row] else {
            return;
        };
        let equations = &mut motion.job.equations;
        let old = equations.unit();
        let omega = [0, 1, 2].map(|i| state[i].rounded() * old);
        let own = (self.internal_states.as_ref())
            .map_or_else(Vec::new, |internal_states| internal_states.now(row));
        let unit = equations.choose_unit(&omega, &own);
        let ratio = old / unit;
        for i in 0..3 {
            // Units are powers of two.
            (self.state.value[i]).put(row, state[i] * old.into() / unit.into());
            let rest = self.state.rest[i].real(row) * ratio.into();
            self.state.rest[i].put(row, rest);
        }
        if let Some(translation) = &mut self.translation {
            translation.rescale(row, ratio);
        }
        if let Some(internal_states) = &mut self.internal_states {
            let inverse = (*equations.inverse_moments()).into();
            internal_states.set_rates(row, equations.internal_states(), inverse, unit);
        }
        self.nonlinear.rescale(row, ratio);
        self.series.rescale(ratio);
        let (now, rest) = self.now[row];
        self.now[row] = (now / ratio, rest / ratio);
        let [x, y, z] = [omega[0] / unit, omega[1] / unit, omega[2] / unit];
        let speed = (x * x + y * y + z * z).sqrt();
        let floor = self.settings.floor / unit;
        self.fastest[row] = (self.fastest[row] * ratio).max(speed).max(floor);
        if self.fastest[row] == 0.0 {
            // At rest, what the load makes of it is large.
            self.fastest[row] = 1.0;
        }
        let linear_terms = equations.linear_terms();
        self.linear_terms.set(row, &linear_terms);
        self.constant_components[row] = linear_terms.constant_components();
        for (_, matrix) in equations.formulas() {
            for n in 0..3 {
                self.constant_components[row][n] &= matrix[n] == [L::Real::default(); 3];
            }
        }
        self.nonlinear.formulas.set(row, equations.formulas());
        for (batches, direction) in self
            .directions
            .iter_mut()
            .zip(PiecewiseEquations::<L::Real>::directions::<B>())
        {
            for i in 0..3 {
                batches[i].put(row, direction[i]);
            }
        }
        let next = motion.job.run.samples.len();
        (self.stop[row], motion.stop) = next_stop(equations, next);
        self.update_constant_component();
    }

    /// What goes on beside attitude and ω, now.
    pub(super) fn auxiliary_state(&self, row: usize) -> AuxiliaryState<L::Real> {
        AuxiliaryState {
            position_velocity: self
                .translation
                .as_ref()
                .map(|translation| translation.now(row)),
            internal_states: (self.internal_states.as_ref())
                .map_or_else(Vec::new, |internal_states| internal_states.now(row)),
        }
    }

    /// Ends a motion before its last output.
    pub(super) fn end_motion(&mut self, row: usize, end: End<Error>) {
        let (time, state) = (self.time(row), self.state.now(row));
        let auxiliary = self.auxiliary_state(row);
        if let Some(motion) = &mut self.motions[row] {
            let run = &mut *motion.job.run;
            run.effort = effort(motion.steps);
            run.time = time;
            run.phase = motion
                .job
                .equations
                .phase(&state, &auxiliary, self.now[row]);
            run.end = end;
        }
        self.motions[row] = None;
    }

    /// Ends the motions that would take too many steps; whether there was one. Each is judged by its own steps, whatever goes on
    /// beside it.
    #[inline(always)]
    pub(super) fn end_overlong(&mut self) -> bool {
        self.motions.iter().flatten().any(ActiveMotion::is_due) && self.end_due()
    }

    #[inline(never)]
    fn end_due(&mut self) -> bool {
        let mut ended = false;
        for row in 0..R {
            let Some(motion) = self.motions[row].as_ref().filter(|motion| motion.is_due()) else {
                continue;
            };
            let (equations, elapsed) = (&motion.job.equations, self.now[row].0);
            if let Err(error) = equations.check_steps(motion.steps, elapsed) {
                self.end_motion(row, End::Failed(error));
                ended = true;
            }
        }
        ended
    }

    /// A lane without motion: at rest for ever.
    pub(super) fn clear(&mut self, row: usize) {
        for i in 0..7 {
            self.state.value[i].set(row, 0.0);
            self.state.rest[i].set(row, 0.0);
        }
        if let Some(translation) = &mut self.translation {
            translation.set(row, &[0.0; 6]);
        }
        if let Some(internal_states) = &mut self.internal_states {
            internal_states.clear(row);
        }
        self.linear_terms
            .set(row, &LinearTerms::none(L::Real::default()));
        self.constant_components[row] = [true; 3];
        self.update_constant_component();
        self.nonlinear.clear(row);
        self.now[row] = (0.0, 0.0);
        self.stop[row] = (f64::INFINITY, 0.0);
        self.fastest[row] = 1.0;
        self.direction[row] = 1.0;
    }
}
