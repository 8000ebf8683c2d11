//! The steps of the method: stages by Newton's iteration, the error, the length of the next step.

use nalgebra::{Complex, SVector};

use super::dense::Dense;
use super::factors::{Factors, Jacobian};
use super::stages::{Stages, combine, combined};
use super::tableau::{COMPLEX, ERROR, NODES, REAL, T, T_INVERSE};
use crate::motion::integrate::runge_kutta::{Progress, RungeKutta};
use crate::motion::integrate::system::System;

/// Newton's iterations before the step is shortened.
const ITERATIONS: i32 = 7;
/// The error of the stages that is left, in units of what a step may err.
const STAGE_TOLERANCE: f64 = 1e-3;
const SHRINK: f64 = 0.2;
const GROW: f64 = 8.0;
/// One over the order of the error that the estimate controls.
const EXPONENT: f64 = 0.25;

/// An integration under way.
#[derive(Clone, Debug)]
pub(crate) struct Radau<const N: usize> {
    progress: Progress<N>,
    /// The slope at the state.
    slope: SVector<f64, N>,
    jacobian: Jacobian<N>,
    /// Whether the Jacobian is that of the present state.
    is_current: bool,
    factors: Option<Factors<N>>,
    /// The last accepted step, and the error it was accepted with.
    last: Option<(Dense<N>, f64)>,
}

impl<const N: usize> RungeKutta<N> for Radau<N> {
    fn new<S: System<N>>(
        system: &mut S,
        start: f64,
        end: f64,
        y: SVector<f64, N>,
        step: Option<f64>,
    ) -> Result<Self, S::Error> {
        let (progress, slope) = Progress::new(system, [start, end], y, step, EXPONENT)?;
        let mut stepper = Self {
            progress,
            slope,
            jacobian: Jacobian::zero(),
            is_current: false,
            factors: None,
            last: None,
        };
        stepper.linearize(system)?;
        Ok(stepper)
    }

    fn progress(&self) -> &Progress<N> {
        &self.progress
    }

    fn advance<S: System<N>>(&mut self, system: &mut S) -> Result<(), S::Error> {
        let mut rejected = false;
        loop {
            let (h, is_last) = self.progress.next()?;
            let factors = match self.factors.take() {
                Some(factors) if factors.step == h => factors,
                _ => Factors::of(&self.jacobian, h),
            };
            let Some((stages, iterations, rate)) = self.collocate(system, &factors, h)? else {
                if self.is_current {
                    self.progress.step = 0.5 * h;
                    rejected = true;
                } else {
                    self.linearize(system)?;
                }
                continue;
            };
            let error = self.error(system, &factors, &stages, h, rejected)?;
            let safety =
                0.9 * f64::from(2 * ITERATIONS + 1) / f64::from(2 * ITERATIONS + iterations);
            let factor = safety * error.powf(-EXPONENT);
            if error <= 1.0 {
                let factor = factor.min(self.predicted(h, error, safety));
                let growth = factor.clamp(SHRINK, if rejected { 1.0 } else { GROW });
                self.accept(system, &stages, h, error, is_last)?;
                if iterations > 2 && rate > 1e-3 {
                    self.linearize(system)?;
                    self.progress.step = h * growth;
                } else if (1.0..1.2).contains(&growth) {
                    self.progress.step = h; // a little more would cost new factors
                    self.factors = Some(factors);
                } else {
                    self.progress.step = h * growth;
                }
                return Ok(());
            }
            self.progress.step = h * if factor.is_nan() {
                SHRINK
            } else {
                factor.clamp(SHRINK, 1.0)
            };
            rejected = true;
            self.progress.check_advances(error)?;
        }
    }

    fn within<S: System<N>>(
        &mut self,
        _: &mut S,
        elapsed: f64,
    ) -> Result<SVector<f64, N>, S::Error> {
        let dense = self.last.as_ref().map(|(dense, _)| dense);
        Ok(dense.map_or(self.progress.state.value, |dense| dense.at(elapsed)))
    }
}

impl<const N: usize> Radau<N> {
    fn accept<S: System<N>>(
        &mut self,
        system: &mut S,
        stages: &Stages<N>,
        h: f64,
        error: f64,
        is_last: bool,
    ) -> Result<(), S::Error> {
        let progress = &mut self.progress;
        let dense = Dense::new(progress.elapsed.0, h, &progress.state.value, stages);
        progress.state = progress.state.plus(&stages[2]);
        system.accept(&mut progress.state);
        progress.advance(h, is_last);
        self.last = Some((dense, error));
        self.is_current = false;
        let y = progress.state.value;
        let elapsed = progress.elapsed.0;
        progress.slope(system, elapsed, &y, &mut self.slope)
    }

    /// The factor by the errors of this step and the one before (Gustafsson).
    fn predicted(&self, h: f64, error: f64, safety: f64) -> f64 {
        match &self.last {
            Some((last, before)) if error > 0.0 && *before > 0.0 => {
                safety * (h / last.step) * (before / error).powf(EXPONENT) * error.powf(-EXPONENT)
            }
            _ => f64::INFINITY,
        }
    }

    /// `∂f/∂y` by differences: Newton's iteration needs its size and direction, not its digits.
    fn linearize<S: System<N>>(&mut self, system: &mut S) -> Result<(), S::Error> {
        let (y, slope) = (self.progress.state.value, self.slope);
        let size = system.error_norm(&y, &y, &y);
        for j in 0..N {
            let mut unit = SVector::<f64, N>::zeros();
            unit[j] = 1.0;
            // The largest value of the group that the component belongs to, as the norm weighs it.
            let group = size / system.error_norm(&y, &y, &unit);
            let scale = [group, (slope[j] * self.progress.step).abs()]
                .into_iter()
                .filter(|x| x.is_finite())
                .fold(y[j].abs(), f64::max);
            let scale = if scale > 0.0 { scale } else { 1.0 };
            let mut moved = y;
            moved[j] += f64::EPSILON.sqrt() * scale;
            let elapsed = self.progress.elapsed.0;
            let mut change = SVector::zeros();
            (self.progress).slope(system, elapsed, &moved, &mut change)?;
            change -= slope;
            let by = moved[j] - y[j];
            self.jacobian.set(j, scale, &change, by);
        }
        self.is_current = true;
        self.factors = None;
        Ok(())
    }

    /// The stages of a step of length h by Newton's iteration with the Jacobian at hand, the number of iterations and how fast they
    /// converged; `None` when they do not.
    fn collocate<S: System<N>>(
        &mut self,
        system: &mut S,
        factors: &Factors<N>,
        h: f64,
    ) -> Result<Option<(Stages<N>, i32, f64)>, S::Error> {
        let y = self.progress.state.value;
        let mut stages = match &self.last {
            Some((last, _)) => NODES.map(|node| last.at(self.progress.elapsed.0 + node * h) - y),
            None => [SVector::zeros(); 3],
        };
        let mut transformed = combined(&T_INVERSE, &stages);
        let mut before = f64::NAN;
        for iteration in 1..=ITERATIONS {
            let mut slopes = [SVector::zeros(); 3];
            for (slope, (stage, node)) in slopes.iter_mut().zip(stages.iter().zip(NODES)) {
                let elapsed = self.progress.elapsed.0 + node * h;
                (self.progress).slope(system, elapsed, &(y + stage), slope)?;
            }
            let right = combined(&T_INVERSE, &slopes);
            let real = factors.solve_real(&(right[0] - transformed[0] * (REAL / h)));
            let pair = |a: &SVector<f64, N>, b: &SVector<f64, N>| {
                SVector::<Complex<f64>, N>::from_fn(|i, _| Complex::new(a[i], b[i]))
            };
            let complex = factors.solve_complex(
                &(pair(&right[1], &right[2])
                    - pair(&transformed[1], &transformed[2]) * (COMPLEX / h)),
            );
            let change = [real, complex.map(|x| x.re), complex.map(|x| x.im)];
            for (total, change) in transformed.iter_mut().zip(&change) {
                *total += change;
            }
            stages = combined(&T, &transformed);
            // Against the end of the step: what is zero at its start, as a body's place may be, has no size of its own there.
            let end = y + stages[2];
            let norm = (change.iter())
                .map(|part| system.error_norm(&y, &end, part))
                .fold(
                    0.0,
                    |most: f64, x| if x > most || x.is_nan() { x } else { most },
                );
            // Below this the iterates differ by rounding alone.
            let rounding = 10.0 * f64::EPSILON * system.error_norm(&y, &end, &end);
            let enough = STAGE_TOLERANCE.max(rounding);
            let rate = norm / before;
            let left = f64::from(ITERATIONS - iteration);
            if norm.is_nan()
                || norm > enough && (rate >= 1.0 || rate.powf(left) / (1.0 - rate) * norm > enough)
            {
                return Ok(None);
            }
            if norm <= enough || rate / (1.0 - rate) * norm < enough {
                return Ok(Some((
                    stages,
                    iteration,
                    if rate.is_nan() { 0.0 } else { rate },
                )));
            }
            before = norm;
        }
        Ok(None)
    }

    /// The estimate of the error in units of what is allowed; where a step was rejected, filtered once more, since the raw
    /// estimate is far too large for what decays fast.
    fn error<S: System<N>>(
        &mut self,
        system: &mut S,
        factors: &Factors<N>,
        stages: &Stages<N>,
        h: f64,
        rejected: bool,
    ) -> Result<f64, S::Error> {
        let y = self.progress.state.value;
        let y_new = y + stages[2];
        let weighted = combine(&ERROR, stages) / h;
        let error = factors.solve_real(&(self.slope + weighted));
        let norm = system.error_norm(&y, &y_new, &error);
        if norm <= 1.0 || !(rejected || self.last.is_none()) {
            return Ok(norm);
        }
        let elapsed = self.progress.elapsed.0;
        let mut slope = SVector::zeros();
        (self.progress).slope(system, elapsed, &(y + error), &mut slope)?;
        let error = factors.solve_real(&(slope + weighted));
        Ok(system.error_norm(&y, &y_new, &error))
    }
}
