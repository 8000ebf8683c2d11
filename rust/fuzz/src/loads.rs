//! Loads drawn from bytes.

use arbitrary::Result;
use nalgebra::Matrix3;
use polhode::Error;
use polhode::motion::loads::{Damping, Feedback, Frame, GravityGradient, Sampled, Term, Windows};

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
    Ok(match draw.up_to(8)? {
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
            GravityGradient::new(draw.positive()?, &draw.vector()?, &draw.vector()?, epoch)
                .map(Term::GravityGradient)
        }
        4 => Damping::new(&matrix(draw)?, &Matrix3::zeros()).map(Term::Damping),
        5 => Damping::new(&Matrix3::zeros(), &matrix(draw)?).map(Term::Damping),
        6 => {
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
            Sampled::new(&times, &values, frame(draw)?).map(Term::Sampled)
        }
        7 => Feedback::new(&matrix(draw)?, &matrix(draw)?, &draw.attitude()?).map(Term::Feedback),
        _ => {
            let windows = draw.list(4, |draw| Ok((draw.number()?, draw.number()?)))?;
            let term = Term::uniform_gravity(&draw.vector()?);
            let inner = if draw.coin()? {
                term
            } else {
                Term::constant_torque(&draw.vector()?, frame(draw)?)
            };
            Windows::new(&windows).and_then(|windows| inner?.scheduled(&windows))
        }
    })
}
