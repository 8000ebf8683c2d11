use nalgebra::{SVector, Vector2};

use super::Radau;
use crate::error::Error;
use crate::motion::integrate::{Compensated, RungeKutta, System};

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

    fn error_norm(&self, _: &SVector<f64, 3>, _: &SVector<f64, 3>, error: &SVector<f64, 3>) -> f64 {
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

// To go on to rounding takes 14.6, 10.8 and 9.1 of them.
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
