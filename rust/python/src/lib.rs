//! The extension module `polhode._core`: arrays in, arrays out, shapes, errors, interrupts; no physics.
//!
//! | file | what it knows |
//! |---|---|
//! | `arrays`, `items`, `meshes` | NumPy layout |
//! | `lazy_arrays` | arrays that are not in memory |
//! | `array_conversion` | what other objects become as arrays, and what would be lost on the way |
//! | `memory` | whether there is room for a result |
//! | `shape`, `stack`, `indexing` | shape arithmetic |
//! | `errors`, `advice` | which exception an error of the core becomes, and the keyword that mends it |
//! | `hints` | the way out of mistakes that many make |
//! | `interrupt` | Ctrl-C and progress |
//! | `depth` | functions of Python that call the package anew |
//! | `closed_form` | exact motions at many times |
//! | `pictures` | pictures of exact motions, which Python draws |
//! | `uncertain` | numbers with a sigma, and the covariances of bodies |
//! | `environment` | the variables that limit threads and name the instruction set |
//! | the others | a class or module of the Python package, or what several of them read as arguments |

// What Python sees is documented in Python's terms; the names are public to it alone.
#![allow(missing_docs, clippy::doc_markdown, clippy::needless_pass_by_value)]

mod about;
mod accumulator;
mod advice;
mod array_conversion;
mod arrays;
mod attitudes;
mod body;
mod closed_form;
mod depth;
mod environment;
mod equimomental;
mod errors;
mod euler_rates;
mod events;
mod figure;
mod files;
mod forms;
mod free_motion;
mod gyrostat;
mod heavy_top;
mod hints;
mod identification;
mod indexing;
mod interrupt;
mod items;
mod kinematics;
mod laminae;
mod lazy_arrays;
mod loads;
mod memory;
mod meshes;
mod orbits;
mod parallel_axis;
mod particles;
mod pictures;
mod principal;
mod random;
mod rates;
mod realizable;
mod regions;
mod rigid_body;
mod rods;
mod rolling;
mod rotations;
mod sensitivity;
mod shape;
mod shapes;
mod solids;
mod stack;
mod times;
mod tops;
mod uncertain;
mod voxels;

use pyo3::prelude::*;

// Every class is frozen or borrowed for as long as it changes, and what is shared is atomic: no call needs the lock of the
// interpreter.
#[pymodule(gil_used = false)]
mod _core {
    use numpy::{PyArray1, PyArrayMethods};
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::accumulator::PyMassAccumulator;
    #[pymodule_export]
    use crate::arrays::{Slabs, real_numbers};
    #[pymodule_export]
    use crate::body::PyRigidBody;
    #[pymodule_export]
    use crate::environment::machine;
    #[pymodule_export]
    use crate::equimomental::stick;
    #[pymodule_export]
    use crate::euler_rates::{angular_velocity_from_euler_rates, euler_rates};
    #[pymodule_export]
    use crate::files::{read_plates, read_stl, stream_solid, surface_area};
    #[pymodule_export]
    use crate::forms::{
        from_log_cholesky, from_parameters, from_pseudo_inertia, from_spatial_inertia,
        to_log_cholesky, to_parameters, to_positive_products, to_pseudo_inertia,
        to_spatial_inertia,
    };
    #[pymodule_export]
    use crate::free_motion::PyFreeMotion;
    #[pymodule_export]
    use crate::gyrostat::PyGyrostat;
    #[pymodule_export]
    use crate::gyrostat::PyGyrostatMotion;
    #[pymodule_export]
    use crate::heavy_top::PyHeavyTop;
    #[pymodule_export]
    use crate::identification::{fit_tumble, tumble_information};
    #[pymodule_export]
    use crate::kinematics::transport;
    #[pymodule_export]
    use crate::laminae::{annulus, disk, ellipse, polygon, rectangle, triangle};
    #[pymodule_export]
    use crate::loads::{
        PyLoad, PyWheel, callback, compiled, schedule, thrusters, torque_callback, wheels,
        with_states,
    };
    #[pymodule_export]
    use crate::orbits::{
        dipole_field, kepler_period, kepler_states, local_frames, oblate_states, sampled_states,
    };
    #[pymodule_export]
    use crate::parallel_axis::{inertia_from_center_of_mass, inertia_to_center_of_mass};
    #[pymodule_export]
    use crate::principal::{
        canonical_axes, classify_tops, principal_axes, principal_derivative, principal_gaps,
        principal_moments, ray_kappa,
    };
    #[pymodule_export]
    use crate::random::{covariance_factor, random_numbers};
    #[pymodule_export]
    use crate::rates::{attitudes, impulses, rates, white_noise};
    #[pymodule_export]
    use crate::realizable::{nearest_valid, within_box};
    #[pymodule_export]
    use crate::regions::{PyRegion, ball, cuboid as box_region, cylinder as cylinder_region};
    #[pymodule_export]
    use crate::regions::{ellipsoid as ellipsoid_region, mesh};
    #[pymodule_export]
    use crate::rigid_body::{PyStepper, PyVaryingBody};
    #[pymodule_export]
    use crate::rods::{arc, ring, rod};
    #[pymodule_export]
    use crate::rolling::{
        PyContact, PyRuledSurface, PySurface, cone as ruled_cone, contact_history,
        contact_invariants, cylinder as ruled_cylinder, disk as surface_disk,
        ellipsoid as surface_ellipsoid, paraboloid, plane, rolling_critical_rate, rolling_modes,
        rolling_states, rolling_steady, rolling_tippe_top, sphere as surface_sphere,
        torus as surface_torus,
    };
    #[pymodule_export]
    use crate::rotations::{
        euler_angles_from_quaternion, quaternion_from_euler_angles, quaternion_from_matrix, rotate,
    };
    #[pymodule_export]
    use crate::sensitivity::motion_sensitivity;
    #[pymodule_export]
    use crate::solids::{
        capsule, cone, cube, cuboid, cylinder, ellipsoid, frustum, hemisphere, hollow_sphere,
        prism, pyramid, sphere, tetrahedron, torus, tube, wedge,
    };
    #[pymodule_export]
    use crate::tops::{free_precession, least_spin, nutation_damping, steady_precession};
    #[pymodule_export]
    use crate::uncertain::PyUncertain;
    #[pymodule_export]
    use crate::voxels::labelled_voxels;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        // NumPy's interface, and what lends its arrays, is looked up on first use, where a Ctrl-C in between would be a
        // panic: use it now.
        drop(PyArray1::<f64>::zeros(module.py(), 0, false).readonly());
        crate::environment::obey()?;
        crate::loads::declare_laws(module)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
