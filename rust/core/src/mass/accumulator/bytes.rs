//! An accumulator as bytes, to be stored or sent: numbers in little-endian order after a line that says what they are.

use std::collections::BTreeMap;

use super::moments::Moments;
use super::pieces::{Matter, Piece, WHOLE, check_loose};
use super::sums::MassAccumulator;
use crate::error::{BodyFault, Error};
use crate::mass::particles::Particles;
use crate::numerics::double_double::DoubleDouble;

const HEADER: &[u8] = b"polhode mass accumulator 1\n";
const LOOSE: u64 = 0;
const SUMMED: u64 = 1;

impl MassAccumulator {
    /// All that has been added, as bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = HEADER.to_vec();
        let mut put = |number: u64| bytes.extend(number.to_le_bytes());
        put(u64::from(self.is_placed));
        put(self.pieces.len() as u64);
        for (&start, piece) in &self.pieces {
            put(start);
            put(piece.end);
            match &piece.matter {
                Matter::Loose { masses, positions } => {
                    put(LOOSE);
                    let numbers = masses.iter().chain(positions.as_flattened());
                    numbers.for_each(|number| put(number.to_bits()));
                }
                Matter::Summed(moments) => {
                    put(SUMMED);
                    numbers(moments).for_each(|number| put(number.to_bits()));
                }
            }
        }
        bytes
    }

    /// The accumulator that [`Self::to_bytes`] wrote, the same to the last bit.
    ///
    /// # Errors
    /// [`BodyFault::NotAnAccumulator`] when the bytes are something else.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let fault = Error::Body(BodyFault::NotAnAccumulator);
        let body = bytes.strip_prefix(HEADER).ok_or(fault.clone())?;
        let (numbers, rest) = body.as_chunks::<8>();
        if !rest.is_empty() {
            return Err(fault);
        }
        let mut numbers = numbers.iter().map(|bytes| u64::from_le_bytes(*bytes));
        let (Some(is_placed @ (0 | 1)), Some(count)) = (numbers.next(), numbers.next()) else {
            return Err(fault);
        };
        let mut pieces = BTreeMap::new();
        let mut free = 0;
        while let Some(start) = numbers.next() {
            let (Some(end), Some(kind)) = (numbers.next(), numbers.next()) else {
                return Err(fault);
            };
            if start < free || end <= start {
                return Err(fault);
            }
            free = end;
            let floats = numbers.by_ref().map(f64::from_bits);
            let matter = match kind {
                LOOSE if end - start < WHOLE => loose(floats, end - start),
                SUMMED => summed(floats),
                _ => None,
            };
            let matter = matter.ok_or(fault.clone())?;
            pieces.insert(start, Piece { end, matter });
        }
        if pieces.len() as u64 != count {
            return Err(fault);
        }
        Ok(Self {
            pieces,
            is_placed: is_placed == 1,
        })
    }
}

fn numbers(moments: &Moments) -> impl Iterator<Item = f64> + '_ {
    let Moments {
        mass,
        center,
        central,
    } = moments;
    let all = std::iter::once(mass).chain(center).chain(central);
    all.flat_map(|number| [number.high, number.low])
}

fn loose(mut floats: impl Iterator<Item = f64>, count: u64) -> Option<Matter> {
    let masses: Vec<f64> = (0..count).map_while(|_| floats.next()).collect();
    let positions: Vec<[f64; 3]> = (0..count)
        .map_while(|_| Some([floats.next()?, floats.next()?, floats.next()?]))
        .collect();
    let is_whole = masses.len() as u64 == count && positions.len() == masses.len();
    if !is_whole || check_loose(Particles::new(&masses, &positions)).is_err() {
        return None;
    }
    Some(Matter::Loose { masses, positions })
}

fn summed(mut floats: impl Iterator<Item = f64>) -> Option<Matter> {
    let mut number = || {
        let (high, low) = (floats.next()?, floats.next()?);
        let number = DoubleDouble::sum(high, low);
        (number == DoubleDouble { high, low }).then_some(number)
    };
    let mut moments = Moments {
        mass: number()?,
        ..Moments::default()
    };
    for place in moments.center.iter_mut().chain(&mut moments.central) {
        *place = number()?;
    }
    let is_matter = moments.mass.high >= 0.0 && numbers(&moments).all(f64::is_finite);
    is_matter.then_some(Matter::Summed(moments))
}
