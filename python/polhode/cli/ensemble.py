"""``polhode ensemble``: many motions with numbers that are drawn, their spread or their states."""

from __future__ import annotations

import json
import re
import shutil
import zipfile
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from polhode import RigidBody, Uncertain, distributions, ensemble, loads, reductions
from polhode._optional import require
from polhode.cli.files import check_suffixes
from polhode.cli.layout import Cell, Column, Field, Report, Table
from polhode.cli.loading import LoadedBody
from polhode.cli.spin import momentum_inside
from polhode.cli.whole import any_body, check_moments_alone, check_source, check_weight, source_of
from polhode.ensembles.merge_tree import BLOCK
from polhode.ensembles.plan import coordinates, layout
from polhode.ensembles.stores import check_same, header
from polhode.errors import FileFormatError, PolhodeError
from polhode.euler_angles import to_quaternion
from polhode.io.writing import writing
from polhode.units import amounts, has_unit, quantities, quantity

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.cli.options import BodyOptions, EnsembleOptions
    from polhode.distributions import Distribution
    from polhode.ensembles.result import Ensemble
    from polhode.reductions import Reduction

    Drawn: TypeAlias = NDArray[np.float64] | Distribution

__all__ = [
    "NUMBERS",
    "SHARES",
    "check_place",
    "client_at",
    "drawn_number",
    "ensemble_report",
    "make_reductions",
    "middle_of",
    "modes_table",
    "numbers",
    "numbers_table",
    "read_draws",
    "save_members",
]

MOST: Final = 2**62
"""More members have no number."""


def ensemble_report(file: Path | None, options: EnsembleOptions, body: BodyOptions) -> Report:
    """Run the members, save them as asked for and report on them."""
    _check(file, options, body)
    end = quantity(options.end or "", "s", "--end")
    if end == 0.0:
        raise PolhodeError(f"--end: expected a time other than 0, got {end:g}")
    if options.save is not None:
        check_place(options.save, resume=options.resume)
    given, notes = _arguments(file, options, body)
    with client_at(options.client) as client:
        many = ensemble(
            t=np.linspace(0.0, end, options.times or 2),
            n=options.n,
            seed=options.seed,
            chunk=options.chunk,
            method=options.method,
            rtol=options.rtol,
            reduce=make_reductions(has_modes=_is_free(options)) if options.save is None else None,
            client=client,
            **given,
        )
        if not many.plan.draws():
            raise PolhodeError(
                "ensemble: nothing is drawn, so that all members would be the same; write a number with a "
                'sigma or with bounds, as in --omega "0, 6.00 ± 0.05, 0.01", or use polhode spin'
            )
        report = Report()
        report.section(
            "",
            Field("file", "file", source_of(file, options.moments)),
            Field("members", "members", options.n),
            Field("seed", "seed", options.seed),
            Field("drawn", "drawn", ", ".join(map(_option, many.plan.draws()))),
            Field("method", "method", str(many.plan.options["method"])),
            Field("time", "end", end, "s"),
        )
        if options.save is None:
            _tell_spread(report, many, options)
        else:
            _tell_saved(report, many, options.save)
    report.notes += notes
    return report


def _check(file: Path | None, options: EnsembleOptions, body: BodyOptions) -> None:
    """Refuse wrong options before anything is read or computed."""
    check_source("ensemble", file, options.moments, body)
    if not options.omega:
        raise PolhodeError('--omega: state the start, as in --omega "0, 6.00 ± 0.05, 0.01 ± 0.01"')
    if options.end is None:
        raise PolhodeError('--end: state the time of the end, as in "20 s"')
    if not 0 < options.n < MOST:
        raise PolhodeError(f"--n: expected a number from 1 to 2^62 - 1, got {options.n}")
    if options.wheel and options.gravity is not None:
        raise PolhodeError(
            "--wheel: it cannot be combined with --gravity; leave out one of the two, or add loads.rotor and "
            "loads.uniform_gravity in Python"
        )
    if options.save is None:
        _check_spread(options)
    elif options.checkpoint is not None:
        raise PolhodeError(
            "--checkpoint: it is for the report on the spread; use --resume to continue --save"
        )
    elif options.times is not None and options.times < 2:
        raise PolhodeError(f"--times: {options.times} is less than 2, the start and the end; give 2 or more")


def _check_spread(options: EnsembleOptions) -> None:
    if options.resume:
        raise PolhodeError("--resume: it continues the file of --save; add --save, or use --checkpoint")
    if options.times is not None:
        raise PolhodeError("--times: the report has the spread at the end only; add --save, or leave it out")
    if options.chunk % BLOCK and 0 < options.chunk < options.n:
        raise PolhodeError(
            f"--chunk: expected a multiple of {BLOCK}, the members that are reduced together, got "
            f"{options.chunk}; {max(round(options.chunk / BLOCK), 1) * BLOCK} is one"
        )


def _arguments(
    file: Path | None, options: EnsembleOptions, body: BodyOptions
) -> tuple[dict[str, Any], list[str]]:
    """Return what `polhode.ensemble` takes of the body, the start and the load; and notes."""
    notes: list[str] = []
    if options.moments:
        given, one = _of_moments(options, body)
    else:
        one = any_body(file, body)
        given = one.body
        notes += one.notes
        if one.assumed:
            notes.append(
                "neither density nor mass was given: density 1 was used; the motion does not depend on it"
            )
        if one.body.covariance is not None:
            raise PolhodeError(
                "ensemble: the body has sigmas, and members draw --moments, --omega and --attitude; write "
                "the numbers of the body alone, or draw its --moments"
            )
    found = {"body": given, "omega": read_draws(options.omega, 3, "rad/s", "--omega")}
    if options.attitude:
        found["attitude"] = _attitude(options.attitude)
    if options.gravity is not None:
        g = quantity(options.gravity, "m/s^2", "--gravity")
        found |= {"load": loads.uniform_gravity((0.0, 0.0, -g)), "about": "origin"}
        if options.method == "auto" and isinstance(given, distributions.FunctionOfDraws):
            raise PolhodeError(
                "--method: with --gravity a body that is drawn needs one; state exact where all bodies are "
                "symmetric tops, else taylor or dop853"
            )
    if options.wheel:
        found["load"] = loads.rotor(momentum_inside(options.wheel, np.eye(3), one))
    return found, notes


def _of_moments(options: EnsembleOptions, body: BodyOptions) -> tuple[Any, Any]:
    """Make the body of the numbers, or what draws it; and the body whose axes have names."""
    check_moments_alone(body, "mass", "center_of_mass")
    check_weight(options.gravity, body)
    mass: Any = 1.0 if body.mass is None else drawn_number(body.mass, "kg", "--mass")
    moments: Any = read_draws(options.moments, 3, "kg m^2", "--moments")
    center: dict[str, Any] = {}
    if body.center_of_mass:
        center["center_of_mass"] = read_draws(body.center_of_mass, 3, "m", "--center-of-mass")
    numbers = (mass, moments, *center.values())
    if any(isinstance(one, distributions.Distribution) for one in numbers):
        given: Any = distributions.apply(RigidBody.from_principal, mass, moments, **center)
    else:
        given = RigidBody.from_principal(mass, moments, **center)
    if not options.wheel:
        return given, None
    middle = RigidBody.from_principal(1.0, middle_of(moments))
    return given, LoadedBody(body=middle, source=[], mass_unit="kg", length="m")


def _attitude(words: tuple[str, ...]) -> Any:
    if words == ("any",):
        return distributions.uniform_rotation()
    angles = read_draws(words, 3, "rad", "--attitude")
    if isinstance(angles, distributions.Distribution):
        return distributions.apply(to_quaternion, angles)
    return to_quaternion(angles)


def _option(place: str) -> str:
    """Return the option of what is drawn."""
    names = {"body.0": "mass", "body.1": "moments", "body.center_of_mass": "center"}
    return names.get(place, place.partition(".")[0])


def _is_free(options: EnsembleOptions) -> bool:
    return options.gravity is None and not options.wheel


def _tell_spread(report: Report, many: Ensemble, options: EnsembleOptions) -> None:
    found = many.compute(checkpoint=options.checkpoint)
    spread, shares = found["spread"], found["shares"]
    if not spread.members:
        raise PolhodeError(
            f"ensemble: none of {len(many)} members reached the end; --save writes the status of each, and "
            "Ensemble.member(k) in Python raises its error"
        )
    report.section("at the end", numbers_table(found))
    if "modes" in found:
        report.section("modes", modes_table(found))
    if spread.left_out:
        report.notes.append(f"{spread.left_out} members failed, and are left out of these numbers")
    if shares.rank_error:
        report.notes.append(f"the ranks of quantiles are right to {shares.rank_error:.1g} of all members")
    if options.checkpoint is not None:
        report.notes.append(f"partial results are in {options.checkpoint}")


def _tell_saved(report: Report, many: Ensemble, path: Path) -> None:
    rows = [{"status": name, "members": count} for name, count in save_members(many, path).items()]
    columns = (Column("status", "status"), Column("members", "members"))
    report.section("how members ended", Table("status", columns, rows))
    report.notes.append(f"saved {path}")


_NPZ, _ZARR = ".npz", ".zarr"
_HEADER: Final = "ensemble.json"
"""In the file: what ensemble it is, so that no other one is taken for it."""


def check_place(path: Path, *, resume: bool) -> None:
    """Refuse what cannot be begun or gone on with there, before anything is computed.

    Parameters
    ----------
    path : pathlib.Path
    resume : bool
        Whether to go on.
    """
    check_suffixes([path], (_NPZ, _ZARR))
    begun = next((place for place in (path, _parts(path)) if _is_there(place)), None)
    if begun is not None and not resume:
        raise PolhodeError(
            f"--save: {begun} exists already; add --resume to continue it, or give another name"
        )
    if begun is None and resume:
        raise PolhodeError(f"--resume: there is nothing at {path} to continue; leave --resume out")


def save_members(many: Ensemble, path: Path) -> dict[str, int]:
    """Run members that are missing there, and count how all of them ended.

    Parameters
    ----------
    many : Ensemble
    path : pathlib.Path

    Returns
    -------
    dict of str to int
        By the status.
    """
    if path.suffix.lower() == _ZARR:
        many.resume(path) if _is_there(path) else many.to_zarr(path)
        zarr = require("zarr", extra="cluster", purpose="--save")
        group: Any = zarr.open_group(path, mode="r")
        status = group["status"][:]
    else:
        parts = _parts(path)
        if path.exists():  # it was put together, and ended before its parts were removed
            _check_whole(path, many)
        else:
            many.resume(parts) if _is_there(parts) else many.to_npz(parts)
            _put_together(parts, path, many)
        if parts.exists():
            shutil.rmtree(parts)
        with np.load(path) as found:
            status = found["status"]
    names, counts = np.unique(np.asarray(status), return_counts=True)
    return dict(zip(map(str, names), counts.tolist(), strict=True))


def _parts(path: Path) -> Path:
    """Return the folder of the chunks of a file, until all are there."""
    return path.with_name(f"{path.name}.parts")


def _is_there(path: Path) -> bool:
    return path.exists() and not (path.is_dir() and not any(path.iterdir()))


def _put_together(parts: Path, path: Path, many: Ensemble) -> None:
    """Write one file, a chunk in memory at a time."""
    plan = many.plan
    chunks = [parts / f"chunk-{index:08}.npz" for index in range(plan.chunks)]
    with writing(path) as stream, zipfile.ZipFile(stream, "w") as archive:
        archive.writestr(_HEADER, json.dumps(header(plan)))
        for name, variable in layout(plan).items():
            with _member(archive, name) as member:
                words: Any = {
                    "descr": variable.dtype, "fortran_order": False, "shape": (plan.n, *variable.tail)
                }  # fmt: skip
                np.lib.format.write_array_header_1_0(member, words)
                for chunk in chunks:
                    with np.load(chunk) as found:
                        member.write(np.ascontiguousarray(found[name], variable.dtype).tobytes())
        for name, (_, values) in coordinates(plan).items():
            with _member(archive, name) as member:
                np.lib.format.write_array(member, np.asarray(values), allow_pickle=False)


def _member(archive: zipfile.ZipFile, name: str) -> Any:
    return archive.open(f"{name}.npy", "w", force_zip64=True)


def _check_whole(path: Path, many: Ensemble) -> None:
    """Refuse a file that is not this ensemble's."""
    try:
        with zipfile.ZipFile(path) as archive:
            found = json.loads(archive.read(_HEADER))
    except (zipfile.BadZipFile, KeyError, ValueError) as error:
        raise FileFormatError(
            f"{path}: holds no ensemble that --save has written ({error}); give another name, or delete it"
        ) from None
    check_same(path, found, header(many.plan))


NUMBERS: Final = (
    ("omega_x", "rad/s"),
    ("omega_y", "rad/s"),
    ("omega_z", "rad/s"),
    ("|omega|", "rad/s"),
    ("|omega|, ratio to start", ""),
    ("z of body from z", "deg"),
)
"""Names and units."""
SHARES: Final = (0.05, 0.5, 0.95)


def numbers(motion: Any) -> Any:
    """Return the numbers of members at the end, shape (members, 6).

    Parameters
    ----------
    motion : Trajectory

    Returns
    -------
    numpy.ndarray
    """
    size = np.sqrt(np.square(motion.omega[:, [0, -1]]).sum(axis=-1))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = size[:, 1] / size[:, 0]
    x, y, z, w = np.moveaxis(motion.quaternion[:, -1], -1, 0)
    tilt = np.degrees(2.0 * np.arctan2(np.hypot(x, y), np.hypot(z, w)))
    return np.column_stack([motion.omega[:, -1], size[:, 1], ratio, tilt])


def make_reductions(*, has_modes: bool) -> dict[str, Reduction]:
    """Return the reductions; modes only of members that are free."""
    both = {"spread": reductions.covariance(numbers), "shares": reductions.quantiles(SHARES, numbers)}
    return both | ({"modes": reductions.mode_changes()} if has_modes else {})


def numbers_table(found: dict[str, Any]) -> Table:
    """Return the spread of each number."""
    columns = (
        Column("name", "number"),
        Column("mean", "mean"),
        Column("sigma", "sigma"),
        Column("low", "5 %"),
        Column("median", "median"),
        Column("high", "95 %"),
        Column("unit", "unit"),
    )
    means, sigmas = found["spread"].mean, np.sqrt(np.diagonal(found["spread"].covariance))
    rows = [
        {
            "name": name,
            "mean": float(means[k]),
            "sigma": float(sigmas[k]),
            **dict(zip(("low", "median", "high"), found["shares"].values[:, k].tolist(), strict=True)),
            "unit": unit,
        }
        for k, (name, unit) in enumerate(NUMBERS)
    ]
    return Table("end", columns, rows)


def modes_table(found: dict[str, Any]) -> Table:
    """Return how many members rotate in which mode, which free ones keep."""
    modes = found["modes"]
    shares = modes.table.sum(axis=0) / modes.table.sum()
    rows = [
        {"mode": name, "share": Cell(f"{100.0 * share:.3g} %", share)}
        for name, share in zip(modes.modes, shares.tolist(), strict=True)
        if share > 0.0
    ]
    return Table("modes", (Column("mode", "mode"), Column("share", "members")), rows)


_TO: Final = re.compile(r"\s+to\s+")


def read_draws(texts: Sequence[str], count: int, unit: str, option: str) -> Drawn:
    """Read numbers that are the same for all members, or their distribution.

    Parameters
    ----------
    texts : sequence of str
        As `amounts` takes them; or with commas between them, some as ``"0.9 to 1.1"``.
    count, unit, option : int, str, str
        As of `amounts`.

    Returns
    -------
    numpy.ndarray or Distribution
        Normal where a number has a sigma, uniform where one has bounds.

    Raises
    ------
    PolhodeError
        For what is neither, or both.
    """
    text = " ".join(texts)
    if _TO.search(text):
        return _uniform(text, count, unit, option)
    given = amounts(texts, count, unit, option)
    means = np.array([one.value if isinstance(one, Uncertain) else one for one in given], dtype=float)
    if not any(isinstance(one, Uncertain) for one in given):
        return means
    sigmas = [one.sigma if isinstance(one, Uncertain) else 0.0 for one in given]
    return distributions.normal(means, sigma=np.array(sigmas, dtype=float))


def drawn_number(text: str, unit: str, option: str) -> Any:
    """Read one number, or its distribution; see `read_draws`."""
    found: Any = read_draws([text], 1, unit, option)
    if isinstance(found, distributions.Normal):
        return distributions.normal(found.mean.item(), sigma=np.asarray(found.sigma).item())
    if isinstance(found, distributions.Uniform):
        return distributions.uniform(found.low.item(), found.high.item())
    return float(found[0])


def middle_of(numbers: Any) -> Any:
    """Return the numbers themselves, or what their distribution is about."""
    if isinstance(numbers, distributions.Normal):
        return numbers.mean
    if isinstance(numbers, distributions.Uniform):
        return 0.5 * numbers.low + 0.5 * numbers.high
    return numbers


def _uniform(text: str, count: int, unit: str, option: str) -> Distribution:
    if re.search(r"±|\+/-|\+-|\d\(", text):
        raise PolhodeError(
            f"{option}: {text!r} has a sigma and bounds, but all numbers of an option are normal or all are "
            "uniform; write sigmas for all that are drawn, or bounds for all"
        )
    bounds = [_bounds(part) for part in text.strip().strip(",").split(",")]
    if any(len(pair) != 2 for pair in bounds) or len(bounds) != count:
        raise PolhodeError(
            f"{option}: expected {count} number{'s'[: count - 1]} with commas between, each alone or with "
            f"bounds as in '0.9 to 1.1', got {text!r}"
        )
    low, high = (quantities([", ".join(side)], count, unit, option) for side in zip(*bounds, strict=True))
    wrong = next(((a, b) for a, b in zip(low, high, strict=True) if a > b), None)
    if wrong is not None:
        raise PolhodeError(
            f"{option}: the lower bound must not exceed the upper one, got {wrong[0]:g} to {wrong[1]:g} "
            f"{unit}; write the smaller one first"
        )
    try:
        return distributions.uniform(low, high)
    except ValueError as error:
        raise PolhodeError(f"{option}: {error}; write bounds that are closer") from None


def _bounds(part: str) -> list[str]:
    """Split a number's bounds, the lower one with the unit of the upper one where it has none itself."""
    words = [word.strip() for word in _TO.split(part.strip())]
    if len(words) == 1:
        return words * 2
    if len(words) == 2 and has_unit(words[1]) and not has_unit(words[0]):
        number = re.match(r"\S+", words[1])
        behind = words[1][number.end() if number else 0 :]
        words[0] += behind
    return words


@contextmanager
def client_at(address: str | None) -> Iterator[Any]:
    """Return a client of the scheduler at an address; None without one.

    Parameters
    ----------
    address : str or None

    Yields
    ------
    distributed.Client or None

    Raises
    ------
    PolhodeError
        Where no scheduler answers.
    """
    if address is None:
        yield None
        return
    distributed = require("distributed", extra="cluster", purpose="--client")
    try:
        # Not as dask's default, which one that finds no scheduler would stay: dask would wait for it.
        client = distributed.Client(address, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise PolhodeError(
            f"--client: no scheduler of dask answers at {address!r} ({type(error).__name__}); give the "
            "address that `dask scheduler` prints, as in tcp://127.0.0.1:8786, or leave --client out"
        ) from error
    try:
        yield client
    finally:
        client.close()
