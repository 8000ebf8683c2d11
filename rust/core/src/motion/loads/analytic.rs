//! The load `Analytic`: a sum of terms, each of one of the analytic laws.

use std::slice;

use nalgebra::Vector3;

use super::body_at_point::BodyAtPoint;
use super::carried_momentum::CarriedMomentum;
use super::carried_momentum::LawContext;
use super::laws::Term;
use super::load::Load;
use super::stiction::Bearing;
use super::switch::{LawSwitch, Switch};
use super::wrench::Wrench;
use crate::error::Error;
use crate::motion::state::Phase;

/// A sum of analytic terms that acts on a body; without terms the body is free.
#[derive(Clone, Debug)]
pub struct Analytic<'a> {
    body: BodyAtPoint,
    terms: &'a [Term],
    active: Vec<&'a Term>,
    /// The number of each among all terms.
    numbers: Vec<usize>,
    /// The terms that act of the controllers of motors, each with the number of the wheel's term.
    controllers: Vec<(usize, &'a Term)>,
    /// What controllers outside ask of the motors, by the number of the wheel's term; nothing, where there are none.
    commands: Vec<Vector3<f64>>,
    /// One for each term among those that act whose law has a sign, once they are settled.
    switches: Vec<Switch>,
    /// The bearings with dry friction, and the limits of rates, once they are settled.
    bearings: Option<Vec<Bearing>>,
    /// A time within the span last entered.
    middle: f64,
}

impl<'a> Analytic<'a> {
    /// The sum of `terms` acting on `body`.
    #[must_use]
    pub fn new(terms: &'a [Term], body: BodyAtPoint) -> Self {
        let asks = |(number, term): (usize, &'a Term)| {
            term.controller().iter().map(move |law| (number, law))
        };
        Self {
            body,
            terms,
            active: terms.iter().collect(),
            numbers: (0..terms.len()).collect(),
            controllers: terms.iter().enumerate().flat_map(asks).collect(),
            commands: Vec::new(),
            switches: Vec::new(),
            bearings: None,
            middle: f64::NAN,
        }
    }

    /// What it acts on.
    #[must_use]
    pub fn body(&self) -> &BodyAtPoint {
        &self.body
    }

    /// The terms.
    #[must_use]
    pub fn terms(&self) -> &'a [Term] {
        self.terms
    }

    /// The terms that act in the span of time last entered; of scheduled ones what they switch.
    #[must_use]
    pub fn active(&self) -> &[&'a Term] {
        &self.active
    }

    /// From now on a controller outside asks the motor of the wheel that is the term of this number for this torque on the body (in B), in
    /// addition to the terms of its own [controller](Term::controller).
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::motion::loads::{Analytic, BodyAtPoint, Drive, Load, Term, Wheel};
    /// use polhode::motion::simulate::{Phase, State};
    /// use polhode::nalgebra::{UnitQuaternion, Vector3};
    ///
    /// // A program asks for 0.2 N m; the motor can do half of that.
    /// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
    /// let wheel = Wheel::new(&Vector3::z(), 0.1, 0.0, 0.0, Drive::Controller)?
    ///     .with_max_torque(0.1)?
    ///     .with_max_momentum(4.0)?
    ///     .with_max_rate(50.0)?
    ///     .with_allocation(&Vector3::z())?;
    /// let terms = [Term::controlled(wheel, vec![])?];
    /// assert!(terms[0].controller().is_empty());
    /// let mut load = Analytic::new(&terms, BodyAtPoint::free(&ball, 0.0));
    /// load.command(0, Vector3::z() * 0.2);
    /// let rest = State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() };
    /// let phase = Phase { internal_state: [0.0].into(), ..Phase::in_place(&rest) };
    /// assert_eq!(load.wrench(0.0, &phase)?.torque, Vector3::z() * 0.1);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    pub fn command(&mut self, term: usize, torque: Vector3<f64>) {
        self.commands.resize(self.terms.len(), Vector3::zeros());
        self.commands[term] = torque;
    }

    /// What is asked of the motor of the wheel that is the term of this number; its law changes with the state unless it is settled by
    /// `switches`.
    fn commanded(
        &self,
        term: usize,
        t: f64,
        phase: &Phase,
        switches: &mut slice::Iter<'_, Switch>,
    ) -> Vector3<f64> {
        let mut sum = self.commands.get(term).copied().unwrap_or_default();
        for (_, law) in self.controllers.iter().filter(|(of, _)| *of == term) {
            let switch = if law.may_switch() {
                switches.next()
            } else {
                None
            };
            sum += match switch {
                Some(switch) => law.settled_wrench(switch.side, &self.body, t, phase).torque,
                None => law.wrench(&self.body, t, phase).torque,
            };
        }
        sum
    }

    /// As [`Self::over_limit`] of the coils of which most is asked, relative to their limit.
    fn coils_over_limit(&self, t: f64, phase: &Phase) -> f64 {
        let mut most: f64 = -1.0;
        for (term, &number) in self.active.iter().zip(&self.numbers) {
            if let Some(coils) = term.coils().filter(|coils| coils.has_limit()) {
                let command = self.commanded(number, t, phase, &mut [].iter());
                let idle = LawContext::without_command(&self.body, t, self.middle, phase);
                most = most.max(coils.over_limit(&LawContext { command, ..idle }));
            }
        }
        most
    }

    /// The wheel of a bearing turns as that says, from now on.
    fn turn(&mut self, bearing: Bearing) {
        let mine = self.bearings.iter_mut().flatten();
        for mine in mine.filter(|mine| mine.is_same(&bearing)) {
            *mine = bearing;
        }
    }

    /// The bearings with dry friction, and the limits of rates, as they are at `phase`.
    fn bearings_at(&self, phase: &Phase) -> Vec<Bearing> {
        let mut found = Vec::new();
        let mut index = 0;
        for carried in self.carried() {
            if let Some((axis, inertia, most)) = carried.bearing() {
                found.push(Bearing::at(index, axis, inertia, most, phase));
            }
            if let Some((axis, inertia, reach)) = carried.rate_limit() {
                found.push(Bearing::limit(index, axis, inertia, reach, phase));
            }
            index += carried.count();
        }
        found
    }
}

impl Load for Analytic<'_> {
    type Error = Error;

    fn analytic(&self) -> Option<&[Term]> {
        Some(self.terms)
    }

    fn exerts_force(&self) -> bool {
        self.terms.iter().any(Term::exerts_force)
    }

    fn depends_on_rates(&self) -> bool {
        self.terms.iter().any(Term::depends_on_rates)
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        (self.terms.iter().flat_map(|term| term.breaks(from, to))).collect()
    }

    fn enter(&mut self, from: f64, to: f64) -> Result<(), Error> {
        let middle = from + 0.5 * (to - from);
        self.middle = middle;
        self.active.clear();
        self.numbers.clear();
        self.controllers.clear();
        self.switches.clear();
        self.bearings = None;
        for (number, term) in self.terms.iter().enumerate() {
            let Some(term) = term.active(middle) else {
                continue;
            };
            term.check(&self.body, from, to)?;
            self.active.push(term);
            self.numbers.push(number);
            let asks = (term.controller().iter()).filter_map(|law| law.active(middle));
            self.controllers.extend(asks.map(|law| (number, law)));
        }
        Ok(())
    }

    fn settle(&mut self, t: f64, phase: &Phase) {
        self.switches.clear();
        let body = &self.body;
        let laws = self
            .active
            .iter()
            .chain(self.controllers.iter().map(|(_, law)| law));
        self.switches
            .extend(laws.filter_map(|law| law.switch(body, t, phase)));
        self.bearings = Some(self.bearings_at(phase));
    }

    fn law_switches(&self) -> Vec<LawSwitch> {
        let of_bearing = |bearing: &Bearing| {
            if bearing.turns == 0.0 {
                LawSwitch::Slip(*bearing)
            } else {
                LawSwitch::Stop(*bearing)
            }
        };
        let signs = self.switches.iter().cloned().map(LawSwitch::Sign);
        signs
            .chain(self.bearings().iter().map(of_bearing))
            .collect()
    }

    fn switch_law(&mut self, change: &LawSwitch) {
        match change {
            LawSwitch::Sign(switch) => {
                for mine in self.switches.iter_mut().filter(|mine| *mine == switch) {
                    mine.side *= -1.0;
                }
            }
            LawSwitch::Stop(bearing) => self.turn(bearing.at_rest()),
            LawSwitch::Slip(bearing) => self.turn(*bearing),
        }
    }

    fn bearings(&self) -> &[Bearing] {
        self.bearings.as_deref().unwrap_or_default()
    }

    fn over_limit(&self, wheel: Option<usize>, t: f64, phase: &Phase) -> f64 {
        let Some(state) = wheel else {
            return self.coils_over_limit(t, phase);
        };
        let mut index = 0;
        for (number, term) in self.terms.iter().enumerate() {
            if let Some(carried) = term.carried() {
                if index == state && carried.count() > 0 {
                    let side = (term.switch(&self.body, t, phase)).map_or(1.0, |it| it.side);
                    let now = LawContext {
                        body: &self.body,
                        t,
                        middle: self.middle,
                        phase,
                        side,
                        command: self.commanded(number, t, phase, &mut [].iter()),
                    };
                    return carried.over_limit(&now);
                }
                index += carried.count();
            }
        }
        -1.0
    }

    fn set_body(&mut self, body: &BodyAtPoint) {
        self.body = *body;
    }

    #[inline]
    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, Error> {
        self.act(t, phase, &mut [])
    }

    fn carried(&self) -> Vec<&dyn CarriedMomentum> {
        (self.terms.iter().filter_map(Term::carried)).collect()
    }

    #[inline]
    fn act(&mut self, t: f64, phase: &Phase, rates: &mut [f64]) -> Result<Wrench, Error> {
        let (mut states, mut all_rates) = (&phase.internal_state[..], &mut *rates);
        let mut switches = self.switches.iter();
        // Those of controllers stand behind those of the terms.
        let own = if self.controllers.is_empty() {
            self.switches.len()
        } else {
            self.active.iter().filter(|term| term.may_switch()).count()
        };
        let mut asked = self.switches.get(own..).unwrap_or_default().iter();
        let mut sum = Wrench::default();
        for (term, &number) in self.active.iter().zip(&self.numbers) {
            let switch = if term.may_switch() {
                switches.next()
            } else {
                None
            };
            sum += if let Some(carried) = term.carried() {
                let mine = states.split_off(..carried.count()).unwrap_or_default();
                let unsettled =
                    || (term.switch(&self.body, t, phase)).map_or(1.0, |switch| switch.side);
                let now = LawContext {
                    body: &self.body,
                    t,
                    middle: self.middle,
                    phase,
                    side: switch.map_or_else(unsettled, |switch| switch.side),
                    command: self.commanded(number, t, phase, &mut asked),
                };
                let rates = all_rates.split_off_mut(..carried.count());
                Wrench::couple(carried.torque(&now, mine, rates))
            } else if let Some(coils) = term.coils() {
                let command = self.commanded(number, t, phase, &mut asked);
                let idle = LawContext::without_command(&self.body, t, self.middle, phase);
                Wrench::couple(coils.torque(&LawContext { command, ..idle }))
            } else if let Some(switch) = switch {
                term.settled_wrench(switch.side, &self.body, t, phase)
            } else {
                term.wrench(&self.body, t, phase)
            };
        }
        let unsettled;
        let bearings = if let Some(settled) = &self.bearings {
            settled
        } else {
            unsettled = self.bearings_at(phase);
            &unsettled
        };
        for bearing in bearings {
            let friction = bearing.friction();
            sum.torque -= bearing.axis * friction;
            if let Some(rate) = rates.get_mut(bearing.index) {
                *rate += friction;
            }
        }
        Ok(sum)
    }
}
