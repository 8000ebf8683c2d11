//! The numbers of a load, by name.

/// Numbers of a term of a load, under the name and with the shape that they have where the term is made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// The name.
    pub name: &'static str,
    /// How many in each direction; in C order.
    pub shape: Vec<usize>,
}

impl Parameter {
    /// Of this name and shape.
    pub(super) fn new(name: &'static str, shape: &[usize]) -> Self {
        Self {
            name,
            shape: shape.to_vec(),
        }
    }

    /// How many numbers they are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.shape.iter().product()
    }
}
