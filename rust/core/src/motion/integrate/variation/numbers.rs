//! Series and vectors of numbers that carry their derivatives with them.

use nalgebra::{Matrix3, Vector3, Vector6};

use crate::numerics::double_double::two_sum;
use crate::numerics::jet::Jet;

/// How many variables are varied at a time.
pub(super) const WIDTH: usize = 8;
/// The highest order of the series.
pub(super) const ORDER: usize = 24;

/// A number and its derivatives by the variables of one block.
pub(super) type Number = Jet<WIDTH>;
pub(super) type Vector = [Number; 3];
/// Three rows.
pub(super) type Matrix = [Vector; 3];
/// (x, y, z, w).
pub(super) type Quadruple = [Number; 4];
/// The coefficients of a power series in time, as far as they are known.
pub(super) type Row = Vec<Number>;
pub(super) type Rows<const N: usize> = [Row; N];

/// The derivatives of (δ, ω) by the variables of a block.
pub(super) type Columns = [Vector6<f64>; WIDTH];

pub(super) const ZERO: Number = Number::constant(0.0);

/// The variables of which derivatives are taken together: those whose columns begin with `first`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub(super) first: usize,
}

impl Block {
    /// The variable of a column, at its value.
    pub(super) fn variable(self, value: f64, column: usize) -> Number {
        match column.checked_sub(self.first) {
            Some(index) if index < WIDTH => Number::variable(value, index),
            _ => Number::constant(value),
        }
    }

    /// A vector whose components are variables, from the column `first` on.
    pub(super) fn vector(self, value: &Vector3<f64>, first: usize) -> Vector {
        [0, 1, 2].map(|i| self.variable(value[i], first + i))
    }

    /// A matrix whose elements are variables, row by row from the column `first` on.
    pub(super) fn matrix(self, value: &Matrix3<f64>, first: usize) -> Matrix {
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.variable(value[(i, j)], first + 3 * i + j)))
    }
}

/// The coefficient of order `k` of a product of two series.
pub(super) fn product(a: &[Number], b: &[Number], k: usize) -> Number {
    let mut sum = ZERO;
    for (x, y) in a[..=k].iter().zip(b[..=k].iter().rev()) {
        sum.value += x.value * y.value;
        for i in 0..WIDTH {
            sum.slopes[i] += x.value * y.slopes[i] + x.slopes[i] * y.value;
        }
    }
    sum
}

/// The coefficient of order `k` of a×b.
pub(super) fn cross_product(a: &Rows<3>, b: &Rows<3>, k: usize) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| product(&a[i], &b[j], k) - product(&a[j], &b[i], k))
}

/// The coefficient of order `k` of the product of two quaternions (x, y, z, w), the second without scalar part.
pub(super) fn turn_product(q: &Rows<4>, v: &Rows<3>, k: usize) -> Quadruple {
    let [x, y, z, w] = q;
    let p = |a: &Row, b: &Row| product(a, b, k);
    [
        p(w, &v[0]) + p(y, &v[2]) - p(z, &v[1]),
        p(w, &v[1]) + p(z, &v[0]) - p(x, &v[2]),
        p(w, &v[2]) + p(x, &v[1]) - p(y, &v[0]),
        -(p(x, &v[0]) + p(y, &v[1]) + p(z, &v[2])),
    ]
}

/// The coefficients of order `k`.
pub(super) fn at<const N: usize>(rows: &Rows<N>, k: usize) -> [Number; N] {
    std::array::from_fn(|i| rows[i][k])
}

/// Begins series anew with their values.
pub(super) fn begin<const N: usize>(rows: &mut Rows<N>, values: &[Number; N]) {
    for (row, value) in rows.iter_mut().zip(values) {
        row.clear();
        row.push(*value);
    }
}

/// The next coefficients of series, from those of their rates.
pub(super) fn extend<const N: usize>(rows: &mut Rows<N>, rates: &[Number; N]) {
    for (row, rate) in rows.iter_mut().zip(rates) {
        row.push(*rate * (1.0 / row.len() as f64));
    }
}

/// What a series adds to its first coefficient within the time `h` (Horner).
pub(super) fn increment(row: &[Number], h: f64) -> Number {
    (row[1..].iter().rev()).fold(ZERO, |sum, coefficient| (sum + *coefficient) * h)
}

pub(super) fn plus(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + b[i])
}

pub(super) fn times<const N: usize>(a: &[Number; N], factor: f64) -> [Number; N] {
    a.map(|x| x * factor)
}

pub(super) fn cross(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

pub(super) fn dot<const N: usize>(a: &[Number; N], b: &[Number; N]) -> Number {
    a.iter().zip(b).fold(ZERO, |sum, (x, y)| sum + *x * *y)
}

pub(super) fn apply(matrix: &Matrix, v: &Vector) -> Vector {
    [0, 1, 2].map(|i| dot(&matrix[i], v))
}

/// A constant matrix times a vector.
pub(super) fn turned(matrix: &Matrix3<f64>, v: &Vector) -> Vector {
    [0, 1, 2].map(|i| (0..3).fold(ZERO, |sum, j| sum + v[j] * matrix[(i, j)]))
}

/// `AᵀMA` of a constant matrix A.
pub(super) fn between(axes: &Matrix3<f64>, matrix: &Matrix) -> Matrix {
    let half = matrix.map(|row| turned(&axes.transpose(), &row)); // M A
    let columns = [0, 1, 2].map(|j| turned(&axes.transpose(), &half.map(|row| row[j])));
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i]))
}

/// The product of two quaternions (x, y, z, w).
pub(super) fn quaternion_product(p: &Quadruple, q: &Quadruple) -> Quadruple {
    let [a, b, c, d] = *p;
    let [x, y, z, w] = *q;
    [
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    ]
}

/// A vector of N as seen in the attitude q, a unit quaternion: `Rᵀ v`.
pub(super) fn seen(q: &Quadruple, v: &Vector) -> Vector {
    let u = [q[0], q[1], q[2]];
    let t = times(&cross(&u, v), 2.0);
    let again = cross(&u, &t);
    [0, 1, 2].map(|i| v[i] - q[3] * t[i] + again[i])
}

/// Adds to numbers, with what rounding leaves out beside them.
pub(super) fn add<const N: usize>([values, rests]: &mut [[Number; N]; 2], changes: &[Number; N]) {
    for ((value, rest), change) in values.iter_mut().zip(rests).zip(changes) {
        (value.value, rest.value) = two_sum(value.value, rest.value + change.value);
        for i in 0..WIDTH {
            let change = rest.slopes[i] + change.slopes[i];
            (value.slopes[i], rest.slopes[i]) = two_sum(value.slopes[i], change);
        }
    }
}
