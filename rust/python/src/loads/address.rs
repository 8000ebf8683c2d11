//! Loads that are compiled functions: the one place where a foreign address is called.
#![allow(unsafe_code)]

use std::ffi::c_void;
use std::mem::MaybeUninit;

use nalgebra::Vector3;
use polhode::motion::loads::{Windows, Wrench};
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyCapsuleMethods, PyInt, PyTuple};

use super::callbacks::MOST_STATES;

/// `void f(double t, const double state[13 + k], double out[6 + k], void *user_data)`, with k states of its own.
type Function = unsafe extern "C" fn(f64, *const f64, *mut f64, *mut c_void);

/// What a function is called with: body, states of its own, and room for all that a load may have.
pub(super) type StateNumbers = [f64; 13 + MOST_STATES];

/// Those numbers before a function is called.
pub(super) const NO_NUMBERS: StateNumbers = [0.0; 13 + MOST_STATES];

/// A compiled function as a term of a load.
pub(super) struct Compiled {
    function: Function,
    user_data: *mut c_void,
    /// What the address belongs to, which must live as long.
    owner: Py<PyAny>,
    pub(super) factor: f64,
    /// Its own states at the start, and what counts as large of each.
    pub(super) initial: Vec<f64>,
    pub(super) scale: Vec<f64>,
    /// When it acts; always, where there are none.
    pub(super) windows: Option<Windows>,
}

// SAFETY: whoever passes an address to `loads.compiled` states that the function may be called from several threads at once
// with the same user data.
unsafe impl Send for Compiled {}
// SAFETY: as above.
unsafe impl Sync for Compiled {}

impl Compiled {
    /// The function at the address that an object of Python stands for.
    ///
    /// # Errors
    /// `TypeError` or `ValueError` where it stands for none.
    pub(super) fn new(
        function: &Bound<'_, PyAny>,
        user_data: Option<usize>,
        (initial, scale): (Vec<f64>, Vec<f64>),
    ) -> PyResult<Self> {
        let (address, own_data) = address(function)?;
        if address == 0 {
            return Err(PyValueError::new_err("function: the address is 0"));
        }
        let user_data = user_data.map_or(own_data, |data| data as *mut c_void);
        // SAFETY: a pointer that is not null may become one to a function; that one of this signature lives there is stated
        // by whoever passes the address.
        let called =
            unsafe { std::mem::transmute::<*const c_void, Function>(address as *const c_void) };
        Ok(Self {
            function: called,
            user_data,
            owner: function.clone().unbind(),
            factor: 1.0,
            initial,
            scale,
            windows: None,
        })
    }

    pub(super) fn owner(&self) -> &Py<PyAny> {
        &self.owner
    }

    pub(super) fn clone_ref(&self, py: Python<'_>) -> Self {
        Self {
            owner: self.owner.clone_ref(py),
            windows: self.windows.clone(),
            initial: self.initial.clone(),
            scale: self.scale.clone(),
            ..*self
        }
    }

    /// What the function says at a time and a state; the rates of its own states, which are `own`, into `rates`. The state is written
    /// into `state`, which is zero beyond the states of its own.
    // By itself: who calls Python instead, perhaps run within run, has no room for these numbers on its stack.
    #[inline(never)]
    pub(super) fn call(
        &self,
        t: f64,
        phase: &Phase,
        own: &[f64],
        rates: &mut [f64],
        state: &mut StateNumbers,
    ) -> Wrench {
        let (body, own_states) = state.split_at_mut(13);
        body.copy_from_slice(&phase.numbers());
        for (place, number) in own_states.iter_mut().zip(own) {
            *place = *number;
        }
        // Only numbers that are read are written first: zeros in all the room would take as long as a short function.
        let mut out = [MaybeUninit::<f64>::uninit(); 6 + MOST_STATES];
        let (wrench, own_rates) = out.split_at_mut(6);
        wrench.fill(MaybeUninit::new(0.0));
        for place in &mut own_rates[..rates.len()] {
            place.write(0.0);
        }
        // SAFETY: whoever passed the address to `loads.compiled` states that a function of this signature lives there, which
        // reads 13 numbers of `state` and its own states and writes 6 to `out` and their rates, and nothing else that is ours; `owner`
        // keeps it alive.
        unsafe {
            (self.function)(t, state.as_ptr(), out.as_mut_ptr().cast(), self.user_data);
        }
        // SAFETY: these numbers were written above, and perhaps again by the function.
        let number = |place: usize| unsafe { out[place].assume_init() };
        for (place, rate) in rates.iter_mut().enumerate() {
            *rate = number(6 + place);
        }
        let [fx, fy, fz, nx, ny, nz] = std::array::from_fn(|place| number(place) * self.factor);
        Wrench {
            force: Vector3::new(fx, fy, fz),
            torque: Vector3::new(nx, ny, nz),
        }
    }
}

/// The address of a function and its user data.
fn address(function: &Bound<'_, PyAny>) -> PyResult<(usize, *mut c_void)> {
    if let Ok(number) = function.cast::<PyInt>() {
        let address = number.extract().map_err(|_| {
            PyValueError::new_err(format!(
                "function: expected an address between 1 and {}, got {number}",
                usize::MAX
            ))
        })?;
        return Ok((address, std::ptr::null_mut()));
    }
    // scipy.LowLevelCallable is a tuple whose first item is a capsule with the signature for a name.
    if let Ok(tuple) = function.cast::<PyTuple>()
        && let Ok(first) = tuple.get_item(0)
        && let Ok(capsule) = first.cast::<PyCapsule>()
    {
        let name = capsule.name()?;
        // SAFETY: the name lives as long as the capsule, which does not change here.
        let name = name.map(|name| unsafe { name.as_cstr() });
        let signature = name.map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let bare = signature.replace("const", "").replace(' ', "");
        if bare != "void(double,double*,double*,void*)" {
            return Err(PyValueError::new_err(format!(
                "function: expected the signature \"void (double, double *, double *, void *)\", got \"{signature}\""
            )));
        }
        let address = capsule.pointer_checked(name)?.as_ptr() as usize;
        return Ok((address, capsule.context()?));
    }
    if let Some(address) = function.getattr_opt("address")?
        && let Ok(address) = address.extract()
    {
        return Ok((address, std::ptr::null_mut()));
    }
    Err(PyTypeError::new_err(format!(
        "function: expected a scipy.LowLevelCallable, an address or an object with one, got {}; wrap a Python function in \
         loads.callback",
        function.get_type()
    )))
}
