//! Equimomental systems of particles.

use polhode::mass::equimomental::{Particles, equimomental_particles, stick as stick_of};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Numbers, read};
use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};

#[pymethods]
impl PyRigidBody {
    /// The smallest set of equal positive masses with the body's mass, centre of mass and inertia tensor.
    ///
    /// Joined rigidly, the particles move like the body under the same forces. Their number is the rank of
    /// the second moment plus one: four for a solid, three for a lamina, two for a rod, one for a point.
    ///
    /// Returns
    /// -------
    /// Particles
    ///     ``masses`` (..., n) and ``positions`` (..., n, 3) in the body frame.
    ///
    /// Raises
    /// ------
    /// InvalidInertiaError
    ///     For a body that was accepted within `rtol` although no distribution of mass has its moments.
    /// ValueError
    ///     For a stack whose bodies need different numbers of particles.
    ///
    /// Examples
    /// --------
    /// A rod of length 6, as two particles:
    ///
    /// >>> from polhode import RigidBody, solids
    /// >>> rod = solids.box((0, 0, 6), mass=2.0)
    /// >>> particles = rod.equimomental_particles()
    /// >>> particles.masses
    /// array([1., 1.])
    /// >>> abs(particles.positions[:, 2]).round(6)
    /// array([1.732051, 1.732051])
    /// >>> RigidBody.from_particles(*particles).isclose(rod)
    /// True
    fn equimomental_particles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let grid = Broadcast::of(["body"], [&self.bodies.shape])?;
        let found = grid.try_map(py, |[b]| equimomental_particles(&self.bodies[b]))?;
        let counts = found.map(py, |row| row.masses.len())?.rows;
        // A stack of no bodies has as many as solids have.
        let first = counts.first().copied().unwrap_or(4);
        if let Some(row) = counts.iter().position(|&count| count != first) {
            return Err(PyValueError::new_err(format!(
                "the bodies of a stack must need equally many particles to fill an array: the first needs {first}, \
                 the one at flat index {row} needs {}; ask each body by itself",
                counts[row]
            )));
        }
        to_python(py, &found, first)
    }
}

/// A stick as three particles on a line: at the distance a and at the distance b on opposite sides of its
/// centre of mass, and at the centre of mass.
///
/// ``m₁ = I₀/(a (a+b))``, ``m₂ = I₀/(b (a+b))``, ``m₀ = m − I₀/(a b)``. They have the mass and the centre of
/// mass of the stick, and the same moment about every axis perpendicular to it: ``I₀ + m x²`` at the distance
/// x.
///
/// Parameters
/// ----------
/// mass : array_like, shape (...)
///     m, positive.
/// inertia : array_like, shape (...)
///     Moment I₀ about an axis perpendicular to the stick through its centre of mass; zero or more.
/// a, b : array_like, shape (...)
///     Positive; their product at least I₀/m.
///
/// Returns
/// -------
/// Particles
///     ``masses`` (..., 3): m₁, m₂, m₀, and ``positions`` (..., 3, 3): a, −b and 0 along z.
///
/// Raises
/// ------
/// PolhodeError
///     If m₀ would be negative; the message tells the least product of the distances.
///
/// Examples
/// --------
/// A uniform stick of length 6 as particles at its ends and its middle, with one sixth, one sixth and two
/// thirds of its mass:
///
/// >>> from polhode import equimomental
/// >>> equimomental.stick(mass=12.0, inertia=36.0, a=3.0, b=3.0).masses
/// array([2., 2., 8.])
#[pyfunction]
pub(crate) fn stick<'py>(
    py: Python<'py>,
    mass: &Bound<'py, PyAny>,
    inertia: &Bound<'py, PyAny>,
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let mass: Stack<f64> = read(mass, "mass")?;
    let inertia: Stack<f64> = read(inertia, "inertia")?;
    let (a, b): (Stack<f64>, Stack<f64>) = (read(a, "a")?, read(b, "b")?);
    let shapes = [&mass.shape[..], &inertia.shape, &a.shape, &b.shape];
    let grid = Broadcast::of(["mass", "inertia", "a", "b"], shapes)?;
    let found = grid.try_map(py, |[m, i, p, q]| stick_of(mass[m], inertia[i], a[p], b[q]))?;
    to_python(py, &found, 3)
}

/// As `polhode.results.Particles`, with `count` particles in each row.
fn to_python<'py>(
    py: Python<'py>,
    found: &Stack<Particles>,
    count: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let shape = [&found.shape[..], &[count]].concat();
    let mut masses = Numbers::of::<f64>(py, "masses", &shape)?;
    masses.put(&found.rows, |row, out| out.extend(&row.masses))?;
    let mut positions = Numbers::of::<[f64; 3]>(py, "positions", &shape)?;
    positions.put(&found.rows, |row, out| {
        out.extend(row.positions.as_flattened());
    })?;
    let parts = (
        masses.finish::<f64>(&shape)?,
        positions.finish::<[f64; 3]>(&shape)?,
    );
    py.import("polhode.results")?
        .getattr("Particles")?
        .call1(parts)
}
