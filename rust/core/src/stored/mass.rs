//! Bodies, and what is cached of them.

use serde::{Deserialize, Serialize};

use super::names::named;
use crate::error::{BodyFault, Error, all_finite, finite};
use crate::io::TriangleMesh;
use crate::mass::provenance::{BodySource, Checks, Closure, MomentsFrom, Provenance};
use crate::mass::validity::{check_rotation, check_symmetry};
use crate::mass::{Amount, ErrorBound, RigidBody};
use crate::numerics::stored_form::{Rows, matrix, rows, stored, vector};
use crate::principal::PrincipalAxes;

stored!(
    RigidBody as Body,
    PrincipalAxes as StoredAxes,
    ErrorBound as Bound,
    Amount as StoredAmount,
    TriangleMesh as Triangles,
);

/// A body; one that is typed by hand may have the first three alone.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Body {
    mass: f64,
    center_of_mass: [f64; 3],
    inertia: Rows,
    #[serde(default, skip_serializing_if = "is_zero")]
    rtol: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cached: Option<BodyCache>,
}

/// What a body knows besides its mass, centre and tensor.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyCache {
    principal: PrincipalAxes,
    error_bound: ErrorBound,
    provenance: Provenance,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks it")]
fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

/// Its own moments and axes as those of a body that is given by them: an admitted table breaks a law by up to `rtol`.
fn admit(body: &RigidBody, rtol: f64) -> Result<RigidBody, Error> {
    let PrincipalAxes { moments, axes } = body.principal();
    RigidBody::from_principal(body.mass(), &moments, &axes, &body.center_of_mass(), rtol)
}

/// True if the triangle inequality was not checked, or holds within the error bound.
fn is_summed(provenance: &Provenance) -> bool {
    let sums = [MomentsFrom::SecondMoment, MomentsFrom::OwnAxes];
    sums.contains(&provenance.moments) || provenance.checks.contains(Checks::UNCHECKED)
}

impl From<&RigidBody> for Body {
    fn from(body: &RigidBody) -> Self {
        let rtol = match admit(body, 0.0) {
            Err(Error::Body(BodyFault::TriangleInequality { relative, .. }))
                if !is_summed(&body.provenance()) =>
            {
                relative * (1.0 + 4.0 * f64::EPSILON)
            }
            _ => 0.0,
        };
        Self {
            mass: body.mass(),
            center_of_mass: body.center_of_mass().into(),
            inertia: rows(&body.inertia()),
            rtol,
            cached: Some(BodyCache {
                principal: body.principal(),
                error_bound: body.error_bound(),
                provenance: body.provenance(),
            }),
        }
    }
}

impl TryFrom<Body> for RigidBody {
    type Error = Error;

    fn try_from(stored: Body) -> Result<Self, Error> {
        let center = vector("center_of_mass", stored.center_of_mass)?;
        let inertia = matrix(&stored.inertia);
        let Some(cached) = stored.cached else {
            return Self::new(stored.mass, &inertia, &center, stored.rtol);
        };
        all_finite("inertia", &inertia)?;
        check_symmetry("inertia", &inertia, 0.0)?;
        let mut numbers = [0.0; 34];
        numbers[0] = stored.mass;
        numbers[1..4].copy_from_slice(center.as_slice());
        let i = &inertia;
        numbers[4..10].copy_from_slice(&[i.m11, i.m12, i.m13, i.m22, i.m23, i.m33]);
        numbers[10..13].copy_from_slice(&cached.principal.moments);
        numbers[13..22].copy_from_slice(cached.principal.axes.transpose().as_slice());
        let bound = &cached.error_bound;
        numbers[22..25].copy_from_slice(&[bound.mass, bound.center_of_mass, bound.inertia]);
        numbers[25..].copy_from_slice(&cached.provenance.to_array());
        let body = Self::from_array(&numbers)?;
        if !is_summed(&cached.provenance) {
            admit(&body, stored.rtol)?;
        }
        Ok(body)
    }
}

/// Rows, of which the columns are the axes.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredAxes {
    moments: [f64; 3],
    axes: Rows,
}

impl From<&PrincipalAxes> for StoredAxes {
    fn from(principal: &PrincipalAxes) -> Self {
        Self {
            moments: principal.moments,
            axes: rows(&principal.axes),
        }
    }
}

impl TryFrom<StoredAxes> for PrincipalAxes {
    type Error = Error;

    fn try_from(StoredAxes { moments, axes }: StoredAxes) -> Result<Self, Error> {
        all_finite("moments", &moments)?;
        for pair in moments.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            if a > b {
                let (smaller, larger) = ("a moment", "the next one");
                return Err(Error::OutOfOrder {
                    smaller,
                    larger,
                    a,
                    b,
                });
            }
        }
        let axes = matrix(&axes);
        check_rotation("axes", &axes)?;
        Ok(Self { moments, axes })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Bound {
    mass: f64,
    center_of_mass: f64,
    inertia: f64,
}

impl From<&ErrorBound> for Bound {
    fn from(bound: &ErrorBound) -> Self {
        Self {
            mass: bound.mass,
            center_of_mass: bound.center_of_mass,
            inertia: bound.inertia,
        }
    }
}

impl TryFrom<Bound> for ErrorBound {
    type Error = Error;

    fn try_from(bound: Bound) -> Result<Self, Error> {
        for (what, value) in [
            ("error_bound.mass", bound.mass),
            ("error_bound.center_of_mass", bound.center_of_mass),
            ("error_bound.inertia", bound.inertia),
        ] {
            if value.is_nan() || value < 0.0 {
                let law = "zero or more";
                return Err(Error::OutOfDomain { what, law, value });
            }
        }
        Ok(Self {
            mass: bound.mass,
            center_of_mass: bound.center_of_mass,
            inertia: bound.inertia,
        })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum StoredAmount {
    Mass(f64),
    Density(f64),
}

impl From<&Amount> for StoredAmount {
    fn from(amount: &Amount) -> Self {
        match *amount {
            Amount::Mass(mass) => Self::Mass(mass),
            Amount::Density(density) => Self::Density(density),
        }
    }
}

impl TryFrom<StoredAmount> for Amount {
    type Error = Error;

    fn try_from(matter: StoredAmount) -> Result<Self, Error> {
        let amount = match matter {
            StoredAmount::Mass(mass) => Self::Mass(mass),
            StoredAmount::Density(density) => Self::Density(density),
        };
        amount.check().map(|_| amount)
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Triangles {
    vertices: Vec<[f64; 3]>,
    faces: Vec<[usize; 3]>,
}

impl From<&TriangleMesh> for Triangles {
    fn from(mesh: &TriangleMesh) -> Self {
        Self {
            vertices: mesh.vertices.clone(),
            faces: mesh.faces.clone(),
        }
    }
}

impl From<Triangles> for TriangleMesh {
    fn from(Triangles { vertices, faces }: Triangles) -> Self {
        Self { vertices, faces }
    }
}

// Where the numbers of a body come from, in words.

named! {
    BodySource {
        BodySource::Tensor => "tensor",
        BodySource::PrincipalMoments => "principal moments",
        BodySource::SecondMoment => "second moment",
        BodySource::Particles => "particles",
        BodySource::Mesh => "mesh",
        BodySource::Surface => "surface",
        BodySource::Curve => "curve",
        BodySource::Tetrahedra => "tetrahedra",
        BodySource::Voxels => "voxels",
        BodySource::Density => "density",
        BodySource::Solid => "solid",
        BodySource::Lamina => "lamina",
        BodySource::Rod => "rod",
        BodySource::Bodies => "bodies",
        BodySource::Balls => "balls",
        BodySource::CommonIsotopes => "atoms, most common isotopes",
        BodySource::AverageAtoms => "atoms, average masses",
        BodySource::OwnAtoms => "atoms, masses of their own",
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
                Self::from_name(name).ok_or_else(|| format!("no check has the name {name:?}"))?;
            Ok(checks.and(more))
        })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredProvenance {
    source: BodySource,
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
