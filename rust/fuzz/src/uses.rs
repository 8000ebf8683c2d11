//! What is made of bodies, and what is asked of them.

use arbitrary::Result;
use nalgebra::Vector3;
use polhode::error::BodyFault;
use polhode::mass::equimomental::{equimomental_particles, stick};
use polhode::mass::forms::SpatialOrder;
use polhode::mass::realizable::{nearest_valid, within_box};
use polhode::{Error as Fault, RigidBody};

use crate::draw::Draw;
use crate::laws::{is_body, size};

/// What is made of bodies is bodies, and what is asked of them is answered.
///
/// # Errors
/// When the bytes are used up.
///
/// # Panics
/// When a law is broken.
pub fn used(body: &RigidBody, draw: &mut Draw<'_>, admitted: f64) -> Result<()> {
    assert!(
        body.is_close(body, 0.0, 0.0),
        "not close to itself: {body:?}"
    );
    let (point, direction) = (draw.vector()?, draw.vector()?);
    let is_a_point = point.iter().all(|x| x.is_finite());
    if let (true, Ok(moment)) = (is_a_point, body.moment_about(&direction, &point)) {
        assert!(
            moment >= 0.0,
            "moment about {direction:?} through {point:?} {moment:?}: {body:?}"
        );
    }
    let is_plain = |x: f64| (1e-60..1e60).contains(&x);
    let is_near = is_a_point && point.amax() < 1e60 && body.center_of_mass().amax() < 1e60;
    let about = body.principal_about(&point);
    if is_plain(body.mass()) && is_plain(size(&body.inertia())) && is_near {
        assert!(about.moments.iter().all(|x| *x >= 0.0), "{about:?}");
    }
    for made in [
        body.translated(&point),
        body.rotated(&draw.rotation()?),
        body.scaled(draw.positive()?, draw.positive()?),
        body.combined(body),
        body.without(&body.scaled(0.5, 0.5).unwrap_or(*body)),
    ]
    .into_iter()
    .flatten()
    {
        is_body(&made, 2.0 * admitted);
    }
    forms(body, admitted);
    if let Ok(particles) = equimomental_particles(body) {
        assert!(particles.masses.iter().all(|&mass| mass > 0.0));
        assert!(particles.positions.iter().flatten().all(|x| x.is_finite()));
        if admitted == 0.0 && is_plain(size(&body.inertia())) && is_plain(body.mass()) {
            let mass: f64 = particles.masses.iter().sum();
            assert!((mass - body.mass()).abs() <= 1e-14 * body.mass());
        }
    }
    if let Ok(particles) = stick(
        draw.positive()?,
        draw.positive()?,
        draw.number()?,
        draw.number()?,
    ) {
        assert!(particles.masses.iter().all(|mass| mass.is_finite()));
    }
    if let Ok((nearest, distance)) = nearest_valid(&draw.symmetric()?) {
        assert!(distance >= 0.0 || distance.is_nan());
        let is_valid = RigidBody::new(1.0, &nearest, &Vector3::zeros(), 0.0).is_ok();
        assert!(
            is_valid || !(is_plain(size(&nearest)) || size(&nearest) == 0.0),
            "{nearest:?}"
        );
    }
    let _ = within_box(body, &draw.vector()?, &draw.vector()?);
    Ok(())
}

/// Forms of other libraries say the same.
fn forms(body: &RigidBody, admitted: f64) {
    let size_of_body = size(&body.inertia()) / body.mass();
    let is_plain = (1e-60..1e60).contains(&size_of_body)
        && (1e-60..1e60).contains(&body.mass())
        && body.center_of_mass().norm_squared() < 1e4 * size_of_body
        && admitted == 0.0
        && body.error_bound().inertia <= 1e-12 * size(&body.inertia());
    if !is_plain {
        return;
    }
    let reach = size_of_body + body.center_of_mass().norm_squared();
    let agrees = |again: core::result::Result<RigidBody, Fault>, what: &str| match again {
        Ok(again) => {
            is_body(&again, 1e-12);
            let off = size(&(again.inertia() - body.inertia()));
            assert!(off <= 1e-13 * reach * body.mass(), "{what}: off by {off:e}");
        }
        // What rounding makes of a body on the edge of the possible is told.
        Err(Fault::Body(BodyFault::TriangleInequality { relative, .. })) => {
            assert!(relative < 1e-10, "{what}")
        }
        Err(error) => assert!(
            matches!(
                error,
                Fault::Body(
                    BodyFault::NegativeMoment { .. } | BodyFault::NotASpatialInertia { .. }
                )
            ),
            "{what}: {error}"
        ),
    };
    agrees(
        RigidBody::from_parameters(&body.parameters(), 1e-12),
        "parameters",
    );
    agrees(
        RigidBody::from_pseudo_inertia(&body.pseudo_inertia(), 1e-12),
        "pseudo-inertia",
    );
    let order = SpatialOrder::AngularLinear;
    let spatial = body.spatial_inertia(order);
    agrees(
        RigidBody::from_spatial_inertia(&spatial, order, 1e-12),
        "spatial inertia",
    );
    if let Ok(parameters) = body.log_cholesky() {
        assert!(parameters.iter().all(|x| x.is_finite()), "{parameters:?}");
        if let Ok(again) = RigidBody::from_log_cholesky(&parameters) {
            is_body(&again, 0.0);
        }
    }
}
