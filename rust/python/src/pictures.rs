//! Pictures and moving pictures of exact motions. Python does it all.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::free_motion::PyFreeMotion;
use crate::gyrostat::PyGyrostatMotion;
use crate::heavy_top::PyHeavyTop;

/// The same two methods for each class of exact motions.
macro_rules! draw_methods {
    ($($class:ident),+) => {$(
        #[pymethods]
        impl $class {
            /// Write the motion of one body as a moving picture, from time 0 to an end.
            ///
            /// Parameters
            /// ----------
            /// path : str or os.PathLike
            ///     ``.html``: an interactive page that needs nothing else; ``.gif``: needs matplotlib; ``.mp4``: needs also the
            ///     program ffmpeg, which the extra ``film`` brings.
            /// end : float
            ///     The time to which it is shown.
            /// **options
            ///     As of `polhode.animation.animate`: `shape`, `frames`, `duration`, `title`, `time_label`, `size`, `fps`, `labels`
            ///     and `progress`.
            ///
            /// Returns
            /// -------
            /// pathlib.Path
            ///     Where it was written.
            #[pyo3(signature = (path, end, **options))]
            fn animate<'py>(
                slf: &Bound<'py, Self>,
                path: &Bound<'py, PyAny>,
                end: &Bound<'py, PyAny>,
                options: Option<&Bound<'py, PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let py = slf.py();
                let all = PyDict::new(py);
                if let Some(options) = options {
                    all.update(options.as_mapping())?;
                }
                all.set_item("end", end)?;
                py.import("polhode.animation")?
                    .call_method("animate", (slf, path), Some(&all))
            }

            /// Draw the components of the angular velocity in the body from time 0 to an end; needs matplotlib.
            ///
            /// Parameters
            /// ----------
            /// end : float
            ///     The time to which it is drawn.
            /// ax : matplotlib.axes.Axes, optional
            ///     Where to draw; a new figure by default.
            ///
            /// Returns
            /// -------
            /// matplotlib.axes.Axes
            #[pyo3(signature = (end, ax=None))]
            fn plot<'py>(
                slf: &Bound<'py, Self>,
                end: &Bound<'py, PyAny>,
                ax: Option<&Bound<'py, PyAny>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let py = slf.py();
                let options = PyDict::new(py);
                options.set_item("end", end)?;
                py.import("polhode.plot")?
                    .call_method("angular_velocity", (slf, ax), Some(&options))
            }
        }
    )+};
}

draw_methods!(PyFreeMotion, PyGyrostatMotion, PyHeavyTop);
