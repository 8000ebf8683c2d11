"""What an identification returns, and which directions its data determine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._core import RigidBody, Uncertain
from polhode._format import one_line
from polhode.errors import FileFormatError
from polhode.io.records import (
    WORDS,
    check_names,
    in_json,
    numbers,
    read_record,
    require_field,
    write_json,
)
from polhode.io.saved import BODY_FIELDS, body_fields, body_of
from polhode.results import State

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from polhode._core import FreeMotion, GyrostatMotion

    Floats = NDArray[np.float64]

__all__ = [
    "ELEMENTS",
    "NUMBERS",
    "Direction",
    "Identified",
    "echelon",
    "find_directions",
    "p_value_of",
    "spread_directions",
    "tensor_of",
]

NUMBERS: Final = ("mass", "cx", "cy", "cz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
"""Names of the ten numbers of a body."""
ELEMENTS: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Places in the tensor of the last six."""
_UNCERTAIN: Final = 0.1
"""Share of its own size beyond which the sigma of a direction is told."""
_RANK: Final = 1e-11
"""Share of the largest singular value, per unit of size, below which nothing is left of a direction."""
_SHARE: Final = 0.15
"""Share of the largest component below which a component has no part in a direction."""
_AXES: Final = "xyz"


@dataclass(frozen=True, eq=False)
class Direction:
    """A combination of parameters that the data hardly determine.

    Attributes
    ----------
    words : str
        What it is: ``"the moment about y"``.
    parameters : numpy.ndarray, shape (P,)
        The direction: the change of each parameter, in units of that parameter. Its length is one when each
        parameter is measured by its own size: the mass, the radius of gyration, the mean of the principal
        moments. Of a tumble the changes of start and offset are zero: these may be any.
    sigma : float
        Standard deviation along the direction, in units of the largest of these changes; infinite where the
        data say nothing.
    relative : float
        The same relative to the size.
    remedy : str
        The measurement that would determine it.
    """

    words: str
    parameters: Floats
    sigma: float
    relative: float
    remedy: str

    def __repr__(self) -> str:
        return one_line(self, {"words": self.words, "sigma": self.sigma, "relative": self.relative})


@dataclass(frozen=True, eq=False, repr=False)
class Identified:
    """A body that was identified from measurements, and how well the measurements determine it.

    Attributes
    ----------
    body : RigidBody
        The most likely body that is possible. It carries the covariance, so sigmas, ledgers and
        :func:`polhode.uncertainty.propagate` go on from it.
    parameters : tuple of str
        Names of the numbers that were estimated. ``cx``, ``cy``, ``cz`` are the components of the centre of
        mass, ``Ixx`` to ``Iyz`` those of the tensor about it.
    estimate : numpy.ndarray, shape (P,)
        Their values.
    covariance : numpy.ndarray, shape (P, P)
        Their covariance. At the edge of what is possible, that of bodies along this edge.
    crlb : numpy.ndarray, shape (P, P)
        Bound of Cramér and Rao at the estimate, as if every set of parameters were possible.
    residuals : numpy.ndarray, shape (n, k)
        In units of their standard deviations; NaN where a sensor has no row.
    columns : tuple of str
        Names of the columns of the residuals, shape (k,).
    chi2 : float
        Sum of their squares at the estimate.
    degrees_of_freedom : int
    p_value : float
        Probability that noise alone gives a larger sum of squares; NaN where the level of the noise was
        estimated from the residuals.
    noise : Uncertain or None
        Standard deviations that were estimated from the residuals, if the data had none.
    bias : Uncertain or None
        Constant offsets that were estimated; None where the data do not determine them.
    scale : Uncertain or None
        Errors of the scales of the gyro that were estimated, shape (3,): measured over true, less 1.
    sensor_place : Uncertain or None
        Place of the accelerometer that was estimated, shape (3,), from the centre of mass in body axes.
    at_edge : bool
        Whether the most likely set of parameters is that of no body. The body is then the most likely among
        the possible ones and lies on their edge: it is flat, thin, or has mass in one point only. Intervals
        are one-sided there.
    linear : bool
        Whether the covariance tells the uncertainty: False at the edge.
    gap : float
        Certificate of a fit at the edge: no possible body has a sum of squares below ``chi2 - gap``.
    observability : tuple of Direction
        Every direction whose standard deviation exceeds 10 % of its size, the worst first.
    scale_known : bool
        Whether the data determine the scale of the tensor.
    dropped : dict of str and int
        Number of rows that were left out, by reason.
    window : int or None
        Number of samples of a window, where the angular acceleration was not given.
    start : State or None
        Of a tumble: the state at the first time. Without measured attitudes its attitude is the identity.
    start_covariance : numpy.ndarray, shape (3, 3), or None
        Covariance of the angular velocity at the first time.
    motion : FreeMotion, GyrostatMotion or None
        The free motion that was fitted; its times count from the first time. None where a torque acts:
        simulate it from `start`.
    alternatives : tuple of Identified
        Other maxima of the likelihood whose logarithm is less by at most 3.
    """

    body: RigidBody
    parameters: tuple[str, ...]
    estimate: Floats
    covariance: Floats
    crlb: Floats
    residuals: Floats
    chi2: float
    degrees_of_freedom: int
    p_value: float
    noise: Uncertain | None
    bias: Uncertain | None
    at_edge: bool
    linear: bool
    gap: float
    observability: tuple[Direction, ...]
    scale_known: bool
    dropped: dict[str, int]
    columns: tuple[str, ...] = ()
    scale: Uncertain | None = None
    sensor_place: Uncertain | None = None
    window: int | None = None
    start: State | None = None
    start_covariance: Floats | None = None
    motion: FreeMotion | GyrostatMotion | None = None
    alternatives: tuple[Identified, ...] = ()

    def plot(self, ax: Axes | None = None, *, t: ArrayLike | None = None) -> Axes:
        """Draw what the fit leaves of the measurements, in units of their standard deviations.

        Noise that is as assumed lies in the grey band between −2 and 2 for 95 of 100 points, and has no
        pattern. Needs matplotlib (extra `plot`).

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; a new figure by default.
        t : array_like, shape (n,), optional
            A time for each row of residuals; by default they are drawn row by row.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from polhode.identify.picture import residuals

        return residuals(self, t, ax)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the result to a file, with every bit of it; :meth:`from_file` reads it.

        The body keeps its sources of uncertainty. Those of `bias` and `noise` are new when they are read:
        they keep their covariances, but none with the body. ``body.save`` writes the body alone.

        Parameters
        ----------
        path : str or os.PathLike
            Ends in ``.json``.

        Examples
        --------
        >>> import tempfile
        >>> from pathlib import Path
        >>> import numpy as np
        >>> from polhode import RigidBody, identify
        >>> t = np.linspace(0.0, 4.0, 200)
        >>> exact = RigidBody.from_principal(1.0, (0.2, 0.35, 0.45)).free_motion((1.0, 3.0, 0.5)).at(t).omega
        >>> found = identify.from_tumble(t, exact + np.random.default_rng(1).normal(0.0, 0.01, (200, 3)))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     found.save(Path(folder) / "throw.json")
        ...     again = identify.Identified.from_file(Path(folder) / "throw.json")
        >>> again.body == found.body
        True
        """
        _save(self, path)

    @staticmethod
    def from_file(path: str | PathLike[str]) -> Identified:
        """Read a result that :meth:`save` wrote.

        Parameters
        ----------
        path : str or os.PathLike
            Ends in ``.json``.

        Raises
        ------
        FileFormatError
            If the file is damaged, or holds something else.
        """
        return _read(path)

    def __repr__(self) -> str:
        told = {
            "mass": self.body.mass,
            "principal_moments": self.body.principal_moments,
            "chi2": self.chi2,
            "degrees_of_freedom": self.degrees_of_freedom,
            "at_edge": self.at_edge,
            "observability": [one.words for one in self.observability],
        }
        return one_line(self, told)


def tensor_of(elements: Any) -> Any:
    """Return the symmetric matrix, shape (..., 3, 3), of elements xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(elements), -1, 0)
    return np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), (0, 1), (-2, -1))


def p_value_of(chi2: float, degrees_of_freedom: int) -> float:
    """Compute the probability that chi-square exceeds a value: the regularized incomplete gamma Q(k/2, x/2).

    A series of the complement below the mean, the continued fraction of Lentz above it
    (https://dlmf.nist.gov/8.11).
    """
    if degrees_of_freedom <= 0:
        return math.nan
    a, x = 0.5 * degrees_of_freedom, 0.5 * chi2
    if x <= 0.0:
        return 1.0
    front = math.exp(a * math.log(x) - x - math.lgamma(a))
    if x < a + 1.0:
        term = total = 1.0 / a
        k = a
        while term > 1e-17 * total:
            k += 1.0
            term *= x / k
            total += term
        return min(1.0, max(0.0, 1.0 - front * total))
    b = x + 1.0 - a
    c, d = 1e300, 1.0 / b
    value, step, i = d, 0.0, 0
    while abs(step - 1.0) > 1e-15 and i < 1_000_000:
        i += 1
        an = -i * (i - a)
        b += 2.0
        d = 1.0 / (an * d + b)
        c = b + an / c
        step = c * d
        value *= step
    return min(1.0, front * value)


def find_directions(
    jacobian: Floats, sizes: Floats, names: Sequence[str], remedy: str, rank: float = _RANK
) -> tuple[tuple[Direction, ...], int]:
    """Find the directions that data hardly determine, the worst first, and how many they do not at all.

    The Jacobian is in units of the sigmas of the data, a triangle of its QR as well. Its singular values are
    those per unit of each parameter's size: a direction of the singular value s has the relative sigma 1/s. A
    ratio of singular values does not matter, but for rounding.
    """
    scaled = jacobian * sizes
    values, rows = np.linalg.svd(scaled, full_matrices=True)[1:]
    values = np.append(values, np.zeros(len(sizes) - len(values)))
    # What is left of nothing after rounding; and where all sigmas are huge, nothing is determined by itself.
    lost = values <= rank * max(float(values.max(initial=0.0)), 1e-300)
    found = [(math.inf, one) for one in echelon(rows[lost])]
    weak = ~lost & (values * _UNCERTAIN < 1.0)
    found += _weak(rows[weak], 1.0 / values[weak])
    directions = (_direction(relative, vector, sizes, names, remedy) for relative, vector in found)
    return tuple(directions), int(lost.sum())


def spread_directions(
    spread: Floats, sizes: Floats, names: Sequence[str], remedy: str
) -> tuple[Direction, ...]:
    """Find the directions of large sigma, the worst first, of estimates linear in independent errors."""
    vectors, values = np.linalg.svd(spread / sizes[:, None], full_matrices=False)[:2]
    large = values > _UNCERTAIN
    found = _weak(vectors[:, large].T, values[large])
    return tuple(_direction(relative, vector, sizes, names, remedy) for relative, vector in found)


def _weak(rows: Floats, sigmas: Floats) -> list[tuple[float, Floats]]:
    """Return directions of large sigma that have names, with their sigmas, the worst first."""
    named = echelon(rows)
    found = [(float(np.linalg.norm((rows @ one) * sigmas)), one) for one in named]
    return sorted(found, key=lambda one: -one[0])


def _direction(
    relative: float, vector: Floats, sizes: Floats, names: Sequence[str], remedy: str
) -> Direction:
    signed = vector * np.sign(vector[np.argmax(np.abs(vector))])
    changes = signed * sizes
    return Direction(
        _words(signed, names), changes, relative * float(np.abs(changes).max()), relative, remedy
    )


def echelon(rows: Floats) -> list[Floats]:
    """Return a basis of the same space with few components each, so that each has a name."""
    rows = rows.copy()
    pivots: list[int] = []
    for k in range(len(rows)):
        left = np.abs(rows[k:])
        left[:, pivots] = 0.0
        row, column = np.unravel_index(int(np.argmax(left)), left.shape)
        rows[[k, k + int(row)]] = rows[[k + int(row), k]]
        rows[k] /= rows[k, column]
        others = np.arange(len(rows)) != k
        rows[others] -= np.outer(rows[others, column], rows[k])
        pivots.append(int(column))
    return [rows[k] / np.linalg.norm(rows[k]) for k in np.argsort(pivots)]


def _words(vector: Floats, names: Sequence[str]) -> str:
    """Return the name of a direction: that of the parameters with a part in it."""
    parts = {name: float(x) for name, x in zip(names, vector, strict=True)}
    most = max(abs(x) for x in parts.values())
    large = [name for name, x in parts.items() if abs(x) > _SHARE * most]
    if len(large) > 1 and all(name.startswith("I") for name in large):
        tensor = tensor_of([parts.get(name, 0.0) for name in NUMBERS[4:]])
        moments, axes = np.linalg.eigh(tensor)
        if (np.abs(moments[:2]) < _SHARE * abs(moments[2])).all():
            axis = axes[:, 2] * np.sign(axes[np.argmax(np.abs(axes[:, 2])), 2])
            x, y, z = (f"{one + 0.0:.2g}" for one in axis.round(2))
            return f"the moment about ({x}, {y}, {z})"
    words = [_parameter_words(name) for name in large]
    return words[0] if len(words) == 1 else f"a combination of {', '.join(words[:-1])} and {words[-1]}"


def _parameter_words(name: str) -> str:
    if name in NUMBERS[1:4]:
        return f"the centre of mass along {name[1]}"
    if name in NUMBERS[4:7]:
        return f"the moment about {name[1]}"
    if name in NUMBERS[7:]:
        return f"the product of inertia {name[1:]}"
    return f"the {name}"


_FORMAT: Final = "polhode.Identified/1"
_ARRAYS: Final = ("estimate", "covariance", "crlb", "residuals")
_NUMBERS: Final = ("chi2", "degrees_of_freedom", "p_value", "gap")
_TRUTHS: Final = ("at_edge", "linear", "scale_known")
_UNCERTAINTIES: Final = ("noise", "bias", "scale", "sensor_place")
_OTHERS: Final = (
    "body", "parameters", "columns", *_UNCERTAINTIES, "observability", "dropped", "window", "start",
    "start_covariance", "free", "rotor", "alternatives",
)  # fmt: skip
_FIELDS: Final = (*_ARRAYS, *_NUMBERS, *_TRUTHS, *_OTHERS)
_STATE: Final = ("omega", "attitude")


def _save(found: Identified, path: str | PathLike[str]) -> None:
    file = Path(path)
    if file.suffix.lower() != ".json":
        raise ValueError(f"path: {file} does not end in .json; name it so")
    write_json(file, {"format": _FORMAT} | _fields(found, file))


def _read(path: str | PathLike[str]) -> Identified:
    file = Path(path)
    if file.suffix.lower() != ".json":
        raise ValueError(f"path: {file} does not end in .json; the result of an identification is JSON")
    return _result(read_record(file, _FORMAT, _FIELDS), file)


def _fields(found: Identified, file: Path) -> dict[str, Any]:
    fields: dict[str, Any] = {"body": in_json(body_fields(found.body), file)}
    fields["parameters"] = list(found.parameters)
    fields["columns"] = list(found.columns)
    fields |= in_json({name: getattr(found, name) for name in _ARRAYS}, file)
    for name in _NUMBERS:
        value = getattr(found, name)
        fields[name] = None if isinstance(value, float) and math.isnan(value) else value
    fields |= {name: bool(getattr(found, name)) for name in _TRUTHS}
    for name in _UNCERTAINTIES:
        value = getattr(found, name)
        if value is not None:
            both = {"value": np.asarray(value.value), "covariance": np.asarray(value.covariance)}
            fields[name] = in_json(both, file)
    fields["observability"] = [
        {
            "words": one.words,
            "parameters": one.parameters.tolist(),
            "relative": None if math.isinf(one.relative) else one.relative,
            "sigma": None if math.isinf(one.sigma) else one.sigma,
            "remedy": one.remedy,
        }
        for one in found.observability
    ]
    fields["dropped"] = dict(found.dropped)
    if found.window is not None:
        fields["window"] = found.window
    if found.start is not None:
        fields["start"] = {name: getattr(found.start, name).tolist() for name in _STATE}
        if found.motion is None:
            fields["free"] = False
        rotor = getattr(found.motion, "rotor", None)
        if rotor is not None:
            fields["rotor"] = np.asarray(rotor).tolist()
    if found.start_covariance is not None:
        fields["start_covariance"] = in_json({"_": found.start_covariance}, file)["_"]
    if found.alternatives:
        fields["alternatives"] = [_fields(one, file) for one in found.alternatives]
    return fields


def _result(fields: dict[str, Any], file: Path) -> Identified:
    def need(name: str) -> Any:
        return require_field(fields, name, file)

    def wrong(name: str, expected: str) -> FileFormatError:
        return FileFormatError(f"{file}: {name} is not {expected}; save it again")

    if not isinstance(need("body"), dict):
        raise wrong("body", "an object with the fields of a body")
    check_names(fields["body"], (*BODY_FIELDS, *WORDS), f"{file}: body")
    body = body_of(fields["body"], file)
    names = need("parameters")
    if not isinstance(names, list) or not all(isinstance(one, str) for one in names):
        raise wrong("parameters", "a list of names")
    columns = fields.get("columns", [])
    if not isinstance(columns, list) or not all(isinstance(one, str) for one in columns):
        raise wrong("columns", "a list of names")
    n = len(names)
    arrays: dict[str, Any] = {name: numbers(need(name), name, file, with_holes=True) for name in _ARRAYS}
    for name, shape in {"estimate": (n,), "covariance": (n, n), "crlb": (n, n)}.items():
        if arrays[name].shape != shape:
            raise FileFormatError(f"{file}: {name} has shape {arrays[name].shape}, expected {shape}")
    told: dict[str, Any] = {}
    for name in _NUMBERS:
        value = need(name)
        told[name] = math.nan if value is None else _number(value, name, file)
    if not told["degrees_of_freedom"].is_integer():
        raise wrong("degrees_of_freedom", "a whole number")
    told["degrees_of_freedom"] = int(told["degrees_of_freedom"])
    for name in _TRUTHS:
        told[name] = need(name)
        if not isinstance(told[name], bool):
            raise wrong(name, "true or false")
    for name in _UNCERTAINTIES:
        told[name] = _uncertain(fields, name, file)
    dropped = need("dropped")
    if not isinstance(dropped, dict) or not all(isinstance(one, int) for one in dropped.values()):
        raise wrong("dropped", "an object of counts")
    window = fields.get("window")
    if window is not None and (isinstance(window, bool) or not isinstance(window, int)):
        raise wrong("window", "a whole number")
    lists = {"observability": need("observability"), "alternatives": fields.get("alternatives", [])}
    for name, value in lists.items():
        if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
            raise wrong(name, "a list of objects")
    for one in lists["alternatives"]:
        check_names(one, (*_FIELDS, *WORDS), f"{file}: alternatives")
    start: State | None = None
    motion: FreeMotion | GyrostatMotion | None = None
    if "start" in fields:
        given = fields["start"]
        if not isinstance(given, dict) or set(given) != set(_STATE):
            raise wrong("start", "an object with omega and attitude")
        omega, attitude = (numbers(given[name], name, file) for name in _STATE)
        start = State(omega, attitude, np.zeros(3), np.zeros(3))
        rotor = numbers(fields["rotor"], "rotor", file) if "rotor" in fields else None
        is_free = fields.get("free", True)
        if not isinstance(is_free, bool):
            raise wrong("free", "true or false")
        try:
            if is_free and rotor is None:
                motion = body.free_motion(omega, attitude)
            elif is_free:
                motion = _certain(body).gyrostat(rotor).free_motion(omega, attitude)
        except ValueError as error:
            raise FileFormatError(f"{file}: {error}") from error
    spread = fields.get("start_covariance")
    if spread is not None:
        spread = numbers(spread, "start_covariance", file, with_holes=True)
    return Identified(
        body=body, parameters=tuple(names), columns=tuple(columns), **arrays, **told, dropped=dropped,
        window=window,
        observability=tuple(_direction_of(one, file) for one in lists["observability"]),
        start=start, motion=motion,
        start_covariance=spread,
        alternatives=tuple(_result(one, file) for one in lists["alternatives"]),
    )  # fmt: skip


def _number(value: Any, name: str, file: Path) -> float:
    found = numbers(value, name, file)
    if found.shape != ():
        raise FileFormatError(f"{file}: {name} has shape {found.shape}, expected one number")
    return float(found)


def _certain(body: RigidBody) -> RigidBody:
    """Return the body without sigmas, which are not followed through the motion of a gyrostat."""
    return RigidBody(mass=float(body.mass), inertia=body.inertia, center_of_mass=body.center_of_mass)


def _uncertain(fields: dict[str, Any], name: str, file: Path) -> Uncertain | None:
    given = fields.get(name)
    if given is None:
        return None
    if not isinstance(given, dict) or set(given) != {"value", "covariance"}:
        raise FileFormatError(f"{file}: {name} is not an object with value and covariance; save it again")
    value, covariance = (numbers(given[part], f"{name}.{part}", file) for part in ("value", "covariance"))
    try:
        return Uncertain(value, covariance=covariance)
    except ValueError as error:
        raise FileFormatError(f"{file}: {name}: {error}") from error


def _direction_of(given: dict[str, Any], file: Path) -> Direction:
    known = ("words", "parameters", "relative", "sigma", "remedy")
    check_names(given, known, f"{file}: observability")
    words, remedy = (require_field(given, name, file) for name in ("words", "remedy"))
    if not isinstance(words, str) or not isinstance(remedy, str):
        raise FileFormatError(f"{file}: observability: words and remedy are not text; save it again")
    change = numbers(require_field(given, "parameters", file), "observability.parameters", file)
    if change.ndim != 1:
        raise FileFormatError(f"{file}: observability.parameters has shape {change.shape}, expected (P,)")
    sizes = (require_field(given, name, file) for name in ("sigma", "relative"))
    sigma, relative = (math.inf if one is None else _number(one, "observability", file) for one in sizes)
    return Direction(words, change, sigma, relative, remedy)
