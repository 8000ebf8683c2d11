//! The six ways in which a free body moves.

use std::fmt;

/// How a free body moves. The first that fits holds, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// All principal moments are equal: ω is constant, whatever its direction.
    Spherical,
    /// Two principal moments are equal: ω circles about the symmetry axis of the body.
    Symmetric,
    /// ω lies along a principal axis and stays there, or the body rests.
    Steady,
    /// `L² = 2T I₂` exactly: ω goes to the intermediate axis and never arrives.
    Separatrix,
    /// `L² < 2T I₂`: ω circles in the body about axis 1, the axis of the least moment, which is the longest of the body.
    LongAxis,
    /// `L² > 2T I₂`: ω circles in the body about axis 3, the axis of the greatest moment, which is the shortest.
    ShortAxis,
}

impl Mode {
    /// The name in lower case.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Spherical => "spherical",
            Self::Symmetric => "symmetric",
            Self::Steady => "steady",
            Self::Separatrix => "separatrix",
            Self::LongAxis => "long-axis",
            Self::ShortAxis => "short-axis",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}
