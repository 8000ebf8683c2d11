"""Arrays that are not in memory (dask, zarr, h5py, memory maps, xarray): particles, runs and closed forms."""

from __future__ import annotations

from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._core import MassAccumulator, real_numbers
from polhode._optional import require
from polhode._progress import progress_bar
from polhode.ensembles.fingerprint import build
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from polhode._core import RigidBody

__all__ = [
    "Labels",
    "body_of_particles",
    "check_coordinates",
    "check_real",
    "check_sizes",
    "dask_array",
    "dataset",
    "in_memory",
    "is_stored",
    "motion_at",
    "one_chunk",
    "require_xarray",
    "simulate",
    "sum_particles",
    "xarray_array",
]


def body_of_particles(masses: Any, positions: Any) -> RigidBody | None:
    """Sum particles that are not in memory, for ``RigidBody.from_particles``."""
    total = sum_particles(masses, positions, 0)
    return None if total is None else total.finish()


def _library(array: Any) -> str:
    return type(array).__module__.partition(".")[0]


def xarray_array(array: Any) -> Any:
    """Return the argument if it is an array of xarray, with names for its axes; else None."""
    return array if _library(array) == "xarray" and hasattr(array, "variable") else None


def dask_array(array: Any) -> Any:
    """Return the array of dask, if an argument is one or an array of xarray that holds one; else None."""
    if xarray_array(array) is not None:
        array = array.data if getattr(array, "chunks", None) is not None else None
    if array is None or _library(array) != "dask":
        return None
    from dask.array import Array

    return array if isinstance(array, Array) else None


def is_stored(array: Any) -> bool:
    """Return whether slices of an array are read from a file when they are asked for."""
    if xarray_array(array) is not None:
        return not getattr(array.variable, "_in_memory", True)
    return isinstance(array, np.memmap) or (
        _library(array) in ("h5py", "zarr") and hasattr(array, "shape") and hasattr(array, "dtype")
    )


def in_memory(array: Any) -> Any:
    """Return a piece of an array in memory, as the core reads it; masked elements and units stay."""
    if xarray_array(array) is not None:
        return in_memory(array.variable.data)
    return np.asarray(array) if isinstance(array, np.memmap) else array


def check_sizes(array: Any, name: str) -> None:
    """Refuse an array of unknown size."""
    if np.isnan(np.array(np.shape(array), dtype=float)).any():
        raise ValueError(
            f"{name}: the sizes of its chunks are not known; {name}.compute_chunk_sizes() finds them"
        )


def check_real(array: Any, name: str) -> None:
    """Refuse an array of dask without real numbers, or of unknown size, before it is computed."""
    if array.dtype.kind not in "biuf":
        raise TypeError(f"{name}: expected real numbers, got dtype {array.dtype}")
    check_sizes(array, name)
    if isinstance(array._meta, np.ma.MaskedArray):
        raise TypeError(
            f"{name}: its elements may be masked and have no value; give them values with "
            "dask.array.ma.filled(array, value)"
        )


_OWN: Final = ("time", "component", "quaternion_component")
_FRAMES: Final = {"omega": "body", "position": "space", "velocity": "space"}


def require_xarray() -> Any:
    """Return the library whose datasets are the results."""
    return require("xarray", extra="cluster", purpose="a motion of dask arrays")


def one_chunk(array: Any, name: str, size: int) -> None:
    """Refuse an array whose last axis has other components, or has them in several chunks."""
    shape = np.shape(array)
    if shape[-1:] != (size,):
        dims = (
            f", axes {array.dims}; the components are to be the last"
            if xarray_array(array) is not None
            else ""
        )
        raise ValueError(f"{name}: expected shape (..., {size}), got {shape}{dims}")
    lazy = dask_array(array)
    if lazy is None:
        return
    check_real(lazy, name)
    count = len(lazy.chunks[-1])
    if count > 1:
        way = f"chunk({{{array.dims[-1]!r}: -1}})" if xarray_array(array) is not None else "rechunk({-1: -1})"
        raise ValueError(
            f"{name}: its {size} components lie in {count} chunks; put them in one: {name}.{way}"
        )


def check_coordinates(array: Any, tail: int, results: Collection[str]) -> None:
    """Refuse an array with a coordinate that has the name of a variable of the result."""
    last = set(array.dims[array.ndim - tail :])
    own = {str(name) for name, one in array.coords.items() if not last & set(one.dims)}
    for name in sorted((own - {str(dim) for dim in array.dims}) & set(results)):
        raise ValueError(
            f"a coordinate is named {name!r}, as one of the result; leave it out with "
            f".drop_vars({name!r}), or rename it"
        )


class Labels:
    """Names for the axes of stacks: those of labelled arrays, or those of ``Trajectory.to_xarray``.

    Parameters
    ----------
    arrays : sequence of array_like
    tails : sequence of int
        How many axes of each are not of the stack.
    shapes : sequence of tuple of int
        Of what else is a stack.
    results : sequence of str
        What will be computed.
    """

    def __init__(
        self,
        arrays: Sequence[Any],
        tails: Sequence[int],
        shapes: Sequence[tuple[int, ...]],
        results: Sequence[str],
    ) -> None:
        named: list[str] = []
        for array, tail in zip(arrays, tails, strict=True):
            if xarray_array(array) is not None:
                own = [str(dim) for dim in array.dims[: array.ndim - tail]]
                named += [dim for dim in own if dim not in named]
                check_coordinates(array, tail, {*_OWN, *results})
        taken = sorted(set(named) & {*_OWN, *results})
        if taken:
            raise ValueError(f"an axis of the stack is named {taken[0]!r}, as one of the result; rename it")
        depth = max(
            [
                np.ndim(array) - tail
                for array, tail in zip(arrays, tails, strict=True)
                if xarray_array(array) is None
            ]
            + [len(shape) for shape in shapes]
        )
        if not named:
            named = ["body"] if depth == 1 else [f"body_{axis}" for axis in range(depth)]
        elif depth > len(named):
            raise ValueError(
                f"a stack of {depth} axes beside axes named {', '.join(named)}: give it names for its axes "
                "too, as an xarray.DataArray"
            )
        self.stack = named
        # Those along which everything has one row stay with whatever has them.
        self.ones = set(named)
        for array, tail in zip(arrays, tails, strict=True):
            stack = np.shape(array)[: np.ndim(array) - tail]
            own = (
                array.dims[: len(stack)]
                if xarray_array(array) is not None
                else named[len(named) - len(stack) :]
            )
            self.ones -= {str(dim) for dim, size in zip(own, stack, strict=True) if size != 1}
        for shape in shapes:
            own = named[len(named) - len(shape) :]
            self.ones -= {dim for dim, size in zip(own, shape, strict=True) if size != 1}
        self.cuts: dict[str, tuple[int, ...]] = {}
        self.sizes: dict[str, tuple[int, str]] = {}
        self.indexes: dict[str, tuple[Any, str]] = {}

    def name_axes(self, array: Any, name: str) -> Any:
        """Return an array with names; that of its last axis is the argument's own."""
        xarray = require_xarray()
        if xarray_array(array) is not None:
            found = array.rename({array.dims[-1]: f"{name} in"}).drop_vars([f"{name} in"], errors="ignore")
        else:
            if dask_array(array) is None:
                array = real_numbers(array, name)
            dims = self.stack[len(self.stack) + 1 - array.ndim :]
            # An axis of one goes along with all.
            kept = [
                axis for axis, size in enumerate(array.shape[:-1]) if size != 1 or dims[axis] in self.ones
            ]
            picked = array[tuple(slice(None) if axis in kept else 0 for axis in range(len(dims)))]
            found = xarray.DataArray(picked, dims=[*(dims[axis] for axis in kept), f"{name} in"])
        for dim, size in zip(found.dims[:-1], found.shape[:-1], strict=True):
            known = self.sizes.setdefault(str(dim), (size, name))
            if known[0] != size:
                raise ValueError(
                    f"{known[1]} and {name}: their axis {dim!r} has {known[0]} and {size} rows; give "
                    "both the same, or one"
                )
        for dim, index in found.indexes.items():
            first = self.indexes.setdefault(str(dim), (index, name))
            if not first[0].equals(index):
                raise ValueError(
                    f"{first[1]} and {name}: their coordinates of the axis {dim!r} are not the same; make "
                    f"them so, such as with xarray.align, or leave one out: {name}.drop_vars({dim!r})"
                )
        self.cuts |= {str(dim): cuts for dim, cuts in found.chunksizes.items()}
        return found

    def to_dask(self, numbers: Any, shape: tuple[int, ...], name: str) -> Any:
        """Return the numbers of a stack, an array of dask where it is more than one."""
        da = require("dask.array", extra="cluster", purpose="a motion of dask arrays")
        found = self.name_axes(numbers, name)
        if not shape:
            return found
        chunks = tuple(self.cuts.get(str(dim), -1) for dim in found.dims)
        return found.copy(data=da.from_array(found.data, chunks=chunks))

    def rows(self) -> Any:
        """Count the rows along the first axis of the stack."""
        da = require("dask.array", extra="cluster", purpose="a motion of dask arrays")
        if not self.stack:
            return self.name_axes(np.zeros(1), "row")
        first, xarray = self.stack[0], require_xarray()
        numbers = da.arange(self.sizes.get(first, (1, ""))[0], chunks=self.cuts.get(first, -1))
        return xarray.DataArray(numbers[:, None], dims=[first, "row in"])


def dataset(found: Mapping[str, Any], stack: Sequence[str], coordinates: Mapping[str, Any]) -> Any:
    """Gather the arrays of a run as ``Trajectory.to_xarray`` does."""
    xarray = require_xarray()
    variables = {}
    for place, array in found.items():
        name = place.removeprefix("states.")
        if name == "quaternion":
            axis, told = "quaternion_component", {"long_name": "R_NB, scalar last"}
        elif name in _FRAMES:
            axis, told = "component", {"frame": _FRAMES[name]}
        else:
            axis, told = f"{name}_component", {"long_name": "of the load"}
        if name == "status":
            told = {"long_name": "how the run ended"}
        core = [dim for dim in array.dims if dim not in stack and not str(dim).endswith(" ")]
        last = [dim for dim in array.dims if str(dim).endswith(" ")]
        variables[name] = (
            array.transpose(*(dim for dim in stack if dim in array.dims), *core, *last)
            .rename(dict.fromkeys(last, axis))
            .assign_attrs(told)
        )
    letters = {"component": list("xyz"), "quaternion_component": list("xyzw")}
    return xarray.Dataset(variables).assign_coords({**coordinates, **letters})


_TAILS: Final = {"omega": 3, "quaternion": 4, "position": 3, "velocity": 3}


def motion_at(motion: Any, t: Any) -> Any:
    """Return the states of a motion as an `xarray.Dataset` of dask arrays.

    Parameters
    ----------
    motion : FreeMotion, HeavyTop or GyrostatMotion
    t : array_like

    Returns
    -------
    xarray.Dataset or None
        None where the times are in memory.
    """
    if dask_array(t) is None:
        return None
    check_real(dask_array(t), "t")
    body = motion.gyrostat.body if hasattr(motion, "gyrostat") else motion.body
    if body.covariance is not None or any(one is not None for one in getattr(motion, "uncertain_start", ())):
        raise ValueError(
            "t: the motion is uncertain, and states at times of dask have no place for a covariance; compute "
            "the times, or begin without sigmas"
        )
    xarray = require_xarray()
    depth = len(motion.shape)
    stack = ["body"] if depth == 1 else [f"body_{axis}" for axis in range(depth)]
    if xarray_array(t) is None:
        dims = ["time"] if t.ndim == 1 else [f"time_{axis}" for axis in range(t.ndim)]
        t = xarray.DataArray(t, dims=dims)
    results = {*stack, *_TAILS, "component", "quaternion_component"}
    check_coordinates(t, 0, results)
    taken = sorted(set(t.dims) & results)
    if taken:
        raise ValueError(f"t: its axis {taken[0]!r} has the name of one of the result; rename it")
    found = xarray.apply_ufunc(
        _states_of_chunk,
        t,
        kwargs={"motion": motion},
        output_core_dims=[[*stack, f"{name} "] for name in _TAILS],
        dask="parallelized",
        output_dtypes=[float] * len(_TAILS),
        dask_gufunc_kwargs={
            "output_sizes": dict(zip(stack, motion.shape, strict=True))
            | {f"{n} ": k for n, k in _TAILS.items()}
        },
    )
    # Not as the coordinate of its axis: that would be computed at once.
    name = "t" if "t" not in t.coords and "t" not in t.dims else "times"
    return dataset(dict(zip(_TAILS, found, strict=True)), stack, {name: t})


def _states_of_chunk(t: Any, *, motion: Any) -> Any:
    """Compute the states of a chunk; the axes of the times come before those of the stack."""
    run, depth = motion.at(t), len(motion.shape)
    front = tuple(range(depth))
    back = tuple(range(np.ndim(t), np.ndim(t) + depth))
    return tuple(np.moveaxis(getattr(run, name), front, back) for name in _TAILS)


_PIECE: Final = 1 << 18
"""Particles that are read at a time, 8 MB; a multiple of the blocks by which the core sums."""
_AT_ONCE: Final = 32
"""Sums that are merged by one task."""


def sum_particles(masses: Any, positions: Any, start: int) -> MassAccumulator | None:
    """Sum the particles of one body.

    Parameters
    ----------
    masses, positions : array_like, shapes (n,) and (n, 3)
    start : int
        The number of the first of them.

    Returns
    -------
    MassAccumulator or None
        None where both are in memory, or are a stack of bodies.
    """
    by_dask = dask_array(masses) is not None or dask_array(positions) is not None
    if not by_dask and not is_stored(masses) and not is_stored(positions):
        return None
    if np.ndim(masses) != 1 or np.ndim(positions) != 2:
        return None
    _check(masses, positions)
    return (_by_dask if by_dask else _in_pieces)(masses, positions, start)


def _check(masses: Any, positions: Any) -> None:
    """Refuse shapes that make no particles, before anything is read."""
    for name, array in (("masses", masses), ("positions", positions)):
        check_sizes(array, name)
    (n,), (m, *axes) = np.shape(masses), np.shape(positions)
    if axes != [3]:
        raise ValueError(f"positions: expected shape (n, 3), got {np.shape(positions)}")
    if n != m:
        raise ValueError(f"masses and positions: expected shapes (n) and (n, 3), got n = {n} and n = {m}")


def _in_pieces(masses: Any, positions: Any, start: int) -> MassAccumulator:
    """Sum what files hold, by pieces that end where the core's blocks end."""
    total, count = MassAccumulator(), np.shape(masses)[0]
    first = 0
    with progress_bar(f"{count} particles") as tell:
        while first < count:
            end = min(first + _PIECE - (start + first) % _PIECE, count)
            total.merge(_part(masses[first:end], positions[first:end], start, first))
            first = end
            if tell is not None:
                tell(end / count)
    return total


def _by_dask(masses: Any, positions: Any, start: int) -> MassAccumulator:
    """Sum chunks where dask computes them, and merge the sums pairwise."""
    dask, da, layers = (
        require(module, extra="cluster", purpose="particles of dask arrays")
        for module in ("dask", "dask.array", "dask.layers")
    )
    known = dask_array(positions)
    if known is None:
        known = dask_array(masses)
    cuts = known.chunks[0]
    arrays = []
    for given, chunks in ((masses, (cuts,)), (positions, (cuts, (3,)))):
        found = dask_array(given)
        # Rows that come from one array of dask are computed once for both.
        arrays.append(da.from_array(given, chunks=chunks) if found is None else found.rechunk(chunks))
    # An array of one sum for each chunk, so that dask makes a chunk and sums it in one task.
    sums = da.blockwise(
        _sum_chunk, "ij", arrays[0], "i", arrays[1], "ij", layers.ArraySliceDep((cuts,)), "i",
        first=start, wanted=build(), align_arrays=False, adjust_chunks={"i": 1, "j": 1}, dtype=object,
        meta=np.empty((0, 0), dtype=object),
    )  # fmt: skip
    nodes = sums.to_delayed().ravel().tolist()
    merge = dask.delayed(_merge, pure=False)
    while len(nodes) > 1:
        nodes = [merge(nodes[first : first + _AT_ONCE]) for first in range(0, len(nodes), _AT_ONCE)]
    with _show_progress(f"{sum(cuts)} particles", len(cuts)):
        total: MassAccumulator = nodes[0].compute().item()
    return total


def _sum_chunk(masses: Any, positions: Any, place: Any, *, first: int, wanted: tuple[str, str]) -> Any:
    """Sum a chunk, on whatever machine it is."""
    if build() != tuple(wanted):
        raise RuntimeError(
            f"this worker has polhode {build()[0]} (core {build()[1][:8]}) and the client polhode "
            f"{wanted[0]} (core {wanted[1][:8]}); the same package must be installed on all of them"
        )
    return _box(_part(masses, positions, first, place[0].start))


def _part(masses: Any, positions: Any, start: int, row: int) -> MassAccumulator:
    """Sum some rows, from `row` on; errors name the rows by their numbers in the whole array."""
    part, first = MassAccumulator(), start + row
    try:
        part.add(in_memory(masses), in_memory(positions), start=first)
    except ValueError as error:
        where = f"particles {first} to {first + len(masses) - 1}: "
        if not isinstance(error, PolhodeError):
            raise type(error)(f"{where}{error}") from None
        error.shift_rows(row)
        error.args = (where, *error.args)
        raise
    return part


def _box(part: MassAccumulator) -> Any:
    box = np.empty((1, 1), dtype=object)
    box[0, 0] = part
    return box


def _merge(boxes: list[Any]) -> Any:
    """Merge sums into a new one; the old ones stay unchanged, because a task may be repeated."""
    total = MassAccumulator()
    for box in boxes:
        total.merge(box.item())
    return _box(total)


@contextmanager
def _show_progress(what: str, chunks: int) -> Iterator[None]:
    """Show a bar while dask's own schedulers compute here; a cluster has its own."""
    callbacks = require("dask.callbacks", extra="cluster", purpose="particles of dask arrays")
    with ExitStack() as stack:
        tell = stack.enter_context(progress_bar(what))
        if tell is not None:
            done = 0

            def count(*_: Any) -> None:
                nonlocal done
                done += 1
                tell(min(done / chunks, 1.0))

            stack.enter_context(callbacks.Callback(posttask=count))
        yield


_VECTORS: Final = {"omega": 3, "attitude": 4, "position": 3, "velocity": 3}
_CHOSEN: Final = ("exact", "taylor")
"""The methods of which "auto" takes the first that can serve; the next can always."""
_TIGHTEST: Final = 2.3e-15
"""Below this `rtol` "auto" takes no closed form."""


def simulate(body: RigidBody, t: Any, omega: Any, attitude: Any, **options: Any) -> Any:
    """Return the states of runs as an `xarray.Dataset` of dask arrays.

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
    options = _choose_method(body, times, options)
    shapes = [body.shape, _shape_of(options["load"])]
    results = ["omega", "quaternion", "position", "velocity", "status", *states]
    labels = Labels(list(given.values()), [1] * len(given), shapes, results)
    arrays = {name: labels.name_axes(value, name) for name, value in given.items()}
    # A stack of bodies goes as its numbers, of which each chunk gets its own.
    arrays["body"] = labels.to_dask(body.__reduce__()[1][0], body.shape, "body")
    if _shape_of(options["load"]):
        rows = np.arange(np.prod(options["load"].shape)).reshape(options["load"].shape)
        arrays["row of load"] = labels.to_dask(rows[..., None], rows.shape, "load")
    arrays["row"] = labels.rows()
    tails = {"omega": 3, "quaternion": 4, "position": 3, "velocity": 3}
    tails |= {f"states.{name}": value.shape[-1] for name, value in states.items()}
    found = xarray.apply_ufunc(
        _run_chunk,
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
    """Start a run of all bodies and loads at rest, so that errors of the call are raised at once."""
    return body.simulate(times[:1], (0.0, 0.0, 0.0), **options)


def _choose_method(body: RigidBody, times: Any, options: dict[str, Any]) -> dict[str, Any]:
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


def _run_chunk(
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
