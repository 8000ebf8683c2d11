//! What a free motion tells without a time: mode, constants, periods, angles.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::DoubleDouble;
use polhode::motion::free::{FreeMotion, Invariants};
use polhode::motion::stability::stability;
use pyo3::prelude::*;

use super::PyFreeMotion;
use crate::arrays::{
    Item, Numbers, read_scalar, write_any_of, write_numbers_of, write_of, write_words_of,
};
use crate::stack::Stack;

type Array<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

impl PyFreeMotion {
    fn invariants(&self, py: Python<'_>) -> PyResult<Stack<Invariants>> {
        self.motions.map(py, Invariants::of_motion)
    }

    /// A float for one motion, an array for a stack.
    fn numbers<'py>(
        &self,
        py: Python<'py>,
        f: fn(&Invariants) -> f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        write_numbers_of(py, &self.invariants(py)?, f)
    }
}

/// A named tuple of `polhode.motion.free`.
pub(super) fn tuple<'py>(
    py: Python<'py>,
    name: &str,
    parts: impl pyo3::call::PyCallArgs<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import("polhode.motion.free")?
        .getattr(name)?
        .call1(parts)
}

/// Angles from the least to the greatest, for each axis.
struct Ranges([[f64; 2]; 3]);

impl Item for Ranges {
    const TAIL: &'static [usize] = &[3, 2];

    fn read(numbers: &[f64]) -> Self {
        Self(std::array::from_fn(|k| {
            [numbers[2 * k], numbers[2 * k + 1]]
        }))
    }

    fn write(&self, out: &mut Vec<f64>) {
        out.extend(self.0.as_flattened());
    }
}

#[pymethods]
impl PyFreeMotion {
    /// How the body moves: the first that fits of "spherical", "symmetric", "steady", "separatrix", "long-axis",
    /// "short-axis".
    ///
    /// Spherical and symmetric bodies have equal moments. A steady spin is along a principal axis. In
    /// long-axis mode (``L² < 2T I₂``) the angular velocity circles in the body about axis 1, that of the
    /// least moment; in short-axis mode (``L² > 2T I₂``) about axis 3; on the separatrix (both sides exactly
    /// equal) it approaches the intermediate axis for ever. A string, or an array of them for a stack.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> print(*brick.free_motion([(0.3, 0.2, 1.1), (1.3, 0.2, 0.1), (0, 1, 0)]).mode)
    /// short-axis long-axis steady
    #[getter]
    fn mode<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        write_words_of(py, &self.motions, |motion| motion.mode.as_str(), "<U10")
    }

    /// Angular momentum L about the centre of mass, components in space, shape (..., 3). It is constant.
    #[getter]
    fn angular_momentum<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_of(py, &self.motions, FreeMotion::angular_momentum)
    }

    /// Kinetic energy of the rotation, ½ ω·I ω. It is constant.
    #[getter]
    fn kinetic_energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, Invariants::kinetic_energy)
    }

    /// ``T/T_min`` with ``T_min = L²/(2 I₃)``, the least energy of a body with this angular momentum.
    ///
    /// One for a spin about axis 3, ``I₃/I₁`` for one about axis 1, ``I₃/I₂`` on the separatrix. Known as E/E₀ of
    /// tumbling asteroids. NaN without angular momentum.
    #[getter]
    fn energy_ratio<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, Invariants::energy_ratio)
    }

    /// k, the modulus of the elliptic functions of time (their parameter is m = k²).
    ///
    /// Zero for a symmetric body and in the limit of a steady spin about axis 1 or 3, one on the separatrix.
    #[getter]
    fn modulus<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, Invariants::modulus)
    }

    /// Complementary modulus k′ = √(1 − k²), accurate near the separatrix too.
    #[getter]
    fn complementary_modulus<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, Invariants::complementary_modulus)
    }

    /// The periods of the motion: each mode has its own, and those that it does not have are NaN.
    ///
    /// Returns
    /// -------
    /// Periods
    ///     ``turn``, ``wobble``: of a steady rotation. ``spin``, ``precession``: of a symmetric body.
    ///     ``rotation``, ``precession``: P_ψ and P_φ of long- and short-axis mode, in the long-axis convention
    ///     of the literature on tumbling asteroids. ``flip``: time from one turning over of the intermediate
    ///     axis to the next. ``rates``: mean rate of precession of each principal axis about L.
    ///
    /// Examples
    /// --------
    /// A wing nut, set spinning about its intermediate axis, turns over every seven seconds:
    ///
    /// >>> from polhode import RigidBody
    /// >>> nut = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> round(nut.free_motion(omega=(0.001, 6.0, 0.0)).periods.flip, 3)
    /// 7.366
    #[getter]
    fn periods<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        let periods = this.invariants(py)?.map(py, Invariants::periods)?;
        let parts = (
            write_numbers_of(py, &periods, |periods| periods.turn)?,
            write_numbers_of(py, &periods, |periods| periods.wobble)?,
            write_numbers_of(py, &periods, |periods| periods.spin)?,
            write_numbers_of(py, &periods, |periods| periods.rotation)?,
            write_numbers_of(py, &periods, |periods| periods.precession)?,
            write_numbers_of(py, &periods, |periods| periods.flip)?,
            write_of(py, &periods, |periods| periods.rates)?,
        );
        let found = tuple(py, "Periods", parts)?;
        if this.is_uncertain() {
            found.setattr("_motion", slf)?;
        }
        Ok(found)
    }

    /// The standard deviations of `periods`.
    fn _periods_sigma<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        (slf.py().import("polhode.uncertainty.motion")?).call_method1("periods_sigma", (slf,))
    }

    /// Least and greatest angle between each principal axis and L, in radians, shape (..., 3, 2).
    ///
    /// This is the range of the Euler angle θ of that axis, with L along z. On the separatrix the bounds are
    /// limits, which the motion approaches. NaN without angular momentum.
    ///
    /// Examples
    /// --------
    /// A plate that wobbles keeps its axis, the third, at a constant angle from L:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> plate = RigidBody.from_principal(mass=1.0, moments=(1.0, 1.0, 2.0))
    /// >>> np.degrees(plate.free_motion(omega=(0.3, 0, 3)).nutation).round(3)
    /// array([[87.138, 92.862],
    ///        [87.138, 92.862],
    ///        [ 2.862,  2.862]])
    #[getter]
    fn nutation<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_of(py, &self.invariants(py)?, |motion| {
            Ranges(motion.nutation())
        })
    }

    /// Half opening angles of the body cone and of the space cone, least and greatest, in radians.
    ///
    /// Returns
    /// -------
    /// Cones
    ///     ``axis``: the principal axis that ω circles, as an index counted from 0: 0 for axis 1, 2 for axis 3.
    ///     ``body``, shape (..., 2): angles between ω and that axis. ``space``, shape (..., 2): angles between
    ///     ω and L.
    ///
    /// Examples
    /// --------
    /// A symmetric body has round cones:
    ///
    /// >>> from polhode import laminae
    /// >>> plate = laminae.disk(radius=0.1, mass=0.2)
    /// >>> cones = plate.free_motion(omega=(0.3, 0, 3)).cones
    /// >>> cones.axis, cones.body.round(4), cones.space.round(4)
    /// (2, array([0.0997, 0.0997]), array([0.0497, 0.0497]))
    #[getter]
    fn cones<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let cones = self.invariants(py)?.map(py, Invariants::cones)?;
        let axis = if cones.is_one() {
            cones[0].axis.into_pyobject(py)?.into_any()
        } else {
            write_any_of(py, &cones, |cones| i64::try_from(cones.axis).unwrap_or(2))?
        };
        let parts = (
            axis,
            write_of(py, &cones, |cones| cones.body)?,
            write_of(py, &cones, |cones| cones.space)?,
        );
        tuple(py, "Cones", parts)
    }

    /// Stability of the steady spins about the principal axes with this angular momentum, shape (..., 3).
    ///
    /// For axis k it is the squared frequency, seen from the body, of small oscillations about a spin with
    /// ``ω = L/I_k``, in (radians per unit of time)². If it is negative, the spin is unstable.
    /// `RigidBody.stability` gives it for a spin rate instead. NaN for an axis with zero moment: no spin
    /// about it has angular momentum.
    ///
    /// Examples
    /// --------
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> brick.free_motion(omega=(0, 2, 0)).stability.round(12)
    /// array([ 4.8 , -0.8 ,  0.96])
    #[getter]
    fn stability<'py>(&self, py: Python<'py>) -> Array<'py> {
        write_of(py, &self.motions, |motion| {
            let moments = motion.moments.map(DoubleDouble::rounded);
            let rates = Invariants::of_motion(motion).steady_rates();
            std::array::from_fn::<_, 3, _>(|k| {
                if moments[k] > 0.0 {
                    stability(&moments, rates[k])[k]
                } else {
                    f64::NAN
                }
            })
        })
    }

    /// The polhode: the closed curve of the angular velocity in the body, exact.
    ///
    /// Parameters
    /// ----------
    /// n : int, optional
    ///     Number of points, at least two; the last point is equal to the first.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (..., n, 3)
    ///     Angular velocities, components in the body frame. The first is that at t = 0; the others follow in
    ///     the sense of the motion, in equal steps of the amplitude of the elliptic functions. If the angular
    ///     velocity is constant, all points are equal. On the separatrix the curve is the limit of the
    ///     polhodes next to it.
    ///
    /// Examples
    /// --------
    /// Every point has the energy and the momentum of the motion:
    ///
    /// >>> import numpy as np
    /// >>> from polhode import RigidBody
    /// >>> brick = RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
    /// >>> curve = brick.free_motion(omega=(0.3, 0.2, 1.1)).polhode(5)
    /// >>> brick.kinetic_energy(curve).rotational.round(12)
    /// array([1.5975, 1.5975, 1.5975, 1.5975, 1.5975])
    #[pyo3(signature = (n=181))]
    fn polhode<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = read_scalar)] n: i128,
    ) -> PyResult<Bound<'py, PyAny>> {
        if n < 2 {
            return Err(pyo3::exceptions::PyValueError::new_err(format!(
                "n: expected at least 2 points of a closed curve, got {n}"
            )));
        }
        let n = usize::try_from(n).unwrap_or(usize::MAX); // far beyond all memory, which is told below
        let shape = [&self.motions.shape[..], &[n]].concat();
        let mut numbers = Numbers::of::<Vector3<f64>>(py, "n", &shape)?;
        for motion in &self.motions.rows {
            numbers.put(motion.polhode_points(n), |point, out| point.write(out))?;
        }
        Ok(numbers.finish::<Vector3<f64>>(&shape)?.into_any())
    }
}
