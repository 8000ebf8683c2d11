//! Values that stand in the last axes of an array: their shapes and their numbers.

use nalgebra::{Matrix3, Matrix4, Matrix6, Matrix6x3, Vector3, Vector6};

/// A value that stands in the last axes of an array.
pub(crate) trait Item: Sized {
    /// Those axes.
    const TAIL: &'static [usize];
    /// From its numbers in C order.
    fn read(numbers: &[f64]) -> Self;
    /// Its numbers in C order.
    fn write(&self, out: &mut Vec<f64>);
}

impl Item for f64 {
    const TAIL: &'static [usize] = &[];

    fn read(numbers: &[f64]) -> Self {
        numbers[0]
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.push(*self);
    }
}

macro_rules! fixed_length {
    ($($n:literal)*) => {$(
        impl Item for [f64; $n] {
            const TAIL: &'static [usize] = &[$n];

            fn read(numbers: &[f64]) -> Self {
                std::array::from_fn(|i| numbers[i])
            }

            fn write(&self, out: &mut Vec<f64>) {
                out.extend_from_slice(self);
            }
        }
    )*};
}
fixed_length!(2 3 4 10 33 34);

/// The corners of a triangle in the plane.
impl Item for [[f64; 2]; 3] {
    const TAIL: &'static [usize] = &[3, 2];

    fn read(numbers: &[f64]) -> Self {
        std::array::from_fn(|i| [numbers[2 * i], numbers[2 * i + 1]])
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend(self.as_flattened());
    }
}

impl Item for Vector3<f64> {
    const TAIL: &'static [usize] = &[3];

    fn read(numbers: &[f64]) -> Self {
        Self::new(numbers[0], numbers[1], numbers[2])
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(self.as_slice());
    }
}

macro_rules! square_matrix {
    ($($matrix:ident $n:literal)*) => {$(
        impl Item for $matrix<f64> {
            const TAIL: &'static [usize] = &[$n, $n];

            fn read(numbers: &[f64]) -> Self {
                Self::from_row_slice(numbers)
            }

            fn write(&self, out: &mut Vec<f64>) {
                out.extend_from_slice(self.transpose().as_slice()); // nalgebra stores columns
            }
        }
    )*};
}
square_matrix!(Matrix3 3 Matrix4 4 Matrix6 6);

impl Item for Matrix6x3<f64> {
    const TAIL: &'static [usize] = &[6, 3];

    fn read(numbers: &[f64]) -> Self {
        Self::from_row_slice(numbers)
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(self.transpose().as_slice()); // nalgebra stores columns
    }
}

impl Item for Vector6<f64> {
    const TAIL: &'static [usize] = &[6];

    fn read(numbers: &[f64]) -> Self {
        Self::from_row_slice(numbers)
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(self.as_slice());
    }
}

/// How many numbers an item has.
pub(crate) fn size<T: Item>() -> usize {
    T::TAIL.iter().product()
}
