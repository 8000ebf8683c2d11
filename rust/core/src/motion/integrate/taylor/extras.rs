//! The terms of a load that are not linear in the coefficients of one order, together.

use nalgebra::Vector3;

use super::almanac::{Almanac, Place, rounded};
use super::field::Field;
use super::formulas::Formulas;
use super::frame::Precision;
use super::gradient::Gradient;
use super::pack::{Pack, plus};
use super::series::Series;
use super::terms::{Analytic, Forced};
use crate::motion::loads::{Forcing, OnOrbit, SeriesStructure};
use crate::numerics::number::Number;

/// Those that the load has; most loads have none.
#[derive(Clone, Debug)]
pub(super) struct Extras<T> {
    is_empty: bool,
    pub(super) formulas: Formulas<T>,
    forced: Option<Box<Forced<T>>>,
    gradients: Vec<Gradient<T>>,
    /// The rows whose orbits have come from the step before.
    are_carried: Vec<bool>,
    /// What the almanac has of the rows, and what motions that were there before have put down.
    orbits: Vec<Orbits>,
    pub(super) almanac: Almanac,
    /// Whether the series are of the attitude as seen from the orbit's frame at the start of the step.
    is_from_orbit: bool,
}

/// Where the orbits of a row come from in a step, in which unit of rates.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Orbits {
    /// Not from the almanac.
    Own,
    /// From the page of this number.
    Known(usize, f64),
    /// Their series are to be found, and put down for this place.
    Sought(Place, f64),
}

impl<L: Number<Real: Precision>, const R: usize> Extras<Pack<L, R>> {
    #[inline(always)]
    pub(super) fn new(parts: &SeriesStructure) -> Self {
        let mut gradients = Vec::new();
        for _ in 0..parts.gradients {
            gradients.push(Gradient::new());
        }
        Self {
            is_empty: !parts.is_timed && parts.gradients == 0,
            formulas: Formulas::new(),
            forced: if parts.is_timed {
                Some(Box::new(Forced::new()))
            } else {
                None
            },
            gradients,
            are_carried: vec![false; R],
            orbits: vec![Orbits::Own; R],
            almanac: Almanac::default(),
            is_from_orbit: Self::FINDS && is_of_orbit_alone(parts),
        }
    }

    /// The attitude that the series begin with, from that in N.
    #[inline(always)]
    pub(super) fn begun(&self, attitude: [Pack<L, R>; 4]) -> [Pack<L, R>; 4] {
        match &self.gradients[..] {
            [gradient] if self.is_from_orbit => gradient.seen_from_frame(attitude),
            _ => attitude,
        }
    }

    /// A sum or a coefficient of the attitude's series, in N.
    #[inline(always)]
    pub(super) fn in_space(&self, attitude: [Pack<L, R>; 4]) -> [Pack<L, R>; 4] {
        match &self.gradients[..] {
            [gradient] if self.is_from_orbit => gradient.in_space(attitude),
            _ => attitude,
        }
    }

    /// What a step adds to the state, its attitude in N.
    #[inline(always)]
    pub(super) fn change_in_space(&self, change: [Pack<L, R>; 7]) -> [Pack<L, R>; 7] {
        let [a, b, c, x, y, z, w] = change;
        let [x, y, z, w] = self.in_space([x, y, z, w]);
        [a, b, c, x, y, z, w]
    }

    /// Whether nothing but orbits goes with the time.
    #[inline(always)]
    pub(super) fn has_orbits_alone(&self) -> bool {
        self.forced.is_none()
    }

    #[inline(always)]
    pub(super) fn is_timed(&self) -> bool {
        self.forced.is_some() || !self.gradients.is_empty()
    }

    /// What depends on time in one row, at the start of a step.
    #[inline(never)]
    pub(super) fn set(
        &mut self,
        row: usize,
        forcing: &Forcing<L::Real>,
        inverse_moments: &Vector3<L::Real>,
    ) {
        if let Some(forced) = &mut self.forced {
            forced.set(row, forcing, inverse_moments);
        }
        if !forcing.has_orbits {
            let mut orbits = forcing.orbits.iter();
            for gradient in &mut self.gradients {
                gradient.set(row, orbits.next().unwrap_or(&OnOrbit::none()));
            }
        }
    }

    /// Whether orbits are found anew in every step, in doubles: then motions side by side look them up.
    const FINDS: bool = !L::VARIES && !L::Real::CARRIES_ORBITS;
    const LOOKS_UP: bool = R > 1 && Self::FINDS;

    /// Whether the orbits of one row, where a step begins, are known already.
    #[inline(always)]
    pub(super) fn recall(&mut self, row: usize, place: impl FnOnce() -> (Place, f64)) -> bool {
        if !Self::LOOKS_UP || self.gradients.is_empty() {
            return L::Real::CARRIES_ORBITS && self.are_carried[row];
        }
        let (place, unit) = place();
        let known = self.almanac.find(&place, unit);
        self.orbits[row] = match known {
            Some(number) => Orbits::Known(number, unit),
            None => Orbits::Sought(place, unit),
        };
        known.is_some()
    }

    /// The series of the orbits: read where those of all rows are known, else found for all and put down. In no step are pages read
    /// after one is put down, which may take the place of another.
    #[inline(always)]
    pub(super) fn expand(&mut self, order: usize) {
        if Self::LOOKS_UP && self.reads_all(order) {
            return;
        }
        for row in 0..self.orbits.len() {
            if let Orbits::Known(number, unit) = self.orbits[row] {
                let page = self.almanac.page(number);
                page.begin(unit, &mut self.gradients, row, order);
            }
        }
        for gradient in &mut self.gradients {
            gradient.expand(order);
        }
        for row in 0..self.orbits.len() {
            if let Orbits::Sought(place, unit) = self.orbits[row] {
                (self.almanac).put(place, unit, &mut self.gradients, row, order);
            }
        }
    }

    /// Gives all rows their orbits at once, if they are all known; a row without motion gets those of another.
    #[inline(always)]
    fn reads_all(&mut self, order: usize) -> bool {
        let (mut pages, mut any) = ([None; R], None);
        for row in 0..R {
            match self.orbits[row] {
                Orbits::Own => {}
                Orbits::Known(number, unit) => {
                    pages[row] = Some((number, unit));
                    any = pages[row];
                }
                Orbits::Sought(..) => return false,
            }
        }
        let Some(any) = any else {
            return false;
        };
        let mut known = [any; R];
        for row in 0..R {
            known[row] = pages[row].unwrap_or(any);
        }
        self.almanac.give_all(&known, &mut self.gradients, order);
        true
    }

    /// A step from `now`, as long ago as that is, shortened so that orbits may be looked up at its end.
    #[inline(always)]
    pub(super) fn shortened(&self, now: (f64, f64), h: f64) -> f64 {
        if self.gradients.is_empty() || L::VARIES || L::Real::CARRIES_ORBITS {
            h
        } else {
            rounded(now, h)
        }
    }

    /// Goes on to the end of a step of length `h`.
    #[inline(always)]
    pub(super) fn advance(&mut self, order: usize, h: Pack<L, R>) {
        if L::Real::CARRIES_ORBITS {
            for gradient in &mut self.gradients {
                gradient.advance(order, h);
            }
            self.are_carried.fill(true);
        }
    }

    /// Comes to another unit of rates in one row: `ratio` of the old one to the new one.
    pub(super) fn rescale(&mut self, row: usize, ratio: f64) {
        for gradient in &mut self.gradients {
            gradient.rescale(row, ratio);
        }
    }

    /// Has the orbits of one row found anew.
    pub(super) fn restart(&mut self, row: usize) {
        self.are_carried[row] = false;
    }

    /// Leaves one row without such terms.
    pub(super) fn vacate(&mut self, row: usize) {
        self.restart(row);
        self.orbits[row] = Orbits::Own;
        self.formulas.vacate(row);
        self.set(row, &Forcing::default(), &Vector3::zeros());
    }

    #[inline(always)]
    pub(super) fn start<const B: usize>(
        &mut self,
        fastest: &[f64; R],
        field: &Field<Pack<L, R>, B>,
    ) {
        for gradient in &mut self.gradients {
            gradient.start(field);
        }
        self.formulas.start(fastest);
    }

    /// Finds what of order `k` depends on the attitude alone, whose coefficient of that order is known sooner than that of ω: the processor
    /// does both side by side.
    #[inline(always)]
    pub(super) fn look_ahead<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        field: &Field<Pack<L, R>, B>,
    ) {
        for gradient in &mut self.gradients {
            gradient.look_ahead(k, series, field, self.is_from_orbit);
        }
    }

    /// `sum` and the coefficients of order `k` of the angular acceleration by all of them.
    #[inline(always)]
    pub(super) fn plus_coefficients<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        field: &Field<Pack<L, R>, B>,
        mut sum: [Pack<L, R>; 3],
    ) -> [Pack<L, R>; 3] {
        sum = self.formulas.plus_coefficients(k, series, sum);
        if self.is_empty {
            return sum;
        }
        if let Some(forced) = &mut self.forced {
            sum = plus(sum, forced.coefficient(k, series, field));
        }
        for gradient in &self.gradients {
            sum = plus(sum, gradient.ahead());
        }
        sum
    }
}

/// Whether nothing but one gravity gradient depends on the attitude: then its series may be as seen from any frame.
fn is_of_orbit_alone(parts: &SeriesStructure) -> bool {
    let sees_space = parts.directions > 0 || parts.on_attitude || parts.is_pushed;
    parts.gradients == 1 && !sees_space && !parts.is_timed && parts.internal_states == 0
}

#[cfg(test)]
mod tests;
