//! Formulas in whole numbers, and both ways through them.

use nalgebra::Matrix3;

use super::*;
use crate::motion::integrate::taylor::series::Coefficient;
use crate::motion::integrate::taylor::single_series::SingleMotionSeries;
use crate::motion::loads::{OMEGA, Steps};

type One = crate::numerics::lane::Double<false>;

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
