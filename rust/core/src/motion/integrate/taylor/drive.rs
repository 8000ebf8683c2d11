//! Runs motions to their last output time, `R` at a time, each with its own steps.

use std::ops::ControlFlow;

use super::course::Course;
use super::field::{Field, Parts};
use super::pack::Pack;
use super::series::{Coefficient, HIGHEST_ORDER, Series};
use super::step::{Compensated, increment, longest};
use crate::error::Error;
use crate::motion::simulate::{Cause, Effort, Failure, State};
use crate::numerics::double_double::two_sum;
use crate::numerics::lane::Lane;

/// Steps between two looks at the watch.
const PATIENCE: u32 = 64;
/// Relative to the tolerance of a step, the size of the last term of its series: the terms left out are a quarter of that,
/// and at the tightest tolerance stay below the rounding of the state even where they all have the same sign.
const LAST_TERM: f64 = 0.05;
/// How far ω may outgrow the unit of time before another is taken: far below where its 24th power overflows.
const OUTGROWN: f64 = 65_536.0;

/// What all motions of a run have in common.
#[derive(Clone, Copy)]
pub(super) struct Settings {
    /// The highest order of the series.
    order: usize,
    /// The size of their last terms as a logarithm to base 2.
    last_term: f64,
    /// The ω that counts as much as the largest |ω| so far: absolute over relative tolerance.
    floor: f64,
    parts: Parts,
}

impl Settings {
    /// With the order at which the work is least: it grows with the square of the order, the step with
    /// `tolerance^(1/order)`.
    pub(super) fn new(relative: f64, absolute: f64, parts: Parts) -> Self {
        let nats = -(LAST_TERM * relative).ln();
        let order = 2 * ((0.3 * nats) as usize).clamp(4, HIGHEST_ORDER / 2);
        Self {
            order,
            last_term: (LAST_TERM * relative).log2(),
            floor: absolute / relative,
            parts,
        }
    }
}

/// How one motion went.
pub type Outcome = Result<Effort, Failure<Error>>;

/// A motion to be run: its course, where its samples go (the first of which is set), and where its outcome goes.
pub(super) struct Job<'a> {
    pub(super) course: Course<'a>,
    pub(super) samples: &'a mut [State],
    pub(super) outcome: &'a mut Outcome,
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
enum Meeting {
    Output(f64),
    Break(f64),
    Nothing,
    End,
}

/// A motion under way.
struct Lead<'a> {
    job: Job<'a>,
    /// The next output.
    next: usize,
    stop: Stop,
    steps: u64,
}

/// `R` motions under way. Times are since the start, in the unit of each motion.
struct Lanes<'a, L, S, const B: usize, const R: usize> {
    settings: Settings,
    series: S,
    field: Field<Pack<L, R>, B>,
    directions: [[Pack<L, R>; 3]; B],
    state: Compensated<Pack<L, R>>,
    leads: [Option<Lead<'a>>; R],
    /// The times now and of the next stop, each with what rounding has left out.
    now: [(f64, f64); R],
    stop: [(f64, f64); R],
    /// The largest |ω| so far, or what else counts as large, and 1 or −1 for backward in time.
    fastest: [f64; R],
    direction: [f64; R],
}

/// Runs all motions that `jobs` gives. About every 64 steps `watch` gets the fraction of the first lane's motion that is
/// done, and may stop them.
#[inline(always)]
pub(super) fn drive<'a, L: Lane, S: Series<Pack<L, R>, B>, const B: usize, const R: usize>(
    settings: Settings,
    jobs: &mut dyn Iterator<Item = Job<'a>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let zero = Pack::new(0.0);
    let mut lanes = Lanes::<L, S, B, R> {
        settings,
        series: S::new(),
        field: Field::new(),
        directions: [[zero; 3]; B],
        state: Compensated::new(),
        leads: [const { None }; R],
        now: [(0.0, 0.0); R],
        stop: [(f64::INFINITY, 0.0); R],
        fastest: [1.0; R],
        direction: [1.0; R],
    };
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
            if watch(lanes.fraction()).is_break() {
                for row in 0..R {
                    lanes.fail(row, Cause::Stopped);
                }
                return ControlFlow::Break(());
            }
        }
    }
}

impl<'a, L: Lane, S: Series<Pack<L, R>, B>, const B: usize, const R: usize>
    Lanes<'a, L, S, B, R>
{
    /// One step of every motion; whether one has ended.
    #[inline(always)]
    fn step(&mut self) -> bool {
        let Settings {
            order,
            last_term,
            parts,
            ..
        } = self.settings;
        self.expand(order, parts);
        let mut h = longest(&self.series, order, last_term, &self.fastest);
        let mut gap = [0.0; R];
        let mut eventful = false;
        for row in 0..R {
            let ((now, now_rest), (stop, stop_rest)) = (self.now[row], self.stop[row]);
            gap[row] = ((stop - now) + (stop_rest - now_rest)) * self.direction[row];
            // Not "h >= gap": NaN is an event too.
            eventful |= !(h[row] < gap[row]) | !(h[row] > f64::EPSILON * now.abs());
        }
        let mut ended = false;
        let mut landed = [false; R];
        if eventful {
            for row in 0..R {
                if self.leads[row].is_some() {
                    let mut meeting = self.meet(row, h[row]);
                    while let Meeting::Output(time) = meeting {
                        let mut within = Pack::new(0.0);
                        within.set(row, time);
                        let change = increment(&self.series, order, within);
                        self.give(row, &self.state.moved(&change, row));
                        meeting = self.meet(row, h[row]);
                    }
                    (h[row], landed[row]) = match meeting {
                        Meeting::Break(gap) => (gap, true),
                        Meeting::Nothing => (h[row], false),
                        _ => (0.0, false),
                    };
                    ended |= self.leads[row].is_none();
                }
            }
        }
        let mut signed = Pack::new(0.0);
        for row in 0..R {
            h[row] *= self.direction[row];
            signed.set(row, h[row]);
        }
        let change = increment(&self.series, order, signed);
        self.state.add(&change);
        let mut outgrown = false;
        for row in 0..R {
            let (now, rest) = self.now[row];
            self.now[row] = two_sum(now, rest + h[row]);
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
                ended |= self.settle(row, landed[row]);
            }
        }
        for lead in self.leads.iter_mut().flatten() {
            lead.steps += 1;
        }
        ended
    }

    /// The series at the states now.
    #[inline(always)]
    fn expand(&mut self, order: usize, parts: Parts) {
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
        let none = [Pack::new(0.0); 3];
        for k in 0..order {
            let sums = self.series.sums(k);
            let (spins, at) = (S::spins(&sums), self.series.get(k));
            let acceleration = self.field.acceleration(parts, k, spins, &at, none);
            self.series.extend(k, &sums, &acceleration);
        }
    }

    /// What a motion comes to next in a step as long as `h`.
    #[inline(never)]
    fn meet(&mut self, row: usize, h: f64) -> Meeting {
        let time = self.time(row);
        let (now, stop) = (self.now[row], self.stop[row]);
        let Some(lead) = &self.leads[row] else {
            return Meeting::End;
        };
        if !(h > f64::EPSILON * now.0.abs()) {
            let error = if h.is_finite() {
                Error::StepTooSmall {
                    time,
                    step: h / lead.job.course.unit(),
                }
            } else {
                Error::NotFiniteMotion { time }
            };
            self.fail(row, Cause::Failed(error));
            return Meeting::End;
        }
        let gap = (stop.0 - now.0) + (stop.1 - now.1);
        match lead.stop {
            _ if gap * self.direction[row] > h => Meeting::Nothing,
            Stop::Output => Meeting::Output(gap),
            Stop::Break => Meeting::Break(gap * self.direction[row]),
        }
    }

    /// Gives a sample to a motion; after the last one it ends.
    #[inline(never)]
    fn give(&mut self, row: usize, state: &[f64; 7]) {
        let Some(lead) = &mut self.leads[row] else {
            return;
        };
        lead.job.samples[lead.next] = lead.job.course.in_body(state);
        lead.next += 1;
        if lead.next == lead.job.samples.len() {
            let steps = lead.steps + 1;
            *lead.job.outcome = Ok(Effort {
                steps,
                evaluations: steps,
            });
            self.vacate(row);
        } else {
            (self.stop[row], lead.stop) = next_stop(&lead.job.course, lead.next);
        }
    }

    /// After a step: past a break the equations are others, and a motion that has become much faster takes another unit.
    /// Whether it has ended.
    #[inline(never)]
    fn settle(&mut self, row: usize, landed: bool) -> bool {
        let Some(lead) = &mut self.leads[row] else {
            return false;
        };
        let rate = [0, 1, 2].map(|i: usize| self.state.value[i].get(row).abs());
        let outgrown = rate.iter().any(|&x| x > 0.5 * OUTGROWN);
        if landed {
            self.now[row] = self.stop[row];
            if let Err(error) = lead.job.course.pass_break() {
                self.fail(row, Cause::Failed(error));
                return true;
            }
        }
        if landed || outgrown {
            self.enter(row);
        }
        false
    }

    /// The next motion into an empty lane.
    #[inline(never)]
    fn load(&mut self, row: usize, jobs: &mut dyn Iterator<Item = Job<'a>>) {
        let Some(job) = jobs.next() else {
            return;
        };
        let start = job.course.start();
        for i in 0..7 {
            self.state.value[i].set(row, start[i]);
            self.state.rest[i].set(row, 0.0);
        }
        self.now[row] = (0.0, 0.0);
        self.direction[row] = job.course.direction();
        self.fastest[row] = 0.0;
        self.leads[row] = Some(Lead {
            job,
            next: 1,
            stop: Stop::Output,
            steps: 0,
        });
        self.enter(row);
    }

    /// Takes the unit of time, the field and the next stop of a motion.
    fn enter(&mut self, row: usize) {
        let Some(lead) = &mut self.leads[row] else {
            return;
        };
        let course = &mut lead.job.course;
        let old = course.unit();
        let omega = [0, 1, 2].map(|i: usize| self.state.value[i].get(row) * old);
        let unit = course.choose_unit(&omega);
        let ratio = old / unit;
        for i in 0..3 {
            self.state.value[i].set(row, omega[i] / unit);
            let rest = self.state.rest[i].get(row) * ratio;
            self.state.rest[i].set(row, rest);
        }
        let (now, rest) = self.now[row];
        self.now[row] = (now / ratio, rest / ratio);
        let [x, y, z] = omega;
        let speed = (x * x + y * y + z * z).sqrt() / unit;
        self.fastest[row] = (self.fastest[row] * ratio)
            .max(speed)
            .max(self.settings.floor / unit);
        if self.fastest[row] == 0.0 {
            // At rest what the load makes of it is large.
            self.fastest[row] = 1.0;
        }
        self.field.set(row, &course.field());
        for (b, direction) in course.directions::<B>().iter().enumerate() {
            for i in 0..3 {
                self.directions[b][i].set(row, direction[i]);
            }
        }
        (self.stop[row], lead.stop) = next_stop(course, lead.next);
    }

    fn fail(&mut self, row: usize, cause: Cause<Error>) {
        let time = self.time(row);
        let state = self.state.moved(&[Pack::new(0.0); 7], row);
        if let Some(lead) = &mut self.leads[row] {
            *lead.job.outcome = Err(Failure {
                time,
                state: lead.job.course.in_body(&state),
                cause,
            });
        }
        self.vacate(row);
    }

    /// A lane without motion: at rest for ever.
    fn vacate(&mut self, row: usize) {
        for i in 0..7 {
            self.state.value[i].set(row, 0.0);
            self.state.rest[i].set(row, 0.0);
        }
        self.leads[row] = None;
        self.now[row] = (0.0, 0.0);
        self.stop[row] = (f64::INFINITY, 0.0);
        self.fastest[row] = 1.0;
        self.direction[row] = 1.0;
    }

    fn time(&self, row: usize) -> f64 {
        self.leads[row]
            .as_ref()
            .map_or(f64::NAN, |lead| lead.job.course.time(self.now[row]))
    }

    fn fraction(&self) -> f64 {
        self.leads[0]
            .as_ref()
            .map_or(1.0, |lead| lead.job.course.fraction(self.now[0].0))
    }
}

/// The output `next` or the end of the segment, whichever comes first.
fn next_stop(course: &Course, next: usize) -> ((f64, f64), Stop) {
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
fn seen<L: Lane, const R: usize>(q: &[Pack<L, R>; 4], e: &[Pack<L, R>; 3]) -> [Pack<L, R>; 3] {
    let [x, y, z, w] = *q;
    let t = cross(&[x, y, z], e);
    let t = [t[0] + t[0], t[1] + t[1], t[2] + t[2]];
    let u = cross(&[x, y, z], &t);
    let mut seen = *e;
    for i in 0..3 {
        seen[i] = (-w).mul_add(t[i], e[i]) + u[i];
    }
    seen
}

#[inline(always)]
fn cross<L: Lane, const R: usize>(a: &[Pack<L, R>; 3], b: &[Pack<L, R>; 3]) -> [Pack<L, R>; 3] {
    [
        a[1].mul_add(b[2], -(a[2] * b[1])),
        a[2].mul_add(b[0], -(a[0] * b[2])),
        a[0].mul_add(b[1], -(a[1] * b[0])),
    ]
}
