//! All terms of a load that are not linear in the coefficients of one order.

use nalgebra::Vector3;

use super::batch::{Batch, plus};
use super::formulas::Formulas;
use super::gravity_gradient::GravityGradientSeries;
use super::linear_terms::LinearTerms;
use super::orbit_cache::{CacheKey, OrbitSeriesCache, round_step_end};
use super::principal_frame::Precision;
use super::series::Series;
use crate::motion::loads::{Forcing, OnOrbit, SeriesStructure};
use crate::numerics::number::Number;

/// The nonlinear terms of a load; most loads have none.
#[derive(Clone, Debug)]
pub(super) struct NonlinearTerms<T> {
    is_empty: bool,
    pub(super) formulas: Formulas<T>,
    forced: Option<Box<ForcedTorques<T>>>,
    gradients: Vec<GravityGradientSeries<T>>,
    /// The rows whose orbits continue from the step before.
    are_continued: Vec<bool>,
    /// Where the orbits of each row come from, and the cache.
    sources: Vec<OrbitSource>,
    pub(super) cache: OrbitSeriesCache,
    /// Whether the series of the attitude are relative to the frame of the orbit at the start of the step.
    in_orbit_frame: bool,
}

/// Where the orbits of a row come from in a step, and the unit of rates.
#[derive(Clone, Copy, Debug, PartialEq)]
enum OrbitSource {
    /// The cache is not used.
    Uncached,
    /// From the entry of this number.
    Cached(usize, f64),
    /// Their series must be computed and inserted with this key.
    Missing(CacheKey, f64),
}

impl<L: Number<Real: Precision>, const R: usize> NonlinearTerms<Batch<L, R>> {
    #[inline(always)]
    pub(super) fn new(parts: &SeriesStructure) -> Self {
        let mut gradients = Vec::new();
        for _ in 0..parts.gradients {
            gradients.push(GravityGradientSeries::new());
        }
        Self {
            is_empty: !parts.is_timed && parts.gradients == 0,
            formulas: Formulas::new(),
            forced: if parts.is_timed {
                Some(Box::new(ForcedTorques::new()))
            } else {
                None
            },
            gradients,
            are_continued: vec![false; R],
            sources: vec![OrbitSource::Uncached; R],
            cache: OrbitSeriesCache::default(),
            in_orbit_frame: Self::RECOMPUTES_ORBITS && is_of_orbit_alone(parts),
        }
    }

    /// Compute the initial attitude of the series from that in N.
    #[inline(always)]
    pub(super) fn initial_attitude(&self, attitude: [Batch<L, R>; 4]) -> [Batch<L, R>; 4] {
        match &self.gradients[..] {
            [gradient] if self.in_orbit_frame => gradient.to_orbit_frame(attitude),
            _ => attitude,
        }
    }

    /// Transform a sum or a coefficient of the series of the attitude to N.
    #[inline(always)]
    pub(super) fn to_space(&self, attitude: [Batch<L, R>; 4]) -> [Batch<L, R>; 4] {
        match &self.gradients[..] {
            [gradient] if self.in_orbit_frame => gradient.to_space(attitude),
            _ => attitude,
        }
    }

    /// Transform the change of the state in a step: its attitude to N.
    #[inline(always)]
    pub(super) fn change_in_space(&self, change: [Batch<L, R>; 7]) -> [Batch<L, R>; 7] {
        let [a, b, c, x, y, z, w] = change;
        let [x, y, z, w] = self.to_space([x, y, z, w]);
        [a, b, c, x, y, z, w]
    }

    /// Return whether nothing but orbits depends on time.
    #[inline(always)]
    pub(super) fn has_only_orbits(&self) -> bool {
        self.forced.is_none()
    }

    #[inline(always)]
    pub(super) fn is_timed(&self) -> bool {
        self.forced.is_some() || !self.gradients.is_empty()
    }

    /// Set the terms of one row that depend on time, at the start of a step.
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

    /// Whether orbits are computed again for every step, in doubles; several motions side by side then use the cache.
    const RECOMPUTES_ORBITS: bool = !L::VARIES && !L::Real::CARRIES_ORBITS;
    const USES_CACHE: bool = R > 1 && Self::RECOMPUTES_ORBITS;

    /// Return whether the orbits of one row at the start of a step are known already.
    #[inline(always)]
    pub(super) fn look_up(&mut self, row: usize, key: impl FnOnce() -> (CacheKey, f64)) -> bool {
        if !Self::USES_CACHE || self.gradients.is_empty() {
            return L::Real::CARRIES_ORBITS && self.are_continued[row];
        }
        let (key, unit) = key();
        let known = self.cache.find(&key, unit);
        self.sources[row] = match known {
            Some(number) => OrbitSource::Cached(number, unit),
            None => OrbitSource::Missing(key, unit),
        };
        known.is_some()
    }

    /// Compute the series of the orbits, or read them from the cache if those of all rows are there. All reads of a step come before
    /// its inserts, because an insert may replace an entry.
    #[inline(always)]
    pub(super) fn expand(&mut self, order: usize) {
        if Self::USES_CACHE && self.restore_all(order) {
            return;
        }
        for row in 0..self.sources.len() {
            if let OrbitSource::Cached(number, unit) = self.sources[row] {
                let entry = self.cache.entry(number);
                entry.restore(unit, &mut self.gradients, row, order);
            }
        }
        for gradient in &mut self.gradients {
            gradient.expand(order);
        }
        for row in 0..self.sources.len() {
            if let OrbitSource::Missing(key, unit) = self.sources[row] {
                (self.cache).insert(key, unit, &mut self.gradients, row, order);
            }
        }
    }

    /// Restore the orbits of all rows if all are in the cache; a row without a motion gets those of another.
    #[inline(always)]
    fn restore_all(&mut self, order: usize) -> bool {
        let (mut entries, mut any) = ([None; R], None);
        for row in 0..R {
            match self.sources[row] {
                OrbitSource::Uncached => {}
                OrbitSource::Cached(number, unit) => {
                    entries[row] = Some((number, unit));
                    any = entries[row];
                }
                OrbitSource::Missing(..) => return false,
            }
        }
        let Some(any) = any else {
            return false;
        };
        let mut known = [any; R];
        for row in 0..R {
            known[row] = entries[row].unwrap_or(any);
        }
        self.cache.restore_all(&known, &mut self.gradients, order);
        true
    }

    /// Shorten a step from `now`, the time since the start, so that the cache may contain the orbits at its end.
    #[inline(always)]
    pub(super) fn shorten_step(&self, now: (f64, f64), h: f64) -> f64 {
        if self.gradients.is_empty() || L::VARIES || L::Real::CARRIES_ORBITS {
            h
        } else {
            round_step_end(now, h)
        }
    }

    /// Continue the orbits to the end of a step of length `h`.
    #[inline(always)]
    pub(super) fn advance(&mut self, order: usize, h: Batch<L, R>) {
        if L::Real::CARRIES_ORBITS {
            for gradient in &mut self.gradients {
                gradient.advance(order, h);
            }
            self.are_continued.fill(true);
        }
    }

    /// Change the unit of rates in one row; `ratio` is the old unit over the new one.
    pub(super) fn rescale(&mut self, row: usize, ratio: f64) {
        for gradient in &mut self.gradients {
            gradient.rescale(row, ratio);
        }
    }

    /// Let the orbits of one row be computed again.
    pub(super) fn restart(&mut self, row: usize) {
        self.are_continued[row] = false;
    }

    /// Remove the terms of one row.
    pub(super) fn clear(&mut self, row: usize) {
        self.restart(row);
        self.sources[row] = OrbitSource::Uncached;
        self.formulas.clear(row);
        self.set(row, &Forcing::default(), &Vector3::zeros());
    }

    #[inline(always)]
    pub(super) fn start<const B: usize>(
        &mut self,
        fastest: &[f64; R],
        linear_terms: &LinearTerms<Batch<L, R>, B>,
    ) {
        for gradient in &mut self.gradients {
            gradient.start(linear_terms);
        }
        self.formulas.start(fastest);
    }

    /// Compute the part of order `k` that depends on the attitude alone. The coefficient of the attitude is known sooner than that of
    /// ω, so the processor computes both side by side.
    #[inline(always)]
    pub(super) fn look_ahead<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Batch<L, R>, B>,
        linear_terms: &LinearTerms<Batch<L, R>, B>,
    ) {
        for gradient in &mut self.gradients {
            gradient.look_ahead(k, series, linear_terms, self.in_orbit_frame);
        }
    }

    /// Add the coefficients of order `k` of the angular acceleration by all terms to `sum`.
    #[inline(always)]
    pub(super) fn plus_coefficients<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Batch<L, R>, B>,
        mut sum: [Batch<L, R>; 3],
    ) -> [Batch<L, R>; 3] {
        sum = self.formulas.plus_coefficients(k, series, sum);
        if self.is_empty {
            return sum;
        }
        if let Some(forced) = &mut self.forced {
            sum = plus(sum, forced.coefficient(k, series));
        }
        for gradient in &self.gradients {
            sum = plus(sum, gradient.coefficient());
        }
        sum
    }
}

/// Return whether nothing but one gravity gradient depends on the attitude: then its series may be relative to any frame.
fn is_of_orbit_alone(parts: &SeriesStructure) -> bool {
    let sees_space = parts.directions > 0 || parts.on_attitude || parts.is_pushed;
    parts.gradients == 1 && !sees_space && !parts.is_timed && parts.internal_states == 0
}

/// Torques that are cubic polynomials in time, in the body or in space; in space the coefficient is `Σ_j τ_j·γ_{k−j}` with the axes
/// γ of space.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
struct ForcedTorques<T> {
    in_body: [[T; 3]; 4],
    in_space: [[T; 3]; 4],
    inverse_moments: [T; 3],
}

impl<L: Number, const R: usize> ForcedTorques<Batch<L, R>> {
    #[inline(always)]
    fn new() -> Self {
        let zero = Batch::new(0.0);
        Self {
            in_body: [[zero; 3]; 4],
            in_space: [[zero; 3]; 4],
            inverse_moments: [zero; 3],
        }
    }

    /// Set the polynomials of one row at the start of a step.
    fn set(&mut self, row: usize, forcing: &Forcing<L::Real>, inverse_moments: &Vector3<L::Real>) {
        for i in 0..3 {
            for k in 0..4 {
                self.in_body[k][i].put(row, forcing.in_body[k][i]);
                self.in_space[k][i].put(row, forcing.in_space[k][i]);
            }
            self.inverse_moments[i].put(row, inverse_moments[i]);
        }
    }

    /// Compute the coefficient of order `k` of the angular acceleration, components in principal axes.
    #[inline(always)]
    fn coefficient<const B: usize>(
        &self,
        k: usize,
        series: &impl Series<Batch<L, R>, B>,
    ) -> [Batch<L, R>; 3] {
        let mut sum = [Batch::new(0.0); 3];
        if B == 3 {
            for j in 0..=k.min(3) {
                let g = series.get(k - j).g;
                for (axis, direction) in g.iter().enumerate() {
                    for i in 0..3 {
                        sum[i] = self.in_space[j][axis].mul_add(direction[i], sum[i]);
                    }
                }
            }
        }
        for i in 0..3 {
            sum[i] = sum[i] * self.inverse_moments[i];
            if k < 4 {
                sum[i] = sum[i] + self.in_body[k][i];
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::integrate::taylor::gravity_gradient::INITIAL_NUMBERS;
    use crate::motion::integrate::taylor::orbit_cache::ENTRIES;
    use crate::numerics::lane::Double;

    type Pair = Batch<Double<false>, 2>;
    const ORDER: usize = 6;

    /// Return keys of one bucket: one more than it has entries.
    fn neighbours() -> Vec<CacheKey> {
        let key = |k: u32| CacheKey {
            when: [f64::from(k).to_bits(), 0, 0],
            terms: (4096, 1),
        };
        let (_, bucket) = key(0).hash();
        let in_the_bucket = (0..).map(key).filter(|it| it.hash().1 == bucket);
        in_the_bucket.take(ENTRIES + 1).collect()
    }

    /// Return a different orbit for each number.
    fn orbit(number: usize) -> [f64; INITIAL_NUMBERS] {
        let x = 0.125 * (1 + number) as f64;
        [0.1, 0.2, 0.3, 0.9, x, 2.0 * x, 3.0 * x, 4.0 * x]
    }

    /// Return the numbers of the orbit of one row.
    fn orbit_numbers(nonlinear: &mut NonlinearTerms<Pair>, row: usize) -> (Vec<f64>, Vec<f64>) {
        let gradient = &mut nonlinear.gradients[0];
        let initial_numbers = gradient.initial_numbers(row).to_vec();
        let half_turn = gradient.orbit().half_turn()[..ORDER].iter().flatten();
        let half_turn = half_turn.map(|x| x.get(row)).collect();
        (initial_numbers, half_turn)
    }

    /// One row inserts an orbit into a full bucket and replaces the entry that the other row reads in the same step, whichever of the
    /// two comes first.
    #[test]
    fn entries_are_read_before_one_is_replaced() {
        let (keys, new) = (neighbours(), ENTRIES);
        let one_gradient = SeriesStructure {
            gradients: 1,
            ..SeriesStructure::default()
        };
        for seeker in 0..2 {
            let reader = 1 - seeker;
            let mut displaced = 0;
            for entry in 0..ENTRIES {
                let mut nonlinear = NonlinearTerms::<Pair>::new(&one_gradient);
                let mut expected = Vec::new();
                for (number, key) in keys[..ENTRIES].iter().enumerate() {
                    // Neither row finds it: both compute it and insert it with the same numbers.
                    for row in 0..2 {
                        assert!(!nonlinear.look_up(row, || (*key, 1.0)));
                        nonlinear.gradients[0].restore(row, orbit(number));
                    }
                    nonlinear.expand(ORDER);
                    expected.push(orbit_numbers(&mut nonlinear, reader));
                }
                assert!(!nonlinear.look_up(seeker, || (keys[new], 1.0)));
                nonlinear.gradients[0].restore(seeker, orbit(new));
                assert!(nonlinear.look_up(reader, || (keys[entry], 1.0)));
                nonlinear.expand(ORDER);
                assert_eq!(
                    orbit_numbers(&mut nonlinear, reader),
                    expected[entry],
                    "entry {entry}"
                );
                assert_eq!(
                    orbit_numbers(&mut nonlinear, seeker).0,
                    orbit(new),
                    "entry {entry}"
                );
                // The new entry is there, and the entry that was read may be gone.
                assert!(nonlinear.look_up(seeker, || (keys[new], 1.0)));
                displaced += usize::from(!nonlinear.look_up(reader, || (keys[entry], 1.0)));
            }
            assert_eq!(displaced, 1, "the entry that was read was never displaced");
        }
    }

    /// With another term that depends on the attitude the series are in N; otherwise the attitude goes to the orbit's frame and back.
    #[test]
    fn series_are_seen_from_the_orbit_if_nothing_else_sees_space() {
        let alone = SeriesStructure {
            gradients: 1,
            on_omega: true,
            quadratic: true,
            ..SeriesStructure::default()
        };
        let others = [
            SeriesStructure {
                gradients: 2,
                ..alone
            },
            SeriesStructure {
                directions: 1,
                ..alone
            },
            SeriesStructure {
                on_attitude: true,
                ..alone
            },
            SeriesStructure {
                is_pushed: true,
                ..alone
            },
            SeriesStructure {
                is_timed: true,
                ..alone
            },
            SeriesStructure {
                internal_states: 1,
                ..alone
            },
            SeriesStructure {
                gradients: 0,
                ..alone
            },
        ];
        let q = [0.5, -0.1, 0.7, 0.5];
        let attitude = q.map(Pair::new);
        let get = |q: [Pair; 4]| q.map(|x| x.get(0));
        for parts in others {
            let nonlinear = NonlinearTerms::<Pair>::new(&parts);
            assert_eq!(get(nonlinear.initial_attitude(attitude)), q, "{parts:?}");
            assert_eq!(get(nonlinear.to_space(attitude)), q, "{parts:?}");
        }
        let mut nonlinear = NonlinearTerms::<Pair>::new(&alone);
        // Twice a right angle about (1, 1, 0) takes x to y, y to x and z to −z.
        let half = 0.5_f64.sqrt();
        nonlinear.gradients[0].restore(0, [half, half, 0.0, 0.0, 0.1, 0.2, 0.3, 0.4]);
        let begun = get(nonlinear.initial_attitude(attitude));
        // −(1, 1, 0)/√2 times q.
        let expected = [-1.2, 0.2, 0.6, 0.4].map(|x: f64| x * half);
        let back = get(nonlinear.to_space(nonlinear.initial_attitude(attitude)));
        for i in 0..4 {
            assert!((begun[i] - expected[i]).abs() < 1e-15, "{begun:?}");
            assert!((back[i] - q[i]).abs() < 1e-15, "{back:?}");
        }
    }
}
