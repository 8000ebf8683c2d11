//! The extension module `polhode._core`: arrays in, arrays out, shapes, errors, interrupts; no physics.
//!
//! | file | what it knows |
//! |---|---|
//! | `arrays` | NumPy layout |
//! | `stack` | shape arithmetic |
//! | `errors` | which exception an error of the core becomes |
//! | `interrupt` | Ctrl-C and progress |
//! | the others | one each for a class or module of the Python package |

// What Python sees is documented in Python's terms; the names are public to it alone.
#![allow(missing_docs, clippy::doc_markdown, clippy::needless_pass_by_value)]

mod accumulator;
mod arrays;
mod errors;
mod files;
mod interrupt;
mod loads;
mod particles;
mod principal;
mod rigid_body;
mod rotations;
mod solids;
mod stack;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::accumulator::PyMassAccumulator;
    #[pymodule_export]
    use crate::files::{read_plates, read_stl, surface_area};
    #[pymodule_export]
    use crate::loads::{PyLoad, constant_torque, torque_callback};
    #[pymodule_export]
    use crate::principal::{classify_tops, principal_axes, principal_gaps};
    #[pymodule_export]
    use crate::rigid_body::PyRigidBody;
    #[pymodule_export]
    use crate::rotations::{
        euler_angles_from_quaternion, quaternion_from_euler_angles, quaternion_from_matrix, rotate,
    };
    #[pymodule_export]
    use crate::solids::{cone, cube, cuboid, cylinder, ellipsoid, sphere};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
