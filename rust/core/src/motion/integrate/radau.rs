//! Radau IIA: the implicit Runge-Kutta method of order 5 that collocates at three points, the last of them the end of the
//! step. It damps what decays fast whatever the length of the step (L-stable), so that a stiff load does not
//! dictate the steps (Hairer & Wanner, Solving ODEs II, §IV.8).

use std::ops::AddAssign;

use nalgebra::{Complex, DMatrix, Dyn, PermutationSequence, SVector};

use super::runge_kutta::System;
use super::runge_kutta::{Progress, RungeKutta, StepError};
use crate::numerics::power_of_two::{exponent, times_power_of_two};

/// Newton's iterations before the step is shortened.
const ITERATIONS: i32 = 7;
/// The error of the stages that is left, in units of what a step may err.
const STAGE_TOLERANCE: f64 = 1e-3;
const SHRINK: f64 = 0.2;
const GROW: f64 = 8.0;
/// For as many steps a length is kept that may grow a little. In a steady motion it would be kept for ever.
const MOST_KEPT: u32 = 8;
/// One over the order of the error that the estimate controls.
const EXPONENT: f64 = 1.0 / STEP_ERROR.order;
/// Of the error that the estimate controls; the constant is that of short steps of `y' = i y`.
const STEP_ERROR: StepError = StepError {
    constant: 4.6e-3,
    order: 4.0,
};

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
    /// How many steps had the length of the one before, though longer ones would do.
    kept: u32,
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
        let (progress, slope) = Progress::new(system, [start, end], y, step, STEP_ERROR)?;
        let mut stepper = Self {
            progress,
            slope,
            jacobian: Jacobian::zero(),
            is_current: false,
            factors: None,
            kept: 0,
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
                } else if (1.0..1.2).contains(&growth) && self.kept < MOST_KEPT {
                    self.progress.step = h; // a little more would cost new factors
                    self.factors = Some(factors);
                    self.kept += 1;
                } else {
                    self.progress.step = h * growth;
                    self.kept = 0;
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

    /// Predict the factor of the step from the errors of this step and the one before (Gustafsson).
    fn predicted(&self, h: f64, error: f64, safety: f64) -> f64 {
        match &self.last {
            Some((last, before)) if error > 0.0 && *before > 0.0 => {
                safety * (h / last.step) * (before / error).powf(EXPONENT) * error.powf(-EXPONENT)
            }
            _ => f64::INFINITY,
        }
    }

    /// Compute `∂f/∂y` by differences: Newton's iteration needs no more than a few digits of it.
    fn linearize<S: System<N>>(&mut self, system: &mut S) -> Result<(), S::Error> {
        let (y, slope) = (self.progress.state.value, self.slope);
        let size = system.error_norm(&y, &y, &y);
        for j in 0..N {
            let mut unit = SVector::<f64, N>::zeros();
            unit[j] = 1.0;
            // The largest value in the group of the component, with the weights of the norm.
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

    /// Compute the stages of a step of length h by Newton's iteration with the present Jacobian; return also the number of iterations and
    /// their rate of convergence, or `None` if they do not converge.
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
            // Relative to the end of the step: a component may be zero at its start, for example the position of a body.
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

    /// Estimate the error in units of the error allowed. After a rejected step the estimate is filtered once more, because the raw one is
    /// far too large for components that decay fast.
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

/// The increments of the three stages over the state at the start of the step.
type Stages<const N: usize> = [SVector<f64, N>; 3];

#[inline]
fn combine<const N: usize>(weights: &[f64; 3], stages: &Stages<N>) -> SVector<f64, N> {
    stages[0] * weights[0] + stages[1] * weights[1] + stages[2] * weights[2]
}

#[inline]
fn combined<const N: usize>(matrix: &[[f64; 3]; 3], stages: &Stages<N>) -> Stages<N> {
    let [a, b, c] = matrix;
    [combine(a, stages), combine(b, stages), combine(c, stages)]
}

/// The states during one step as a polynomial of degree 3 in time.
#[derive(Clone, Debug)]
struct Dense<const N: usize> {
    start: f64,
    step: f64,
    y: SVector<f64, N>,
    coefficients: Stages<N>,
}

impl<const N: usize> Dense<N> {
    fn new(start: f64, step: f64, y: &SVector<f64, N>, stages: &Stages<N>) -> Self {
        let column = |k: usize| combine(&POLYNOMIAL.map(|row| row[k]), stages);
        Self {
            start,
            step,
            y: *y,
            coefficients: [column(0), column(1), column(2)],
        }
    }

    /// Compute the state at `elapsed` since the start of the integration.
    fn at(&self, elapsed: f64) -> SVector<f64, N> {
        let x = (elapsed - self.start) / self.step;
        let [first, second, third] = &self.coefficients;
        self.y + (first + (second + third * x) * x) * x
    }
}

/// The Jacobian `∂f/∂y`, and the sizes of the components of y.
#[derive(Clone, Debug)]
struct Jacobian<const N: usize> {
    matrix: DMatrix<f64>,
    /// Exponents of the powers of two that are the units of the components.
    units: SVector<i32, N>,
}

impl<const N: usize> Jacobian<N> {
    fn zero() -> Self {
        Self {
            matrix: DMatrix::zeros(N, N),
            units: SVector::zeros(),
        }
    }

    /// Set the derivatives by component j, whose size is about `size`, from a change `by` of it.
    fn set(&mut self, j: usize, size: f64, change: &SVector<f64, N>, by: f64) {
        self.units[j] = exponent(size);
        for i in 0..N {
            self.matrix[(i, j)] = change[i] / by;
        }
    }

    /// Compute the matrix in the units of the components and the unit `2^time` of time.
    fn in_units(&self, time: i32) -> DMatrix<f64> {
        DMatrix::from_fn(N, N, |i, j| {
            times_power_of_two(self.matrix[(i, j)], time + self.units[j] - self.units[i])
        })
    }
}

/// The matrices of Newton's iteration, `γ/h − J` and `(α + iβ)/h − J`, factored, in the units of J and a unit of time near h. With these
/// units no product of pivots overflows or underflows, and pivots are compared in the same unit.
#[derive(Clone, Debug)]
struct Factors<const N: usize> {
    step: f64,
    /// Exponents of the powers of two that are the units.
    time: i32,
    units: SVector<i32, N>,
    real: Triangles<f64, N>,
    complex: Triangles<Complex<f64>, N>,
}

impl<const N: usize> Factors<N> {
    fn of(jacobian: &Jacobian<N>, step: f64) -> Self {
        let time = exponent(step);
        let h = times_power_of_two(step, -time);
        let matrix = jacobian.in_units(time);
        let real = DMatrix::from_diagonal_element(N, N, REAL / h) - &matrix;
        let complex = DMatrix::from_diagonal_element(N, N, COMPLEX / h)
            - matrix.map(|x| Complex::new(x, 0.0));
        Self {
            step,
            time,
            units: jacobian.units,
            real: Triangles::of(real),
            complex: Triangles::of(complex),
        }
    }

    /// Return the solution; NaN if the matrix is singular or not finite.
    fn solve_real(&self, right: &SVector<f64, N>) -> SVector<f64, N> {
        let right = SVector::from_fn(|i, _| self.inward(right[i], i));
        let solution = self.real.solve(&right);
        SVector::from_fn(|i, _| {
            (solution.as_ref()).map_or(f64::NAN, |x| times_power_of_two(x[i], self.units[i]))
        })
    }

    fn solve_complex(&self, right: &SVector<Complex<f64>, N>) -> SVector<Complex<f64>, N> {
        let right = SVector::from_fn(|i, _| {
            Complex::new(self.inward(right[i].re, i), self.inward(right[i].im, i))
        });
        let solution = self.complex.solve(&right);
        SVector::from_fn(|i, _| {
            let none = Complex::new(f64::NAN, f64::NAN);
            let x = solution.as_ref().map_or(none, |x| x[i]);
            let outward = |x| times_power_of_two(x, self.units[i]);
            Complex::new(outward(x.re), outward(x.im))
        })
    }

    /// Convert a rate of component i to the units.
    #[inline]
    fn inward(&self, rate: f64, i: usize) -> f64 {
        times_power_of_two(rate, self.time - self.units[i])
    }
}

/// A factored matrix, `P A = L U`: each column contains that of L below the diagonal, where L has ones, and that of U from the diagonal
/// up. Its size is a constant, because a run solves with it thousands of times.
#[derive(Clone, Debug)]
struct Triangles<T: nalgebra::ComplexField, const N: usize> {
    rows: PermutationSequence<Dyn>,
    columns: Box<[[T; N]]>,
}

impl<T: nalgebra::ComplexField + Copy + AddAssign, const N: usize> Triangles<T, N> {
    fn of(matrix: DMatrix<T>) -> Self {
        let (rows, lower, upper) = matrix.lu().unpack();
        let column =
            |j: usize| std::array::from_fn(|i| if i > j { lower[(i, j)] } else { upper[(i, j)] });
        Self {
            rows,
            columns: (0..N).map(column).collect(),
        }
    }

    /// Solve `A x = right`; `None` if the matrix is singular.
    #[inline]
    fn solve(&self, right: &SVector<T, N>) -> Option<SVector<T, N>> {
        let mut x = *right;
        self.rows.permute_rows(&mut x);
        for (j, column) in self.columns.iter().enumerate() {
            let part = -x[j];
            for i in j + 1..N {
                x[i] += part * column[i];
            }
        }
        for (j, column) in self.columns.iter().enumerate().rev() {
            if column[j].is_zero() {
                return None;
            }
            x[j] /= column[j];
            let part = -x[j];
            for i in 0..j {
                x[i] += part * column[i];
            }
        }
        Some(x)
    }
}

const ROOT_6: f64 = 2.449_489_742_783_178;
/// The points of collocation, in steps.
const NODES: [f64; 3] = [(4.0 - ROOT_6) / 10.0, (4.0 + ROOT_6) / 10.0, 1.0];
/// The inverse of the method's matrix is `T Λ T⁻¹` with Λ of a real block γ and the block of α ± iβ.
const REAL: f64 = 3.637_834_252_744_496;
const COMPLEX: Complex<f64> = Complex::new(2.681_082_873_627_752, -3.050_430_199_247_410_5);
const T: [[f64; 3]; 3] = [
    [
        0.094_438_762_488_975_24,
        -0.141_255_295_020_954_2,
        0.030_029_194_105_147_42,
    ],
    [
        0.250_213_122_965_333_3,
        0.204_129_352_293_799_94,
        -0.382_942_112_757_261_9,
    ],
    [1.0, 1.0, 0.0],
];
const T_INVERSE: [[f64; 3]; 3] = [
    [
        4.178_718_591_551_904,
        0.327_682_820_761_062_4,
        0.523_376_445_499_449_5,
    ],
    [
        -4.178_718_591_551_904,
        -0.327_682_820_761_062_4,
        0.476_623_554_500_550_45,
    ],
    [
        0.502_872_634_945_786_8,
        -2.571_926_949_855_605,
        0.596_039_204_828_224_9,
    ],
];
/// The weights of the stages in the estimate of the error, of order 3.
const ERROR: [f64; 3] = [
    (-13.0 - 7.0 * ROOT_6) / 3.0,
    (-13.0 + 7.0 * ROOT_6) / 3.0,
    -1.0 / 3.0,
];
/// The stages as the polynomial through them: rows of coefficients of x, x², x³, x in steps.
const POLYNOMIAL: [[f64; 3]; 3] = [
    [
        (13.0 + 7.0 * ROOT_6) / 3.0,
        (-23.0 - 22.0 * ROOT_6) / 3.0,
        (10.0 + 15.0 * ROOT_6) / 3.0,
    ],
    [
        (13.0 - 7.0 * ROOT_6) / 3.0,
        (-23.0 + 22.0 * ROOT_6) / 3.0,
        (10.0 - 15.0 * ROOT_6) / 3.0,
    ],
    [1.0 / 3.0, -8.0 / 3.0, 10.0 / 3.0],
];

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, Matrix3, SVector, Vector2};

    use super::*;
    use crate::error::Error;
    use crate::motion::integrate::{Compensated, RungeKutta, System};

    #[test]
    fn constants_are_those_of_the_method() {
        // Collocation: the row i of A integrates the Lagrange polynomials through the nodes from 0 to node i.
        let powers = |x: f64| [x, x * x / 2.0, x * x * x / 3.0];
        let vandermonde = Matrix3::from_fn(|j, k| NODES[j].powi(i32::try_from(k).expect("small")));
        let integrals = Matrix3::from_fn(|i, k| powers(NODES[i])[k]);
        let method = integrals * vandermonde.try_inverse().expect("distinct nodes");
        let matrix = |rows: &[[f64; 3]; 3]| Matrix3::from_fn(|i, j| rows[i][j]);
        let blocks = Matrix3::new(
            REAL,
            0.0,
            0.0,
            0.0,
            COMPLEX.re,
            -COMPLEX.im,
            0.0,
            COMPLEX.im,
            COMPLEX.re,
        );
        let eigen = |sign: f64| {
            let mut blocks = blocks;
            blocks[(1, 2)] *= sign;
            blocks[(2, 1)] *= sign;
            matrix(&T) * blocks * matrix(&T_INVERSE) - method.try_inverse().expect("regular")
        };
        assert!((matrix(&T) * matrix(&T_INVERSE) - Matrix3::identity()).norm() < 1e-14);
        assert!(eigen(1.0).norm() < 1e-13, "{}", eigen(1.0));
        // The dense output passes through the stages.
        for (i, node) in NODES.into_iter().enumerate() {
            for (j, row) in POLYNOMIAL.iter().enumerate() {
                let value = node * (row[0] + node * (row[1] + node * row[2]));
                assert!((value - if i == j { 1.0 } else { 0.0 }).abs() < 1e-14);
            }
        }
    }

    fn check<T: nalgebra::ComplexField<RealField = f64> + Copy + AddAssign>(numbers: [T; 9]) {
        let matrix = DMatrix::from_row_slice(3, 3, &numbers);
        let right = SVector::from([numbers[1], numbers[3], numbers[8]]);
        let x = Triangles::<T, 3>::of(matrix.clone())
            .solve(&right)
            .expect("regular");
        assert!((matrix * x - right).norm() <= 1e-14 * x.norm());
    }

    #[test]
    fn solutions_solve_also_where_rows_change_their_places() {
        let numbers = [0.0, 2.0, 1.0, 1.0, 1e-9, -3.0, 4.0, -1.0, 0.5];
        check(numbers);
        check(numbers.map(|x| Complex::new(x, 1.0 - x * x)));
    }

    #[test]
    fn a_singular_matrix_has_no_solution() {
        let rows = |last: f64| DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, last]);
        let right = SVector::from([1.0, 1.0]);
        assert!(Triangles::<f64, 2>::of(rows(4.0)).solve(&right).is_none());
        assert!(
            Triangles::<f64, 2>::of(rows(4.0 + 1e-15))
                .solve(&right)
                .is_some()
        );
    }

    /// ẏ = −λ (y − cos t) − sin t beside ẍ = −x: the solution from y(0) = 1 + departure is cos t + departure e^(−λ t).
    struct Stiff {
        rate: f64,
        tolerance: f64,
    }

    impl System<3> for Stiff {
        type Error = Error;

        fn derivative(
            &mut self,
            t: f64,
            y: &SVector<f64, 3>,
            slope: &mut SVector<f64, 3>,
        ) -> Result<(), Error> {
            let pull = -self.rate * (y[0] - t.cos()) - t.sin();
            *slope = SVector::from([pull, y[2], -y[1]]);
            Ok(())
        }

        fn error_norm(
            &self,
            _: &SVector<f64, 3>,
            _: &SVector<f64, 3>,
            error: &SVector<f64, 3>,
        ) -> f64 {
            error.norm() / self.tolerance
        }

        fn accept(&mut self, _: &mut Compensated<3>) {}
    }

    fn run(rate: f64, tolerance: f64, departure: f64, end: f64) -> (f64, f64, u64) {
        let mut system = Stiff { rate, tolerance };
        let y = SVector::from([1.0 + departure, 1.0, 0.0]);
        let mut stepper = Radau::new(&mut system, 0.0, end, y, None).expect("finite");
        let mut between: f64 = 0.0;
        while !stepper.is_finished() {
            let before = stepper.elapsed();
            stepper.advance(&mut system).expect("smooth");
            for part in [0.0, 0.3, 0.8, 1.0] {
                let t = before + part * (stepper.elapsed() - before);
                let exact = Vector2::new(t.cos(), -t.sin());
                let y = stepper.within(&mut system, t).expect("smooth");
                between = between.max((y.fixed_rows::<2>(1) - exact).norm());
            }
        }
        let exact = SVector::from([end.cos(), end.cos(), -end.sin()]);
        (
            (stepper.state() - exact).norm(),
            between,
            stepper.progress().steps,
        )
    }

    #[test]
    fn error_follows_the_tolerance() {
        for tolerance in [1e-4, 1e-7, 1e-10] {
            let (error, between, _) = run(50.0, tolerance, 0.0, 10.0);
            assert!(error < 30.0 * tolerance, "{error:e}");
            assert!(between < 100.0 * tolerance, "{between:e}");
        }
        assert!(run(0.0, 1e-8, 0.0, -7.0).0 > 0.0);
    }

    #[test]
    fn steps_do_not_depend_on_the_stiffness() {
        let mild = run(1e3, 1e-8, 0.5, 10.0);
        for rate in [1e5, 1e7, 1e9] {
            let (error, _, steps) = run(rate, 1e-8, 0.5, 10.0);
            assert!(error < 1e-6, "{error:e}");
            assert!(steps < mild.2 + mild.2 / 4, "{steps} for {}", mild.2);
        }
    }

    /// ẍ = −sin x, whose Jacobian changes along the way.
    struct Pendulum {
        tolerance: f64,
    }

    impl System<2> for Pendulum {
        type Error = Error;

        fn derivative(
            &mut self,
            _: f64,
            y: &Vector2<f64>,
            slope: &mut Vector2<f64>,
        ) -> Result<(), Error> {
            *slope = Vector2::new(y[1], -y[0].sin());
            Ok(())
        }

        fn error_norm(&self, _: &Vector2<f64>, _: &Vector2<f64>, error: &Vector2<f64>) -> f64 {
            error.norm() / self.tolerance
        }

        fn accept(&mut self, _: &mut Compensated<2>) {}
    }

    // Iterations down to rounding need 14.6, 10.8 and 9.1 evaluations a step.
    #[test]
    fn iterations_end_where_the_tolerance_needs_no_more() {
        for (tolerance, most) in [(1e-4, 9.5), (1e-6, 8.5), (1e-8, 7.75)] {
            let mut system = Pendulum { tolerance };
            let y = Vector2::new(2.0, 0.0);
            let mut stepper = Radau::new(&mut system, 0.0, 50.0, y, None).expect("finite");
            while !stepper.is_finished() {
                stepper.advance(&mut system).expect("smooth");
            }
            let progress = stepper.progress();
            let each = progress.evaluations as f64 / progress.steps as f64;
            assert!(each <= most, "{tolerance:e}: {each} evaluations a step");
        }
    }
}
