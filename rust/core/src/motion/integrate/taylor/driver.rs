//! The loop over steps: runs motions to their last output time, `R` side by side, each with its own steps.
//!
//! A step stops at outputs, at breaks of the load and at switches of its law.
//!
//! The law of a motion switches at the zeros of its switching functions. These are the scalar part of the error of each feedback and,
//! under quadratic damping, `ω(0)·ω(t)`, which passes through zero with ω. Both are linear in the state. So their series are known,
//! and all their zeros within a step are found, even if they are many or close to each other.

use std::hint::black_box;
use std::mem::swap;
use std::ops::ControlFlow;

use super::batch::{Batch, plus};
use super::directions::direction_in_body;
use super::equations::LinearTerms;
use super::equations::{AuxiliaryState, PiecewiseEquations, Precision};
use super::internal_states::InternalStates;
use super::nonlinear::NonlinearTerms;
use super::orbit_cache::OrbitSeriesCache;
use super::series::{Coefficient, MAX_COUNT, Series};
use super::step::{Compensated, Observer, Step, longest_step};
use super::translation::Translation;
use crate::error::{Error, MotionFault};
use crate::motion::loads::{Forcing, SeriesStructure};
use crate::motion::problem::limits::HELD;
use crate::motion::problem::{Effort, End, Run};
use crate::motion::state::Phase;
use crate::numerics::dispatch::{Kernel, dispatch_within};
use crate::numerics::double_double::{fast_two_sum, two_sum};
use crate::numerics::lane::Lane;
use crate::numerics::number::{Number, Real};
use crate::numerics::sign_changes::sign_changes;

/// The largest ω, in the unit of rates, before another unit is chosen: far below the number whose 26th power overflows.
pub(super) const MAX_RATE: f64 = 65_536.0;

/// Steps of a motion between two checks that it can reach its end.
const STEPS_PER_CHECK: u64 = 64;

/// Steps between two calls of `watch`; fewer with derivatives, whose steps take longer.
const STEPS_PER_PROGRESS: u32 = 64;
const VARIATIONAL_STEPS_PER_PROGRESS: u32 = 4;

/// The size of the last term of a series, relative to the tolerance of a step. The terms left out are a quarter of that. At the tightest
/// tolerance they stay below the rounding of the state even if they all have the same sign.
pub(in crate::motion::integrate) const LAST_TERM: f64 = 0.05;

/// The settings that all motions of a run share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    /// The highest order of the series.
    pub(super) order: usize,
    /// The size of their last terms as a logarithm to base 2.
    last_term: f64,
    /// The least ω that errors are relative to: absolute over relative tolerance.
    floor: f64,
    pub(super) parts: SeriesStructure,
}

impl Settings {
    /// Return the settings for motions with derivatives, whose series limit the step themselves.
    pub(super) fn of_derivatives(order: usize, parts: SeriesStructure) -> Self {
        Self {
            order,
            last_term: 0.0,
            floor: 0.0,
            parts,
        }
    }

    /// Return the settings for equations with these `parts`, with the order at which the work is least, at most `highest`.
    pub(super) fn new(
        relative: f64,
        absolute: f64,
        highest: usize,
        parts: SeriesStructure,
    ) -> Self {
        Self {
            order: order_of_least_work(relative, highest),
            last_term: (LAST_TERM * relative).log2(),
            floor: absolute / relative,
            parts,
        }
    }
}

/// Return the order at which the work is least: the work grows with the square of the order, the step with `tolerance^(1/order)`. It
/// is even, and at most `highest`.
pub(in crate::motion::integrate) fn order_of_least_work(relative: f64, highest: usize) -> usize {
    let nats = -(LAST_TERM * relative).ln();
    let mut halves = (4..highest / 2).filter(|&half| half as f64 + 1.0 <= 0.36 * nats);
    2 * halves.next_back().map_or(4, |half| half + 1)
}

/// A function that gets the samples of a motion in the numbers of its run.
pub(super) type SampleSink<'a, X> = &'a mut dyn FnMut(usize, &[X; 7], &[X]);

/// A motion to compute, and its run, which is at its start.
pub(super) struct Job<'a, X: Precision> {
    /// In a box: a job passes through several hands.
    pub(super) equations: Box<PiecewiseEquations<'a, X>>,
    pub(super) run: &'a mut Run<Error>,
    /// Gets the number of each sample, ω and (x, y, z, w) in body axes and real units, and the values of the states of the load that are
    /// reported.
    pub(super) sink: Option<SampleSink<'a, X>>,
}

/// The next time at which a motion stops.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// A time of output.
    Output,
    /// A break of its load.
    Break,
}

/// The reason for which the equations of a motion change after a step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Landing {
    None,
    Break,
    Switch,
}

/// A motion in a lane.
pub(super) struct ActiveMotion<'a, X: Precision> {
    pub(super) job: Job<'a, X>,
    pub(super) stop: Stop,
    pub(super) steps: u64,
    /// Switches of the law without a step between them.
    pub(super) switches_without_step: u32,
}

impl<X: Precision> ActiveMotion<'_, X> {
    /// Return whether the number of steps must be checked: every [`STEPS_PER_CHECK`] steps, and at the largest number allowed.
    #[inline(always)]
    fn is_due(&self) -> bool {
        self.steps >= self.job.equations.most_steps() || self.steps.is_multiple_of(STEPS_PER_CHECK)
    }
}

/// `R` motions side by side. Times are since the start, in the unit of each motion.
pub(super) struct Lanes<'a, L: Number<Real: Precision>, S, const B: usize, const R: usize> {
    pub(super) settings: Settings,
    pub(super) series: S,
    linear_terms: LinearTerms<Batch<L, R>, B>,
    pub(super) nonlinear: NonlinearTerms<Batch<L, R>>,
    /// The terms of one motion that depend on time; stored here so that no step allocates memory.
    forcing: Forcing<L::Real>,
    directions: [[Batch<L, R>; 3]; B],
    pub(super) state: Compensated<Batch<L, R>>,
    translation: Option<Box<Translation<Batch<L, R>>>>,
    pub(super) internal_states: Option<Box<InternalStates<Batch<L, R>>>>,
    pub(super) motions: [Option<ActiveMotion<'a, L::Real>>; R],
    /// The present time and that of the next stop, each with its rounding error.
    pub(super) now: [(f64, f64); R],
    pub(super) stop: [(f64, f64); R],
    /// The size of ω that errors are relative to: the largest |ω| so far, or more; and 1, or −1 for backward in time.
    fastest: [f64; R],
    pub(super) direction: [f64; R],
    /// Which components of ω are constant in each motion.
    constant_components: [[bool; 3]; R],
}

/// Run all motions of `jobs`. About every 64 steps `watch` gets the fraction of the motion in the first lane that is done, and may stop
/// all. `observer` gets each step if there is one lane. Orbits are read from `cache` and inserted there.
#[inline(always)]
pub(super) fn drive<
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
    const B: usize,
    const R: usize,
>(
    settings: Settings,
    jobs: &mut dyn Iterator<Item = Job<'_, L::Real>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    observer: Option<Observer>,
    cache: &mut OrbitSeriesCache,
) -> ControlFlow<()> {
    let mut lanes = Lanes::<L, S, B, R>::new(settings);
    swap(&mut lanes.nonlinear.cache, cache);
    let flow = run(&mut lanes, jobs, watch, observer);
    swap(&mut lanes.nonlinear.cache, cache);
    flow
}

#[inline(always)]
fn run<
    'a,
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
    const B: usize,
    const R: usize,
>(
    lanes: &mut Lanes<'a, L, S, B, R>,
    jobs: &mut dyn Iterator<Item = Job<'a, L::Real>>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    mut observer: Option<Observer>,
) -> ControlFlow<()> {
    let steps_per_progress = if L::VARIES {
        VARIATIONAL_STEPS_PER_PROGRESS
    } else {
        STEPS_PER_PROGRESS
    };
    let mut steps_left = steps_per_progress;
    let mut idle = true;
    loop {
        if idle {
            for row in 0..R {
                if lanes.motions[row].is_none() {
                    lanes.load_next(row, jobs);
                }
            }
            if lanes.motions.iter().all(Option::is_none) {
                return ControlFlow::Continue(());
            }
        }
        // Known to the compiler: for several motions, and for derivatives, it leaves out what an observer gets.
        let before = if const { R == 1 && !L::VARIES } && observer.is_some() {
            lanes.step_start()
        } else {
            None
        };
        idle = lanes.step();
        idle |= lanes.end_overlong();
        // The last step of a motion that failed ends at a wrong time. It is not used: `solve_with_observer` passes on the last step
        // of a complete run only.
        if const { R == 1 && !L::VARIES }
            && let (Some(observer), Some(before)) = (&mut observer, before)
            && observer(lanes.finished_step(before), idle).is_break()
        {
            lanes.end_motion(0, End::Stopped);
            return ControlFlow::Break(());
        }
        steps_left -= 1;
        if steps_left == 0 {
            steps_left = steps_per_progress;
            if watch(lanes.fraction()).is_break() {
                for row in 0..R {
                    lanes.end_motion(row, End::Stopped);
                }
                return ControlFlow::Break(());
            }
        }
    }
}

impl<'a, L, S, const B: usize, const R: usize> Lanes<'a, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
{
    /// Return lanes without motions.
    #[inline(always)]
    fn new(settings: Settings) -> Self {
        let zero = Batch::new(0.0);
        Self {
            settings,
            series: S::new(),
            linear_terms: LinearTerms::none(zero),
            nonlinear: NonlinearTerms::new(&settings.parts),
            forcing: Forcing::default(),
            directions: [[zero; 3]; B],
            state: Compensated::new(),
            translation: settings
                .parts
                .is_pushed
                .then(|| Box::new(Translation::ZERO)),
            internal_states: match settings.parts.internal_states {
                0 => None,
                count => Some(Box::new(InternalStates::new(count))),
            },
            motions: [const { None }; R],
            now: [(0.0, 0.0); R],
            stop: [(f64::INFINITY, 0.0); R],
            fastest: [1.0; R],
            direction: [1.0; R],
            constant_components: [[true; 3]; R],
        }
    }

    /// Set in the series which component of ω is constant in all motions.
    fn update_constant_component(&mut self) {
        let is_constant = |n: &usize| self.constant_components.iter().all(|row| row[*n]);
        let constant = [0, 2].into_iter().find(is_constant);
        let is_autonomous = !self.nonlinear.is_timed() && self.internal_states.is_none();
        self.series
            .set_constant_component(constant.filter(|_| is_autonomous));
    }

    /// Compute the time from now to the next stop, positive also backward in time.
    #[inline(always)]
    pub(super) fn gap(&self, row: usize) -> f64 {
        let ((now, now_rest), (stop, stop_rest)) = (self.now[row], self.stop[row]);
        ((stop - now) + (stop_rest - now_rest)) * self.direction[row]
    }

    /// Compute the time from now to the next stop. Not inlined: the compiler would compute it in every step, but only a break or an
    /// output needs it.
    #[inline(never)]
    pub(super) fn time_to_stop(&self, row: usize) -> L::Real {
        let ((now, now_rest), (stop, stop_rest)) = (self.now[row], self.stop[row]);
        L::Real::pair(stop, -now) + L::Real::pair(stop_rest, -now_rest)
    }

    pub(super) fn time(&self, row: usize) -> f64 {
        let motion = self.motions[row].as_ref();
        motion.map_or(f64::NAN, |motion| motion.job.equations.time(self.now[row]))
    }

    fn fraction(&self) -> f64 {
        let motion = self.motions[0].as_ref();
        motion.map_or(1.0, |motion| motion.job.equations.fraction(self.now[0].0))
    }

    /// Put the next motion into an empty lane; if none is left, the lane stays empty.
    #[inline(never)]
    fn load_next(&mut self, row: usize, jobs: &mut dyn Iterator<Item = Job<'a, L::Real>>) {
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

    /// Set the unit of rates, the equations and the next stop of a motion for its present segment.
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
            // At rest: errors are relative to the unit of rates, which is that of the load.
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
        // Numbers with derivatives have room for three directions: the last are used, the others are zero.
        let directions = PiecewiseEquations::<L::Real>::directions::<B>();
        for b in B.saturating_sub(self.settings.parts.directions)..B {
            for i in 0..3 {
                self.directions[b][i].put(row, directions[b][i]);
            }
        }
        let next = motion.job.run.samples.len();
        (self.stop[row], motion.stop) = next_stop(equations, next);
        self.update_constant_component();
    }

    /// Return the present state beside attitude and ω.
    fn auxiliary_state(&self, row: usize) -> AuxiliaryState<L::Real> {
        AuxiliaryState {
            position_velocity: self
                .translation
                .as_ref()
                .map(|translation| translation.now(row)),
            internal_states: (self.internal_states.as_ref())
                .map_or_else(Vec::new, |internal_states| internal_states.now(row)),
        }
    }

    /// End a motion before its last output.
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

    /// End the motions that would take too many steps, and return whether there was one. Only its own steps count for a motion, not
    /// those of the motions beside it.
    #[inline(always)]
    fn end_overlong(&mut self) -> bool {
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

    /// Empty a lane: its numbers are those of a motion at rest without end.
    fn clear(&mut self, row: usize) {
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

    /// Make one step of every motion, and return whether a motion has ended.
    #[inline(always)]
    fn step(&mut self) -> bool {
        let Settings {
            order, last_term, ..
        } = self.settings;
        self.expand();
        let mut h = longest_step(&self.series, order, last_term, &self.fastest);
        self.nonlinear.formulas.limit(&self.series, &mut h);
        self.series.limit(&mut h);
        if let Some(internal_states) = &mut self.internal_states {
            internal_states.limit(order, last_term, &self.fastest, &mut h);
        }
        let mut eventful = self.settings.parts.may_flip();
        for row in 0..R {
            let (now, rest) = self.now[row];
            let ago = (now * self.direction[row], rest * self.direction[row]);
            h[row] = self.nonlinear.shorten_step(ago, h[row]);
            let (now, gap) = (self.now[row].0, self.gap(row));
            // A NaN step length also takes the slow path.
            let is_plain = (h[row] < gap) & (h[row] > f64::EPSILON * now.abs());
            eventful |= !is_plain;
        }
        let mut landings = [Landing::None; R];
        if eventful {
            for row in 0..R {
                if self.motions[row].is_some() {
                    (h[row], landings[row]) = self.serve_stops(row, h[row]);
                }
            }
        }
        let mut signed = Batch::new(0.0);
        for row in 0..R {
            h[row] *= self.direction[row];
            signed.set(row, h[row]);
            if landings[row] == Landing::Break {
                signed.put(row, self.time_to_stop(row));
            }
        }
        let change = self.series.increment(order, signed);
        self.state.add(&self.nonlinear.change_in_space(change));
        if let Some(translation) = &mut self.translation {
            let change = translation.increment(order, signed);
            translation.add(&change);
        }
        if let Some(internal_states) = &mut self.internal_states {
            internal_states.advance(order, signed);
        }
        self.nonlinear.advance(order, signed);
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
            outgrown |= speed > MAX_RATE;
        }
        if eventful | outgrown {
            for row in 0..R {
                self.finish_step(row, landings[row]);
                ended |= self.motions[row].is_none();
            }
        }
        for motion in self.motions.iter_mut().flatten() {
            motion.steps += 1;
        }
        ended
    }

    /// Compute the series at the present states.
    #[inline(always)]
    fn expand(&mut self) {
        let order = self.settings.order;
        if self.nonlinear.is_timed() {
            for row in 0..R {
                if let Some(motion) = &self.motions[row] {
                    let equations = &motion.job.equations;
                    let now = self.now[row];
                    self.forcing.clear();
                    self.forcing.has_orbits =
                        (self.nonlinear).look_up(row, || equations.cache_key(now));
                    if self.forcing.has_orbits && self.nonlinear.has_only_orbits() {
                        continue;
                    }
                    equations.force(&mut self.forcing, now);
                    (self.nonlinear).set(row, &self.forcing, equations.inverse_moments());
                }
            }
            self.nonlinear.expand(order);
        }
        let [w0, w1, w2, x, y, z, w] = self.state.value.components();
        let q = [x, y, z, w];
        let mut g = self.directions;
        for g in &mut g {
            *g = direction_in_body(&q, g);
        }
        self.series.start(&Coefficient {
            w: [w0, w1, w2],
            q: self.nonlinear.initial_attitude(q),
            g,
        });
        self.nonlinear.start(&self.fastest, &self.linear_terms);
        if let Some(internal_states) = &mut self.internal_states {
            internal_states.start();
        }
        let parts = self.settings.parts;
        let are_linear = self.nonlinear.is_empty() && self.internal_states.is_none();
        if R > 1 && are_linear && !parts.on_attitude {
            if parts.on_omega {
                self.extend_linear::<true>(order);
            } else {
                self.extend_linear::<false>(order);
            }
        } else {
            // For several motions order 0 is computed before the loop, so that its special terms are not in the loop.
            let first = usize::from(R > 1);
            for k in 0..first {
                self.extend(k);
            }
            for k in first..order {
                // Hidden from the compiler: it would keep an address for each array and increment all of them in every iteration, and
                // there are more addresses than registers.
                self.extend(black_box(k));
            }
        }
        if let Some(translation) = &mut self.translation {
            translation.expand(order, &self.series, &self.linear_terms);
        }
    }

    /// Compute all coefficients under torques that are linear in ω (if `ON_OMEGA`) and in directions of space, or constant. The loop does
    /// not choose between torques: where two ways meet, the compiler takes the numbers of several motions apart and computes one after
    /// the other.
    #[inline(always)]
    fn extend_linear<const ON_OMEGA: bool>(&mut self, order: usize) {
        let parts = SeriesStructure {
            on_omega: ON_OMEGA,
            ..SeriesStructure::default()
        };
        self.extend_by_linear_terms(parts, 0, true);
        for k in 1..order {
            // Hidden, as in the loop for all torques.
            self.extend_by_linear_terms(parts, black_box(k), false);
        }
    }

    /// Compute the coefficients of order `k` + 1 under torques with these `parts` alone.
    #[inline(always)]
    fn extend_by_linear_terms(&mut self, parts: SeriesStructure, k: usize, is_first: bool) {
        let sums = self.series.sums(k);
        let (spins, at) = (S::spins(&sums), self.series.get(k));
        let acceleration = (self.linear_terms).acceleration(parts, is_first, spins, &at);
        self.series.extend(k, &sums, &acceleration);
    }

    /// Compute the coefficients of order `k` + 1.
    #[inline(always)]
    fn extend(&mut self, k: usize) {
        self.nonlinear
            .look_ahead(k, &self.series, &self.linear_terms);
        let sums = self.series.sums(k);
        let (spins, at) = (S::spins(&sums), self.series.get(k));
        let acceleration =
            (self.linear_terms).acceleration(self.settings.parts, k == 0, spins, &at);
        let series = &self.series;
        let acceleration = self.nonlinear.plus_coefficients(k, series, acceleration);
        let acceleration = match &mut self.internal_states {
            Some(internal_states) => internal_states.plus_coefficients(k, series, acceleration),
            None => acceleration,
        };
        let acceleration = if L::VARIES && self.linear_terms.has_off_diagonal() {
            self.add_off_diagonal(k, &spins, acceleration)
        } else {
            acceleration
        };
        self.series.extend(k, &sums, &acceleration);
    }

    /// Add the terms of elements off the diagonal of the tensor to the coefficient of order `k` of the angular acceleration.
    #[inline(never)]
    fn add_off_diagonal(
        &self,
        k: usize,
        spins: &[Batch<L, R>; 3],
        acceleration: [Batch<L, R>; 3],
    ) -> [Batch<L, R>; 3] {
        let linear_terms = &self.linear_terms;
        let mut squares = [Batch::new(0.0); 3];
        for j in 0..=k {
            let (a, b) = (self.series.get(j).w, self.series.get(k - j).w);
            squares = [0, 1, 2].map(|i| a[i].mul_add(b[i], squares[i]));
        }
        linear_terms.divide_by_off_diagonal(&plus(
            acceleration,
            linear_terms.off_diagonal_torque(&linear_terms.products, spins, &squares),
        ))
    }

    /// Compute the state of a motion, and the state beside it, at a time since the start of the step.
    #[inline(never)]
    pub(super) fn within(
        &self,
        row: usize,
        time: L::Real,
    ) -> ([L::Real; 7], AuxiliaryState<L::Real>) {
        if L::LEVEL == 0 {
            // Numbers with derivatives: their loop over steps is not compiled for a level.
            self.find_within(row, time)
        } else {
            dispatch_within::<L, _>(Within {
                lanes: self,
                row,
                time,
            })
        }
    }

    #[inline(always)]
    fn find_within(&self, row: usize, time: L::Real) -> ([L::Real; 7], AuxiliaryState<L::Real>) {
        let mut within = Batch::new(0.0);
        within.put(row, time);
        let order = self.settings.order;
        let change = self.series.increment(order, within);
        let change = self.nonlinear.change_in_space(change);
        let state = self.state.state_after(&change, row);
        // Without `map`: its closure would be compiled without the instructions of the level.
        let position_velocity = match &self.translation {
            Some(translation) => {
                Some(translation.state_after(&translation.increment(order, within), row))
            }
            None => None,
        };
        let internal_states = match &self.internal_states {
            Some(internal_states) => internal_states.within(row, order, within),
            None => Vec::new(),
        };
        (
            state,
            AuxiliaryState {
                position_velocity,
                internal_states,
            },
        )
    }

    /// Return the state at the start of the next step of the first motion.
    #[inline(never)]
    fn step_start(&self) -> Option<StepStart<'a, L, R>> {
        let motion = self.motions[0].as_ref()?;
        Some(StepStart {
            equations: motion.job.equations.clone(),
            now: self.now[0],
            state: self.state.clone(),
            auxiliary: self.auxiliary_state(0),
        })
    }

    /// Return the last step as polynomials; `before` is the state at its start.
    #[inline(never)]
    fn finished_step(&self, before: StepStart<'a, L, R>) -> Step {
        let StepStart {
            equations,
            now,
            state,
            auxiliary,
        } = before;
        let order = self.settings.order;
        let mut series = Vec::with_capacity(order);
        for k in 1..=order {
            let Coefficient { w, q, .. } = self.series.get(k);
            let q = self.nonlinear.to_space(q);
            let [w0, w1, w2, x, y, z, s] = [w[0], w[1], w[2], q[0], q[1], q[2], q[3]];
            let coefficient = [w0, w1, w2, x, y, z, s].map(|number| number.real(0));
            series.push(equations.in_body(&coefficient).map(L::Real::rounded));
        }
        let mut own = Vec::new();
        if let Some(internal_states) = &self.internal_states {
            for k in 0..=order {
                let coefficients =
                    equations.internal_states_in_body(&internal_states.coefficients(0, k));
                own.push(coefficients.into_iter().map(L::Real::rounded).collect());
            }
        }
        // The difference from the rounded doubles, which is large for double-double numbers.
        let own_change = equations
            .internal_states_in_body(&auxiliary.internal_states)
            .into_iter()
            .enumerate();
        let own_change: Vec<f64> = own_change
            .map(|(i, exact)| {
                let rounded: &Vec<f64> = &own[0];
                (exact - rounded[i].into()).rounded()
            })
            .collect();
        let unit = equations.unit();
        let end = self.motions[0].as_ref().map_or_else(
            || equations.last_elapsed(),
            |motion| (self.now[0].0 + self.now[0].1) / motion.job.equations.unit(),
        );
        let begin = (now.0 + now.1) / unit;
        let initial = equations.initial();
        let state_in_body =
            equations.in_body(&state.value.components().map(|number| number.real(0)));
        let rest_in_body = equations.in_body(&state.rest.components().map(|number| number.real(0)));
        let rounded = state_in_body.map(L::Real::rounded);
        let change = |i: usize| (state_in_body[i] - rounded[i].into() + rest_in_body[i]).rounded();
        Step {
            ends: [begin, end],
            rest: ((now.0 - begin * unit) + now.1) / unit,
            unit,
            state: rounded,
            change: std::array::from_fn(change),
            series,
            own,
            own_change,
            path: (self.translation.as_ref().zip(auxiliary.position_velocity))
                .map_or_else(Vec::new, |(translation, place)| {
                    translation.path(0, order, &place)
                }),
            initial: [initial.position, initial.velocity],
        }
    }
}

/// Computes the state of a motion within a step.
struct Within<'a, 'b, L: Number<Real: Precision>, S, const B: usize, const R: usize> {
    lanes: &'b Lanes<'a, L, S, B, R>,
    row: usize,
    time: L::Real,
}

impl<N, S, const B: usize, const R: usize> Kernel for Within<'_, '_, N, S, B, R>
where
    N: Number<Real: Precision>,
    S: Series<Batch<N, R>, B>,
{
    type Output = ([N::Real; 7], AuxiliaryState<N::Real>);

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        self.lanes.find_within(self.row, self.time)
    }
}

/// Return the output `next` or the end of the segment, whichever comes first.
pub(super) fn next_stop<X: Precision>(
    equations: &PiecewiseEquations<X>,
    next: usize,
) -> ((f64, f64), Stop) {
    let (output, end) = (equations.output(next), equations.end_of_segment());
    // An output on a break belongs to the segment that ends there.
    let ahead = ((output.0 - end.0) + (output.1 - end.1)) * equations.direction();
    if ahead > 0.0 {
        (end, Stop::Break)
    } else {
        (output, Stop::Output)
    }
}

/// Return the effort of so many steps. One evaluation computes all coefficients of a step.
pub(super) fn effort(steps: u64) -> Effort {
    Effort {
        steps,
        evaluations: steps,
    }
}

/// The state at the start of a step.
struct StepStart<'a, L: Number<Real: Precision>, const R: usize> {
    equations: Box<PiecewiseEquations<'a, L::Real>>,
    now: (f64, f64),
    state: Compensated<Batch<L, R>>,
    auxiliary: AuxiliaryState<L::Real>,
}

/// The largest distance behind a zero of the series, relative to the step, at which the sign of a function is checked.
const HIDDEN_BY_ROUNDING: f64 = 1e-9;

/// The next stop of a motion within a step.
enum Arrival<X> {
    /// An output at this time since the start of the step.
    Output(X),
    /// A break after this time.
    Break(f64),
    Nothing,
    End,
}

impl<L, S, const B: usize, const R: usize> Lanes<'_, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
{
    /// Record the outputs of a motion within the step `h`. Return the length of the step, up to a break or a switch, and its landing.
    #[inline(always)]
    pub(super) fn serve_stops(&mut self, row: usize, h: f64) -> (f64, Landing) {
        let (mut h, landing) = if self.settings.parts.may_flip() {
            self.until_switch(row, h)
        } else {
            (h, Landing::None)
        };
        if landing == Landing::Switch && self.is_sticking(row, h) {
            h = 0.0; // a step without length is an error
        }
        loop {
            let time = match self.next_arrival(row, h) {
                Arrival::Output(time) => time,
                Arrival::Break(gap) => return (gap, Landing::Break),
                Arrival::Nothing => return (h, landing),
                Arrival::End => return (0.0, Landing::None),
            };
            let (state, auxiliary) = self.within(row, time);
            self.record_sample(row, &state, &auxiliary);
        }
    }

    /// Return the next stop of a motion in a step of length `h`.
    #[inline(never)]
    fn next_arrival(&mut self, row: usize, h: f64) -> Arrival<L::Real> {
        let gap = self.gap(row);
        let time = self.time(row);
        let Some(motion) = &self.motions[row] else {
            return Arrival::End;
        };
        let advances = h > f64::EPSILON * self.now[row].0.abs();
        if !advances {
            let error = if h.is_finite() {
                Error::Motion(MotionFault::StepTooSmall {
                    time,
                    step: h / motion.job.equations.unit(),
                })
            } else {
                Error::Motion(MotionFault::NotFiniteMotion { time })
            };
            self.end_motion(row, End::Failed(error));
            return Arrival::End;
        }
        match motion.stop {
            _ if gap > h => Arrival::Nothing,
            Stop::Output => Arrival::Output(self.time_to_stop(row)),
            Stop::Break => Arrival::Break(gap),
        }
    }

    /// Record a sample of a motion; after the last sample the motion ends.
    #[inline(never)]
    fn record_sample(
        &mut self,
        row: usize,
        state: &[L::Real; 7],
        auxiliary: &AuxiliaryState<L::Real>,
    ) {
        let now = self.stop[row];
        let Some(motion) = &mut self.motions[row] else {
            return;
        };
        let phase = motion.job.equations.phase(state, auxiliary, now);
        let run = &mut *motion.job.run;
        if !phase.is_finite() {
            // The run ends at its last finite sample.
            let before = run.samples.len() - 1;
            run.effort = effort(motion.steps);
            run.time = motion.job.equations.time_of(before);
            run.phase = run.samples[before].clone();
            let time = motion.job.equations.time_of(before + 1);
            run.end = End::Failed(Error::Motion(MotionFault::NotFiniteMotion { time }));
            self.motions[row] = None;
            return;
        }
        let number = run.samples.len();
        let is_last = motion.job.equations.is_last(number);
        if is_last {
            run.phase.clone_from(&phase);
        }
        run.samples.push(phase);
        if let Some(sink) = &mut motion.job.sink {
            let equations = &motion.job.equations;
            let own = equations.reported_internal_states(state, &auxiliary.internal_states);
            sink(number, &equations.in_body(state), &own);
        }
        if is_last {
            run.effort = effort(motion.steps + 1);
            run.time = motion.job.equations.last_time();
            run.end = End::Complete;
            self.motions[row] = None;
        } else {
            (self.stop[row], motion.stop) = next_stop(&motion.job.equations, number + 1);
        }
    }

    /// Finish a step: change the equations after a break or a switch, and the unit of a motion that has become much faster.
    #[inline(never)]
    pub(super) fn finish_step(&mut self, row: usize, landing: Landing) {
        let mut state = self.state.now(row);
        let mut own = match &self.internal_states {
            Some(internal_states) if L::VARIES => internal_states.now(row),
            _ => Vec::new(),
        };
        let Some(motion) = &mut self.motions[row] else {
            return;
        };
        let equations = &mut motion.job.equations;
        let changed = match landing {
            Landing::None => Ok(()),
            Landing::Break => {
                self.now[row] = self.stop[row];
                self.nonlinear.restart(row);
                equations.pass_break(&state)
            }
            Landing::Switch => equations.switch_laws(&mut state, &mut own),
        };
        if L::VARIES && landing == Landing::Switch {
            for i in 0..3 {
                self.state.value[i].put(row, state[i]);
            }
            if let Some(internal_states) = &mut self.internal_states {
                internal_states.put(row, &own);
            }
        }
        if let Err(error) = changed {
            self.end_motion(row, End::Failed(error));
        } else if landing != Landing::None
            || state[..3]
                .iter()
                .any(|w| w.rounded().abs() > 0.5 * MAX_RATE)
        {
            self.enter_segment(row);
        }
    }

    /// Return whether the law of a motion, which switches after the step `h`, has switched many times without a step between: then it
    /// holds the body there.
    fn is_sticking(&mut self, row: usize, h: f64) -> bool {
        let least = (4.0 * f64::EPSILON * self.now[row].0.abs()).max(f64::MIN_POSITIVE);
        let Some(motion) = &mut self.motions[row] else {
            return false;
        };
        motion.switches_without_step = if h > least {
            0
        } else {
            motion.switches_without_step + 1
        };
        motion.switches_without_step > HELD
    }

    /// Return the length of the step of one row: `h`, or the time until the law switches.
    #[inline(always)]
    fn until_switch(&self, row: usize, h: f64) -> (f64, Landing) {
        for zero in self.switch_times(row, h) {
            // The state itself must have the new sign, here or a few last digits later. If rounding hides it, there is no switch.
            let (mut time, mut later) = (zero, f64::EPSILON * zero.max(f64::EPSILON * h));
            while time <= h && later <= HIDDEN_BY_ROUNDING * h {
                let (state, _) = self.within(row, L::Real::from(time * self.direction[row]));
                if self.has_switched(row, &state) {
                    return (time, Landing::Switch);
                }
                time = zero + later;
                later *= 2.0;
            }
        }
        (h, Landing::None)
    }

    /// Find the zeros of the series of the switching functions within the step `h` of one row: times, ascending.
    #[inline(never)]
    fn switch_times(&self, row: usize, h: f64) -> Vec<f64> {
        let mut switch_times = Vec::new();
        let Some(motion) = &self.motions[row] else {
            return switch_times;
        };
        let equations = &motion.job.equations;
        let now = self.now[row];
        let end = equations.end_of_segment();
        let left = ((end.0 - now.0) + (end.1 - now.1)) * self.direction[row];
        let length = h.min(left);
        // The shortest step that advances the time.
        let least = 2.0 * f64::EPSILON * now.0.abs();
        // A step that is NaN, or does not advance the time, is an error elsewhere.
        if !(h.is_finite() && length > least) {
            return switch_times;
        }
        let mut add_zeros = |value: &dyn Fn(usize) -> f64, side: f64| {
            let mut coefficients = [0.0; MAX_COUNT];
            let coefficients = &mut coefficients[..=self.settings.order];
            let mut power = 1.0;
            for (k, coefficient) in coefficients.iter_mut().enumerate() {
                *coefficient = value(k) * power;
                power *= length * self.direction[row];
            }
            switch_times.extend(sign_changes(coefficients, Some(side)));
        };
        for index in 0..equations.switch_count() {
            let value = |k: usize| {
                let q = self.series.get(k).q;
                equations.switch_value(index, &[0, 1, 2, 3].map(|i| q[i].real(row)))
            };
            add_zeros(&value, equations.side(index));
        }
        if self.nonlinear.formulas.may_reverse(row) {
            let start = [0, 1, 2].map(|i| self.state.value[i].get(row));
            let along = |k: usize| {
                let w = self.series.get(k).w;
                (0..3).map(|i| start[i] * w[i].get(row)).sum()
            };
            add_zeros(&along, 1.0);
        }
        switch_times.sort_by(f64::total_cmp);
        (switch_times.into_iter())
            .map(|zero| (zero * length).max(least).max(f64::MIN_POSITIVE))
            .collect()
    }

    /// Return whether a feedback has changed its sign between the start of the step and `state`, or ω has passed through zero under
    /// quadratic damping.
    #[inline(never)]
    fn has_switched(&self, row: usize, state: &[L::Real; 7]) -> bool {
        let motion = self.motions[row].as_ref();
        let start = [0, 1, 2].map(|i| self.state.value[i].get(row));
        let omega = [0, 1, 2].map(|i| state[i].rounded());
        motion.is_some_and(|motion| motion.job.equations.has_switched(state))
            || (self.nonlinear.formulas).is_reversed(row, &start, &omega)
    }
}
