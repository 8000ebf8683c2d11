//! Runs motions to their last output time, `R` at a time, each with its own steps.

mod search;
mod seen;
mod settings;

use std::ops::ControlFlow;

use super::course::Course;
use super::extras::Extras;
use super::field::Field;
use super::frame::Precision;
use super::pack::{Pack, cross_term};
use super::push::Push;
use super::series::{Coefficient, Series};
use super::step::{Compensated, increment, longest};
use crate::error::{Error, MotionFault};
use crate::motion::simulate::{Effort, End, HELD, Run};
use crate::motion::state::Phase;
use crate::numerics::double_double::{fast_two_sum, two_sum};
use crate::numerics::number::{Number, Real};
use search::Landing;
pub(crate) use seen::Step;
pub(super) use seen::drive_seen;
pub(super) use settings::Settings;

/// Steps between two looks at the watch.
const PATIENCE: u32 = 64;
/// How far ω may outgrow the unit of rates before another is taken: far below where its 26th power overflows.
const OUTGROWN: f64 = 65_536.0;

/// A motion to be run, and its run, which is at its start.
pub(super) struct Job<'a, X: Precision> {
    pub(super) course: Course<'a, X>,
    pub(super) run: &'a mut Run<Error>,
}

/// What a motion comes to next.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stop {
    /// A time of output.
    Output,
    /// A break of its load.
    Break,
}

/// What a motion comes to within a step.
enum Meeting<X> {
    /// An output, at this time since the start of the step.
    Output(X),
    /// A break, after this time.
    Break(f64),
    Nothing,
    End,
}

/// A motion under way.
struct Lead<'a, X: Precision> {
    job: Job<'a, X>,
    /// The next output.
    next: usize,
    stop: Stop,
    steps: u64,
    /// Changes of the law without a step between them.
    flips_at_once: u32,
}

/// `R` motions under way. Times are since the start, in the unit of each motion.
struct Lanes<'a, L: Number<Real: Precision>, S, const B: usize, const R: usize> {
    settings: Settings,
    series: S,
    field: Field<Pack<L, R>, B>,
    extras: Extras<Pack<L, R>>,
    directions: [[Pack<L, R>; 3]; B],
    state: Compensated<Pack<L, R>>,
    push: Option<Box<Push<Pack<L, R>>>>,
    leads: [Option<Lead<'a, L::Real>>; R],
    /// The times now and of the next stop, each with what rounding has left out.
    now: [(f64, f64); R],
    stop: [(f64, f64); R],
    /// The largest |ω| so far, or what else counts as large, and 1 or −1 for backward in time.
    fastest: [f64; R],
    direction: [f64; R],
    /// The components of ω that are constant in each motion.
    still: [[bool; 3]; R],
}

/// Runs all motions that `jobs` gives. About every 64 steps `watch` gets the fraction of the first lane's motion that is
/// done, and may stop them.
#[inline(always)]
pub(super) fn drive<
    L: Number<Real: Precision>,
    S: Series<Pack<L, R>, B>,
    const B: usize,
    const R: usize,
>(
    settings: Settings,
    jobs: &mut dyn Iterator<Item = Job<'_, L::Real>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut lanes = Lanes::<L, S, B, R>::new(settings);
    let mut patience = PATIENCE;
    let mut idle = true;
    loop {
        if idle {
            for row in 0..R {
                if lanes.leads[row].is_none() {
                    lanes.load(row, jobs);
                }
            }
            if lanes.leads.iter().all(Option::is_none) {
                return ControlFlow::Continue(());
            }
        }
        idle = lanes.step();
        patience -= 1;
        if patience == 0 {
            patience = PATIENCE;
            idle |= lanes.refuse_endless();
            if watch(lanes.fraction()).is_break() {
                for row in 0..R {
                    lanes.end(row, End::Stopped);
                }
                return ControlFlow::Break(());
            }
        }
    }
}

impl<'a, L, S, const B: usize, const R: usize> Lanes<'a, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Pack<L, R>, B>,
{
    /// All empty.
    #[inline(always)]
    fn new(settings: Settings) -> Self {
        let zero = Pack::new(0.0);
        Self {
            settings,
            series: S::new(),
            field: Field::none(zero),
            extras: Extras::new(&settings.parts),
            directions: [[zero; 3]; B],
            state: Compensated::new(),
            push: settings.parts.is_pushed.then(|| Box::new(Push::new())),
            leads: [const { None }; R],
            now: [(0.0, 0.0); R],
            stop: [(f64::INFINITY, 0.0); R],
            fastest: [1.0; R],
            direction: [1.0; R],
            still: [[true; 3]; R],
        }
    }

    /// Tells the series which component of ω is constant in all motions.
    fn hold(&mut self) {
        let is_still = |n: &usize| self.still.iter().all(|row| row[*n]);
        let still = [0, 2].into_iter().find(is_still);
        self.series.hold(still.filter(|_| !self.extras.is_timed()));
    }

    /// One step of every motion; whether one has ended.
    #[inline(always)]
    fn step(&mut self) -> bool {
        let Settings {
            order, last_term, ..
        } = self.settings;
        self.expand();
        let mut h = longest(&self.series, order, last_term, &self.fastest);
        self.extras
            .limit(&self.series, &self.field, &self.fastest, &mut h);
        let mut eventful = self.settings.parts.may_flip();
        for row in 0..R {
            let (now, gap) = (self.now[row].0, self.gap(row));
            // What is not a number is an event too.
            let is_plain = (h[row] < gap) & (h[row] > f64::EPSILON * now.abs());
            eventful |= !is_plain;
        }
        let mut landings = [Landing::None; R];
        if eventful {
            for row in 0..R {
                if self.leads[row].is_some() {
                    (h[row], landings[row]) = self.pass(row, h[row]);
                }
            }
        }
        let mut signed = Pack::new(0.0);
        for row in 0..R {
            h[row] *= self.direction[row];
            signed.set(row, h[row]);
            if landings[row] == Landing::Break {
                signed.put(row, self.time_to_stop(row));
            }
        }
        let change = increment(&self.series, order, signed);
        self.state.add(&change);
        if let Some(push) = &mut self.push {
            let change = push.increment(order, signed);
            push.add(&change);
        }
        self.extras.advance(order, signed);
        let mut ended = false;
        let mut outgrown = false;
        for row in 0..R {
            let (now, rest) = self.now[row];
            let (reached, more) = two_sum(now, h[row]);
            self.now[row] = fast_two_sum(reached, rest + more);
            let (x, y) = (self.state.value[0].get(row), self.state.value[1].get(row));
            let z = self.state.value[2].get(row);
            let speed = (x * x + y * y + z * z).sqrt();
            if speed > self.fastest[row] {
                self.fastest[row] = speed;
            }
            outgrown |= speed > OUTGROWN;
        }
        if eventful | outgrown {
            for row in 0..R {
                self.settle(row, landings[row]);
                ended |= self.leads[row].is_none();
            }
        }
        for lead in self.leads.iter_mut().flatten() {
            lead.steps += 1;
        }
        ended
    }

    /// The series at the states now.
    #[inline(always)]
    fn expand(&mut self) {
        let order = self.settings.order;
        let [w0, w1, w2, x, y, z, w] = self.state.value;
        let q = [x, y, z, w];
        let mut g = self.directions;
        for g in &mut g {
            *g = seen(&q, g);
        }
        self.series.start(&Coefficient {
            w: [w0, w1, w2],
            q,
            g,
        });
        if self.extras.is_timed() {
            for row in 0..R {
                if let Some(lead) = &self.leads[row] {
                    let moment = lead.job.course.moment(self.now[row]);
                    let inverse = lead.job.course.inverse_moments();
                    self.extras.set(row, &moment, inverse, &q);
                }
            }
        }
        self.extras.start(&self.fastest);
        // Several motions have order 0 apart, so that what is special about it is not in their loop.
        let first = usize::from(R > 1);
        for k in 0..first {
            self.extend(k);
        }
        for k in first..order {
            self.extend(k);
        }
        if let Some(push) = &mut self.push {
            push.expand(order, &self.series, &self.field);
        }
    }

    /// The coefficients of order `k` + 1.
    #[inline(always)]
    fn extend(&mut self, k: usize) {
        let sums = self.series.sums(k);
        let (spins, at) = (S::spins(&sums), self.series.get(k));
        let acceleration = (self.field).acceleration(self.settings.parts, k, spins, &at);
        let (series, field) = (&self.series, &self.field);
        let acceleration = self
            .extras
            .plus_coefficients(k, series, field, acceleration);
        self.series.extend(k, &sums, &acceleration);
    }

    /// Serves what a motion comes to within the step `h`: the step that is left, and what it lands on.
    #[inline(always)]
    fn pass(&mut self, row: usize, h: f64) -> (f64, Landing) {
        let (mut h, landing) = if self.settings.parts.may_flip() {
            self.until_flip(row, h)
        } else {
            (h, Landing::None)
        };
        if landing == Landing::Flip && self.is_held(row, h) {
            h = 0.0; // which advances nothing: an error
        }
        loop {
            let time = match self.meet(row, h) {
                Meeting::Output(time) => time,
                Meeting::Break(gap) => return (gap, Landing::Break),
                Meeting::Nothing => return (h, landing),
                Meeting::End => return (0.0, Landing::None),
            };
            let (state, place) = self.within(row, time);
            self.give(row, &state, place.as_ref());
        }
    }

    /// Whether the law of a motion, which changes after the step `h`, has changed on one spot again and again: then it holds the
    /// body there.
    fn is_held(&mut self, row: usize, h: f64) -> bool {
        let least = (4.0 * f64::EPSILON * self.now[row].0.abs()).max(f64::MIN_POSITIVE);
        let Some(lead) = &mut self.leads[row] else {
            return false;
        };
        lead.flips_at_once = if h > least { 0 } else { lead.flips_at_once + 1 };
        lead.flips_at_once > HELD
    }

    /// The state of a motion, and its position and velocity when it is pushed, at a time since the start of the step.
    #[inline(always)]
    fn within(&self, row: usize, time: L::Real) -> ([L::Real; 7], Option<[L::Real; 6]>) {
        let mut within = Pack::new(0.0);
        within.put(row, time);
        let order = self.settings.order;
        let state = (self.state).moved(&increment(&self.series, order, within), row);
        // No `map`: its closure would be compiled without the instructions of the level.
        let place = match &self.push {
            Some(push) => Some(push.moved(&push.increment(order, within), row)),
            None => None,
        };
        (state, place)
    }

    /// Whether a feedback has another sign in the `state` later in the step than at its start, or ω has passed through zero
    /// under quadratic damping.
    #[inline(never)]
    fn has_flipped(&self, row: usize, state: &[L::Real; 7]) -> bool {
        let lead = self.leads[row].as_ref();
        let start = [0, 1, 2].map(|i| self.state.value[i].get(row));
        let omega = [0, 1, 2].map(|i| state[i].rounded());
        lead.is_some_and(|lead| lead.job.course.has_flipped(state))
            || (self.extras).is_reversed(row, &self.field, &start, &omega)
    }

    /// The time from now to the next stop, positive also backward in time.
    #[inline(always)]
    fn gap(&self, row: usize) -> f64 {
        let ((now, now_rest), (stop, stop_rest)) = (self.now[row], self.stop[row]);
        ((stop - now) + (stop_rest - now_rest)) * self.direction[row]
    }

    /// The time from now to the next stop.
    #[inline(always)]
    fn time_to_stop(&self, row: usize) -> L::Real {
        let ((now, now_rest), (stop, stop_rest)) = (self.now[row], self.stop[row]);
        L::Real::pair(stop, -now) + L::Real::pair(stop_rest, -now_rest)
    }

    /// What a motion comes to next in a step as long as `h`.
    #[inline(never)]
    fn meet(&mut self, row: usize, h: f64) -> Meeting<L::Real> {
        let gap = self.gap(row);
        let time = self.time(row);
        let Some(lead) = &self.leads[row] else {
            return Meeting::End;
        };
        let advances = h > f64::EPSILON * self.now[row].0.abs();
        if !advances {
            let error = if h.is_finite() {
                Error::Motion(MotionFault::StepTooSmall {
                    time,
                    step: h / lead.job.course.unit(),
                })
            } else {
                Error::Motion(MotionFault::NotFiniteMotion { time })
            };
            self.end(row, End::Failed(error));
            return Meeting::End;
        }
        match lead.stop {
            _ if gap > h => Meeting::Nothing,
            Stop::Output => Meeting::Output(self.time_to_stop(row)),
            Stop::Break => Meeting::Break(gap),
        }
    }

    /// Gives a sample to a motion; after the last one it ends.
    #[inline(never)]
    fn give(&mut self, row: usize, state: &[L::Real; 7], place: Option<&[L::Real; 6]>) {
        let now = self.stop[row];
        let Some(lead) = &mut self.leads[row] else {
            return;
        };
        let phase = lead.job.course.phase(state, place, now);
        let run = &mut *lead.job.run;
        if !phase.is_finite() {
            // It came to the last state that is one.
            let before = lead.next - 1;
            run.effort = effort(lead.steps);
            run.time = lead.job.course.time_of(before);
            run.phase = run.samples[before];
            let time = lead.job.course.time_of(lead.next);
            run.end = End::Failed(Error::Motion(MotionFault::NotFiniteMotion { time }));
            self.leads[row] = None;
            return;
        }
        run.samples[lead.next] = phase;
        lead.next += 1;
        if lead.next == run.samples.len() {
            run.effort = effort(lead.steps + 1);
            run.time = lead.job.course.last_time();
            run.phase = phase;
            run.end = End::Complete;
            self.leads[row] = None;
        } else {
            (self.stop[row], lead.stop) = next_stop(&lead.job.course, lead.next);
        }
    }

    /// After a step: past a break or a flip the equations are others, and a motion that has become much faster takes
    /// another unit.
    #[inline(never)]
    fn settle(&mut self, row: usize, landing: Landing) {
        let state = self.state.now(row);
        let Some(lead) = &mut self.leads[row] else {
            return;
        };
        let course = &mut lead.job.course;
        let changed = match landing {
            Landing::None => Ok(()),
            Landing::Break => {
                self.now[row] = self.stop[row];
                self.extras.restart(row);
                course.pass_break(&state)
            }
            Landing::Flip => course.flip(&state),
        };
        if let Err(error) = changed {
            self.end(row, End::Failed(error));
        } else if landing != Landing::None
            || state[..3]
                .iter()
                .any(|w| w.rounded().abs() > 0.5 * OUTGROWN)
        {
            self.enter(row);
        }
    }

    /// The next motion into an empty lane, or none for ever.
    #[inline(never)]
    fn load(&mut self, row: usize, jobs: &mut dyn Iterator<Item = Job<'a, L::Real>>) {
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
        self.extras.restart(row);
        self.now[row] = (0.0, 0.0);
        self.direction[row] = job.course.direction();
        self.fastest[row] = 0.0;
        self.leads[row] = Some(Lead {
            job,
            next: 1,
            stop: Stop::Output,
            steps: 0,
            flips_at_once: 0,
        });
        self.enter(row);
    }

    /// Takes the unit of rates, the field and the next stop of a motion.
    fn enter(&mut self, row: usize) {
        let state = self.state.now(row);
        let Some(lead) = &mut self.leads[row] else {
            return;
        };
        let course = &mut lead.job.course;
        let old = course.unit();
        let omega = [0, 1, 2].map(|i| state[i].rounded() * old);
        let unit = course.choose_unit(&omega);
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
        self.extras.rescale(row, ratio);
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
        for (packs, direction) in self
            .directions
            .iter_mut()
            .zip(Course::<L::Real>::directions::<B>())
        {
            for i in 0..3 {
                packs[i].put(row, direction[i]);
            }
        }
        (self.stop[row], lead.stop) = next_stop(course, lead.next);
        self.hold();
    }

    /// Ends a motion before its last output.
    fn end(&mut self, row: usize, end: End<Error>) {
        let (time, state) = (self.time(row), self.state.now(row));
        let place = self.push.as_ref().map(|push| push.now(row));
        if let Some(lead) = &mut self.leads[row] {
            let run = &mut *lead.job.run;
            run.effort = effort(lead.steps);
            run.time = time;
            run.phase = lead.job.course.phase(&state, place.as_ref(), self.now[row]);
            run.end = end;
        }
        self.leads[row] = None;
    }

    /// Ends the motions that would take too many steps; whether there was one.
    pub(super) fn refuse_endless(&mut self) -> bool {
        let mut ended = false;
        for row in 0..R {
            let Some(lead) = &self.leads[row] else {
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
    fn vacate(&mut self, row: usize) {
        for i in 0..7 {
            self.state.value[i].set(row, 0.0);
            self.state.rest[i].set(row, 0.0);
        }
        if let Some(push) = &mut self.push {
            push.set(row, &[0.0; 6]);
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

    fn time(&self, row: usize) -> f64 {
        let lead = self.leads[row].as_ref();
        lead.map_or(f64::NAN, |lead| lead.job.course.time(self.now[row]))
    }

    fn fraction(&self) -> f64 {
        let lead = self.leads[0].as_ref();
        lead.map_or(1.0, |lead| lead.job.course.fraction(self.now[0].0))
    }
}

/// An evaluation is that of all coefficients of a step.
fn effort(steps: u64) -> Effort {
    Effort {
        steps,
        evaluations: steps,
    }
}

/// The output `next` or the end of the segment, whichever comes first.
fn next_stop<X: Precision>(course: &Course<X>, next: usize) -> ((f64, f64), Stop) {
    let (output, end) = (course.output(next), course.end_of_segment());
    // An output on a break belongs to the segment that ends there.
    let ahead = ((output.0 - end.0) + (output.1 - end.1)) * course.direction();
    if ahead > 0.0 {
        (end, Stop::Break)
    } else {
        (output, Stop::Output)
    }
}

/// A direction fixed in space as seen from the body: `Rᵀ e` for the attitude (x, y, z, w).
#[inline(always)]
pub(super) fn seen<L: Number, const R: usize>(
    q: &[Pack<L, R>; 4],
    e: &[Pack<L, R>; 3],
) -> [Pack<L, R>; 3] {
    let [x, y, z, w] = *q;
    let (u, zero) = ([x, y, z], [Pack::new(0.0); 3]);
    let t = cross_term(&u, e, zero);
    let t = [t[0] + t[0], t[1] + t[1], t[2] + t[2]];
    let mut seen = cross_term(&u, &t, zero);
    for i in 0..3 {
        seen[i] = (-w).mul_add(t[i], e[i]) + seen[i];
    }
    seen
}
