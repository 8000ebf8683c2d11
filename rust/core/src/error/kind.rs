//! The kinds of mistake.

/// What kind of mistake an [`Error`](super::Error) reports, for callers that map errors to classes of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A number or option outside its domain.
    Argument,
    /// Mass properties that no real body has.
    Inertia,
    /// A mesh that does not bound a solid.
    Mesh,
    /// A file that is not what it says.
    File,
    /// An attitude at which the quantity asked for is not defined.
    SingularAttitude,
    /// An integral over a density that did not converge.
    Quadrature,
    /// An integration that could not go on.
    Integration,
    /// A body that cannot touch a plane as it should.
    Contact,
    /// More than there is memory for.
    Memory,
}
