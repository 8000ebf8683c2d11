//! Numbers, vectors and rotations drawn from bytes.

use arbitrary::{Result, Unstructured};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_4;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// What float64 has at its ends, and where squares and cubes leave it.
const EXTREMES: [f64; 24] = [
    0.0,
    -0.0,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    f64::MAX,
    -f64::MAX,
    f64::MIN_POSITIVE,
    5e-324,
    -5e-324,
    1e-310,
    f64::EPSILON,
    1.0 - f64::EPSILON,
    1.0 + f64::EPSILON,
    1.3e154,
    1.4e154,
    1e-154,
    1e-160,
    1e100,
    -1e100,
    1e-100,
    1e300,
    1e-300,
    1e16,
];

/// A source of input. A tame one draws finite numbers of ordinary sizes alone, so that it gets past the first checks.
#[derive(Debug)]
pub struct Draw<'a> {
    bytes: Unstructured<'a>,
    wild: bool,
}

impl<'a> Draw<'a> {
    /// The first byte tells whether it is wild: one in four is.
    ///
    /// # Errors
    /// When there are no bytes.
    pub fn new(bytes: &'a [u8]) -> Result<Self> {
        let mut bytes = Unstructured::new(bytes);
        let wild = bytes.arbitrary::<u8>()?.is_multiple_of(4);
        Ok(Self { bytes, wild })
    }

    /// Whether numbers may be anything.
    #[must_use]
    pub fn is_wild(&self) -> bool {
        self.wild
    }

    /// A number from 0 to `last`.
    ///
    /// # Errors
    /// When the bytes are used up, as all that follow.
    pub fn up_to(&mut self, last: usize) -> Result<usize> {
        self.spent()?;
        self.bytes.int_in_range(0..=last)
    }

    /// Either.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn coin(&mut self) -> Result<bool> {
        self.spent()?;
        self.bytes.arbitrary()
    }

    /// One of them.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn one_of<T: Copy>(&mut self, of: &[T]) -> Result<T> {
        self.spent()?;
        self.bytes.choose(of).copied()
    }

    /// All bytes that are left.
    #[must_use]
    pub fn rest(self) -> &'a [u8] {
        self.bytes.take_rest()
    }

    /// The next bytes, as many as there are of `count`.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn bytes(&mut self, count: usize) -> Result<&'a [u8]> {
        let count = count.min(self.bytes.len());
        self.bytes.bytes(count)
    }

    /// An input without bytes would be drawn as zeros without end.
    fn spent(&self) -> Result<()> {
        if self.bytes.is_empty() {
            return Err(arbitrary::Error::NotEnoughData);
        }
        Ok(())
    }

    /// A number.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn number(&mut self) -> Result<f64> {
        let kind = self.up_to(15)?;
        let u = &mut self.bytes;
        Ok(match kind {
            0..=2 => f64::from(u.int_in_range(-4_i8..=4)?),
            3..=6 => f64::from(u.arbitrary::<i16>()?) / 8192.0,
            7 => {
                let exponent: i8 = u.int_in_range(-9..=9)?;
                f64::from(u.arbitrary::<i16>()?) * 10.0_f64.powi(exponent.into())
            }
            8 => {
                let exponent: i16 = u.int_in_range(-30..=30)?;
                2.0_f64.powi(exponent.into())
            }
            9 => FRAC_PI_4 * f64::from(u.int_in_range(-9_i8..=9)?),
            10..=13 => (1.0 + f64::from(u.arbitrary::<u16>()?)) / 65536.0,
            14 if self.wild => *u.choose(&EXTREMES)?,
            _ if self.wild => f64::from_bits(u.arbitrary()?),
            _ => f64::from(u.arbitrary::<i32>()?) / 1e9,
        })
    }

    /// A number, mostly above zero.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn positive(&mut self) -> Result<f64> {
        let number = self.number()?;
        Ok(if self.wild { number } else { number.abs() })
    }

    /// A power of two from 2⁻⁶⁰ to 1.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn tiny(&mut self) -> Result<f64> {
        let exponent = i32::try_from(self.up_to(60)?).unwrap_or_default();
        Ok(2.0_f64.powi(-exponent))
    }

    /// Numbers.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn numbers<const N: usize>(&mut self) -> Result<[f64; N]> {
        let mut all = [0.0; N];
        for number in &mut all {
            *number = self.number()?;
        }
        Ok(all)
    }

    /// A vector; one in four has components that are zero.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn vector(&mut self) -> Result<Vector3<f64>> {
        Ok(match self.up_to(15)? {
            0 => Vector3::zeros(),
            1 => Vector3::x() * self.number()?,
            2 => Vector3::y() * self.number()?,
            3 => Vector3::z() * self.number()?,
            _ => self.numbers::<3>()?.into(),
        })
    }

    /// Some of a thing, at most `most`.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn list<T>(
        &mut self,
        most: usize,
        mut one: impl FnMut(&mut Self) -> Result<T>,
    ) -> Result<Vec<T>> {
        let count = self.up_to(most)?;
        (0..count).map(|_| one(self)).collect()
    }

    /// A rotation: mostly of unit length to rounding.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn attitude(&mut self) -> Result<UnitQuaternion<f64>> {
        let [x, y, z, w] = match self.up_to(7)? {
            0 => [0.0, 0.0, 0.0, 1.0],
            1 => [1.0, 0.0, 0.0, 0.0],
            _ => self.numbers()?,
        };
        let q = Quaternion::new(w, x, y, z);
        let norm = q.norm();
        Ok(if norm > 1e-100 && norm < 1e100 {
            UnitQuaternion::new_normalize(q)
        } else {
            UnitQuaternion::identity()
        })
    }

    /// A rotation matrix; of a wild source sometimes none.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn rotation(&mut self) -> Result<Matrix3<f64>> {
        if self.wild && self.up_to(3)? == 0 {
            return Ok(Matrix3::from_row_slice(&self.numbers::<9>()?));
        }
        Ok(self.attitude()?.to_rotation_matrix().into_inner())
    }

    /// A symmetric matrix.
    ///
    /// # Errors
    /// When the bytes are used up.
    pub fn symmetric(&mut self) -> Result<Matrix3<f64>> {
        let [xx, yy, zz, xy, xz, yz] = match self.up_to(3)? {
            0 => {
                let [xx, yy, zz] = self.numbers()?;
                [xx, yy, zz, 0.0, 0.0, 0.0]
            }
            _ => self.numbers()?,
        };
        Ok(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
    }
}

/// How long anything goes on: an input that takes ten seconds counts as one that hangs, also on a busy machine.
const LONGEST: Duration = Duration::from_secs(2);

/// A watch that stops what goes on after so many looks, or after two seconds.
pub fn patience(mut looks: u32) -> impl FnMut(f64) -> ControlFlow<()> {
    let start = Instant::now();
    move |_| {
        looks = looks.saturating_sub(1);
        if looks == 0 || start.elapsed() > LONGEST {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}
