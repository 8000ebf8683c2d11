//! A motion into a lane, its unit, its end.

use super::lanes::{Job, Lanes, Lead, Stop, effort};
use super::stops::next_stop;
use crate::error::Error;
use crate::motion::integrate::taylor::course::{Besides, Course};
use crate::motion::integrate::taylor::linear_terms::Field;
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::batch::Pack;
use crate::motion::integrate::taylor::series::Series;
use crate::motion::problem::End;
use crate::motion::state::Phase;
use crate::numerics::number::{Number, Real};

impl<'a, L, S, const B: usize, const R: usize> Lanes<'a, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Pack<L, R>, B>,
{
    /// The next motion into an empty lane, or none for ever.
    #[inline(never)]
    pub(super) fn load(&mut self, row: usize, jobs: &mut dyn Iterator<Item = Job<'a, L::Real>>) {
        let Some(job) = jobs.next() else {
            return self.vacate(row);
        };
        let start = job.course.start();
        for i in 0..7 {
            self.state.value[i].put(row, start[i]);
            self.state.rest[i].set(row, 0.0);
        }
        if let Some(push) = &mut self.push {
            let Phase {
                position: r,
                velocity: v,
                ..
            } = job.course.initial();
            push.set(row, &[r.x, r.y, r.z, v.x, v.y, v.z]);
        }
        if let Some(carried) = &mut self.carried {
            carried.set(row, &job.course.own_at_start());
        }
        self.extras.restart(row);
        self.now[row] = (0.0, 0.0);
        self.direction[row] = job.course.direction();
        self.fastest[row] = 0.0;
        self.leads[row] = Some(Lead {
            job,
            stop: Stop::Output,
            steps: 0,
            flips_at_once: 0,
        });
        self.enter(row);
    }

    /// Takes the unit of rates, the field and the next stop of a motion.
    pub(super) fn enter(&mut self, row: usize) {
        let state = self.state.now(row);
        let Some(lead) = &mut self.leads[row] else {
            return;
        };
        let course = &mut lead.job.course;
        let old = course.unit();
        let omega = [0, 1, 2].map(|i| state[i].rounded() * old);
        let own = (self.carried.as_ref()).map_or_else(Vec::new, |carried| carried.now(row));
        let unit = course.choose_unit(&omega, &own);
        let ratio = old / unit;
        for i in 0..3 {
            // Units are powers of two.
            (self.state.value[i]).put(row, state[i] * old.into() / unit.into());
            let rest = self.state.rest[i].real(row) * ratio.into();
            self.state.rest[i].put(row, rest);
        }
        if let Some(push) = &mut self.push {
            push.rescale(row, ratio);
        }
        if let Some(carried) = &mut self.carried {
            let inverse = (*course.inverse_moments()).into();
            carried.enter(row, course.own(), inverse, unit);
        }
        self.extras.rescale(row, ratio);
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
        let field = course.field();
        self.field.set(row, &field);
        self.still[row] = field.stillness();
        for (_, matrix) in course.formulas() {
            for n in 0..3 {
                self.still[row][n] &= matrix[n] == [L::Real::default(); 3];
            }
        }
        self.extras.formulas.set(row, course.formulas());
        for (packs, direction) in self
            .directions
            .iter_mut()
            .zip(Course::<L::Real>::directions::<B>())
        {
            for i in 0..3 {
                packs[i].put(row, direction[i]);
            }
        }
        let next = lead.job.run.samples.len();
        (self.stop[row], lead.stop) = next_stop(course, next);
        self.hold();
    }

    /// What goes on beside attitude and ω, now.
    pub(super) fn besides(&self, row: usize) -> Besides<L::Real> {
        Besides {
            place: self.push.as_ref().map(|push| push.now(row)),
            own: (self.carried.as_ref()).map_or_else(Vec::new, |carried| carried.now(row)),
        }
    }

    /// Ends a motion before its last output.
    pub(super) fn end(&mut self, row: usize, end: End<Error>) {
        let (time, state) = (self.time(row), self.state.now(row));
        let besides = self.besides(row);
        if let Some(lead) = &mut self.leads[row] {
            let run = &mut *lead.job.run;
            run.effort = effort(lead.steps);
            run.time = time;
            run.phase = lead.job.course.phase(&state, &besides, self.now[row]);
            run.end = end;
        }
        self.leads[row] = None;
    }

    /// Ends the motions that would take too many steps; whether there was one. Each is judged by its own steps, whatever goes on
    /// beside it.
    #[inline(always)]
    pub(super) fn refuse_endless(&mut self) -> bool {
        self.leads.iter().flatten().any(Lead::is_due) && self.refuse_due()
    }

    #[inline(never)]
    fn refuse_due(&mut self) -> bool {
        let mut ended = false;
        for row in 0..R {
            let Some(lead) = self.leads[row].as_ref().filter(|lead| lead.is_due()) else {
                continue;
            };
            let (course, elapsed) = (&lead.job.course, self.now[row].0);
            if let Err(error) = course.check_steps(lead.steps, elapsed) {
                self.end(row, End::Failed(error));
                ended = true;
            }
        }
        ended
    }

    /// A lane without motion: at rest for ever.
    pub(super) fn vacate(&mut self, row: usize) {
        for i in 0..7 {
            self.state.value[i].set(row, 0.0);
            self.state.rest[i].set(row, 0.0);
        }
        if let Some(push) = &mut self.push {
            push.set(row, &[0.0; 6]);
        }
        if let Some(carried) = &mut self.carried {
            carried.vacate(row);
        }
        self.field.set(row, &Field::none(L::Real::default()));
        self.still[row] = [true; 3];
        self.hold();
        self.extras.vacate(row);
        self.now[row] = (0.0, 0.0);
        self.stop[row] = (f64::INFINITY, 0.0);
        self.fastest[row] = 1.0;
        self.direction[row] = 1.0;
    }
}
