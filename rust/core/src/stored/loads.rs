//! Loads that are plain numbers, each by what its constructor takes.

use serde::{Deserialize, Serialize};

use super::form::{Rows, matrix, rows, stored, vector};
use crate::error::Error;
use crate::motion::kinematics::Frame;
use crate::motion::loads::{
    ConstantForce, ConstantTorque, Damping, Rotor, Slug, UniformGravity, Windows,
};

/// The form of a load: its fields, how each is read from the load, and the load that they make.
macro_rules! form {
    ($($form:ident of $load:ident as $it:ident { $($field:ident: $type:ty = $value:expr),+ $(,)? } => $made:expr;)+) => {
        stored!($($load as $form),+);
        $(
            #[derive(Serialize, Deserialize)]
            #[serde(deny_unknown_fields)]
            struct $form { $($field: $type),+ }

            impl From<&$load> for $form {
                fn from($it: &$load) -> Self {
                    Self { $($field: $value),+ }
                }
            }

            impl TryFrom<$form> for $load {
                type Error = Error;

                fn try_from($it: $form) -> Result<Self, Error> {
                    $made
                }
            }
        )+
    };
}

form! {
    Torque of ConstantTorque as it { vector: [f64; 3] = it.vector.into(), frame: Frame = it.frame }
        => Self::new(&it.vector.into(), it.frame);
    Force of ConstantForce as it {
        vector: [f64; 3] = it.vector.into(),
        frame: Frame = it.frame,
        point: Option<[f64; 3]> = it.point.map(Into::into),
    } => {
        let point = it.point.map(|point| vector("point", point)).transpose()?;
        Self::new(&it.vector.into(), it.frame, point.as_ref())
    };
    Gravity of UniformGravity as it { gravity: [f64; 3] = it.gravity.into() }
        => Self::new(&it.gravity.into());
    Damper of Damping as it { linear: Rows = rows(&it.linear), quadratic: Rows = rows(&it.quadratic) }
        => Self::new(&matrix(&it.linear), &matrix(&it.quadratic));
    Momentum of Rotor as it { momentum: [f64; 3] = it.momentum.into() }
        => Self::new(&it.momentum.into());
    Sphere of Slug as it { inertia: f64 = it.inertia, damping: f64 = it.damping }
        => Self::new(it.inertia, it.damping);
    Times of Windows as it { windows: Vec<(f64, Option<f64>)> = ends(it) } => {
        let end = |&(on, off): &(f64, Option<f64>)| (on, off.unwrap_or(f64::INFINITY));
        Self::new(&it.windows.iter().map(end).collect::<Vec<_>>())
    };
}

/// Windows of which the last may have no end.
fn ends(windows: &Windows) -> Vec<(f64, Option<f64>)> {
    let end = |&(on, off): &(f64, f64)| (on, off.is_finite().then_some(off));
    windows.as_slice().iter().map(end).collect()
}
