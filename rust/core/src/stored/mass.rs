//! Bodies, and what is told of them.

use serde::{Deserialize, Serialize};

use crate::error::{BodyFault, Error, all_finite};
use crate::io::TriangleMesh;
use crate::mass::provenance::{Checks, MomentsFrom, Provenance};
use crate::mass::validity::{check_rotation, check_symmetry};
use crate::mass::{Amount, ErrorBound, RigidBody};
use crate::numerics::stored_form::{Rows, matrix, rows, stored, vector};
use crate::principal::PrincipalAxes;

stored!(
    RigidBody as Body,
    PrincipalAxes as Axes,
    ErrorBound as Bound,
    Amount as Matter,
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
    told: Option<Told>,
}

/// What a body knows besides its mass, centre and tensor.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Told {
    principal: PrincipalAxes,
    error_bound: ErrorBound,
    provenance: Provenance,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks it")]
fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

/// Its own moments and axes as those of a body that is given by them: an admitted table breaks a law by up to `rtol`.
fn admitted(body: &RigidBody, rtol: f64) -> Result<RigidBody, Error> {
    let PrincipalAxes { moments, axes } = body.principal();
    RigidBody::from_principal(body.mass(), &moments, &axes, &body.center_of_mass(), rtol)
}

/// Whether its law was not asked for, or held but for the rounding that its bound tells.
fn is_summed(provenance: &Provenance) -> bool {
    let sums = [MomentsFrom::SecondMoment, MomentsFrom::OwnAxes];
    sums.contains(&provenance.moments) || provenance.checks.contains(Checks::UNCHECKED)
}

impl From<&RigidBody> for Body {
    fn from(body: &RigidBody) -> Self {
        let rtol = match admitted(body, 0.0) {
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
            told: Some(Told {
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
        let Some(told) = stored.told else {
            return Self::new(stored.mass, &inertia, &center, stored.rtol);
        };
        all_finite("inertia", &inertia)?;
        check_symmetry("inertia", &inertia, 0.0)?;
        let mut numbers = [0.0; 34];
        numbers[0] = stored.mass;
        numbers[1..4].copy_from_slice(center.as_slice());
        let i = &inertia;
        numbers[4..10].copy_from_slice(&[i.m11, i.m12, i.m13, i.m22, i.m23, i.m33]);
        numbers[10..13].copy_from_slice(&told.principal.moments);
        numbers[13..22].copy_from_slice(told.principal.axes.transpose().as_slice());
        let bound = &told.error_bound;
        numbers[22..25].copy_from_slice(&[bound.mass, bound.center_of_mass, bound.inertia]);
        numbers[25..].copy_from_slice(&told.provenance.to_array());
        let body = Self::from_array(&numbers)?;
        if !is_summed(&told.provenance) {
            admitted(&body, stored.rtol)?;
        }
        Ok(body)
    }
}

/// Rows, of which the columns are the axes.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Axes {
    moments: [f64; 3],
    axes: Rows,
}

impl From<&PrincipalAxes> for Axes {
    fn from(principal: &PrincipalAxes) -> Self {
        Self {
            moments: principal.moments,
            axes: rows(&principal.axes),
        }
    }
}

impl TryFrom<Axes> for PrincipalAxes {
    type Error = Error;

    fn try_from(Axes { moments, axes }: Axes) -> Result<Self, Error> {
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
enum Matter {
    Mass(f64),
    Density(f64),
}

impl From<&Amount> for Matter {
    fn from(amount: &Amount) -> Self {
        match *amount {
            Amount::Mass(mass) => Self::Mass(mass),
            Amount::Density(density) => Self::Density(density),
        }
    }
}

impl TryFrom<Matter> for Amount {
    type Error = Error;

    fn try_from(matter: Matter) -> Result<Self, Error> {
        let amount = match matter {
            Matter::Mass(mass) => Self::Mass(mass),
            Matter::Density(density) => Self::Density(density),
        };
        amount.checked().map(|_| amount)
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
