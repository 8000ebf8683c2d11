//! Sums of analytic terms.

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

    fn breaks(&self) -> Vec<f64> {
        self.terms.iter().flat_map(Term::breaks).collect()
    }

    fn enter(&mut self, from: f64, to: f64) -> Result<(), Error> {
        let middle = from + 0.5 * (to - from);
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
        let mut switches = self.switches.iter();
        let wrenches = (self.active.iter()).map(|term| {
            let switch = if term.may_switch() {
                switches.next()
            } else {
                None
            };
            match switch {
                Some(switch) => term.settled_wrench(switch.side, &self.subject, t, phase),
                None => term.wrench(&self.subject, t, phase),
            }
        });
        Ok(wrenches.sum())
    }
}
