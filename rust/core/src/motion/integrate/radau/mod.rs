//! Radau IIA: the implicit Runge-Kutta method of order 5 that collocates at three points, the last of them the end of the
//! step. It damps what decays fast whatever the length of the step (L-stable), so that a stiff load does not
//! dictate the steps (Hairer & Wanner, Solving ODEs II, §IV.8).

mod dense;
mod tableau;
#[cfg(test)]
mod tests;

use nalgebra::{Complex, DMatrix, DVector, Dyn, LU, SVector};

pub use self::dense::Dense;
use self::tableau::{COMPLEX, ERROR, NODES, REAL, T, T_INVERSE};
use super::first_step::first_step;
use super::{Compensated, System};
use crate::error::{Error, MotionFault};
use crate::numerics::double_double::fast_two_sum;

/// Newton's iterations before the step is shortened.
const ITERATIONS: i32 = 7;
/// The error of the stages that is left, in units of what a step may err.
const STAGE_TOLERANCE: f64 = 1e-3;
const SHRINK: f64 = 0.2;
const GROW: f64 = 8.0;
/// One over the order of the error that the estimate controls.
const EXPONENT: f64 = 0.25;

/// The increments of the three stages over the state at the start of the step.
type Stages<const N: usize> = [SVector<f64, N>; 3];

/// An integration under way.
#[derive(Clone, Debug)]
pub struct Radau<const N: usize> {
    start: f64,
    span: f64,
    /// Time since the start, and what rounding has left out of it.
    elapsed: (f64, f64),
    state: Compensated<N>,
    /// The slope at the state.
    slope: SVector<f64, N>,
    /// The step to try next.
    step: f64,
    jacobian: DMatrix<f64>,
    /// Whether the Jacobian is that of the present state.
    is_current: bool,
    factors: Option<Factors>,
    /// The last accepted step, and the error it was accepted with.
    last: Option<(Dense<N>, f64)>,
    /// Accepted steps.
    pub steps: u64,
    /// Evaluations of the equations, those for Jacobians included.
    pub evaluations: u64,
}

/// `γ/h − J` and `(α + iβ)/h − J`, factored.
#[derive(Clone, Debug)]
struct Factors {
    step: f64,
    real: LU<f64, Dyn, Dyn>,
    complex: LU<Complex<f64>, Dyn, Dyn>,
}

impl Factors {
    fn of(jacobian: &DMatrix<f64>, step: f64) -> Self {
        let n = jacobian.nrows();
        let real = DMatrix::from_diagonal_element(n, n, REAL / step) - jacobian;
        let complex = DMatrix::from_diagonal_element(n, n, COMPLEX / step)
            - jacobian.map(|x| Complex::new(x, 0.0));
        Self {
            step,
            real: real.lu(),
            complex: complex.lu(),
        }
    }

    /// Not numbers where the matrix is singular or none.
    fn solve_real<const N: usize>(&self, right: &SVector<f64, N>) -> SVector<f64, N> {
        let right = DVector::from_column_slice(right.as_slice());
        let solution = self.real.solve(&right);
        SVector::from_fn(|i, _| solution.as_ref().map_or(f64::NAN, |x| x[i]))
    }

    fn solve_complex<const N: usize>(
        &self,
        right: &SVector<Complex<f64>, N>,
    ) -> SVector<Complex<f64>, N> {
        let right = DVector::from_column_slice(right.as_slice());
        let solution = self.complex.solve(&right);
        let none = Complex::new(f64::NAN, f64::NAN);
        SVector::from_fn(|i, _| solution.as_ref().map_or(none, |x| x[i]))
    }
}

impl<const N: usize> Radau<N> {
    /// At the state `y` at time `start`, on the way to `end`, with `step` to try first or one of its own choice.
    ///
    /// # Errors
    /// What the equations refuse at the start; a slope there that is not finite.
    pub fn new<S: System<N>>(
        system: &mut S,
        start: f64,
        end: f64,
        y: SVector<f64, N>,
        step: Option<f64>,
    ) -> Result<Self, S::Error> {
        let mut state = Compensated::new(y);
        system.accept(&mut state);
        let span = end - start;
        let slope = system.derivative(start, &state.value)?;
        if !slope.iter().all(|x| x.is_finite()) {
            return Err(Error::from(MotionFault::NotFiniteMotion { time: start }).into());
        }
        let (step, evaluations) = match step {
            Some(step) if step != 0.0 => (step.abs().min(span.abs()).copysign(span), 1),
            _ => (
                first_step(system, start, span, &state.value, &slope, EXPONENT)?,
                2,
            ),
        };
        let mut stepper = Self {
            start,
            span,
            elapsed: (0.0, 0.0),
            state,
            slope,
            step,
            jacobian: DMatrix::zeros(N, N),
            is_current: false,
            factors: None,
            last: None,
            steps: 0,
            evaluations,
        };
        stepper.linearize(system)?;
        Ok(stepper)
    }

    /// Time since the start.
    #[must_use]
    pub fn elapsed(&self) -> f64 {
        self.elapsed.0
    }

    /// The step that would be tried next.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Whether the end is reached.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.elapsed.0 == self.span
    }

    /// The state now.
    #[must_use]
    pub fn state(&self) -> &SVector<f64, N> {
        &self.state.value
    }

    /// The states during the last accepted step as the polynomial of its collocation; `None` before the first step.
    #[must_use]
    pub fn dense(&self) -> Option<&Dense<N>> {
        self.last.as_ref().map(|(dense, _)| dense)
    }

    /// One accepted step toward the end.
    ///
    /// # Errors
    /// What the equations refuse; a step too small to advance the time.
    pub fn advance<S: System<N>>(&mut self, system: &mut S) -> Result<(), S::Error> {
        let mut rejected = false;
        loop {
            let remaining = (self.span - self.elapsed.0) - self.elapsed.1;
            let is_last = 1.01 * self.step.abs() >= remaining.abs();
            let h = if is_last { remaining } else { self.step };
            if self.elapsed.0 + h == self.elapsed.0 && !is_last {
                return Err(self.stuck(h).into());
            }
            let factors = match self.factors.take() {
                Some(factors) if factors.step == h => factors,
                _ => Factors::of(&self.jacobian, h),
            };
            let Some((stages, iterations, rate)) = self.collocate(system, &factors, h)? else {
                if self.is_current {
                    self.step = 0.5 * h;
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
                    self.step = h * growth;
                } else if (1.0..1.2).contains(&growth) {
                    self.step = h; // a little more would cost new factors
                    self.factors = Some(factors);
                } else {
                    self.step = h * growth;
                }
                return Ok(());
            }
            self.step = h * if factor.is_nan() {
                SHRINK
            } else {
                factor.clamp(SHRINK, 1.0)
            };
            rejected = true;
            if self.elapsed.0 + self.step == self.elapsed.0 {
                let time = self.start + self.elapsed.0;
                return Err(if error.is_nan() {
                    Error::Motion(MotionFault::NotFiniteMotion { time })
                } else {
                    self.stuck(self.step)
                }
                .into());
            }
        }
    }

    fn accept<S: System<N>>(
        &mut self,
        system: &mut S,
        stages: &Stages<N>,
        h: f64,
        error: f64,
        is_last: bool,
    ) -> Result<(), S::Error> {
        let dense = Dense::new(self.elapsed.0, h, &self.state.value, stages);
        self.state = self.state.plus(&stages[2]);
        system.accept(&mut self.state);
        self.elapsed = if is_last {
            (self.span, 0.0)
        } else {
            fast_two_sum(self.elapsed.0, h + self.elapsed.1)
        };
        self.last = Some((dense, error));
        self.steps += 1;
        self.is_current = false;
        self.slope = self.at(system, self.elapsed.0, &self.state.value.clone())?;
        Ok(())
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

    fn at<S: System<N>>(
        &mut self,
        system: &mut S,
        elapsed: f64,
        y: &SVector<f64, N>,
    ) -> Result<SVector<f64, N>, S::Error> {
        self.evaluations += 1;
        system.derivative(self.start + elapsed, y)
    }

    /// `∂f/∂y` by differences: Newton's iteration needs its size and direction, not its digits.
    fn linearize<S: System<N>>(&mut self, system: &mut S) -> Result<(), S::Error> {
        let (y, slope) = (self.state.value, self.slope);
        let size = system.error_norm(&y, &y, &y);
        for j in 0..N {
            let mut unit = SVector::<f64, N>::zeros();
            unit[j] = 1.0;
            // The largest value of the group that the component belongs to, as the norm weighs it.
            let group = size / system.error_norm(&y, &y, &unit);
            let scale = [group, (slope[j] * self.step).abs()]
                .into_iter()
                .filter(|x| x.is_finite())
                .fold(y[j].abs(), f64::max);
            let scale = if scale > 0.0 { scale } else { 1.0 };
            let mut moved = y;
            moved[j] += f64::EPSILON.sqrt() * scale;
            let change = self.at(system, self.elapsed.0, &moved)? - slope;
            let by = moved[j] - y[j];
            for i in 0..N {
                self.jacobian[(i, j)] = change[i] / by;
            }
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
        factors: &Factors,
        h: f64,
    ) -> Result<Option<(Stages<N>, i32, f64)>, S::Error> {
        let y = self.state.value;
        let mut stages = match &self.last {
            Some((last, _)) => NODES.map(|node| last.at(self.elapsed.0 + node * h) - y),
            None => [SVector::zeros(); 3],
        };
        let mut transformed = combined(&T_INVERSE, &stages);
        let mut before = f64::NAN;
        for iteration in 1..=ITERATIONS {
            let mut slopes = [SVector::zeros(); 3];
            for (slope, (stage, node)) in slopes.iter_mut().zip(stages.iter().zip(NODES)) {
                *slope = self.at(system, self.elapsed.0 + node * h, &(y + stage))?;
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
        factors: &Factors,
        stages: &Stages<N>,
        h: f64,
        rejected: bool,
    ) -> Result<f64, S::Error> {
        let y = self.state.value;
        let y_new = y + stages[2];
        let weighted = combine(&ERROR, stages) / h;
        let error = factors.solve_real(&(self.slope + weighted));
        let norm = system.error_norm(&y, &y_new, &error);
        if norm <= 1.0 || !(rejected || self.last.is_none()) {
            return Ok(norm);
        }
        let slope = self.at(system, self.elapsed.0, &(y + error))?;
        let error = factors.solve_real(&(slope + weighted));
        Ok(system.error_norm(&y, &y_new, &error))
    }

    fn stuck(&self, step: f64) -> Error {
        Error::Motion(MotionFault::StepTooSmall {
            time: self.start + self.elapsed.0,
            step,
        })
    }
}

fn combine<const N: usize>(weights: &[f64; 3], stages: &Stages<N>) -> SVector<f64, N> {
    stages[0] * weights[0] + stages[1] * weights[1] + stages[2] * weights[2]
}

fn combined<const N: usize>(matrix: &[[f64; 3]; 3], stages: &Stages<N>) -> Stages<N> {
    matrix.each_ref().map(|row| combine(row, stages))
}
