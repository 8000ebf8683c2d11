//! Macros for stored forms: structs of plain numbers, which stand beside the types that are stored as them.

use nalgebra::{Matrix3, Vector3};

use crate::error::{Error, all_finite};

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

/// The form of a type: its fields, how each is read from a value, and the value that they make.
macro_rules! form {
    ($($form:ident of $load:ident as $it:ident { $($field:ident: $type:ty = $value:expr),+ $(,)? } => $made:expr;)+) => {
        crate::numerics::stored_form::stored!($($load as $form),+);
        $(
            #[derive(serde::Serialize, serde::Deserialize)]
            #[serde(deny_unknown_fields)]
            struct $form { $($field: $type),+ }

            impl From<&$load> for $form {
                fn from($it: &$load) -> Self {
                    Self { $($field: $value),+ }
                }
            }

            impl TryFrom<$form> for $load {
                type Error = crate::error::Error;

                fn try_from($it: $form) -> Result<Self, crate::error::Error> {
                    $made
                }
            }
        )+
    };
}

pub(crate) use {form, stored};

/// A matrix by its rows.
pub(crate) type Rows = [[f64; 3]; 3];

pub(crate) fn rows(matrix: &Matrix3<f64>) -> Rows {
    matrix.transpose().data.0
}

pub(crate) fn matrix(rows: &Rows) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

pub(crate) fn vector(what: &'static str, numbers: [f64; 3]) -> Result<Vector3<f64>, Error> {
    all_finite(what, &numbers).map(|()| numbers.into())
}
