//! One step of every motion.

use std::hint::black_box;

use super::lanes::{Landing, Lanes, OUTGROWN};
use super::settings::Settings;
use super::stops::Meeting;
use crate::motion::integrate::taylor::course::Besides;
use crate::motion::integrate::taylor::directions::seen;
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::batch::{Pack, plus};
use crate::motion::integrate::taylor::series::{Coefficient, Series};
use crate::motion::integrate::taylor::step::longest;
use crate::motion::problem::limits::HELD;
use crate::numerics::double_double::{fast_two_sum, two_sum};
use crate::numerics::number::{Number, Real};

impl<L, S, const B: usize, const R: usize> Lanes<'_, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Pack<L, R>, B>,
{
    /// One step of every motion; whether one has ended.
    #[inline(always)]
    pub(super) fn step(&mut self) -> bool {
        let Settings {
            order, last_term, ..
        } = self.settings;
        self.expand();
        let mut h = longest(&self.series, order, last_term, &self.fastest);
        self.extras.formulas.limit(&self.series, &mut h);
        self.series.limit(&mut h);
        if let Some(carried) = &mut self.carried {
            carried.limit(order, last_term, &self.fastest, &mut h);
        }
        let mut eventful = self.settings.parts.may_flip();
        for row in 0..R {
            let (now, rest) = self.now[row];
            let ago = (now * self.direction[row], rest * self.direction[row]);
            h[row] = self.extras.shortened(ago, h[row]);
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
        let change = self.series.increment(order, signed);
        self.state.add(&self.extras.change_in_space(change));
        if let Some(push) = &mut self.push {
            let change = push.increment(order, signed);
            push.add(&change);
        }
        if let Some(carried) = &mut self.carried {
            carried.advance(order, signed);
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
    pub(super) fn expand(&mut self) {
        let order = self.settings.order;
        if self.extras.is_timed() {
            for row in 0..R {
                if let Some(lead) = &self.leads[row] {
                    let course = &lead.job.course;
                    let now = self.now[row];
                    self.forcing.clear();
                    self.forcing.has_orbits = (self.extras).recall(row, || course.place(now));
                    if self.forcing.has_orbits && self.extras.has_orbits_alone() {
                        continue;
                    }
                    course.force(&mut self.forcing, now);
                    (self.extras).set(row, &self.forcing, course.inverse_moments());
                }
            }
            self.extras.expand(order);
        }
        let [w0, w1, w2, x, y, z, w] = self.state.value.all();
        let q = [x, y, z, w];
        let mut g = self.directions;
        for g in &mut g {
            *g = seen(&q, g);
        }
        self.series.start(&Coefficient {
            w: [w0, w1, w2],
            q: self.extras.begun(q),
            g,
        });
        self.extras.start(&self.fastest, &self.field);
        if let Some(carried) = &mut self.carried {
            carried.start();
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
        if let Some(push) = &mut self.push {
            push.expand(order, &self.series, &self.field);
        }
    }

    /// The coefficients of order `k` + 1.
    #[inline(always)]
    pub(super) fn extend(&mut self, k: usize) {
        self.extras.look_ahead(k, &self.series, &self.field);
        let sums = self.series.sums(k);
        let (spins, at) = (S::spins(&sums), self.series.get(k));
        let acceleration = (self.field).acceleration(self.settings.parts, k, spins, &at);
        let (series, field) = (&self.series, &self.field);
        let acceleration = self
            .extras
            .plus_coefficients(k, series, field, acceleration);
        let acceleration = match &mut self.carried {
            Some(carried) => carried.plus_coefficients(k, series, acceleration),
            None => acceleration,
        };
        let acceleration = if L::VARIES && self.field.is_tilted() {
            self.tilted(k, &spins, acceleration)
        } else {
            acceleration
        };
        self.series.extend(k, &sums, &acceleration);
    }

    /// The coefficient of order `k` of the angular acceleration, with what the elements off the diagonal of the tensor make of it.
    #[inline(never)]
    fn tilted(
        &self,
        k: usize,
        spins: &[Pack<L, R>; 3],
        acceleration: [Pack<L, R>; 3],
    ) -> [Pack<L, R>; 3] {
        let field = &self.field;
        let mut squares = [Pack::new(0.0); 3];
        for j in 0..=k {
            let (a, b) = (self.series.get(j).w, self.series.get(k - j).w);
            squares = [0, 1, 2].map(|i| a[i].mul_add(b[i], squares[i]));
        }
        field.tilted(&plus(
            acceleration,
            field.tilt(&field.products, spins, &squares),
        ))
    }

    /// Serves what a motion comes to within the step `h`: the step that is left, and what it lands on.
    #[inline(always)]
    pub(super) fn pass(&mut self, row: usize, h: f64) -> (f64, Landing) {
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
            let (state, besides) = self.within(row, time);
            self.give(row, &state, &besides);
        }
    }

    /// Whether the law of a motion, which changes after the step `h`, has changed on one spot again and again: then it holds the
    /// body there.
    pub(super) fn is_held(&mut self, row: usize, h: f64) -> bool {
        let least = (4.0 * f64::EPSILON * self.now[row].0.abs()).max(f64::MIN_POSITIVE);
        let Some(lead) = &mut self.leads[row] else {
            return false;
        };
        lead.flips_at_once = if h > least { 0 } else { lead.flips_at_once + 1 };
        lead.flips_at_once > HELD
    }

    /// The state of a motion, and what goes on beside it, at a time since the start of the step.
    #[inline(always)]
    pub(super) fn within(&self, row: usize, time: L::Real) -> ([L::Real; 7], Besides<L::Real>) {
        let mut within = Pack::new(0.0);
        within.put(row, time);
        let order = self.settings.order;
        let change = self.series.increment(order, within);
        let change = self.extras.change_in_space(change);
        let state = self.state.moved(&change, row);
        // No `map`: its closure would be compiled without the instructions of the level.
        let place = match &self.push {
            Some(push) => Some(push.moved(&push.increment(order, within), row)),
            None => None,
        };
        let own = match &self.carried {
            Some(carried) => carried.within(row, order, within),
            None => Vec::new(),
        };
        (state, Besides { place, own })
    }

    /// Whether a feedback has another sign in the `state` later in the step than at its start, or ω has passed through zero
    /// under quadratic damping.
    #[inline(never)]
    pub(super) fn has_flipped(&self, row: usize, state: &[L::Real; 7]) -> bool {
        let lead = self.leads[row].as_ref();
        let start = [0, 1, 2].map(|i| self.state.value[i].get(row));
        let omega = [0, 1, 2].map(|i| state[i].rounded());
        lead.is_some_and(|lead| lead.job.course.has_flipped(state))
            || (self.extras.formulas).is_reversed(row, &start, &omega)
    }
}
