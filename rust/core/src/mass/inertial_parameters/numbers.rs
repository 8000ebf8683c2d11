//! Mass, centre of mass and tensor about it, as ten numbers.

use nalgebra::{Matrix3, Vector3};

use crate::mass::body::RigidBody;
use crate::numerics::number::Real;

/// The elements of a symmetric tensor in their order: xx, yy, zz, xy, xz, yz.
pub const ELEMENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Where element (i, j) stands among the [`ELEMENTS`].
#[must_use]
pub const fn place(i: usize, j: usize) -> usize {
    if i == j { i } else { i + j + 2 }
}

/// m, C and the elements of `I_C` (off the diagonal *minus* the products), in the axes of the body frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ten<X> {
    /// Mass.
    pub mass: X,
    /// Centre of mass, from the origin of the body frame.
    pub center: [X; 3],
    /// The [`ELEMENTS`] of the tensor about it.
    pub inertia: [X; 6],
}

impl<X: Copy> Ten<X> {
    /// In the order m, C, `I_C`.
    #[must_use]
    pub fn to_array(&self) -> [X; 10] {
        std::array::from_fn(|k| match k {
            0 => self.mass,
            1..4 => self.center[k - 1],
            _ => self.inertia[k - 4],
        })
    }

    /// From that order.
    #[must_use]
    pub fn from_array(numbers: &[X; 10]) -> Self {
        Self {
            mass: numbers[0],
            center: std::array::from_fn(|k| numbers[1 + k]),
            inertia: std::array::from_fn(|k| numbers[4 + k]),
        }
    }

    /// Each of the numbers turned into another.
    #[must_use]
    pub fn map<Y: Copy>(&self, f: impl FnMut(X) -> Y) -> Ten<Y> {
        Ten::from_array(&self.to_array().map(f))
    }
}

impl Ten<f64> {
    /// Those of a body.
    #[must_use]
    pub fn of(body: &RigidBody) -> Self {
        let tensor = body.inertia();
        Self {
            mass: body.mass(),
            center: body.center_of_mass().into(),
            inertia: ELEMENTS.map(|place| tensor[place]),
        }
    }

    /// C as a vector.
    #[must_use]
    pub fn center_vector(&self) -> Vector3<f64> {
        self.center.into()
    }

    /// The tensor as a matrix.
    #[must_use]
    pub fn tensor(&self) -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| self.inertia[place(i, j)])
    }
}

/// `d² 1 − d dᵀ`, by [`ELEMENTS`].
pub(super) fn lever<X: Real>(d: [X; 3]) -> [X; 6] {
    let [x, y, z] = d;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    [yy + zz, xx + zz, xx + yy, -(x * y), -(x * z), -(y * z)]
}

impl<X: Real> Ten<X> {
    /// The body moved by `d`.
    #[must_use]
    pub fn translated(&self, d: [X; 3]) -> Self {
        Self {
            center: std::array::from_fn(|k| self.center[k] + d[k]),
            ..*self
        }
    }

    /// The body turned about the origin: `C → R C`, `I → R I Rᵀ`, with R by rows.
    #[must_use]
    pub fn rotated(&self, R: &[[X; 3]; 3]) -> Self {
        let dot = |a: [X; 3], b: [X; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let tensor: [[X; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| self.inertia[place(i, j)]));
        let half: [[X; 3]; 3] = R.map(|row| tensor.map(|column| dot(row, column)));
        Self {
            mass: self.mass,
            center: R.map(|row| dot(row, self.center)),
            inertia: ELEMENTS.map(|(i, j)| dot(half[i], R[j])),
        }
    }

    /// The same shape `length` times as large and `mass` times as heavy.
    #[must_use]
    pub fn scaled(&self, length: X, mass: X) -> Self {
        let factor = mass * length * length;
        Self {
            mass: self.mass * mass,
            center: self.center.map(|c| c * length),
            inertia: self.inertia.map(|i| i * factor),
        }
    }

    /// Bodies put together, each with a sign: `I = Σ ± (I_k + m_k (d_k² 1 − d_k d_kᵀ))`, `d_k = C_k − C`.
    #[must_use]
    pub fn together<'a>(parts: impl Iterator<Item = (f64, &'a Self)> + Clone) -> Self {
        let (mut mass, mut first) = (X::zero(), [X::zero(); 3]);
        // About the first one, so that bodies far from the origin lose nothing.
        let reference =
            (parts.clone().next()).map_or([0.0; 3], |(_, part)| part.center.map(X::rounded));
        let from = |center: &[X; 3]| -> [X; 3] {
            std::array::from_fn(|k| center[k] - X::from(reference[k]))
        };
        for (sign, part) in parts.clone() {
            let m = part.mass * X::from(sign);
            mass += m;
            let d = from(&part.center);
            for k in 0..3 {
                first[k] += m * d[k];
            }
        }
        let mean = first.map(|sum| sum / mass);
        let mut inertia = [X::zero(); 6];
        for (sign, part) in parts {
            let sign = X::from(sign);
            let d = from(&part.center);
            let arm = lever(std::array::from_fn(|k| d[k] - mean[k]));
            for k in 0..6 {
                inertia[k] += sign * (part.inertia[k] + part.mass * arm[k]);
            }
        }
        Self {
            mass,
            center: std::array::from_fn(|k| mean[k] + X::from(reference[k])),
            inertia,
        }
    }

    /// The tensor about a point of the body frame.
    #[must_use]
    pub fn about(&self, point: [X; 3]) -> [X; 6] {
        let arm = lever(std::array::from_fn(|k| self.center[k] - point[k]));
        std::array::from_fn(|k| self.inertia[k] + self.mass * arm[k])
    }
}
