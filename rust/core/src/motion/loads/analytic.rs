//! Sums of analytic terms.

use super::carried::Carried;
use super::load::Load;
use super::subject::Subject;
use super::switch::Switch;
use super::term::Term;
use super::wrench::Wrench;
use crate::error::Error;
use crate::motion::state::Phase;

/// A sum of analytic terms that acts on a body; without terms the body is free.
#[derive(Clone, Debug)]
pub struct Analytic<'a> {
    subject: Subject,
    terms: &'a [Term],
    active: Vec<&'a Term>,
    /// One for each term among those that act whose law has a sign, once they are settled.
    switches: Vec<Switch>,
    /// A time within the span last entered.
    middle: f64,
}

impl<'a> Analytic<'a> {
    /// The sum of `terms` acting on `subject`.
    #[must_use]
    pub fn new(terms: &'a [Term], subject: Subject) -> Self {
        Self {
            subject,
            terms,
            active: terms.iter().collect(),
            switches: Vec::new(),
            middle: f64::NAN,
        }
    }

    /// What it acts on.
    #[must_use]
    pub fn subject(&self) -> &Subject {
        &self.subject
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

    fn breaks(&self, _: f64, _: f64) -> Vec<f64> {
        self.terms.iter().flat_map(Term::breaks).collect()
    }

    fn enter(&mut self, from: f64, to: f64) -> Result<(), Error> {
        let middle = from + 0.5 * (to - from);
        self.middle = middle;
        self.active.clear();
        self.switches.clear();
        for term in self.terms.iter().filter_map(|term| term.active(middle)) {
            term.check(&self.subject, from, to)?;
            self.active.push(term);
        }
        Ok(())
    }

    fn settle(&mut self, phase: &Phase) {
        self.switches.clear();
        let switches = self.active.iter().filter_map(|term| term.switch(phase));
        self.switches.extend(switches);
    }

    fn switches(&self) -> Vec<Switch> {
        self.switches.clone()
    }

    fn flip(&mut self, index: usize) {
        self.switches[index].side *= -1.0;
    }

    #[inline]
    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, Error> {
        self.act(t, phase, &mut [])
    }

    fn carried(&self) -> Vec<&dyn Carried> {
        (self.terms.iter().filter_map(Term::carried)).collect()
    }

    #[inline]
    fn act(&mut self, t: f64, phase: &Phase, rates: &mut [f64]) -> Result<Wrench, Error> {
        let (mut own, mut rates) = (&phase.own[..], rates);
        let mut switches = self.switches.iter();
        let mut sum = Wrench::default();
        for term in &self.active {
            let switch = if term.may_switch() {
                switches.next()
            } else {
                None
            };
            sum += if let Some(carried) = term.carried() {
                let mine = own.split_off(..carried.count()).unwrap_or_default();
                let side = switch.map_or_else(|| side(term, phase), |switch| switch.side);
                if let Some(rates) = rates.split_off_mut(..carried.count()) {
                    carried.rates(side, self.middle, phase, mine, rates);
                }
                Wrench::couple(carried.torque(side, self.middle, phase, mine))
            } else if let Some(switch) = switch {
                term.settled_wrench(switch.side, &self.subject, t, phase)
            } else {
                term.wrench(&self.subject, t, phase)
            };
        }
        Ok(sum)
    }
}

/// The sign that a law has at `phase`.
fn side(term: &Term, phase: &Phase) -> f64 {
    term.switch(phase).map_or(1.0, |switch| switch.side)
}
