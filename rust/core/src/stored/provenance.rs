//! Where the numbers of a body come from, in words.

use serde::{Deserialize, Serialize};

use super::form::named;
use crate::error::{Error, finite};
use crate::mass::provenance::{Checks, Closure, MomentsFrom, Provenance, Source};
use crate::numerics::stored_form::stored;

named! {
    Source {
        Source::Tensor => "tensor",
        Source::PrincipalMoments => "principal moments",
        Source::SecondMoment => "second moment",
        Source::Particles => "particles",
        Source::Mesh => "mesh",
        Source::Surface => "surface",
        Source::Curve => "curve",
        Source::Tetrahedra => "tetrahedra",
        Source::Voxels => "voxels",
        Source::Density => "density",
        Source::Solid => "solid",
        Source::Lamina => "lamina",
        Source::Rod => "rod",
        Source::Bodies => "bodies",
        Source::CommonIsotopes => "atoms, most common isotopes",
        Source::AverageAtoms => "atoms, average masses",
        Source::OwnAtoms => "atoms, masses of their own",
    }
    MomentsFrom {
        MomentsFrom::Given => "given",
        MomentsFrom::Tensor => "tensor",
        MomentsFrom::SecondMoment => "second moment",
        MomentsFrom::OwnAxes => "second moment in own axes",
    }
    Closure {
        Closure::Caps => "caps",
        Closure::Hull => "hull",
    }
}

stored!(Checks as Vec<String>, Provenance as StoredProvenance);

impl From<&Checks> for Vec<String> {
    fn from(checks: &Checks) -> Self {
        checks.names().map(str::to_owned).collect()
    }
}

impl TryFrom<Vec<String>> for Checks {
    type Error = String;

    fn try_from(names: Vec<String>) -> Result<Self, String> {
        names.iter().try_fold(Self::default(), |checks, name| {
            let more =
                Self::named(name).ok_or_else(|| format!("no check has the name {name:?}"))?;
            Ok(checks.and(more))
        })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredProvenance {
    source: Source,
    elements: usize,
    checks: Checks,
    welded: usize,
    closure: Option<Closure>,
    volume_change: f64,
    moments: MomentsFrom,
    rounded_to_zero: u8,
    rounding: f64,
}

impl From<&Provenance> for StoredProvenance {
    fn from(from: &Provenance) -> Self {
        Self {
            source: from.source,
            elements: from.elements,
            checks: from.checks,
            welded: from.welded,
            closure: from.closure,
            volume_change: from.volume_change,
            moments: from.moments,
            rounded_to_zero: from.rounded_to_zero,
            rounding: from.rounding,
        }
    }
}

impl TryFrom<StoredProvenance> for Provenance {
    type Error = Error;

    fn try_from(parts: StoredProvenance) -> Result<Self, Error> {
        let what = "provenance.rounding";
        if finite(what, parts.rounding)? < 0.0 {
            let (law, value) = ("zero or more", parts.rounding);
            return Err(Error::OutOfDomain { what, law, value });
        }
        Ok(Self {
            source: parts.source,
            elements: parts.elements,
            checks: parts.checks,
            welded: parts.welded,
            closure: parts.closure,
            volume_change: finite("provenance.volume_change", parts.volume_change)?,
            moments: parts.moments,
            rounded_to_zero: parts.rounded_to_zero,
            rounding: parts.rounding,
        })
    }
}
