//! The twelve sequences, their names, and about which axes each turns.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, MotionFault};

/// Three axes to turn about one after the other.
///
/// Intrinsic (`"ZXZ"`): about the axes of the turning body, `R_NB = R_1(α) R_2(β) R_3(γ)`.
/// Extrinsic (`"zxz"`): about the axes fixed in space, `R_NB = R_3(γ) R_2(β) R_1(α)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sequence {
    pub(super) axes: [usize; 3],
    pub(super) intrinsic: bool,
}

impl FromStr for Sequence {
    type Err = Error;

    /// `"ZXZ"` (= `"goldstein"`, `"landau"`), `"ZYX"` (= `"aerospace"`) and so on; lower case is extrinsic.
    fn from_str(text: &str) -> Result<Self, Error> {
        let fault = || {
            Error::Motion(MotionFault::EulerSequence {
                got: text.to_owned(),
            })
        };
        let letters = match text {
            "goldstein" | "landau" => "ZXZ",
            "aerospace" => "ZYX",
            other => other,
        };
        let intrinsic = letters.chars().all(|c| c.is_ascii_uppercase());
        if !intrinsic && !letters.chars().all(|c| c.is_ascii_lowercase()) {
            return Err(fault());
        }
        let axes: Vec<usize> = letters
            .to_ascii_lowercase()
            .chars()
            .filter_map(|c| "xyz".find(c))
            .collect();
        match axes[..] {
            [a, b, c] if letters.len() == 3 && a != b && b != c => Ok(Self {
                axes: [a, b, c],
                intrinsic,
            }),
            _ => Err(fault()),
        }
    }
}

impl fmt::Display for Sequence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters = if self.intrinsic {
            ["X", "Y", "Z"]
        } else {
            ["x", "y", "z"]
        };
        self.axes
            .iter()
            .try_for_each(|&axis| f.write_str(letters[axis]))
    }
}

impl Sequence {
    /// Whether the first and the third axis are the same.
    #[inline]
    pub(super) fn is_proper(self) -> bool {
        self.axes[0] == self.axes[2]
    }
}
