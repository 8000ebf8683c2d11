//! All terms of a load that are not linear in the coefficients of one order: torques that depend on time alone, and those that are not
//! linear in ω, from the formulas that their laws state.

use nalgebra::Vector3;

use super::batch::{Batch, CacheAligned, plus};
use super::equations::CacheKey;
use super::equations::LinearTerms;
use super::equations::Precision;
use super::gravity_gradient::GravityGradientSeries;
use super::orbit_cache::{OrbitSeriesCache, round_step_end};
use super::series::{MAX_COUNT, Series, is_unused};
use crate::motion::loads::{Forcing, FormulaStep, OrbitState, SeriesStructure, TorqueFormula};
use crate::numerics::dispatch::{Kernel, dispatch_within};
use crate::numerics::lane::Lane;
use crate::numerics::number::{Number, Real};

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
    /// Return the terms that a load with these `parts` can have, all zero. Not inlined: it is the same for all series.
    #[inline(never)]
    pub(super) fn new(parts: &SeriesStructure) -> Self {
        let mut gradients = Vec::new();
        for _ in 0..parts.gradients {
            gradients.push(GravityGradientSeries::new());
        }
        Self {
            is_empty: !parts.is_timed && parts.gradients == 0,
            formulas: Formulas::new(),
            forced: if parts.is_timed {
                Some(Box::new(ForcedTorques::ZERO))
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

    /// Return whether there are none of these terms.
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.is_empty && self.formulas.formulas.is_empty()
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
                gradient.set(row, orbits.next().unwrap_or(&OrbitState::none()));
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
    const ZERO: Self = Self {
        in_body: [[Batch::ZERO; 3]; 4],
        in_space: [[Batch::ZERO; 3]; 4],
        inverse_moments: [Batch::ZERO; 3],
    };

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
                    if is_unused(direction) {
                        continue;
                    }
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

/// The coefficients of a scalar.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
struct Scalar<T>([T; MAX_COUNT]);

/// The coefficients of a vector.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
struct Vector<T>([[T; 3]; MAX_COUNT]);

impl<L: Number, const R: usize> Scalar<Batch<L, R>> {
    const ZERO: Self = Self([Batch::ZERO; MAX_COUNT]);
}

impl<L: Number, const R: usize> Vector<Batch<L, R>> {
    const ZERO: Self = Self([[Batch::ZERO; 3]; MAX_COUNT]);
}

/// A formula, and the coefficients of its scalars and vectors.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
struct FormulaSeries<T> {
    steps: Vec<FormulaStep>,
    vector: usize,
    /// The matrix over the moments; zero in a row without this formula.
    matrix: [[T; 3]; 3],
    scalars: Vec<Scalar<T>>,
    /// The vectors after ω.
    vectors: Vec<Vector<T>>,
    /// Index of the scalar |ω|, if the formula contains it.
    speed: Option<usize>,
    /// Whether the vector is |ω| ω.
    is_quadratic: bool,
    /// `1/2s₀`.
    half_over_speed: T,
}

/// The formulas of all rows; most loads have none.
///
/// With `u = ω·ω` and `s = |ω| = √u`, from s s = u
///
/// ```text
/// s_k = (u_k − Σ_{0<j<k} s_j s_{k−j})/2s₀
/// ```
///
/// Rounding errors in s grow as `1/s(t)`, so a step is shorter than the time in which ω would come to zero at its present rate. If ω
/// passes through zero nevertheless, the step ends there. At ω = 0, s has no series, and |ω| ω has no second derivative: below
/// [`REST_SPEED`](Precision::REST_SPEED) of the largest ω, or below that
/// [beside torques](Precision::REST_SPEED_BESIDE_TORQUES), the speed counts as zero, in steps so short that the error stays below
/// rounding.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
pub(super) struct Formulas<T> {
    formulas: Vec<FormulaSeries<T>>,
    /// The speed below which a row counts as at rest.
    rest_speed: T,
}

impl<L: Number<Real: Precision>, const R: usize> Formulas<Batch<L, R>> {
    pub(super) fn new() -> Self {
        let zero = Batch::new(0.0);
        Self {
            formulas: Vec::new(),
            rest_speed: zero,
        }
    }

    /// Set the formulas of one row, each with its matrix over the moments.
    pub(super) fn set<'a>(
        &mut self,
        row: usize,
        formulas: impl Iterator<Item = (&'a TorqueFormula<L::Real>, [[L::Real; 3]; 3])>,
    ) {
        self.clear(row);
        let mut taken = vec![false; self.formulas.len()];
        for (formula, matrix) in formulas {
            let fits = |(i, known): (usize, &FormulaSeries<_>)| {
                !taken[i] && known.steps == formula.steps && known.vector == formula.vector
            };
            let place = (self.formulas.iter().enumerate().position(fits)).unwrap_or_else(|| {
                self.formulas.push(FormulaSeries::new(formula));
                taken.push(false);
                taken.len() - 1
            });
            taken[place] = true;
            for (batches, numbers) in self.formulas[place].matrix.iter_mut().zip(matrix) {
                for (batch, number) in batches.iter_mut().zip(numbers) {
                    batch.put(row, number);
                }
            }
        }
    }

    /// Remove the formulas of one row.
    pub(super) fn clear(&mut self, row: usize) {
        for formula in &mut self.formulas {
            for x in formula.matrix.as_flattened_mut() {
                x.set(row, 0.0);
            }
        }
    }

    #[inline(always)]
    pub(super) fn start(&mut self, fastest: &[f64; R]) {
        for row in 0..R {
            self.rest_speed.set(row, L::Real::REST_SPEED * fastest[row]);
        }
    }

    /// Raise the speed that counts as zero to its part of this acceleration, that by all other torques.
    #[inline(always)]
    fn raise_rest_speed(&mut self, acceleration: &[Batch<L, R>; 3]) {
        for row in 0..R {
            let (rest_speed, least) = (
                self.rest_speed.get(row),
                L::Real::REST_SPEED_BESIDE_TORQUES * size(acceleration, row),
            );
            self.rest_speed.set(
                row,
                if least > rest_speed {
                    least
                } else {
                    rest_speed
                },
            );
        }
    }

    /// Add the coefficient of order `k` of the angular acceleration by all formulas to `sum`. Called for one order after the other.
    #[inline(always)]
    pub(super) fn plus_coefficients<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Batch<L, R>, B>,
        mut sum: [Batch<L, R>; 3],
    ) -> [Batch<L, R>; 3] {
        if k == 0 && !self.formulas.is_empty() {
            self.raise_rest_speed(&sum);
        }
        let rest_speed = self.rest_speed;
        for formula in &mut self.formulas {
            let [x, y, z] = if R == 1 {
                formula.coefficient(k, series, rest_speed)
            } else {
                dispatch_within::<L, _>(Next {
                    formula,
                    k,
                    series,
                    rest_speed,
                })
                .0
            };
            sum = [sum[0] + x, sum[1] + y, sum[2] + z];
        }
        sum
    }

    /// Iterate over the series of |ω| of the formulas that act in one row.
    fn with_speed(&self, row: usize) -> impl Iterator<Item = &Scalar<Batch<L, R>>> {
        let acting = self.formulas.iter().filter(move |it| it.acts(row));
        acting.filter_map(|it| Some(&it.scalars[it.speed?]))
    }

    /// Return whether ω of one row has passed through zero between `start` and `omega`: beyond it the series of |ω| continues as
    /// −|ω|, which is another law.
    pub(super) fn is_reversed(&self, row: usize, start: &[f64; 3], omega: &[f64; 3]) -> bool {
        let along: f64 = (0..3).map(|i| start[i] * omega[i]).sum();
        along < 0.0 && self.may_reverse(row)
    }

    /// Return whether the law of one row changes if ω passes through zero: a formula contains |ω|, and ω does not count as zero.
    pub(super) fn may_reverse(&self, row: usize) -> bool {
        self.with_speed(row).any(|speed| speed.0[0].get(row) > 0.0)
    }

    /// Shorten the steps of motions whose law contains |ω|: a motion that counts as at rest stays so, and others do not come to rest
    /// at their present rate.
    #[inline(always)]
    pub(super) fn limit<const B: usize>(
        &self,
        series: &impl Series<Batch<L, R>, B>,
        h: &mut [f64; R],
    ) {
        if self.formulas.is_empty() {
            return;
        }
        let (w, change) = (series.get(0).w, series.get(1).w);
        for row in 0..R {
            if self.with_speed(row).next().is_none() {
                continue;
            }
            let (rest_speed, speed, rate) =
                (self.rest_speed.get(row), size(&w, row), size(&change, row));
            let most = if speed <= rest_speed {
                2.0 * rest_speed / rate
            } else {
                0.8 * speed / rate
            };
            h[row] = if h[row] > most { most } else { h[row] };
        }
    }
}

#[inline(always)]
fn size<L: Number, const R: usize>(w: &[Batch<L, R>; 3], row: usize) -> f64 {
    let (x, y, z) = (w[0].get(row), w[1].get(row), w[2].get(row));
    (x * x + y * y + z * z).sqrt()
}

/// Computes the coefficient of order `k` of several rows. A separate function: within the loop over steps its sums are not kept in
/// registers. A single row would be slower with it, because the arguments of a function must be in memory.
struct Next<'a, L, S, const R: usize, const B: usize> {
    formula: &'a mut FormulaSeries<Batch<L, R>>,
    k: usize,
    series: &'a S,
    rest_speed: Batch<L, R>,
}

impl<N: Number<Real: Precision>, S: Series<Batch<N, R>, B>, const R: usize, const B: usize> Kernel
    for Next<'_, N, S, R, B>
{
    type Output = CacheAligned<[Batch<N, R>; 3]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        CacheAligned(
            self.formula
                .coefficient(self.k, self.series, self.rest_speed),
        )
    }
}

impl<L: Number<Real: Precision>, const R: usize> FormulaSeries<Batch<L, R>> {
    #[inline(never)]
    fn new(formula: &TorqueFormula<L::Real>) -> Self {
        let (mut scalars, mut vectors, mut speed) = (Vec::new(), Vec::new(), None);
        for step in &formula.steps {
            match step {
                FormulaStep::Square | FormulaStep::Speed(_) => {
                    if matches!(step, FormulaStep::Speed(_)) {
                        speed = Some(scalars.len());
                    }
                    scalars.push(Scalar::ZERO);
                }
                FormulaStep::Times(..) => vectors.push(Vector::ZERO),
            }
        }
        Self {
            steps: formula.steps.clone(),
            vector: formula.vector,
            matrix: [[Batch::ZERO; 3]; 3],
            scalars,
            vectors,
            speed,
            is_quadratic: formula.steps
                == [
                    FormulaStep::Square,
                    FormulaStep::Speed(0),
                    FormulaStep::Times(1, 0),
                ]
                && formula.vector == 1,
            half_over_speed: Batch::ZERO,
        }
    }

    /// Return whether it acts in one row.
    #[inline(always)]
    fn acts(&self, row: usize) -> bool {
        self.matrix.iter().flatten().any(|x| x.get(row) != 0.0)
    }

    /// Compute the coefficient of order `k` of the angular acceleration, components in principal axes.
    #[inline(always)]
    fn coefficient<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Batch<L, R>, B>,
        rest_speed: Batch<L, R>,
    ) -> [Batch<L, R>; 3] {
        let vector = if self.is_quadratic {
            // In one piece: intermediate results stay in registers.
            let speeds = self.set_speed(k, 1, square(k, series), rest_speed);
            times(k, speeds, |j| series.get(j).w)
        } else {
            self.step_by_step(k, series, rest_speed)
        };
        let mut sum = [Batch::new(0.0); 3];
        for n in 0..3 {
            for i in 0..3 {
                sum[n] = self.matrix[n][i].mul_add(vector[i], sum[n]);
            }
        }
        sum
    }

    /// Compute the coefficient of order `k` of the vector of any formula.
    #[inline(always)]
    fn step_by_step<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Batch<L, R>, B>,
        rest_speed: Batch<L, R>,
    ) -> [Batch<L, R>; 3] {
        let (mut scalars, mut vectors) = (0, 0);
        for i in 0..self.steps.len() {
            match self.steps[i] {
                FormulaStep::Square => {
                    self.scalars[scalars].0[k] = square(k, series);
                    scalars += 1;
                }
                FormulaStep::Speed(of) => {
                    let square = self.scalars[of].0[k];
                    let _speeds = self.set_speed(k, scalars, square, rest_speed);
                    scalars += 1;
                }
                FormulaStep::Times(factor, vector) => {
                    let factor = &self.scalars[factor].0;
                    let product = if vector == 0 {
                        times(k, factor, |j| series.get(j).w)
                    } else {
                        let vector = &self.vectors[vector - 1].0;
                        times(k, factor, |j| vector[j])
                    };
                    self.vectors[vectors].0[k] = product;
                    vectors += 1;
                }
            }
        }
        match self.vector {
            0 => series.get(k).w,
            number => self.vectors[number - 1].0[k],
        }
    }

    /// Compute the coefficient of order `k` of |ω|, the scalar of this index, from that of ω·ω.
    #[inline(always)]
    fn set_speed(
        &mut self,
        k: usize,
        number: usize,
        square: Batch<L, R>,
        rest_speed: Batch<L, R>,
    ) -> &[Batch<L, R>; MAX_COUNT] {
        let speeds = &mut self.scalars[number].0;
        speeds[k] = Batch::new(0.0);
        if k == 0 {
            for row in 0..R {
                let speed = square.real(row).root();
                let moves = speed.rounded() > rest_speed.get(row);
                speeds[0].set(row, 0.0);
                self.half_over_speed.set(row, 0.0);
                if moves {
                    speeds[0].put(row, speed);
                    (self.half_over_speed).put(row, L::Real::from(0.5) / speed);
                }
            }
        } else {
            let mut rest = square;
            for j in 1..k {
                rest = (-speeds[j]).mul_add(speeds[k - j], rest);
            }
            speeds[k] = rest * self.half_over_speed;
        }
        speeds
    }
}

/// Compute the coefficient of order `k` of ω·ω.
#[inline(always)]
fn square<L: Number, const R: usize, const B: usize>(
    k: usize,
    series: &impl Series<Batch<L, R>, B>,
) -> Batch<L, R> {
    let mut square = Batch::new(0.0);
    for j in 0..=k {
        let (a, b) = (series.get(j).w, series.get(k - j).w);
        for i in 0..3 {
            square = a[i].mul_add(b[i], square);
        }
    }
    square
}

/// Compute the coefficient of order `k` of a scalar times a vector.
#[inline(always)]
fn times<L: Number, const R: usize>(
    k: usize,
    factor: &[Batch<L, R>; MAX_COUNT],
    vector: impl Fn(usize) -> [Batch<L, R>; 3],
) -> [Batch<L, R>; 3] {
    let mut product = [Batch::new(0.0); 3];
    for j in 0..=k {
        let w = vector(k - j);
        for i in 0..3 {
            product[i] = factor[j].mul_add(w[i], product[i]);
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::motion::integrate::taylor::gravity_gradient::INITIAL_NUMBERS;
    use crate::motion::integrate::taylor::orbit_cache::ENTRIES;
    use crate::motion::integrate::taylor::series::{Coefficient, Coefficients};
    use crate::motion::integrate::taylor::single::SingleMotionSeries;
    use crate::motion::loads::{OMEGA, Steps};
    use crate::numerics::lane::{BASELINE, Double};

    type Pair = Batch<Double<BASELINE>, 2>;
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

    type One = Double<BASELINE>;

    /// The coefficients of `M u² ω` with `u = ω·ω`, of `ω = (1 + t, 0, 2)`, for which `u² = 25 + 20 t + 14 t² + 4 t³ + t⁴`.
    #[test]
    fn products_of_products() {
        let number = |x: f64| Batch([<One as Number>::new(x)]);
        let mut steps = Steps::default();
        let square = steps.square();
        let cube = steps.times(square, OMEGA);
        let fifth = steps.times(square, cube);
        let formula = steps.torque(Matrix3::<f64>::identity(), fifth);
        let mut formulas = Formulas::new();
        let matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.5], [0.0, 0.0, 1.0]];
        formulas.set(0, [(&formula, matrix)].into_iter());
        let mut series = SingleMotionSeries::<One, 0>::new();
        series.start(&Coefficient {
            w: [number(1.0), number(0.0), number(2.0)],
            q: [number(0.0), number(0.0), number(0.0), number(1.0)],
            g: [],
        });
        let x = [25.0, 45.0, 34.0, 18.0, 5.0, 1.0, 0.0];
        let z = [50.0, 40.0, 28.0, 8.0, 2.0, 0.0, 0.0];
        for k in 0..x.len() {
            let sums = series.sums(k);
            let found = formulas.plus_coefficients(k, &series, [number(0.0); 3]);
            assert_eq!(found.map(|x| x.get(0)), [x[k], 0.5 * z[k], z[k]]);
            let rate = if k == 0 { 1.0 } else { 0.0 };
            series.extend(k, &sums, &[number(rate), number(0.0), number(0.0)]);
        }
        assert!(!formulas.may_reverse(0)); // there is no |ω| in it
        formulas.set(0, std::iter::empty());
        let none = formulas.plus_coefficients(0, &series, [number(0.0); 3]);
        assert_eq!(none.map(|x| x.get(0)), [0.0; 3]);
    }

    /// |ω| ω in one piece and step by step.
    #[test]
    fn the_quick_way_has_the_same_bits() {
        let number = |x: f64| Batch([<One as Number>::new(x)]);
        let mut steps = Steps::default();
        let speed = steps.speed();
        let vector = steps.times(speed, OMEGA);
        let formula = steps.torque(Matrix3::<f64>::identity(), vector);
        let (mut quick, mut slow) = (FormulaSeries::new(&formula), FormulaSeries::new(&formula));
        assert!(quick.is_quadratic);
        slow.is_quadratic = false;
        for formula in [&mut quick, &mut slow] {
            formula.matrix = [[number(0.3); 3]; 3];
        }
        let mut series = SingleMotionSeries::<One, 0>::new();
        series.start(&Coefficient {
            w: [number(0.6), number(-0.1), number(0.3)],
            q: [number(0.0), number(0.0), number(0.0), number(1.0)],
            g: [],
        });
        for k in 0..20 {
            let sums = series.sums(k);
            let [a, b] = [&mut quick, &mut slow].map(|it| it.coefficient(k, &series, number(0.0)));
            assert_eq!(a.map(|x| x.get(0)), b.map(|x| x.get(0)));
            series.extend(k, &sums, &a);
        }
        assert!(series.get(20).w[0].get(0) != 0.0);
    }

    /// Of two formulas alike each keeps a place of its own, also where another row has one of them alone.
    #[test]
    fn each_row_has_its_own() {
        let formula = |by: f64| {
            let mut steps = Steps::default();
            let speed = steps.speed();
            let vector = steps.times(speed, OMEGA);
            steps.torque(Matrix3::identity() * by, vector)
        };
        let (once, twice) = (formula(1.0), formula(2.0));
        let rows = |by: f64| [[by, 0.0, 0.0], [0.0, by, 0.0], [0.0, 0.0, by]];
        let mut formulas = Formulas::<Batch<One, 2>>::new();
        formulas.set(1, [(&twice, rows(2.0))].into_iter());
        formulas.set(0, [(&once, rows(1.0)), (&twice, rows(2.0))].into_iter());
        let matrices = |row: usize| -> Vec<f64> {
            let all = formulas.formulas.iter();
            all.map(|formula| formula.matrix[2][2].get(row)).collect()
        };
        assert_eq!((matrices(0), matrices(1)), (vec![1.0, 2.0], vec![2.0, 0.0]));
    }
}
