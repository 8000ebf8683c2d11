//! One step of every motion.

use std::hint::black_box;

use super::lanes::{Landing, Lanes, MAX_RATE};
use super::settings::Settings;
use super::stops::Arrival;
use crate::motion::integrate::taylor::batch::{Batch, plus};
use crate::motion::integrate::taylor::course::AuxiliaryState;
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::series::direction_in_body;
use crate::motion::integrate::taylor::series::{Coefficient, Series};
use crate::motion::integrate::taylor::step::longest_step;
use crate::motion::problem::limits::HELD;
use crate::numerics::double_double::{fast_two_sum, two_sum};
use crate::numerics::number::{Number, Real};

impl<L, S, const B: usize, const R: usize> Lanes<'_, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
{
    /// One step of every motion; whether one has ended.
    #[inline(always)]
    pub(super) fn step(&mut self) -> bool {
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
            // What is not a number is an event too.
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

    /// The series at the states now.
    #[inline(always)]
    pub(super) fn expand(&mut self) {
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
        // Several motions have order 0 apart, so that what is special about it is not in their loop.
        let first = usize::from(R > 1);
        for k in 0..first {
            self.extend(k);
        }
        for k in first..order {
            // Hidden from the compiler, which would keep an address for each array and add to all of them in every round: there
            // are more addresses than registers.
            self.extend(black_box(k));
        }
        if let Some(translation) = &mut self.translation {
            translation.expand(order, &self.series, &self.linear_terms);
        }
    }

    /// The coefficients of order `k` + 1.
    #[inline(always)]
    pub(super) fn extend(&mut self, k: usize) {
        self.nonlinear
            .look_ahead(k, &self.series, &self.linear_terms);
        let sums = self.series.sums(k);
        let (spins, at) = (S::spins(&sums), self.series.get(k));
        let acceleration = (self.linear_terms).acceleration(self.settings.parts, k, spins, &at);
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

    /// The coefficient of order `k` of the angular acceleration, with what the elements off the diagonal of the tensor make of it.
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

    /// Serves what a motion comes to within the step `h`: the step that is left, and what it lands on.
    #[inline(always)]
    pub(super) fn serve_stops(&mut self, row: usize, h: f64) -> (f64, Landing) {
        let (mut h, landing) = if self.settings.parts.may_flip() {
            self.until_switch(row, h)
        } else {
            (h, Landing::None)
        };
        if landing == Landing::Switch && self.is_sticking(row, h) {
            h = 0.0; // which advances nothing: an error
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

    /// Whether the law of a motion, which changes after the step `h`, has changed on one spot again and again: then it holds the
    /// body there.
    pub(super) fn is_sticking(&mut self, row: usize, h: f64) -> bool {
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

    /// The state of a motion, and what goes on beside it, at a time since the start of the step.
    #[inline(always)]
    pub(super) fn within(
        &self,
        row: usize,
        time: L::Real,
    ) -> ([L::Real; 7], AuxiliaryState<L::Real>) {
        let mut within = Batch::new(0.0);
        within.put(row, time);
        let order = self.settings.order;
        let change = self.series.increment(order, within);
        let change = self.nonlinear.change_in_space(change);
        let state = self.state.moved(&change, row);
        // No `map`: its closure would be compiled without the instructions of the level.
        let position_velocity = match &self.translation {
            Some(translation) => {
                Some(translation.moved(&translation.increment(order, within), row))
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

    /// Whether a feedback has another sign in the `state` later in the step than at its start, or ω has passed through zero
    /// under quadratic damping.
    #[inline(never)]
    pub(super) fn has_switched(&self, row: usize, state: &[L::Real; 7]) -> bool {
        let motion = self.motions[row].as_ref();
        let start = [0, 1, 2].map(|i| self.state.value[i].get(row));
        let omega = [0, 1, 2].map(|i| state[i].rounded());
        motion.is_some_and(|motion| motion.job.equations.has_switched(state))
            || (self.nonlinear.formulas).is_reversed(row, &start, &omega)
    }
}
