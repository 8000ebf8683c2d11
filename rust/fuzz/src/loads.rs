//! Loads drawn from bytes.

use std::ops::ControlFlow;

use arbitrary::Result;
use nalgebra::{Matrix3, Vector3};
use polhode::Error;
use polhode::motion::loads::kepler::Orbit;
use polhode::motion::loads::{
    AttitudeTarget, Damping, Drive, Feedback, Frame, GravityGradient, Magnetic, MagneticField,
    Oblate, OrbitModel, Panels, PiecewiseSignal, Plates, Rotor, Sampled, Slug, Stream, Term, Wheel,
    Windows,
};

use crate::draw::Draw;

fn frame(draw: &mut Draw<'_>) -> Result<Frame> {
    draw.one_of(&[Frame::Body, Frame::Space])
}

fn matrix(draw: &mut Draw<'_>) -> Result<Matrix3<f64>> {
    Ok(if draw.coin()? {
        Matrix3::identity() * draw.positive()?
    } else {
        let half = Matrix3::from_row_slice(&draw.numbers::<9>()?);
        half * half.transpose()
    })
}

type Made = core::result::Result<Term, Error>;

/// A term of any law, if what was drawn makes one.
///
/// # Errors
/// When the bytes are used up.
pub fn term(draw: &mut Draw<'_>) -> Result<Made> {
    Ok(match draw.up_to(13)? {
        0 => Term::constant_torque(&draw.vector()?, frame(draw)?),
        1 => {
            let point = draw.vector()?;
            let point = if draw.coin()? { Some(&point) } else { None };
            Term::constant_force(&draw.vector()?, frame(draw)?, point)
        }
        2 => Term::uniform_gravity(&draw.vector()?),
        3 => {
            let epoch = if draw.coin()? {
                Some(draw.number()?)
            } else {
                None
            };
            if draw.coin()? {
                GravityGradient::new(draw.positive()?, &draw.vector()?, &draw.vector()?, epoch)
            } else {
                path(draw)?.and_then(|(mu, path)| GravityGradient::along(mu, path))
            }
            .map(Term::GravityGradient)
        }
        4 => Damping::new(&matrix(draw)?, &Matrix3::zeros()).map(Term::Damping),
        5 => Damping::new(&Matrix3::zeros(), &matrix(draw)?).map(Term::Damping),
        6 => {
            let (times, values) = samples(draw)?;
            Sampled::new(&times, &values, frame(draw)?).map(Term::Sampled)
        }
        7 => feedback(draw)?.map(Term::Feedback),
        8 => {
            let windows = draw.list(4, |draw| Ok((draw.number()?, draw.number()?)))?;
            let term = Term::uniform_gravity(&draw.vector()?);
            let inner = if draw.coin()? {
                term
            } else {
                Term::constant_torque(&draw.vector()?, frame(draw)?)
            };
            Windows::new(&windows).and_then(|windows| inner?.schedule(&windows))
        }
        9 => Rotor::new(&draw.vector()?).map(Term::Rotor),
        10 => Slug::new(draw.positive()?, draw.positive()?).map(Term::Slug),
        11 => {
            let (axis, inertia) = (draw.vector()?, draw.positive()?);
            let (rate, friction, drive) = (draw.number()?, draw.positive()?, drive(draw)?);
            let dry = if draw.coin()? { draw.positive()? } else { 0.0 };
            let most = if draw.coin()? { Some(rate.abs() + draw.positive()?) } else { None };
            drive
                .and_then(|drive| Wheel::new(&axis, inertia, rate, friction, drive))
                .and_then(|wheel| wheel.with_dry_friction(dry))
                .and_then(|wheel| match most {
                    Some(most) => wheel.with_max_rate(most)?.with_max_torque(most),
                    None => Ok(wheel),
                })
                .map(Term::Wheel)
        }
        12 => panels(draw)?.map(Term::Panels),
        _ => {
            let (dipole, field) = (draw.vector()?, field(draw)?);
            let gain = if draw.coin()? {
                Some(draw.number()?)
            } else {
                None
            };
            field.and_then(|field| Magnetic::new(&dipole, gain, field).map(Term::Magnetic))
        }
    })
}

/// Plates in light or air, all with the same coefficients.
fn panels(draw: &mut Draw<'_>) -> Result<core::result::Result<Panels, Error>> {
    let go_on = &mut |_: f64| ControlFlow::Continue(());
    let plates = draw.list(6, |draw| Ok((draw.vector()?, draw.positive()?, draw.vector()?)))?;
    let mut all = Plates::default();
    for (center, area, normal) in &plates {
        if let Err(error) = all.add(center, *area, normal) {
            return Ok(Err(error));
        }
    }
    let (is_air, level, share) = (draw.coin()?, draw.positive()?, draw.numbers::<2>()?);
    let surface = if is_air {
        all.dragging(&share[..1])
    } else {
        all.reflecting(&[share])
    };
    let stream = match (draw.coin()?, is_air) {
        (false, false) => Stream::light(&draw.vector()?),
        (false, true) => Stream::air(&draw.vector()?),
        (true, is_air) => {
            let (times, values) = samples(draw)?;
            if is_air {
                Stream::air_sampled(&times, &values, go_on)
            } else {
                Stream::light_sampled(&times, &values, go_on)
            }
        }
    };
    let level = PiecewiseSignal::constant("level", level);
    Ok(surface.and_then(|surface| Panels::new(surface, stream?, level?)))
}

fn feedback(draw: &mut Draw<'_>) -> Result<core::result::Result<Feedback, Error>> {
    let (stiffness, damping) = (matrix(draw)?, matrix(draw)?);
    Ok(aim(draw)?.and_then(|aim| Feedback::toward(&stiffness, &damping, aim)))
}

/// Times, ascending unless some are the same, and a vector for each.
fn samples(draw: &mut Draw<'_>) -> Result<(Vec<f64>, Vec<Vector3<f64>>)> {
    let mut times = draw.list(6, Draw::number)?;
    times.sort_by(f64::total_cmp);
    if draw.coin()? && times.len() >= 2 {
        times.push(100.0);
        times.insert(0, -100.0);
        times.sort_by(f64::total_cmp);
    }
    let values = times
        .iter()
        .map(|_| draw.vector())
        .collect::<Result<Vec<_>>>()?;
    Ok((times, values))
}

fn drive(draw: &mut Draw<'_>) -> Result<core::result::Result<Drive, Error>> {
    Ok(match draw.up_to(3)? {
        0 => PiecewiseSignal::constant("torque", draw.number()?).map(Drive::Torque),
        1 => feedback(draw)?.map(Drive::Feedback),
        2 => Ok(Drive::Controller),
        _ => {
            let (times, values) = samples(draw)?;
            let values: Vec<f64> = values.iter().map(|v| v.x).collect();
            let held = PiecewiseSignal::table("speed", &times, &values);
            if draw.coin()? {
                held.map(Drive::Speed)
            } else {
                held.map(Drive::Torque)
            }
        }
    })
}

fn field(draw: &mut Draw<'_>) -> Result<core::result::Result<MagneticField, Error>> {
    Ok(match draw.up_to(2)? {
        0 => MagneticField::uniform(&draw.vector()?),
        1 => {
            let (times, values) = samples(draw)?;
            MagneticField::sampled(&times, &values)
        }
        _ => {
            let strength = draw.vector()?;
            path(draw)?.and_then(|(_, path)| MagneticField::of_dipole(&strength, path))
        }
    })
}

/// An orbit and its μ.
fn path(draw: &mut Draw<'_>) -> Result<core::result::Result<(f64, OrbitModel), Error>> {
    let mu = draw.positive()?;
    if draw.coin()? {
        let (times, values) = samples(draw)?;
        return Ok(OrbitModel::sampled(&times, &values).map(|path| (mu, path)));
    }
    let orbit = Orbit::new(mu, &draw.vector()?, &draw.vector()?);
    let path = if draw.coin()? {
        let (j2, radius, pole) = (draw.number()?, draw.positive()?, draw.vector()?);
        orbit
            .and_then(|orbit| Oblate::new(&orbit, j2, radius, &pole))
            .and_then(|orbit| OrbitModel::oblate(orbit, None))
    } else {
        orbit.and_then(|orbit| OrbitModel::kepler(&orbit, None))
    };
    Ok(path.map(|path| (mu, path)))
}

/// What a feedback turns the body toward.
fn aim(draw: &mut Draw<'_>) -> Result<core::result::Result<AttitudeTarget, Error>> {
    Ok(match draw.up_to(3)? {
        0 => Ok(AttitudeTarget::Fixed(draw.attitude()?)),
        1 => AttitudeTarget::turning(&draw.attitude()?, &draw.vector()?, None),
        2 => path(draw)?.map(|(_, path)| AttitudeTarget::Down(path)),
        _ => {
            let (times, _) = samples(draw)?;
            let attitudes = (times.iter().map(|_| draw.attitude())).collect::<Result<Vec<_>>>()?;
            AttitudeTarget::sampled(&times, &attitudes)
        }
    })
}
