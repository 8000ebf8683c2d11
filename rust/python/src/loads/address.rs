//! Loads that are compiled functions: the one place where a foreign address is called.
#![allow(unsafe_code)]

use std::ffi::c_void;

use nalgebra::Vector3;
use polhode::motion::loads::{Windows, Wrench};
use polhode::motion::state::Phase;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyCapsuleMethods, PyInt, PyTuple};

use super::callbacks::MOST_STATES;

/// `void f(double t, const double state[13 + k], double out[6 + k], void *user_data)`, with k states of its own.
type Function = unsafe extern "C" fn(f64, *const f64, *mut f64, *mut c_void);

/// What a function reads and writes, with room for all states that a load may have.
pub(super) struct Exchange {
    /// Body and states of its own; zero beyond them.
    state: [f64; 13 + MOST_STATES],
    /// Force, torque and the rates of its states.
    out: [f64; 6 + MOST_STATES],
}

impl Exchange {
    /// Before a function is called.
    pub(super) const fn new() -> Self {
        Self {
            state: [0.0; 13 + MOST_STATES],
            out: [0.0; 6 + MOST_STATES],
        }
    }
}

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

    /// What the function says at a time and a state; the rates of its own states, which are `own`, into `rates`.
    // Numbers are read one by one: they were written just before, one by one, and a processor that reads two of them at once waits
    // until both are in the cache.
    #[inline(always)]
    pub(super) fn call(
        &self,
        t: f64,
        phase: &Phase,
        own: &[f64],
        rates: &mut [f64],
        exchange: &mut Exchange,
    ) -> Wrench {
        let Exchange { state, out } = exchange;
        let (q, w, r, v) = (
            &phase.attitude,
            &phase.omega,
            &phase.position,
            &phase.velocity,
        );
        let body = [
            &q.i, &q.j, &q.k, &q.w, &w.x, &w.y, &w.z, &r.x, &r.y, &r.z, &v.x, &v.y, &v.z,
        ];
        let (of_body, own_states) = state.split_at_mut(13);
        for (place, number) in of_body.iter_mut().zip(body) {
            *place = read(number);
        }
        for (place, number) in own_states.iter_mut().zip(own) {
            *place = *number;
        }
        out[..6].fill(0.0);
        out[6..][..rates.len()].fill(0.0);
        // SAFETY: whoever passed the address to `loads.compiled` states that a function of this signature lives there, which
        // reads 13 numbers of `state` and its own states and writes 6 to `out` and their rates, and nothing else that is ours; `owner`
        // keeps it alive.
        unsafe {
            (self.function)(t, state.as_ptr(), out.as_mut_ptr(), self.user_data);
        }
        for (rate, number) in rates.iter_mut().zip(&out[6..]) {
            *rate = *number;
        }
        let [fx, fy, fz, nx, ny, nz] = std::array::from_fn(|place| read(&out[place]) * self.factor);
        Wrench {
            force: Vector3::new(fx, fy, fz),
            torque: Vector3::new(nx, ny, nz),
        }
    }

    /// [`Self::call`] with an exchange of its own. Not inlined: who calls Python instead, perhaps run within run, has no room for it on
    /// its stack.
    #[inline(never)]
    pub(super) fn call_once(
        &self,
        t: f64,
        phase: &Phase,
        own: &[f64],
        rates: &mut [f64],
    ) -> Wrench {
        self.call(t, phase, own, rates, &mut Exchange::new())
    }
}

/// Read a number by itself.
#[inline(always)]
fn read(number: &f64) -> f64 {
    // SAFETY: what a reference points to can be read.
    unsafe { std::ptr::read_volatile(number) }
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
