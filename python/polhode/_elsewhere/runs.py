"""Runs whose starts are computed later, chunk by chunk: a dataset of what they will give."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._elsewhere.datasets import Labels, dataset, one_chunk, require_xarray
from polhode._elsewhere.kinds import dask_array
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from polhode._core import RigidBody

__all__ = ["simulated"]

_VECTORS: Final = {"omega": 3, "attitude": 4, "position": 3, "velocity": 3}
_NUMBERS: Final = 34
"""Of a body, as pickle has them."""
_CHOSEN: Final = ("exact", "taylor")
"""The methods of which "auto" takes the first that can serve; the next can always."""
_TIGHTEST: Final = 2.3e-15
"""Below this `rtol` "auto" takes no closed form."""


def simulated(body: RigidBody, t: Any, omega: Any, attitude: Any, options: dict[str, Any]) -> Any:
    """Give the states of runs as an `xarray.Dataset` of dask arrays.

    Parameters
    ----------
    body : RigidBody
    t, omega, attitude, options
        As of ``RigidBody.simulate``.

    Returns
    -------
    xarray.Dataset or None
        None where nothing is computed later.
    """
    attitude = attitude.as_quat() if hasattr(attitude, "as_quat") else attitude
    given = {"omega": omega, "attitude": attitude}
    given |= {name: options.pop(name) for name in ("position", "velocity")}
    given = {name: value for name, value in given.items() if value is not None}
    if not any(dask_array(value) is not None for value in given.values()):
        return None
    xarray = require_xarray()
    for name, way in (
        ("events", "run the chunks by themselves, with dask.delayed"),
        ("progress", "the bars of dask show it, such as dask.diagnostics.ProgressBar"),
    ):
        if options.pop(name) is not None:
            raise ValueError(f"{name}: a run of dask arrays is computed later and has none; {way}")
    if options["states"] is not None:
        raise ValueError(
            "states: a run of dask arrays begins with the states that the load has by itself; run the chunks "
            "by themselves, with dask.delayed"
        )
    if body.covariance is not None:
        raise ValueError(
            "body: carries a covariance, which a run of dask arrays has no place for; give it without sigmas"
        )
    for name, value in given.items():
        if isinstance(value, _core.Uncertain):
            raise TypeError(f"{name}: a run of dask arrays has no covariance; give its value, {name}.value")
    times = _core.real_numbers(t, "t")
    for name, value in given.items():
        one_chunk(value, name, _VECTORS[name])
    _core.RigidBody.from_principal(1.0, (1.0, 1.0, 1.0)).simulate(times, (0.0, 0.0, 0.0))  # refuses bad times
    rest: dict[str, Any] = {"velocity": (0.0, 0.0, 0.0)} if "velocity" in given else {}
    if options["on_failure"] == "raise":
        rest["on_failure"] = "keep"
    states = _first(body, times, options | rest).states
    options = _settled(body, times, options)
    shapes = [body.shape, _shape_of(options["load"])]
    results = ["omega", "quaternion", "position", "velocity", "status", *states]
    labels = Labels(list(given.values()), [1] * len(given), shapes, results)
    arrays = {name: labels.named(value, name) for name, value in given.items()}
    # A stack of bodies goes as its numbers, of which each chunk gets its own.
    arrays["body"] = labels.chunked(body.__reduce__()[1][0], body.shape, "body")
    if _shape_of(options["load"]):
        rows = np.arange(np.prod(options["load"].shape)).reshape(options["load"].shape)
        arrays["row of load"] = labels.chunked(rows[..., None], rows.shape, "load")
    arrays["row"] = labels.rows()
    tails = {"omega": 3, "quaternion": 4, "position": 3, "velocity": 3}
    tails |= {f"states.{name}": value.shape[-1] for name, value in states.items()}
    found = xarray.apply_ufunc(
        _chunk,
        *arrays.values(),
        kwargs={"names": tuple(arrays), "t": times, "outputs": tuple(tails), "options": options},
        input_core_dims=[[array.dims[-1]] for array in arrays.values()],
        output_core_dims=[*(["time", f"{name} "] for name in tails), []],
        dask="parallelized",
        output_dtypes=[*(float for _ in tails), "<U8"],
        dask_gufunc_kwargs={
            "output_sizes": {"time": len(times)} | {f"{name} ": n for name, n in tails.items()}
        },
    )
    return dataset(dict(zip((*tails, "status"), found, strict=True)), labels.stack, {"time": times})


def _shape_of(load: Any) -> tuple[int, ...]:
    return () if load is None else tuple(load.shape)


def _first(body: RigidBody, times: Any, options: Mapping[str, Any]) -> Any:
    """Begin with all bodies and loads, at rest: what is wrong with the call is told at once."""
    return body.simulate(times[:1], (0.0, 0.0, 0.0), **options)


def _settled(body: RigidBody, times: Any, options: dict[str, Any]) -> dict[str, Any]:
    """Name the method, where "auto" would choose by the bodies and loads of a chunk."""
    if options["method"] != "auto" or not (body.shape or _shape_of(options["load"])):
        return options
    for method in _CHOSEN[options["rtol"] < _TIGHTEST :]:
        try:
            _first(body, times, options | {"method": method, "on_failure": "raise"})
        except PolhodeError:
            continue
        return options | {"method": method}
    return options | {"method": "dop853"}


def _chunk(
    *arrays: Any, names: tuple[str, ...], t: Any, outputs: tuple[str, ...], options: dict[str, Any]
) -> Any:
    """Run a chunk."""
    given = dict(zip(names, arrays, strict=True))
    body = _core.RigidBody._from_numbers(given.pop("body"))
    row, rows = given.pop("row"), given.pop("row of load", None)
    if rows is not None:
        load = options["load"]
        options = options | {"load": load[np.unravel_index(rows[..., 0].astype(int), load.shape)]}
    try:
        run = body.simulate(t, **given, **options)
    except PolhodeError as error:
        if row.ndim > 1:  # errors name rows of the chunk
            error.args = (f"in the chunk that begins with row {row.flat[0]}: {error}", *error.args[1:])
        raise
    found = [
        run.states[name.removeprefix("states.")] if name.startswith("states.") else getattr(run, name)
        for name in outputs
    ]
    return (*found, np.asarray(run.status, dtype="<U8"))
