//! The function of each law, which stands beside it: a law without one does not compile.

use pyo3::prelude::*;

/// A law of the core that a function of `polhode.loads` makes.
pub(super) trait RegisteredLaw {
    /// Adds the function to the module.
    fn declare(module: &Bound<'_, PyModule>) -> PyResult<()>;
}

/// Says which function makes a law.
macro_rules! register {
    ($law:ident by $function:ident) => {
        impl crate::loads::registry::RegisteredLaw for polhode::motion::loads::$law {
            fn declare(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
                use pyo3::types::PyModuleMethods;
                module.add_function(pyo3::wrap_pyfunction!($function, module)?)
            }
        }
    };
}

pub(super) use register;

/// Adds the functions of all laws to the module.
pub(crate) fn declare_laws(module: &Bound<'_, PyModule>) -> PyResult<()> {
    macro_rules! all {
        ($($law:ident)+) => {
            $(<polhode::motion::loads::$law as RegisteredLaw>::declare(module)?;)+
        };
    }
    polhode::for_each_law!(all);
    Ok(())
}
