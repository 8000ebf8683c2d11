//! Where a body's numbers come from: what it was made of, what was checked, what was changed.

use std::fmt;

/// What a body was made from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum BodySource {
    /// An inertia tensor that was given.
    #[default]
    Tensor,
    /// Principal moments that were given.
    PrincipalMoments,
    /// A second moment that was given.
    SecondMoment,
    /// Particles.
    Particles,
    /// A solid bounded by triangles.
    Mesh,
    /// A thin shell of triangles.
    Surface,
    /// A thin wire of straight segments.
    Curve,
    /// Tetrahedra.
    Tetrahedra,
    /// Voxels.
    Voxels,
    /// A density that is a function of position.
    Density,
    /// A solid in closed form.
    Solid,
    /// A lamina in closed form.
    Lamina,
    /// A rod in closed form.
    Rod,
    /// Other bodies, put together or taken away.
    Bodies,
    /// Atoms, each of the most common isotope of its element where its label names none.
    CommonIsotopes,
    /// Atoms of their elements' average masses.
    AverageAtoms,
    /// Atoms whose masses came with them.
    OwnAtoms,
    /// The union of balls.
    Balls,
}

impl BodySource {
    const ALL: [Self; 18] = [
        Self::Tensor,
        Self::PrincipalMoments,
        Self::SecondMoment,
        Self::Particles,
        Self::Mesh,
        Self::Surface,
        Self::Curve,
        Self::Tetrahedra,
        Self::Voxels,
        Self::Density,
        Self::Solid,
        Self::Lamina,
        Self::Rod,
        Self::Bodies,
        Self::CommonIsotopes,
        Self::AverageAtoms,
        Self::OwnAtoms,
        Self::Balls,
    ];
}

impl fmt::Display for BodySource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tensor => "tensor",
            Self::PrincipalMoments => "principal moments",
            Self::SecondMoment => "second moment",
            Self::Particles => "particles",
            Self::CommonIsotopes => "atoms, most common isotopes",
            Self::AverageAtoms => "atoms, average masses",
            Self::OwnAtoms => "atoms, masses of their own",
            Self::Mesh => "mesh",
            Self::Surface => "surface",
            Self::Curve => "curve",
            Self::Tetrahedra => "tetrahedra",
            Self::Voxels => "voxels",
            Self::Density => "density",
            Self::Solid => "solid",
            Self::Lamina => "lamina",
            Self::Rod => "rod",
            Self::Bodies => "bodies",
            Self::Balls => "balls",
        })
    }
}

/// What the principal moments were found from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MomentsFrom {
    /// They were given.
    Given,
    /// The float64 tensor, which in a rotated frame has lost the smallest moment of a thin body by about ε I₃/I₁.
    #[default]
    Tensor,
    /// The second moment of the matter, before it was rounded to a tensor.
    SecondMoment,
    /// The second moment summed again in the body's own axes, which keeps the smallest moment of a thin body.
    OwnAxes,
}

impl MomentsFrom {
    const ALL: [Self; 4] = [Self::Given, Self::Tensor, Self::SecondMoment, Self::OwnAxes];
}

impl fmt::Display for MomentsFrom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Given => "given",
            Self::Tensor => "tensor",
            Self::SecondMoment => "second moment",
            Self::OwnAxes => "second moment in own axes",
        })
    }
}

/// How an open mesh was closed on request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Closure {
    /// Each hole by triangles from its edges to the mean of their ends.
    Caps,
    /// By the convex hull in its place.
    Hull,
}

impl fmt::Display for Closure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Caps => "caps",
            Self::Hull => "hull",
        })
    }
}

/// A set of checks that the input has passed; [`Checks::UNCHECKED`] says that one was left out on request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Checks(u16);

impl Checks {
    /// Checks that matter was asked to go without.
    pub const UNCHECKED: Self = Self(1);
    /// Indices name things that exist.
    pub const INDICES: Self = Self(1 << 1);
    /// Numbers are finite.
    pub const FINITE: Self = Self(1 << 2);
    /// A mesh has no boundary.
    pub const CLOSED: Self = Self(1 << 3);
    /// Neighbouring faces are wound alike.
    pub const WINDING: Self = Self(1 << 4);
    /// The faces look outward.
    pub const ORIENTATION: Self = Self(1 << 5);
    /// There is volume (area, length) beyond rounding.
    pub const VOLUME: Self = Self(1 << 6);
    /// No face stands twice.
    pub const DUPLICATES: Self = Self(1 << 7);
    /// Masses or densities are not negative, their sum is positive.
    pub const MASSES: Self = Self(1 << 8);
    /// A tensor is symmetric, has no negative moment and obeys the triangle inequality.
    pub const TENSOR: Self = Self(1 << 9);
    /// Components of a mesh that are wound inward lie in others.
    pub const CAVITIES: Self = Self(1 << 10);
    /// The mesh was mended on request before it passed them.
    pub const REPAIRED: Self = Self(1 << 11);

    const NAMES: [&'static str; 12] = [
        "unchecked",
        "indices",
        "finite",
        "closed",
        "winding",
        "orientation",
        "volume",
        "duplicates",
        "masses",
        "tensor",
        "cavities",
        "repaired",
    ];

    /// Both sets together.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether all checks of `other` are among these.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Their names.
    pub(crate) fn names(self) -> impl Iterator<Item = &'static str> {
        let is_in = move |bit: &usize| self.0 >> bit & 1 == 1;
        (0..Self::NAMES.len())
            .filter(is_in)
            .map(|bit| Self::NAMES[bit])
    }

    /// The check of this name.
    #[cfg(feature = "serde")]
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        let bit = Self::NAMES.iter().position(|known| *known == name)?;
        Some(Self(1 << bit))
    }
}

impl fmt::Display for Checks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, name) in self.names().enumerate() {
            f.write_str(if place > 0 { ", " } else { "" })?;
            f.write_str(name)?;
        }
        Ok(())
    }
}

/// Where a body's numbers come from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Provenance {
    /// What the body was made from.
    pub source: BodySource,
    /// How many of them: particles, triangles, segments, cells, bodies; 1 for one tensor or solid.
    pub elements: usize,
    /// What the input has passed.
    pub checks: Checks,
    /// Corners joined to others within a length that was asked for; equal corners are one and not counted.
    pub welded: usize,
    /// How an open mesh was closed.
    pub closure: Option<Closure>,
    /// By how much that changed the volume that the faces span with the middle of the mesh.
    pub volume_change: f64,
    /// What the principal moments were found from.
    pub moments: MomentsFrom,
    /// Principal moments that rounding had left, or a table had admitted, and that are stored as zero.
    pub rounded_to_zero: u8,
    /// By how much each coordinate of the particles was rounded at most, where that is known: half a unit of the last
    /// digit that a file prints. In the unit of length; 0 where nothing is known of it.
    pub rounding: f64,
}

impl Provenance {
    /// Of matter of a kind whose second moment was summed or is known.
    #[must_use]
    pub(crate) fn of_matter(source: BodySource, elements: usize, checks: Checks) -> Self {
        Self {
            source,
            elements,
            checks,
            moments: MomentsFrom::SecondMoment,
            ..Self::default()
        }
    }

    /// Of particles.
    #[must_use]
    pub fn of_particles(count: usize) -> Self {
        Self::of_matter(
            BodySource::Particles,
            count,
            Checks::FINITE.and(Checks::MASSES),
        )
    }

    /// The same, the moments from sums in the body's own axes.
    #[must_use]
    pub(crate) fn in_own_axes(self) -> Self {
        Self {
            moments: MomentsFrom::OwnAxes,
            ..self
        }
    }

    /// Of two bodies put together: what was done to either was done to both.
    #[must_use]
    pub(crate) fn of_both(&self, other: &Self) -> Self {
        let parts = |part: &Self| match part.source {
            BodySource::Bodies => part.elements,
            _ => 1,
        };
        Self {
            source: BodySource::Bodies,
            elements: parts(self).saturating_add(parts(other)),
            checks: self.checks.and(other.checks),
            welded: self.welded.saturating_add(other.welded),
            closure: self.closure.or(other.closure),
            volume_change: self.volume_change + other.volume_change,
            moments: MomentsFrom::Tensor,
            rounded_to_zero: 0,
            rounding: self.rounding.max(other.rounding),
        }
    }

    /// As numbers, for storage.
    #[must_use]
    pub fn to_array(&self) -> [f64; 9] {
        let closure = match self.closure {
            None => 0.0,
            Some(Closure::Caps) => 1.0,
            Some(Closure::Hull) => 2.0,
        };
        [
            f64::from(self.source as u8),
            self.elements as f64,
            f64::from(self.checks.0),
            self.welded as f64,
            closure,
            self.volume_change,
            f64::from(self.moments as u8),
            f64::from(self.rounded_to_zero),
            self.rounding,
        ]
    }

    /// What [`Self::to_array`] took apart; numbers that stand for nothing become defaults.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts below 2^52; the cast saturates"
    )]
    pub fn from_array(numbers: &[f64; 9]) -> Self {
        let [
            source,
            elements,
            checks,
            welded,
            closure,
            volume_change,
            moments,
            rounded,
            rounding,
        ] = *numbers;
        Self {
            source: BodySource::ALL
                .get(source as usize)
                .copied()
                .unwrap_or_default(),
            elements: elements as usize,
            checks: Checks(checks as u16),
            welded: welded as usize,
            closure: match closure as u8 {
                1 => Some(Closure::Caps),
                2 => Some(Closure::Hull),
                _ => None,
            },
            volume_change,
            moments: MomentsFrom::ALL
                .get(moments as usize)
                .copied()
                .unwrap_or_default(),
            rounded_to_zero: rounded as u8,
            rounding,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_back() {
        for source in BodySource::ALL {
            for moments in MomentsFrom::ALL {
                for closure in [None, Some(Closure::Caps), Some(Closure::Hull)] {
                    let provenance = Provenance {
                        source,
                        elements: 12,
                        checks: Checks::CLOSED.and(Checks::UNCHECKED),
                        welded: 3,
                        closure,
                        volume_change: -0.5,
                        moments,
                        rounded_to_zero: 1,
                        rounding: 5e-4,
                    };
                    assert_eq!(Provenance::from_array(&provenance.to_array()), provenance);
                }
            }
        }
    }

    #[test]
    fn checks_are_listed_in_order() {
        let checks = Checks::VOLUME.and(Checks::INDICES).and(Checks::CLOSED);
        assert_eq!(checks.to_string(), "indices, closed, volume");
        assert_eq!(
            checks.and(Checks::REPAIRED).to_string(),
            "indices, closed, volume, repaired"
        );
        assert!(checks.contains(Checks::CLOSED) && !checks.contains(Checks::WINDING));
    }
}
