//! Names as stored forms of values that are one of a few; four numbers as that of an attitude.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::error::Error;
use crate::motion::attitude::from_components;

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

pub(super) use named;

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
