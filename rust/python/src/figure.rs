//! What bodies look like: the shapes that they were made of. Pictures ask for it; no number of a body depends on it.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use polhode::RigidBody;

/// Bodies of a larger stack are drawn by their inertia.
pub(crate) const MOST_ROWS: usize = 64;
/// So are bodies of more parts.
const MOST_PARTS: usize = 256;
/// Particles and corners that are kept, and faces: those of a larger body would double its memory.
pub(crate) const MOST_POINTS: usize = 256;
pub(crate) const MOST_FACES: usize = 20_000;

/// Says that the body is known by its inertia alone, whatever it is made of.
const WHOLE: &str = "whole";

/// The parts of each body of a stack, or nothing where no shape is known.
pub(crate) type Figures = Option<Arc<Vec<Figure>>>;

/// The parts of a body.
pub(crate) type Figure = Arc<[Part]>;

/// A shape in its own place.
pub(crate) struct Outline {
    /// The function that makes it, or what its numbers are.
    pub(crate) kind: Cow<'static, str>,
    /// Lengths, or coordinates one point after the other.
    pub(crate) numbers: Vec<f64>,
    /// Triangles of a mesh.
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Outline {
    pub(crate) fn of(kind: &'static str, numbers: Vec<f64>) -> Self {
        let (kind, faces) = (Cow::Borrowed(kind), Vec::new());
        Self {
            kind,
            numbers,
            faces,
        }
    }

    /// Of a body of which nothing but its numbers is known.
    pub(crate) fn of_inertia(body: &RigidBody) -> Self {
        Self::of("inertia", body.to_array().to_vec())
    }

    /// Of points with their coordinates, if they are not too many.
    pub(crate) fn of_points<const N: usize>(
        kind: &'static str,
        points: &[[f64; N]],
    ) -> Option<Self> {
        (points.len() <= MOST_POINTS).then(|| Self::of(kind, points.as_flattened().to_vec()))
    }

    /// Of particles, if they are not too many: their masses, then their positions.
    pub(crate) fn of_particles(masses: &[f64], positions: &[[f64; 3]]) -> Option<Self> {
        let numbers = || [masses, positions.as_flattened()].concat();
        (masses.len() <= MOST_POINTS).then(|| Self::of("particles", numbers()))
    }

    /// Of a mesh that was checked, if its faces are not too many.
    pub(crate) fn of_mesh<I: Copy + TryInto<u32>>(
        kind: &'static str,
        vertices: &[[f64; 3]],
        faces: &[[I; 3]],
    ) -> Option<Self> {
        if faces.len() > MOST_FACES || vertices.len() > 3 * MOST_FACES {
            return None;
        }
        let face = |corners: &[I; 3]| {
            let [a, b, c] = corners.map(|corner| corner.try_into().ok());
            Some([a?, b?, c?])
        };
        Some(Self {
            faces: faces.iter().map(face).collect::<Option<_>>()?,
            ..Self::of(kind, vertices.as_flattened().to_vec())
        })
    }

    /// That of a body, where it is.
    pub(crate) fn place(self) -> Figure {
        Arc::new([Part {
            outline: Arc::new(self),
            place: Placement::default(),
            is_taken_out: false,
        }])
    }
}

/// A part of a body.
#[derive(Clone)]
pub(crate) struct Part {
    pub(crate) outline: Arc<Outline>,
    pub(crate) place: Placement,
    pub(crate) is_taken_out: bool,
}

/// Where a shape goes: x → turn x + shift; the turn scales, too.
#[derive(Clone, Copy)]
pub(crate) struct Placement {
    pub(crate) turn: Matrix3<f64>,
    pub(crate) shift: Vector3<f64>,
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            turn: Matrix3::identity(),
            shift: Vector3::zeros(),
        }
    }
}

impl Placement {
    pub(crate) fn after(&self, before: &Self) -> Self {
        Self {
            turn: self.turn * before.turn,
            shift: self.turn * before.shift + self.shift,
        }
    }
}

/// The shapes of the rows of a result, if they are few.
pub(crate) fn figures(rows: usize, of: impl FnMut(usize) -> Figure) -> Figures {
    (rows <= MOST_ROWS).then(|| Arc::new((0..rows).map(of).collect()))
}

/// The shape of one body, if it is known.
pub(crate) fn alone(outline: Option<Outline>) -> Figures {
    outline.map(|outline| Arc::new(vec![outline.place()]))
}

/// The shapes of homogeneous bodies by the lengths of each.
pub(crate) fn figures_of_lengths(
    kind: &'static str,
    rows: usize,
    mut lengths: impl FnMut(usize) -> Vec<f64>,
) -> Figures {
    figures(rows, |row| Outline::of(kind, lengths(row)).place())
}

/// Bodies put together: each with whether it is taken out.
pub(crate) fn together(bodies: impl IntoIterator<Item = (Figure, bool)>) -> Figure {
    let mut parts = Vec::new();
    for (figure, is_out) in bodies {
        let is_whole = figure.iter().any(|part| part.outline.kind == WHOLE);
        if is_whole || parts.len() + figure.len() > MOST_PARTS {
            return Outline::of(WHOLE, Vec::new()).place();
        }
        parts.extend(figure.iter().map(|part| Part {
            is_taken_out: part.is_taken_out != is_out,
            ..part.clone()
        }));
    }
    parts.into()
}
