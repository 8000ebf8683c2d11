//! Torques that are not linear in ω, by the formulas that their laws state.

use super::frame::Precision;
use super::pack::{Lined, Pack};
use super::series::Series;
use super::twin::COUNT;
use crate::motion::loads::{FormulaStep, TorqueFormula};
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;
use crate::numerics::number::{Number, Real};

/// The coefficients of a scalar.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Pack
struct Scalar<T>([T; COUNT]);

/// The coefficients of a vector.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Pack
struct Vector<T>([[T; 3]; COUNT]);

/// A formula, and the coefficients of its scalars and vectors.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Pack
struct Worked<T> {
    steps: Vec<FormulaStep>,
    vector: usize,
    /// The matrix over the moments: zero in a row in which the formula does not act.
    matrix: [[T; 3]; 3],
    scalars: Vec<Scalar<T>>,
    /// Those after ω.
    vectors: Vec<Vector<T>>,
    /// The number of |ω|, if it is in the formula.
    speed: Option<usize>,
    /// Whether the vector is |ω| ω.
    is_quadratic: bool,
    /// `1/2s₀`.
    half_over_speed: T,
}

/// Those that act in one of the rows; most loads have none.
///
/// With `u = ω·ω` and `s = |ω| = √u`, from s s = u
///
/// ```text
/// s_k = (u_k − Σ_{0<j<k} s_j s_{k−j})/2s₀
/// ```
///
/// Rounding in s grows as `1/s(t)` does, so a step does not go as far as ω would take to zero at its present rate. Where ω
/// passes through zero all the same the step ends, and at ω = 0 there is no series, and of |ω| ω no second derivative: below
/// [`STILL`](Precision::STILL) of the fastest ω, or the same [beside torques](Precision::STILL_BESIDE_TORQUES), the speed counts as
/// zero, in steps over which what it does stays below rounding.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Pack
pub(super) struct Formulas<T> {
    worked: Vec<Worked<T>>,
    /// The speed below which a row is still.
    still: T,
}

impl<L: Number<Real: Precision>, const R: usize> Formulas<Pack<L, R>> {
    pub(super) fn new() -> Self {
        let zero = Pack::new(0.0);
        Self {
            worked: Vec::new(),
            still: zero,
        }
    }

    /// Takes those of one row, each with its matrix over the moments.
    pub(super) fn set<'a>(
        &mut self,
        row: usize,
        formulas: impl Iterator<Item = (&'a TorqueFormula<L::Real>, [[L::Real; 3]; 3])>,
    ) {
        self.vacate(row);
        let mut taken = vec![false; self.worked.len()];
        for (formula, matrix) in formulas {
            let fits = |(i, worked): (usize, &Worked<_>)| {
                !taken[i] && worked.steps == formula.steps && worked.vector == formula.vector
            };
            let place = (self.worked.iter().enumerate().position(fits)).unwrap_or_else(|| {
                self.worked.push(Worked::new(formula));
                taken.push(false);
                taken.len() - 1
            });
            taken[place] = true;
            for (packs, numbers) in self.worked[place].matrix.iter_mut().zip(matrix) {
                for (pack, number) in packs.iter_mut().zip(numbers) {
                    pack.put(row, number);
                }
            }
        }
    }

    /// Leaves one row without formulas.
    pub(super) fn vacate(&mut self, row: usize) {
        for worked in &mut self.worked {
            for x in worked.matrix.as_flattened_mut() {
                x.set(row, 0.0);
            }
        }
    }

    #[inline(always)]
    pub(super) fn start(&mut self, fastest: &[f64; R]) {
        for row in 0..R {
            self.still.set(row, L::Real::STILL * fastest[row]);
        }
    }

    /// Counts speeds as zero that are too small a part of this acceleration, the one by all else.
    #[inline(always)]
    fn beside(&mut self, acceleration: &[Pack<L, R>; 3]) {
        for row in 0..R {
            let (still, least) = (
                self.still.get(row),
                L::Real::STILL_BESIDE_TORQUES * size(acceleration, row),
            );
            self.still
                .set(row, if least > still { least } else { still });
        }
    }

    /// `sum` and the coefficients of order `k` of the angular acceleration by all of them; asked for in order.
    #[inline(always)]
    pub(super) fn plus_coefficients<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        mut sum: [Pack<L, R>; 3],
    ) -> [Pack<L, R>; 3] {
        if k == 0 && !self.worked.is_empty() {
            self.beside(&sum);
        }
        let still = self.still;
        for worked in &mut self.worked {
            let [x, y, z] = if R == 1 {
                worked.coefficient(k, series, still)
            } else {
                dispatch(Next {
                    worked,
                    k,
                    series,
                    still,
                })
                .0
            };
            sum = [sum[0] + x, sum[1] + y, sum[2] + z];
        }
        sum
    }

    /// Those with |ω| that act in one row.
    fn with_speed(&self, row: usize) -> impl Iterator<Item = &Scalar<Pack<L, R>>> {
        let acting = self.worked.iter().filter(move |it| it.acts(row));
        acting.filter_map(|it| Some(&it.scalars[it.speed?]))
    }

    /// Whether the series of one row, whose ω was `start`, are another law's where it is `omega`: where ω passes through zero
    /// along a line, the series of |ω| goes on as −|ω|.
    pub(super) fn is_reversed(&self, row: usize, start: &[f64; 3], omega: &[f64; 3]) -> bool {
        let along: f64 = (0..3).map(|i| start[i] * omega[i]).sum();
        along < 0.0 && self.may_reverse(row)
    }

    /// Whether the law of one row changes where ω passes through zero: its ω is not as good as zero, so that there is a series of
    /// |ω|.
    pub(super) fn may_reverse(&self, row: usize) -> bool {
        self.with_speed(row).any(|speed| speed.0[0].get(row) > 0.0)
    }

    /// Keeps the steps of motions with |ω| in their law so short that those almost at rest stay so and that others do not come to
    /// rest at their present rate.
    #[inline(always)]
    pub(super) fn limit<const B: usize>(
        &self,
        series: &impl Series<Pack<L, R>, B>,
        h: &mut [f64; R],
    ) {
        if self.worked.is_empty() {
            return;
        }
        let (w, change) = (series.get(0).w, series.get(1).w);
        for row in 0..R {
            if self.with_speed(row).next().is_none() {
                continue;
            }
            let (still, speed, rate) = (self.still.get(row), size(&w, row), size(&change, row));
            let most = if speed <= still {
                2.0 * still / rate
            } else {
                0.8 * speed / rate
            };
            h[row] = if h[row] > most { most } else { h[row] };
        }
    }
}

#[inline(always)]
fn size<L: Number, const R: usize>(w: &[Pack<L, R>; 3], row: usize) -> f64 {
    let (x, y, z) = (w[0].get(row), w[1].get(row), w[2].get(row));
    (x * x + y * y + z * z).sqrt()
}

/// The coefficient of order `k` of several rows: a function of its own, since loops within that of the steps keep its sums out of
/// registers. One row is slower with it, since what another function may read must stand in memory.
struct Next<'a, L, S, const R: usize, const B: usize> {
    worked: &'a mut Worked<Pack<L, R>>,
    k: usize,
    series: &'a S,
    still: Pack<L, R>,
}

impl<N: Number<Real: Precision>, S: Series<Pack<N, R>, B>, const R: usize, const B: usize> Kernel
    for Next<'_, N, S, R, B>
{
    type Output = Lined<[Pack<N, R>; 3]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        Lined(self.worked.coefficient(self.k, self.series, self.still))
    }
}

impl<L: Number<Real: Precision>, const R: usize> Worked<Pack<L, R>> {
    fn new(formula: &TorqueFormula<L::Real>) -> Self {
        let zero = Pack::new(0.0);
        let (mut scalars, mut vectors, mut speed) = (Vec::new(), Vec::new(), None);
        for step in &formula.steps {
            match step {
                FormulaStep::Square | FormulaStep::Speed(_) => {
                    if matches!(step, FormulaStep::Speed(_)) {
                        speed = Some(scalars.len());
                    }
                    scalars.push(Scalar([zero; COUNT]));
                }
                FormulaStep::Times(..) => vectors.push(Vector([[zero; 3]; COUNT])),
            }
        }
        Self {
            steps: formula.steps.clone(),
            vector: formula.vector,
            matrix: [[zero; 3]; 3],
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
            half_over_speed: zero,
        }
    }

    /// Whether it acts in one row.
    #[inline(always)]
    fn acts(&self, row: usize) -> bool {
        self.matrix.iter().flatten().any(|x| x.get(row) != 0.0)
    }

    /// The coefficient of order `k` of the angular acceleration, components in principal axes.
    #[inline(always)]
    fn coefficient<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        still: Pack<L, R>,
    ) -> [Pack<L, R>; 3] {
        let vector = if self.is_quadratic {
            // In one piece: what a step gives to the next one stays in registers.
            let speeds = self.set_speed(k, 1, square(k, series), still);
            times(k, speeds, |j| series.get(j).w)
        } else {
            self.step_by_step(k, series, still)
        };
        let mut sum = [Pack::new(0.0); 3];
        for n in 0..3 {
            for i in 0..3 {
                sum[n] = self.matrix[n][i].mul_add(vector[i], sum[n]);
            }
        }
        sum
    }

    /// The coefficient of order `k` of the vector of any formula.
    #[inline(always)]
    fn step_by_step<const B: usize>(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        still: Pack<L, R>,
    ) -> [Pack<L, R>; 3] {
        let (mut scalars, mut vectors) = (0, 0);
        for i in 0..self.steps.len() {
            match self.steps[i] {
                FormulaStep::Square => {
                    self.scalars[scalars].0[k] = square(k, series);
                    scalars += 1;
                }
                FormulaStep::Speed(of) => {
                    let square = self.scalars[of].0[k];
                    let _speeds = self.set_speed(k, scalars, square, still);
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

    /// The coefficient of order `k` of |ω|, the scalar of this number, from that of ω·ω.
    #[inline(always)]
    fn set_speed(
        &mut self,
        k: usize,
        number: usize,
        square: Pack<L, R>,
        still: Pack<L, R>,
    ) -> &[Pack<L, R>; COUNT] {
        let speeds = &mut self.scalars[number].0;
        speeds[k] = Pack::new(0.0);
        if k == 0 {
            for row in 0..R {
                let speed = square.real(row).root();
                let moves = speed.rounded() > still.get(row);
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

/// The coefficient of order `k` of ω·ω.
#[inline(always)]
fn square<L: Number, const R: usize, const B: usize>(
    k: usize,
    series: &impl Series<Pack<L, R>, B>,
) -> Pack<L, R> {
    let mut square = Pack::new(0.0);
    for j in 0..=k {
        let (a, b) = (series.get(j).w, series.get(k - j).w);
        for i in 0..3 {
            square = a[i].mul_add(b[i], square);
        }
    }
    square
}

/// The coefficient of order `k` of a scalar times a vector.
#[inline(always)]
fn times<L: Number, const R: usize>(
    k: usize,
    factor: &[Pack<L, R>; COUNT],
    vector: impl Fn(usize) -> [Pack<L, R>; 3],
) -> [Pack<L, R>; 3] {
    let mut product = [Pack::new(0.0); 3];
    for j in 0..=k {
        let w = vector(k - j);
        for i in 0..3 {
            product[i] = factor[j].mul_add(w[i], product[i]);
        }
    }
    product
}

#[cfg(test)]
mod tests;
