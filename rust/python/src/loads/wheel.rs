//! The class `Wheel`: a wheel in a body, which is a record and a load in one, and the function that makes those with a motor.

use std::hash::{DefaultHasher, Hash, Hasher};

use nalgebra::Vector3;
use numpy::PyUntypedArrayMethods;
use polhode::error::MotionFault;
use polhode::motion::loads::{
    Drive, PiecewiseSignal, Rotor, Term, Wheel, allocation, allocation_error,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyString, PyTuple};

use super::callbacks::check_name;
use super::load::{LoadPart, PyLoad};
use super::pickle_recipe::{recipe, unfold};
use super::registry::register;
use crate::arrays::{
    copy_of, floats, list_floats, numpy, read, read_list, read_scalar, try_rows, write,
    write_numbers, write_of,
};
use crate::errors::to_py;
use crate::indexing::{picked_by, to_index};
use crate::shape::tuple;
use crate::stack::{Broadcast, Stack};

/// How a wheel turns.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Turns {
    /// J (Ω + a·ω) is constant.
    Free,
    /// Ω is constant.
    Held,
    /// By what the argument of this name says.
    Driven(&'static str),
}

impl Turns {
    const DRIVEN: [&'static str; 4] = ["torque", "friction", "dry_friction", "times"];

    fn word(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Held => "held",
            Self::Driven(_) => "driven",
        }
    }
}

/// A wheel in a body, or a stack of wheels: a record of its numbers, which is also a load.
///
/// Made by :func:`polhode.wheel`, and with a motor and friction by :func:`polhode.loads.wheel`.
/// :meth:`RigidBody.gyrostat` takes it in `wheels`; wherever a load is expected it acts as one, alone or in a
/// sum. It is not multiplied by a factor.
///
/// Attributes
/// ----------
/// axis : numpy.ndarray, shape (..., 3)
///     Axis a of the wheel, in the body frame; only the direction counts.
/// inertia : float or numpy.ndarray, shape (...)
///     Moment of inertia J of the wheel about its axis.
/// rate : float or numpy.ndarray, shape (...)
///     Rate Ω relative to the body at the start, in radians per unit of time. NaN if J is zero, and for a speed
///     that is given at times.
/// momentum : float or numpy.ndarray, shape (...)
///     J Ω at the start.
/// mode : {"free", "held", "driven"}
///     ``"free"``: the momentum of the wheel along its axis, ``J (Ω + a·ω)``, is constant. ``"held"``: its
///     rate Ω relative to the body is constant. ``"driven"``: a motor, friction or a speed that changes acts.
/// motor : float, numpy.ndarray, Load or None
///     Torque τ of the motor, the argument `torque` of :func:`polhode.loads.wheel`.
/// speed, times, friction, dry_friction, max_torque, max_momentum, max_rate, allocation : float, numpy.ndarray or None
///     As :func:`polhode.loads.wheel` takes them; each None where it is not given.
/// name : str
///     Name of its state in ``states`` of a trajectory.
///
/// Examples
/// --------
/// >>> import polhode
/// >>> body = polhode.RigidBody.from_principal(mass=1.0, moments=(1.0, 2.0, 2.5))
/// >>> wheel = polhode.wheel(axis=(0, 1, 0), inertia=0.1, rate=50.0)
/// >>> exact = body.gyrostat(wheels=[wheel]).free_motion((0.1, 0.2, 0.3)).at([0.0, 5.0])
/// >>> run = body.simulate([0.0, 5.0], (0.1, 0.2, 0.3), load=wheel)
/// >>> abs(exact.omega - run.omega).max() < 1e-12
/// np.True_
#[pyclass(name = "Wheel", module = "polhode", extends = PyLoad, frozen)]
pub(crate) struct PyWheel {
    pub(crate) axis: Stack<Vector3<f64>>,
    pub(crate) inertia: Stack<f64>,
    pub(crate) momentum: Stack<f64>,
    rate: Stack<f64>,
    pub(crate) turns: Turns,
}

impl PyWheel {
    /// With the momentum J Ω.
    fn of(
        py: Python<'_>,
        axis: Stack<Vector3<f64>>,
        inertia: Stack<f64>,
        rate: Stack<f64>,
        turns: Turns,
    ) -> PyResult<Self> {
        let momentum = Broadcast::of(["inertia", "rate"], [&inertia.shape, &rate.shape])?
            .try_map(py, |[j, w]| Ok(inertia[j] * rate[w]))?;
        Ok(Self {
            axis,
            inertia,
            momentum,
            rate,
            turns,
        })
    }

    fn acting(self, py: Python<'_>, load: PyLoad) -> PyResult<Py<Self>> {
        Py::new(py, PyClassInitializer::from(load).add_subclass(self))
    }
}

/// The rows of a stack of `shape` that are picked, of numbers that broadcast to it.
fn pick<T: Clone + Send + Sync>(
    py: Python<'_>,
    numbers: &Stack<T>,
    shape: &[usize],
    rows: &Stack<i64>,
) -> PyResult<Stack<T>> {
    let grid = Broadcast::of(["wheel", "wheel"], [shape, &numbers.shape])?;
    rows.map(py, |&row| numbers[grid.operands(to_index(row))[1]].clone())
}

#[pymethods]
impl PyWheel {
    /// Axis a of the wheel, in the body frame, shape (..., 3); only the direction counts.
    #[getter]
    fn axis<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(write(py, &self.axis)?.into_any())
    }

    /// Moment of inertia J of the wheel about its axis.
    #[getter]
    fn inertia<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        write_numbers(py, &self.inertia)
    }

    /// J Ω at the start, where Ω is the rate of the wheel relative to the body.
    #[getter]
    fn momentum<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        write_numbers(py, &self.momentum)
    }

    /// Rate Ω relative to the body at the start, in radians per unit of time. NaN if J is zero, and for a speed
    /// that is given at times.
    #[getter]
    fn rate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        write_numbers(py, &self.rate)
    }

    /// How the wheel turns: "free", "held" at a constant rate, or "driven" by a motor, by friction or by a speed that
    /// changes.
    #[getter]
    fn mode(&self) -> &'static str {
        self.turns.word()
    }

    /// Name of its state in ``states`` of a trajectory.
    #[getter]
    fn name(slf: &Bound<'_, Self>) -> String {
        let part = slf.as_super().get().parts.first();
        part.and_then(|part| part.name.as_deref())
            .unwrap_or("wheel")
            .to_owned()
    }

    /// Torque of the motor that was given to `loads.wheel`; None where none was. Its method `torque` is that of a load.
    #[getter]
    fn motor(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "torque")
    }

    /// Rate Ω that was given, a constant or values at `times`; None where none was.
    #[getter]
    fn speed(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "speed")
    }

    /// Times of the torque or of the speed; None where none were given.
    #[getter]
    fn times(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "times")
    }

    /// Coefficient of viscous friction in the bearing; None where none was given.
    #[getter]
    fn friction(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "friction")
    }

    /// Torque of dry friction in the bearing; None where none was given.
    #[getter]
    fn dry_friction(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "dry_friction")
    }

    /// Largest torque of the motor; None where none was given.
    #[getter]
    fn max_torque(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "max_torque")
    }

    /// Largest ``J Ω``; None where none was given.
    #[getter]
    fn max_momentum(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "max_momentum")
    }

    /// Largest rate Ω; None where none was given.
    #[getter]
    fn max_rate(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "max_rate")
    }

    /// Row of the allocation that the motor follows; None where none was given.
    #[getter]
    fn allocation(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "allocation")
    }

    /// A wheel without motor and friction, of numbers that `polhode.wheel` has checked.
    ///
    /// One without moment is a rotor where it acts as a load: its momentum is constant in the body.
    #[staticmethod]
    fn _of(
        py: Python<'_>,
        axis: &Bound<'_, PyAny>,
        inertia: &Bound<'_, PyAny>,
        rate: &Bound<'_, PyAny>,
        momentum: &Bound<'_, PyAny>,
        mode: &str,
        name: &str,
    ) -> PyResult<Py<Self>> {
        let moments: Stack<f64> = read(inertia, "inertia")?;
        let momenta: Stack<f64> = read(momentum, "momentum")?;
        let massless = moments.rows.iter().filter(|moment| **moment == 0.0).count();
        let is_held = mode == "held";
        if massless == 0 {
            let (rate, speed) = if is_held {
                (None, Some(rate))
            } else {
                (Some(rate), None)
            };
            let made = wheel(
                py, axis, inertia, rate, None, speed, None, None, None, None, None, None, None,
                name,
            )?;
            let (load, made) = (made.bind(py).as_super().get(), made.get());
            let numbers = Self {
                axis: made.axis.clone(),
                inertia: moments,
                momentum: momenta, // to the last bit
                rate: made.rate.clone(),
                turns: made.turns,
            };
            return numbers.acting(py, load.clone_ref(py));
        }
        if massless < moments.rows.len() {
            return Err(PyValueError::new_err(format!(
                "inertia: {massless} of the {} wheels of a stack have no moment, which are rotors, and the others have one; \
                 make two wheels",
                moments.rows.len()
            )));
        }
        check_name(name)?;
        let axis: Stack<Vector3<f64>> = read(axis, "axis")?;
        let shapes = [&axis.shape[..], &moments.shape, &momenta.shape];
        let inside = Broadcast::of(["axis", "inertia", "momentum"], shapes)?
            .try_map(py, |[a, _, h]| {
                Ok((axis[a] / axis[a].amax()).normalize() * momenta[h])
            })?;
        let terms = try_rows(py, &inside, |h| Rotor::new(h).map(Term::Rotor))?;
        let recipe = recipe(py, "rotor", (write(py, &inside)?,))?;
        let numbers = Self {
            rate: momenta.map(py, |_| f64::NAN)?,
            axis,
            inertia: moments,
            momentum: momenta,
            turns: if is_held { Turns::Held } else { Turns::Free },
        };
        numbers.acting(
            py,
            PyLoad::one(LoadPart::Term(terms.into()), recipe).with_name(name),
        )
    }

    fn __getitem__(slf: &Bound<'_, Self>, key: &Bound<'_, PyAny>) -> PyResult<Py<Self>> {
        let (py, this, load) = (slf.py(), slf.get(), slf.as_super().get());
        let shape = load.stack_shape()?;
        let picked = picked_by(py, &shape, key)?;
        let rows = Stack {
            shape: picked.shape().to_vec(),
            rows: picked.as_slice()?.to_vec(),
        };
        let numbers = Self {
            axis: pick(py, &this.axis, &shape, &rows)?,
            inertia: pick(py, &this.inertia, &shape, &rows)?,
            momentum: pick(py, &this.momentum, &shape, &rows)?,
            rate: pick(py, &this.rate, &shape, &rows)?,
            turns: this.turns,
        };
        numbers.acting(py, load.map(|part| part.pick(py, &shape, key))?)
    }

    /// The load that it is, as its parts, and its numbers; for pickle.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, this) = (slf.py(), slf.get());
        let load = slf.as_super().get();
        let parts: Vec<_> = load.parts.iter().map(|part| part.recipe.bind(py)).collect();
        let turns = match this.turns {
            Turns::Driven(by) => by,
            turns => turns.word(),
        };
        let restore = py.get_type::<Self>().getattr("_from_parts")?;
        let numbers = [
            parts.into_pyobject(py)?,
            write(py, &this.axis)?.into_any(),
            write(py, &this.inertia)?.into_any(),
            write(py, &this.momentum)?.into_any(),
            write(py, &this.rate)?.into_any(),
            PyString::new(py, turns).into_any(),
            PyString::new(py, &Self::name(slf)).into_any(),
        ];
        Ok((restore, PyTuple::new(py, numbers)?))
    }

    /// The wheel that `__reduce__` took apart.
    #[staticmethod]
    #[expect(clippy::too_many_arguments, reason = "as `__reduce__` has them")]
    fn _from_parts(
        py: Python<'_>,
        parts: Vec<Bound<'_, PyTuple>>,
        axis: &Bound<'_, PyAny>,
        inertia: &Bound<'_, PyAny>,
        momentum: &Bound<'_, PyAny>,
        rate: &Bound<'_, PyAny>,
        turns: &str,
        name: &str,
    ) -> PyResult<Py<Self>> {
        let numbers = Self {
            axis: read(axis, "axis")?,
            inertia: read(inertia, "inertia")?,
            momentum: read(momentum, "momentum")?,
            rate: read(rate, "rate")?,
            turns: match (turns, Turns::DRIVEN.iter().find(|by| **by == turns)) {
                (_, Some(by)) => Turns::Driven(by),
                ("held", _) => Turns::Held,
                _ => Turns::Free,
            },
        };
        numbers.acting(py, PyLoad::of_recipes(py, parts)?.with_name(name))
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// Whether all numbers are equal; one with a motor or friction is equal to itself alone.
    fn __eq__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> bool {
        let Ok(other) = other.cast::<Self>() else {
            return false;
        };
        let (this, that) = (slf.get(), other.get());
        slf.is(other)
            || !matches!(this.turns, Turns::Driven(_))
                && this.turns == that.turns
                && this.axis == that.axis
                && this.inertia == that.inertia
                && this.momentum == that.momentum
                && Self::name(slf) == Self::name(other)
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.turns.hash(&mut hasher);
        for axis in &self.axis.rows {
            for x in axis {
                (x + 0.0).to_bits().hash(&mut hasher); // zeros of both signs are equal
            }
        }
        hasher.finish()
    }

    /// One wheel by its numbers; a stack by its shape.
    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        let (this, shape) = (slf.get(), slf.as_super().get().stack_shape()?);
        let mode = this.turns.word();
        if !shape.is_empty() {
            return Ok(format!("<Wheel stack of shape {}: {mode}>", tuple(&shape)));
        }
        let [x, y, z]: [f64; 3] = this.axis[0].into();
        let (inertia, momentum) = (this.inertia[0], this.momentum[0]);
        Ok(format!(
            "<Wheel: {mode}, axis=[{x:?}, {y:?}, {z:?}], inertia={inertia:?}, momentum={momentum:?}>"
        ))
    }
}

/// An argument of the function that made it; of a stack that was indexed, the rows that were picked.
fn option(wheel: &Bound<'_, PyWheel>, name: &str) -> PyResult<Option<Py<PyAny>>> {
    let py = wheel.py();
    let Some(part) = wheel.as_super().get().parts.first() else {
        return Ok(None);
    };
    let steps = unfold(part.recipe.bind(py))?;
    let arguments = &steps[0].1;
    let last = arguments.get_item(arguments.len().saturating_sub(1))?;
    let Ok(options) = last.cast::<PyDict>() else {
        return Ok(None);
    };
    let given = |name: &str| -> PyResult<Option<Bound<'_, PyAny>>> {
        Ok(options.get_item(name)?.filter(|value| !value.is_none()))
    };
    let Some(mut value) = given(name)? else {
        return Ok(None);
    };
    let is_table = given("times")?.is_some() && ["torque", "speed", "times"].contains(&name);
    for (_, picked) in steps.iter().filter(|(step, _)| step == "_picked") {
        let (shape, key) = (
            picked.get_item(1)?.extract::<Vec<usize>>()?,
            picked.get_item(2)?,
        );
        if let Ok(load) = value.cast::<PyLoad>() {
            let load = load.get().map(|part| part.pick(py, &shape, &key))?;
            value = load.into_pyobject(py)?.into_any();
        } else if value.hasattr("dtype")? && !is_table {
            let every = numpy(py)?.call_method1("broadcast_to", (value, shape))?;
            value = every.get_item(key)?;
        }
    }
    if value.hasattr("dtype")? {
        value = numpy(py)?.call_method1("array", (value,))?.get_item(())?; // which may be changed
    }
    Ok(Some(value.unbind()))
}

/// A wheel in the body, with a motor and friction in its bearing.
///
/// Its state is its angular momentum about its axis a, ``h = J (Ω + a·ω)``, where Ω is its rate relative to
/// the body. The inertia of the body includes the wheel as if it were locked. The equation of the wheel is
/// ``ḣ = τ - c Ω - c₀ sign(Ω)``, where τ is the torque of the motor on the wheel. On the rest of the body,
/// whose tensor is ``I - J a aᵀ``, the wheel exerts the torque ``-a ḣ - ω × h a``. If ``speed`` is given in
/// place of ``torque``, the motor exerts the torque that this speed needs.
///
/// Parameters
/// ----------
/// axis : array_like, shape (..., 3)
///     a in the body frame, of any length.
/// inertia : array_like, shape (...)
///     J about the axis. ``I - J a aᵀ`` must have positive moments.
/// rate : array_like, shape (...), optional
///     Ω at the start; zero by default.
/// torque : float, array_like of shape (n,), or Load, optional
///     Torque τ of the motor on the wheel: a constant; values at `times`, each of which is held until the
///     next; or a load as a controller. The motor then exerts on the body the component along a of the torque of
///     that load, ``τ = -a·N``. A controller is a :func:`feedback`, or any load that exerts a torque alone: a
///     function (:func:`torque_callback`), a sampled controller (:func:`with_states` with `update`), and sums and
///     schedules of these. Its states stand behind those of the wheels. Wheels that are given the same object
///     follow one controller, which is asked once for all of them.
/// speed : array_like, shape (...) or (n,), optional
///     Rate Ω, in radians per unit of time: a constant, or values at `times` with straight lines in between.
/// times : array_like, shape (n,), optional
///     Times of `torque` or `speed`, ascending. A torque is not defined before the first of them; a speed is
///     defined only from the first to the last.
/// friction : array_like, shape (...), optional
///     Coefficient c of viscous friction: torque divided by rate. Not together with `speed`.
/// dry_friction : array_like, shape (...), optional
///     Torque c₀ of dry friction (Coulomb's law): it is against the rate and does not depend on its size. Not
///     together with `speed`. While the wheel is at rest, friction exerts the torque that keeps it at rest;
///     if that were larger than c₀, the wheel begins to slip. The method "auto" is then "dop853", which finds
///     the times of stop and slip. The run must go forward in time.
/// max_torque : array_like, shape (...), optional
///     Largest ``|τ|`` of the motor: a larger torque, given or asked for, is clipped.
///     :meth:`polhode.Event.limit` is where that begins and ends.
/// max_momentum, max_rate : array_like, shape (...), optional
///     Largest ``|J Ω|`` and largest ``|Ω|`` of the wheel; the smaller limit holds if both are given. A wheel that
///     comes to its limit stays there as long as the motor is asked for more: the motor exerts what keeps the rate.
///     The run goes on, and must go forward in time. :meth:`polhode.Event.rate_limit` and
///     :meth:`polhode.Event.momentum_limit` are the times at which a wheel comes to its limit and leaves it.
/// allocation : array_like, shape (..., 3), optional
///     Vector m of a motor that follows a controller: ``τ = -m·N`` in place of ``-a·N``. :func:`wheels` finds it
///     for a set of wheels.
/// name : str, optional
///     Name of its state in ``states`` of the trajectory. If several have the same name, the second becomes
///     ``wheel_2``, and so on.
///
/// Returns
/// -------
/// Wheel
///     A load, and a record of its numbers. :meth:`polhode.RigidBody.gyrostat` takes it too, if it has no
///     motor, no friction and no speed that changes.
///
/// Notes
/// -----
/// With a limit, dry friction, an allocation, or a controller other than a feedback, the method "auto" is "dop853".
/// The friction of Stribeck, which falls with the rate, is not modelled.
///
/// See Also
/// --------
/// wheels : a set of wheels that share the torque of a controller.
/// rotor : a momentum that stays constant.
/// polhode.wheel : a wheel that turns freely or at a constant rate.
///
/// Examples
/// --------
/// A wheel is spun up, and the body turns in the opposite sense; the total angular momentum stays zero:
///
/// >>> from polhode import RigidBody, loads
/// >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
/// >>> wheel = loads.wheel(axis=(0, 0, 1), inertia=0.5, torque=0.1)
/// >>> motion = body.simulate([0, 10], omega=(0, 0, 0), load=wheel)
/// >>> (momentum,) = motion.states.values()
/// >>> motion.omega[-1].round(9), momentum[-1].round(9)
/// (array([ 0. ,  0. , -0.5]), array([1.]))
#[pyfunction]
#[pyo3(
    signature = (axis, inertia, rate=None, *, torque=None, speed=None, times=None, friction=None,
                 dry_friction=None, max_torque=None, max_momentum=None, max_rate=None, allocation=None,
                 name="wheel")
)]
#[expect(
    clippy::too_many_arguments,
    clippy::too_many_lines,
    reason = "keyword arguments in Python"
)]
pub(crate) fn wheel(
    py: Python<'_>,
    axis: &Bound<'_, PyAny>,
    inertia: &Bound<'_, PyAny>,
    rate: Option<&Bound<'_, PyAny>>,
    torque: Option<&Bound<'_, PyAny>>,
    speed: Option<&Bound<'_, PyAny>>,
    times: Option<&Bound<'_, PyAny>>,
    friction: Option<&Bound<'_, PyAny>>,
    dry_friction: Option<&Bound<'_, PyAny>>,
    max_torque: Option<&Bound<'_, PyAny>>,
    max_momentum: Option<&Bound<'_, PyAny>>,
    max_rate: Option<&Bound<'_, PyAny>>,
    allocation: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
) -> PyResult<Py<PyWheel>> {
    check_name(name)?;
    let limits = [
        ("max_torque", max_torque),
        ("max_momentum", max_momentum),
        ("max_rate", max_rate),
    ];
    for (what, given) in limits {
        if given.is_some() && torque.is_none() {
            return Err(PyTypeError::new_err(format!(
                "{what}: it is a limit of a motor; give the motor a torque= too"
            )));
        }
    }
    if allocation.is_some() && !torque.is_some_and(PyAnyMethods::is_instance_of::<PyLoad>) {
        return Err(PyTypeError::new_err(
            "allocation: it is that of a motor that follows a controller: torque=loads.feedback(...)",
        ));
    }
    if speed.is_some() {
        for (what, given) in [
            ("rate", rate),
            ("torque", torque),
            ("friction", friction),
            ("dry_friction", dry_friction),
        ] {
            if given.is_some() {
                return Err(PyTypeError::new_err(format!(
                    "{what}: not beside speed=, which says what the wheel does"
                )));
            }
        }
    }
    let drive = match (torque, speed) {
        (_, Some(speed)) if times.is_some() => {
            Stack::one((Drive::Speed(read_drive("speed", speed, times)?), None))
        }
        (_, Some(speed)) => {
            let constant = |speed: &f64| {
                PiecewiseSignal::constant("speed", *speed).map(|held| (Drive::Speed(held), None))
            };
            try_rows(py, &read::<f64>(speed, "speed")?, constant)?
        }
        (None, None) => Stack::one((Drive::Torque(no_drive(py, times)?), None)),
        (Some(torque), None) => match torque.cast::<PyLoad>() {
            Ok(load) => read_controller(py, load.get(), times)?,
            Err(_) => Stack::one((Drive::Torque(read_drive("torque", torque, times)?), None)),
        },
    };
    let axis: Stack<Vector3<f64>> = read(axis, "axis")?;
    let inertia: Stack<f64> = read(inertia, "inertia")?;
    let or_zero = |given: Option<&Bound<'_, PyAny>>, name| {
        given.map_or_else(|| Ok(Stack::one(0.0)), |given| read::<f64>(given, name))
    };
    let (rates, frictions) = (or_zero(rate, "rate")?, or_zero(friction, "friction")?);
    let dry_frictions = or_zero(dry_friction, "dry_friction")?;
    let or_none = |given: Option<&Bound<'_, PyAny>>, name| {
        given.map_or_else(
            || Ok(Stack::one(None)),
            |given| read::<f64>(given, name)?.map(py, |x| Some(*x)),
        )
    };
    let [max_torques, max_momenta, max_rates] = limits.map(|(what, given)| or_none(given, what));
    let (max_torques, max_momenta, max_rates) = (max_torques?, max_momenta?, max_rates?);
    let rows: Stack<Option<Vector3<f64>>> = match allocation {
        None => Stack::one(None),
        Some(given) => read::<Vector3<f64>>(given, "allocation")?.map(py, |row| Some(*row))?,
    };
    let names = [
        "axis",
        "inertia",
        "rate",
        "friction",
        "dry_friction",
        "torque",
        "max_torque",
        "max_momentum",
        "max_rate",
        "allocation",
    ];
    let shapes = [
        &axis.shape[..],
        &inertia.shape,
        &rates.shape,
        &frictions.shape,
        &dry_frictions.shape,
        &drive.shape,
        &max_torques.shape,
        &max_momenta.shape,
        &max_rates.shape,
        &rows.shape,
    ];
    let terms = Broadcast::of(names, shapes)?.try_map(py, |[a, j, w, c, c0, d, t, h, r, m]| {
        let (drive, controller) = drive[d].clone();
        let mut wheel = Wheel::new(&axis[a], inertia[j], rates[w], frictions[c], drive)?
            .with_dry_friction(dry_frictions[c0])?;
        if let Some(torque) = max_torques[t] {
            wheel = wheel.with_max_torque(torque)?;
        }
        if let Some(momentum) = max_momenta[h] {
            wheel = wheel.with_max_momentum(momentum)?;
        }
        if let Some(rate) = max_rates[r] {
            wheel = wheel.with_max_rate(rate)?;
        }
        if let Some(row) = &rows[m] {
            wheel = wheel.with_allocation(row)?;
        }
        match controller {
            Some(controller) => Term::controlled(wheel, controller),
            None => Ok(Term::Wheel(wheel)),
        }
    })?;
    let number = |given: Option<_>, numbers: &Stack<f64>| {
        (given.map(|_: &Bound<'_, PyAny>| write_of(py, numbers, |x| *x))).transpose()
    };
    let options = PyDict::new(py);
    options.set_item("torque", keep(torque)?)?;
    options.set_item("speed", keep(speed)?)?;
    options.set_item("times", keep(times)?)?;
    options.set_item("friction", number(friction, &frictions)?)?;
    options.set_item("dry_friction", number(dry_friction, &dry_frictions)?)?;
    for (what, given) in limits {
        let numbers = given.map(|given| read::<f64>(given, what)).transpose()?;
        let kept = numbers
            .map(|numbers| write_of(py, &numbers, |x| *x))
            .transpose()?;
        options.set_item(what, kept)?;
    }
    options.set_item("allocation", keep(allocation)?)?;
    options.set_item("name", name)?;
    let moment = write_of(py, &inertia, |x| *x)?;
    let arguments = (write(py, &axis)?, moment, number(rate, &rates)?, options);
    let recipe = recipe(py, "wheel", arguments)?;
    let mut load = PyLoad::one(LoadPart::Term(terms.into()), recipe).with_name(name);
    if let Some(Ok(controller)) = torque.map(|torque| torque.cast::<PyLoad>())
        && !controller.get().is_analytic()
        && let Some(part) = load.parts.first_mut()
    {
        part.controller = Some(controller.clone().unbind());
    }
    let acts = |numbers: &Stack<f64>| numbers.rows.iter().any(|x| *x != 0.0);
    let turns = match speed {
        _ if torque.is_some() => Turns::Driven("torque"),
        _ if acts(&frictions) => Turns::Driven("friction"),
        _ if acts(&dry_frictions) => Turns::Driven("dry_friction"),
        Some(_) if times.is_some() => Turns::Driven("times"),
        Some(_) => Turns::Held,
        None => Turns::Free,
    };
    let rate = match speed {
        None => rates,
        Some(speed) if turns == Turns::Held => read(speed, "speed")?,
        Some(_) => Stack::one(f64::NAN), // that of the table at the start
    };
    PyWheel::of(py, axis, inertia, rate, turns)?.acting(py, load)
}

/// An argument as it is kept: a load, or a copy of numbers.
fn keep<'py>(given: Option<&Bound<'py, PyAny>>) -> PyResult<Option<Bound<'py, PyAny>>> {
    given
        .map(|given| {
            if given.is_instance_of::<PyLoad>() {
                return Ok(given.clone());
            }
            copy_of(given)
        })
        .transpose()
}

register!(Wheel by wheel);

/// No torque.
fn no_drive(py: Python<'_>, times: Option<&Bound<'_, PyAny>>) -> PyResult<PiecewiseSignal> {
    if times.is_some() {
        return Err(PyTypeError::new_err("times: give torque= or speed= too"));
    }
    PiecewiseSignal::constant("torque", 0.0).map_err(|error| to_py(py, &error))
}

/// A number, or one for each of the times.
fn read_drive(
    what: &'static str,
    given: &Bound<'_, PyAny>,
    times: Option<&Bound<'_, PyAny>>,
) -> PyResult<PiecewiseSignal> {
    let py = given.py();
    let values = floats(given, what)?;
    let made = match times {
        None if values.ndim() == 0 => PiecewiseSignal::constant(what, values.as_slice()?[0]),
        None => {
            return Err(PyTypeError::new_err(format!(
                "{what}: expected one number, got {} of them; give the times= from which each holds",
                values.len()
            )));
        }
        Some(times) => {
            let times = list_floats(times, "times", "n", &[])?;
            let values = list_floats(given, what, "n", &[])?;
            if times.len() != values.len() {
                return Err(PyValueError::new_err(format!(
                    "{what}: expected one for each of the {} times, got {}",
                    times.len(),
                    values.len()
                )));
            }
            PiecewiseSignal::table(what, times.as_slice()?, values.as_slice()?)
        }
    };
    made.map_err(|error| to_py(py, &error))
}

/// What a motor does, and the terms of the controller that it follows.
type Motor = (Drive, Option<Vec<Term>>);

/// The analytic terms of a controller, which exerts a torque alone.
pub(super) fn controller_terms(py: Python<'_>, load: &PyLoad) -> PyResult<Stack<Vec<Term>>> {
    if load.thrusters().next().is_some() {
        return Err(to_py(py, &MotionFault::NoController.into()));
    }
    load.terms(py)
}

/// What a controller asks of a motor: a feedback alone has a series, the terms of others are asked one by one.
fn read_controller(
    py: Python<'_>,
    load: &PyLoad,
    times: Option<&Bound<'_, PyAny>>,
) -> PyResult<Stack<Motor>> {
    if times.is_some() {
        return Err(PyTypeError::new_err(
            "times: not beside a controller; loads.schedule(...) makes one that acts at times",
        ));
    }
    let terms = controller_terms(py, load)?;
    let is_feedback =
        load.is_analytic() && (terms.rows.iter()).all(|row| matches!(row[..], [Term::Feedback(_)]));
    let motors = terms.rows.into_iter().map(|mut row| match row.pop() {
        Some(Term::Feedback(law)) if is_feedback => (Drive::Feedback(law), None),
        last => {
            row.extend(last);
            (Drive::Controller, Some(row))
        }
    });
    Ok(Stack {
        shape: terms.shape,
        rows: motors.collect(),
    })
}

/// A set of wheels whose motors share the torque that a controller asks for.
///
/// The motors exert ``τ = -M N``, where N is the torque of the controller on the body and M, with a row for each wheel,
/// is the allocation. On the body they exert ``-A τ``, with the axes, of unit length, as the columns of A. Three
/// wheels at right angles need no allocation; wheels that each take the component of N along their own axis exert
/// ``A Aᵀ N``, which for four wheels is not N.
///
/// Parameters
/// ----------
/// axes : array_like, shape (n, 3)
///     Axes of the wheels, in the body frame; only the directions count.
/// inertias : array_like, shape () or (n,)
///     Moments of inertia J about the axes.
/// torque : Load
///     A controller, as :func:`wheel` takes it. It is asked once for all wheels.
/// allocation : str or array_like, shape (n, 3)
///     M. ``"pseudo-inverse"`` is the one with the least sum of the squares of the torques of the motors. A given one must
///     obey ``A M A = A``, so that the body gets the torque N, or its part within the span of the axes.
/// rate, friction, dry_friction, max_torque, max_momentum, max_rate : array_like, shape () or (n,), optional
///     As of :func:`wheel`, for all wheels or for each.
/// name : str, optional
///     Name of the states. That of the first wheel is the name, the second one has ``wheel_2``, and so on.
///
/// Returns
/// -------
/// Load
///     The sum of the wheels.
///
/// Examples
/// --------
/// A pyramid of four wheels turns a satellite; the body feels the torque of the controller alone:
///
/// >>> import numpy as np
/// >>> from polhode import RigidBody, loads
/// >>> body = RigidBody.from_principal(90.0, (8.0, 9.0, 10.0))
/// >>> axes = [(1, 0, 1), (0, 1, 1), (-1, 0, 1), (0, -1, 1)]
/// >>> control = loads.feedback(K=0.5, D=3.0)
/// >>> wheels = loads.wheels(axes, 0.02, torque=control, max_torque=0.5)
/// >>> motion = body.simulate([0, 60], (0, 0, 0), (0, 0, 0.28, 0.96), load=wheels)
/// >>> print(*motion.states, bool(motion.rotation[-1].magnitude() < 1e-3))
/// wheel wheel_2 wheel_3 wheel_4 True
#[pyfunction]
#[pyo3(signature = (axes, inertias, *, torque, allocation=None, rate=None, friction=None, dry_friction=None,
                   max_torque=None, max_momentum=None, max_rate=None, name="wheel"),
       text_signature = "(axes, inertias, *, torque, allocation=\"pseudo-inverse\", rate=None, friction=None, dry_friction=None, max_torque=None, max_momentum=None, max_rate=None, name=\"wheel\")")]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub(crate) fn wheels(
    py: Python<'_>,
    axes: &Bound<'_, PyAny>,
    inertias: &Bound<'_, PyAny>,
    torque: &Bound<'_, PyAny>,
    allocation: Option<&Bound<'_, PyAny>>,
    rate: Option<&Bound<'_, PyAny>>,
    friction: Option<&Bound<'_, PyAny>>,
    dry_friction: Option<&Bound<'_, PyAny>>,
    max_torque: Option<&Bound<'_, PyAny>>,
    max_momentum: Option<&Bound<'_, PyAny>>,
    max_rate: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
) -> PyResult<PyLoad> {
    if !torque.is_instance_of::<PyLoad>() {
        return Err(PyTypeError::new_err(format!(
            "torque: expected a controller, such as loads.feedback(...), got {}; a wheel with a torque of its own is made by \
             loads.wheel(axis, inertia, torque=...)",
            torque.get_type()
        )));
    }
    let axes: Stack<Vector3<f64>> = read_list(axes, "axes", "n")?;
    let count = axes.rows.len();
    let each = |given: Option<&Bound<'_, PyAny>>, what: &str| -> PyResult<Option<Vec<f64>>> {
        let Some(given) = given else {
            return Ok(None);
        };
        let numbers: Stack<f64> = read(given, what)?;
        match numbers.shape[..] {
            [] => Ok(Some(vec![numbers[0]; count])),
            [found] if found == count => Ok(Some(numbers.rows)),
            _ => Err(PyValueError::new_err(format!(
                "{what}: expected one number, or one for each of the {count} wheels, got the shape {}",
                tuple(&numbers.shape)
            ))),
        }
    };
    let rows = read_allocation(py, &axes.rows, allocation)?;
    let named = [
        ("inertias", Some(inertias)),
        ("rate", rate),
        ("friction", friction),
        ("dry_friction", dry_friction),
        ("max_torque", max_torque),
        ("max_momentum", max_momentum),
        ("max_rate", max_rate),
    ];
    let mut numbers = Vec::new();
    for (what, given) in named {
        numbers.push(each(given, what)?);
    }
    let mut all = PyLoad::default();
    for (index, (axis, row)) in axes.rows.iter().zip(rows).enumerate() {
        let of = |which: usize| -> Option<Bound<'_, PyAny>> {
            let values = numbers[which].as_ref()?;
            Some(PyFloat::new(py, values[index]).into_any())
        };
        let axis = write(py, &Stack::one(*axis))?.into_any();
        let row = write(py, &Stack::one(row))?.into_any();
        let inertia = of(0).unwrap_or_else(|| inertias.clone());
        let made = wheel(
            py,
            &axis,
            &inertia,
            of(1).as_ref(),
            Some(torque),
            None,
            None,
            of(2).as_ref(),
            of(3).as_ref(),
            of(4).as_ref(),
            of(5).as_ref(),
            of(6).as_ref(),
            Some(&row),
            name,
        )?;
        all = all.plus(py, made.bind(py).as_super().get())?;
    }
    Ok(all)
}

/// How far A M A may be from A, for an allocation of few digits.
const RIGHT_INVERSE: f64 = 1e-6;

/// The rows of the allocation of wheels about these axes: the pseudo-inverse, or a given one that does what it is for.
fn read_allocation(
    py: Python<'_>,
    axes: &[Vector3<f64>],
    given: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<Vector3<f64>>> {
    let best = allocation(axes).map_err(|error| to_py(py, &error))?;
    let Some(given) = given else {
        return Ok(best);
    };
    if let Ok(word) = given.cast::<PyString>() {
        return if word.to_cow()? == "pseudo-inverse" {
            Ok(best)
        } else {
            Err(PyValueError::new_err(format!(
                "allocation: expected \"pseudo-inverse\" or an array of shape (n, 3), got \"{}\"",
                word.to_cow()?
            )))
        };
    }
    let rows: Stack<Vector3<f64>> = read_list(given, "allocation", "n")?;
    if rows.rows.len() != axes.len() {
        return Err(PyValueError::new_err(format!(
            "allocation: expected a row for each of the {} wheels, shape ({}, 3), got shape ({}, 3)",
            axes.len(),
            axes.len(),
            rows.rows.len()
        )));
    }
    let off = allocation_error(axes, &rows.rows);
    if off.is_nan() || off > RIGHT_INVERSE {
        return Err(PyValueError::new_err(format!(
            "allocation: with these rows M and the axes A, of unit length, as columns, A M A must be A, so that the body gets the torque that \
             is asked for; it is off by {off:.3e}. allocation=\"pseudo-inverse\" finds M; a wheel that takes any other share is \
             loads.wheel(axis, inertia, torque=controller, allocation=row)"
        )));
    }
    Ok(rows.rows)
}
