//! The class `Wheel`: a wheel in a body, which is a record and a load in one, and the function that makes those with a motor.

use std::hash::{DefaultHasher, Hash, Hasher};

use nalgebra::Vector3;
use numpy::PyUntypedArrayMethods;
use polhode::motion::loads::{Drive, PiecewiseSignal, Rotor, Term, Wheel};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};

use super::callbacks::check_name;
use super::load::{LoadPart, PyLoad};
use super::pickle_recipe::{recipe, unfold};
use super::registry::register;
use crate::arrays::{
    floats, list_floats, numpy, read, read_scalar, try_rows, write, write_numbers, write_of,
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
/// speed, times, friction, dry_friction, limit : float, numpy.ndarray or None
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

    /// Largest possible torque of a motor that follows a feedback; None where none was given.
    #[getter]
    fn limit(slf: &Bound<'_, Self>) -> PyResult<Option<Py<PyAny>>> {
        option(slf, "limit")
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
                py, axis, inertia, rate, None, speed, None, None, None, None, name,
            )?;
            let (load, made) = (made.bind(py).as_super().get(), made.get());
            let numbers = Self {
                axis: made.axis.clone(),
                inertia: moments,
                momentum: momenta, // to the last bit
                rate: made.rate.clone(),
                turns: made.turns,
            };
            return numbers.acting(py, load.clone_ref(py)?);
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
            PyLoad::one(LoadPart::Term(terms), recipe).with_name(name),
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
///     next; or a :func:`feedback`. The motor then exerts on the body the component along a of the torque of that
///     feedback.
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
/// limit : float, optional
///     Largest possible ``|τ|``, for a motor that follows a feedback. The method "auto" is then "dop853".
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
/// See Also
/// --------
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
#[pyo3(signature = (axis, inertia, rate=None, *, torque=None, speed=None, times=None, friction=None,
                   dry_friction=None, limit=None, name="wheel"))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
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
    #[pyo3(from_py_with = read_scalar)] limit: Option<f64>,
    #[pyo3(from_py_with = read_scalar)] name: &str,
) -> PyResult<Py<PyWheel>> {
    check_name(name)?;
    if limit.is_some() && !torque.is_some_and(PyAnyMethods::is_instance_of::<PyLoad>) {
        return Err(PyTypeError::new_err(
            "limit: it is that of a motor that follows a feedback: torque=loads.feedback(...)",
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
            Stack::one(Drive::Speed(read_drive("speed", speed, times)?))
        }
        (_, Some(speed)) => {
            let constant =
                |speed: &f64| PiecewiseSignal::constant("speed", *speed).map(Drive::Speed);
            try_rows(py, &read::<f64>(speed, "speed")?, constant)?
        }
        (None, None) => Stack::one(Drive::Torque(no_drive(py, times)?)),
        (Some(torque), None) => match torque.cast::<PyLoad>() {
            Ok(load) => read_feedback(py, load.get(), times, limit)?,
            Err(_) => Stack::one(Drive::Torque(read_drive("torque", torque, times)?)),
        },
    };
    let axis: Stack<Vector3<f64>> = read(axis, "axis")?;
    let inertia: Stack<f64> = read(inertia, "inertia")?;
    let or_zero = |given: Option<&Bound<'_, PyAny>>, name| {
        given.map_or_else(|| Ok(Stack::one(0.0)), |given| read::<f64>(given, name))
    };
    let (rates, frictions) = (or_zero(rate, "rate")?, or_zero(friction, "friction")?);
    let dry_frictions = or_zero(dry_friction, "dry_friction")?;
    let names = [
        "axis",
        "inertia",
        "rate",
        "friction",
        "dry_friction",
        "torque",
    ];
    let shapes = [
        &axis.shape[..],
        &inertia.shape,
        &rates.shape,
        &frictions.shape,
        &dry_frictions.shape,
        &drive.shape,
    ];
    let terms = Broadcast::of(names, shapes)?.try_map(py, |[a, j, w, c, c0, d]| {
        Wheel::new(
            &axis[a],
            inertia[j],
            rates[w],
            frictions[c],
            drive[d].clone(),
        )
        .and_then(|wheel| wheel.with_dry_friction(dry_frictions[c0]))
        .map(Term::Wheel)
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
    options.set_item("limit", limit)?;
    options.set_item("name", name)?;
    let moment = write_of(py, &inertia, |x| *x)?;
    let arguments = (write(py, &axis)?, moment, number(rate, &rates)?, options);
    let recipe = recipe(py, "wheel", arguments)?;
    let load = PyLoad::one(LoadPart::Term(terms), recipe).with_name(name);
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
            numpy(given.py())?.call_method1("array", (given, "float64"))
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

/// What a feedback asks of a motor.
fn read_feedback(
    py: Python<'_>,
    load: &PyLoad,
    times: Option<&Bound<'_, PyAny>>,
    limit: Option<f64>,
) -> PyResult<Stack<Drive>> {
    let refused = || {
        PyTypeError::new_err(
            "torque: expected a number, numbers with times=, or one loads.feedback(...) alone, not a sum, a scaled or scheduled one",
        )
    };
    if times.is_some() {
        return Err(PyTypeError::new_err("times: not beside a feedback"));
    }
    let terms = load.terms(py)?;
    if !load.is_analytic() || terms.rows.iter().any(|row| row.len() != 1) {
        return Err(refused());
    }
    let shape = terms.shape;
    let drives = terms.rows.into_iter().map(|mut row| match row.pop() {
        Some(Term::Feedback(law)) => Ok(match limit {
            Some(limit) => Drive::Limited(law, limit),
            None => Drive::Feedback(law),
        }),
        _ => Err(refused()),
    });
    Ok(Stack {
        shape,
        rows: drives.collect::<PyResult<_>>()?,
    })
}
