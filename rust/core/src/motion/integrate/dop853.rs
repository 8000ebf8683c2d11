//! DOP853: the explicit Runge-Kutta method of order 8 by Dormand and Prince with step-size control by embedded estimates
//! of orders 5 and 3 and a dense output of order 7 (Hairer, Nørsett & Wanner, Solving ODEs I, §II.5, §II.6, §II.10).

use nalgebra::SVector;

use super::runge_kutta::{Progress, RungeKutta};
use super::system::System;
use super::tableau::{DENSE, ERROR_3, ERROR_5, EXTENDED_STAGES, NODES, Row, STAGE_WEIGHTS, STAGES};

/// The factor by which a step may shrink or grow, and the part of the optimal factor that is used.
const SHRINK: f64 = 1.0 / 3.0;
const GROW: f64 = 6.0;
const SAFETY: f64 = 0.9;
/// One over the order of the error that the estimate controls.
const EXPONENT: f64 = 1.0 / 8.0;

/// An integration under way.
#[derive(Clone, Debug)]
pub(crate) struct Dop853<const N: usize> {
    progress: Progress<N>,
    /// The slopes of the last accepted step; the thirteenth is the slope at its end.
    slopes: [SVector<f64, N>; EXTENDED_STAGES],
    /// Time and state before the last accepted step, and its length.
    last: (f64, SVector<f64, N>, f64),
    /// Its polynomial, once it is asked for.
    dense: Option<Dense<N>>,
}

impl<const N: usize> RungeKutta<N> for Dop853<N> {
    fn new<S: System<N>>(
        system: &mut S,
        start: f64,
        end: f64,
        y: SVector<f64, N>,
        step: Option<f64>,
    ) -> Result<Self, S::Error> {
        let (progress, slope) = Progress::new(system, [start, end], y, step, EXPONENT)?;
        let mut slopes = [SVector::zeros(); EXTENDED_STAGES];
        slopes[STAGES] = slope;
        Ok(Self {
            last: (0.0, progress.state.value, 0.0),
            progress,
            slopes,
            dense: None,
        })
    }

    fn progress(&self) -> &Progress<N> {
        &self.progress
    }

    fn advance<S: System<N>>(&mut self, system: &mut S) -> Result<(), S::Error> {
        self.dense = None;
        let mut largest = GROW;
        loop {
            let (h, is_last) = self.progress.next()?;
            let y = self.progress.state.value;
            self.slopes[0] = self.slopes[STAGES];
            let slope_at_start = self.slopes[0];
            for stage in 1..STAGES {
                let y = y + self.weighted(STAGE_WEIGHTS[stage]) * h;
                let elapsed = self.progress.elapsed.0 + NODES[stage] * h;
                (self.progress).slope(system, elapsed, &y, &mut self.slopes[stage])?;
            }
            let state = (self.progress.state).plus(&(self.weighted(STAGE_WEIGHTS[STAGES]) * h));
            let error = self.error(system, &y, &state.value, h);
            let factor = SAFETY * error.powf(-EXPONENT); // infinite for no error, NaN for one that is not finite
            let progress = &mut self.progress;
            if error <= 1.0 {
                self.last = (progress.elapsed.0, y, h);
                progress.state = state;
                progress.advance(h, is_last);
                progress.step = h * factor.clamp(SHRINK, largest);
                system.accept(&mut progress.state);
                let y = progress.state.value;
                let elapsed = progress.elapsed.0;
                return progress.slope(system, elapsed, &y, &mut self.slopes[STAGES]);
            }
            self.slopes[STAGES] = slope_at_start;
            // The factor is below one, or not a number.
            progress.step = h * factor.max(SHRINK);
            largest = 1.0;
            progress.check_advances(error)?;
        }
    }

    fn within<S: System<N>>(
        &mut self,
        system: &mut S,
        elapsed: f64,
    ) -> Result<SVector<f64, N>, S::Error> {
        let dense = match self.dense.take() {
            Some(dense) => dense,
            None => self.polynomial(system)?,
        };
        let y = dense.at(elapsed);
        self.dense = Some(dense);
        Ok(y)
    }
}

impl<const N: usize> Dop853<N> {
    /// The states during the last accepted step as a polynomial in time.
    ///
    /// # Errors
    /// What the equations refuse in the three more evaluations it takes.
    #[inline]
    fn polynomial<S: System<N>>(&mut self, system: &mut S) -> Result<Dense<N>, S::Error> {
        let (start, y, h) = self.last;
        for stage in STAGES + 1..EXTENDED_STAGES {
            let y = y + self.weighted(STAGE_WEIGHTS[stage]) * h;
            let elapsed = start + NODES[stage] * h;
            (self.progress).slope(system, elapsed, &y, &mut self.slopes[stage])?;
        }
        let change = self.progress.state.value - y;
        let (before, after) = (self.slopes[0] * h, self.slopes[STAGES] * h);
        let mut coefficients = [change; 7];
        coefficients[1] = before - change;
        coefficients[2] = change * 2.0 - (after + before);
        for (coefficient, row) in coefficients[3..].iter_mut().zip(DENSE) {
            *coefficient = self.weighted(row) * h;
        }
        Ok(Dense {
            start,
            step: h,
            y,
            coefficients,
        })
    }

    #[inline]
    fn weighted(&self, row: Row) -> SVector<f64, N> {
        let mut sum = SVector::zeros();
        for &(stage, weight) in row {
            let slope = &self.slopes[stage];
            for i in 0..N {
                sum[i] += slope[i] * weight;
            }
        }
        sum
    }

    /// The estimate of order 5, damped by that of order 3, in units of what is allowed.
    #[inline]
    fn error<S: System<N>>(
        &self,
        system: &S,
        y: &SVector<f64, N>,
        y_new: &SVector<f64, N>,
        h: f64,
    ) -> f64 {
        let norm = |row| system.error_norm(y, y_new, &(self.weighted(row) * h));
        let (fifth, third) = (norm(ERROR_5), norm(ERROR_3));
        if fifth == 0.0 {
            0.0
        } else {
            fifth * (fifth / fifth.hypot(0.1 * third))
        }
    }
}

/// The states during one step as a polynomial of degree 7 in time.
#[derive(Clone, Debug)]
struct Dense<const N: usize> {
    start: f64,
    step: f64,
    y: SVector<f64, N>,
    coefficients: [SVector<f64, N>; 7],
}

impl<const N: usize> Dense<N> {
    /// The state at `elapsed` since the start of the integration.
    #[inline]
    fn at(&self, elapsed: f64) -> SVector<f64, N> {
        let x = (elapsed - self.start) / self.step;
        let mut y = SVector::zeros();
        for (i, coefficient) in self.coefficients.iter().enumerate().rev() {
            y = (y + coefficient) * if i % 2 == 0 { x } else { 1.0 - x };
        }
        self.y + y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::motion::integrate::Compensated;
    use nalgebra::{Vector1, Vector2};

    /// ẍ = −x, whose solution from (1, 0) is (cos t, −sin t).
    struct Oscillator {
        tolerance: f64,
    }

    impl System<2> for Oscillator {
        type Error = Error;

        fn derivative(
            &mut self,
            _t: f64,
            y: &Vector2<f64>,
            slope: &mut Vector2<f64>,
        ) -> Result<(), Error> {
            *slope = Vector2::new(y.y, -y.x);
            Ok(())
        }

        fn error_norm(&self, _: &Vector2<f64>, _: &Vector2<f64>, error: &Vector2<f64>) -> f64 {
            error.norm() / self.tolerance
        }

        fn accept(&mut self, _: &mut Compensated<2>) {}
    }

    fn run(tolerance: f64, end: f64) -> (f64, f64, u64) {
        let mut system = Oscillator { tolerance };
        let mut stepper =
            Dop853::new(&mut system, 3.0, 3.0 + end, Vector2::x(), None).expect("finite");
        let mut between: f64 = 0.0;
        while !stepper.is_finished() {
            let before = stepper.elapsed();
            stepper.advance(&mut system).expect("smooth");
            for part in [0.0, 0.3, 0.5, 0.9, 1.0] {
                let t = before + part * (stepper.elapsed() - before);
                let y = stepper.within(&mut system, t).expect("smooth");
                between = between.max((y - Vector2::new(t.cos(), -t.sin())).norm());
            }
        }
        let exact = Vector2::new(end.cos(), -end.sin());
        (
            (stepper.state() - exact).norm(),
            between,
            stepper.progress.steps,
        )
    }

    #[test]
    fn error_follows_the_tolerance_forward_and_backward() {
        for end in [20.0, -20.0] {
            for tolerance in [1e-6, 1e-9, 1e-12] {
                let (error, between, _) = run(tolerance, end);
                assert!(error < 50.0 * tolerance, "{error:e}");
                assert!(between < 200.0 * tolerance, "{between:e}");
            }
        }
    }

    #[test]
    fn order_is_eight() {
        // Work grows with the eighth root of the accuracy: 10⁴ times as accurate for 10^½ times the steps.
        let (coarse, fine) = (run(1e-6, 200.0).2 as f64, run(1e-10, 200.0).2 as f64);
        assert!(
            (fine / coarse).log10() < 0.6 && (fine / coarse).log10() > 0.4,
            "{}",
            fine / coarse
        );
    }

    /// At rest for half a second, then shaken.
    struct Shaken;

    impl System<1> for Shaken {
        type Error = Error;

        fn derivative(
            &mut self,
            t: f64,
            _: &Vector1<f64>,
            slope: &mut Vector1<f64>,
        ) -> Result<(), Error> {
            slope.x = if t < 0.5 { 0.0 } else { 1e3 * (1e3 * t).sin() };
            Ok(())
        }

        fn error_norm(&self, _: &Vector1<f64>, _: &Vector1<f64>, error: &Vector1<f64>) -> f64 {
            error.norm() / 1e-6
        }

        fn accept(&mut self, _: &mut Compensated<1>) {}
    }

    #[test]
    fn a_step_after_one_that_was_refused_is_no_longer() {
        let first = |step: f64| {
            let mut stepper =
                Dop853::new(&mut Shaken, 0.0, 100.0, Vector1::zeros(), Some(step)).expect("finite");
            stepper.advance(&mut Shaken).expect("at rest");
            (stepper.elapsed(), stepper.progress.step)
        };
        // One second reaches into the shaking: a third of it is taken, without any error, and so is the next.
        assert_eq!(first(1.0), (SHRINK, SHRINK));
        // Where none was refused, a step without error is followed by the longest that may follow.
        assert_eq!(first(0.0625), (0.0625, 0.0625 * GROW));
    }
}
