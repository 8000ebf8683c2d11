//! From a value to its stored form and back: names for what is one of a few, plain numbers for what has parts.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::error::{Error, all_finite};
use crate::motion::attitude::from_components;

/// Stores a type as another one, which derives `serde`: `From<&Type>` there, `TryFrom<Form>` back.
macro_rules! stored {
    ($($type:ty as $form:ty),+ $(,)?) => {$(
        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                <$form>::from(self).serialize(to)
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                let form = <$form as serde::Deserialize>::deserialize(from)?;
                form.try_into().map_err(serde::de::Error::custom)
            }
        }
    )+};
}

/// Stores each value of a type by its name.
macro_rules! named {
    ($($type:ty { $($value:path => $name:literal),+ $(,)? })+) => {$(
        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                to.serialize_str(match self { $($value => $name),+ })
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                let name = std::borrow::Cow::<'de, str>::deserialize(from)?;
                match &*name {
                    $($name => Ok($value),)+
                    other => Err(serde::de::Error::unknown_variant(other, &[$($name),+])),
                }
            }
        }
    )+};
}

pub(super) use {named, stored};

/// A matrix by its rows.
pub(super) type Rows = [[f64; 3]; 3];

pub(super) fn rows(matrix: &Matrix3<f64>) -> Rows {
    matrix.transpose().data.0
}

pub(super) fn matrix(rows: &Rows) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

pub(super) fn vector(what: &'static str, numbers: [f64; 3]) -> Result<Vector3<f64>, Error> {
    all_finite(what, &numbers).map(|()| numbers.into())
}

/// The attitude of these components: as they are where their length is one but for rounding.
pub(super) fn attitude(components: [f64; 4]) -> Result<UnitQuaternion<f64>, Error> {
    let unit = from_components("attitude", &components)?;
    let [x, y, z, w] = components;
    let given = Quaternion::new(w, x, y, z);
    Ok(if (unit.coords - given.coords).amax() <= f64::EPSILON {
        UnitQuaternion::new_unchecked(given)
    } else {
        unit
    })
}
