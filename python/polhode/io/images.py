"""Voxels in NIfTI, NRRD and NumPy files, bodies of segmentations, densities from grey values."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import Argument, short
from polhode._optional import require
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import check_ordinary, naming
from polhode.units import metres_per

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from polhode._core import RigidBody
    from polhode._typing import SupportsSigma

    Floats = NDArray[np.float64]
    Number = float | _core.Uncertain | SupportsSigma

__all__ = [
    "IMAGE_SUFFIXES",
    "Image",
    "bodies_of_labels",
    "body_of_image",
    "grey_value_density",
    "is_image",
    "metres_per_unit",
    "read_image",
    "unit_of",
]

IMAGE_SUFFIXES: Final = (".nii", ".nii.gz", ".nrrd", ".nhdr", ".npy")
"""Ends of the names of files that are read as images."""
_OTHERS: Final = "*"
_BACKGROUND: Final = 0
_UNITS: Final = {
    "mm": "mm",
    "meter": "m",
    "micron": "um",
    "m": "m",
    "cm": "cm",
    "um": "um",
    "µm": "um",
    "nm": "nm",
}
"""Names of units in files, with their names here."""
_SHOWN: Final = 12


class Image(NamedTuple):
    """Values on a grid of voxels.

    Attributes
    ----------
    values : numpy.ndarray, shape (nx, ny, nz)
    affine : numpy.ndarray, shape (4, 4)
        The centre of voxel (i, j, k) is ``affine @ (i, j, k, 1)``, in the axes and the unit of the file.
    unit : str or None
        Unit of length of the file, one of those in :data:`polhode.units.METRES`; None where it states none.
    """

    values: NDArray[Any]
    affine: Floats
    unit: str | None

    def __repr__(self) -> str:
        return short(self)


def is_image(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is read as an image, by its name.

    Parameters
    ----------
    path : str or os.PathLike

    Examples
    --------
    >>> from polhode.images import is_image
    >>> is_image("femur.nii.gz"), is_image("femur.stl")
    (True, False)
    """
    return os.fspath(path).lower().endswith(IMAGE_SUFFIXES)


def read_image(path: str | os.PathLike[str]) -> Image:
    """Read an image: NIfTI by nibabel, NRRD by pynrrd (extra ``image``), arrays of NumPy (``.npy``).

    Parameters
    ----------
    path : str or os.PathLike
        ``.nii``, ``.nii.gz``, ``.nrrd``, ``.nhdr`` or ``.npy``. An array of NumPy has no unit, and its
        voxels are
        cubes of edge 1 with the first one at the origin.

    Returns
    -------
    Image
        The axes are those of the file: NIfTI's first axis runs to the patient's right, its second to the
        front and its
        third to the head (RAS); NRRD says which in its header, mostly left, back and head (LPS). The two
        differ by half
        a turn about the third axis.

    Raises
    ------
    FileFormatError
        When the file is damaged, or not an image of three dimensions.
    ModuleNotFoundError
        With the line that installs the reader.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from polhode.images import read_image
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "mask.npy")
    ...     np.save(path, np.ones((2, 3, 4)))
    ...     read_image(path).values.shape
    (2, 3, 4)
    """
    file = Path(path)
    check_ordinary(file)
    name = file.name.lower()
    if name.endswith((".nii", ".nii.gz")):
        image = _read_nifti(file)
    elif name.endswith((".nrrd", ".nhdr")):
        image = _read_nrrd(file)
    elif name.endswith(".npy"):
        try:
            with naming(file):
                values = np.load(file, allow_pickle=False)
        except ValueError as error:
            raise FileFormatError(
                file, f": not an array of NumPy: {error}; save it again with numpy.save"
            ) from None
        image = Image(values, np.eye(4), None)
    else:
        raise FileFormatError(file, f": not the name of an image; use one of {', '.join(IMAGE_SUFFIXES)}")
    values = image.values
    while values.ndim > 3 and values.shape[-1] == 1:  # one instant, or one channel
        values = values[..., 0]
    if values.ndim != 3:
        raise FileFormatError(
            file,
            f": an image of three dimensions is needed, and this one has the shape {values.shape}; "
            "save one instant or one channel of it",
        )
    if values.dtype.kind not in "biuf":
        raise FileFormatError(
            file, f": its values are no real numbers ({values.dtype}); save one channel of it"
        )
    return image._replace(values=values)


def _read_nifti(file: Path) -> Image:
    nibabel = require("nibabel", extra="image", purpose=f"{file}: reading NIfTI")
    try:
        image = nibabel.load(file)
        values = np.asanyarray(image.dataobj)
    except FileNotFoundError:
        raise
    except Exception as error:  # nibabel has many, and zlib its own
        raise FileFormatError(file, f": not a whole NIfTI file: {error}; export it again") from None
    return Image(
        values, np.array(image.affine, dtype=np.float64), _UNITS.get(image.header.get_xyzt_units()[0])
    )


def _read_nrrd(file: Path) -> Image:
    nrrd = require("nrrd", extra="image", purpose=f"{file}: reading NRRD")
    try:
        values, header = nrrd.read(os.fspath(file))
    except FileNotFoundError:
        raise
    except Exception as error:  # pynrrd has many, and zlib its own
        raise FileFormatError(file, f": not a whole NRRD file: {error}; export it again") from None
    affine = np.eye(4)
    directions = header.get("space directions")
    if directions is not None:
        rows = np.array(
            [row for row in directions if row is not None and not np.isnan(row).any()], dtype=np.float64
        )
        if rows.shape != (3, 3):
            raise FileFormatError(file, f": space directions: expected three vectors, got {directions}")
        affine[:3, :3] = rows.T
    elif (spacings := header.get("spacings", header.get("axis mins"))) is not None and "spacings" in header:
        affine[:3, :3] = np.diag(np.asarray(spacings, dtype=np.float64)[:3])
    origin = header.get("space origin")
    if origin is not None:
        affine[:3, 3] = origin
    units = {
        _UNITS.get(str(unit).strip('"')) for unit in header.get("space units", header.get("units", ())) or ()
    }
    return Image(values, affine, next(iter(units)) if len(units) == 1 else None)


def grey_value_density(table: ArrayLike) -> Callable[[ArrayLike], Floats]:
    """Make densities from grey values, such as CT numbers in Hounsfield units, by a table.

    Between two rows of the table the density is linear. Below its first value it is that of the first row,
    so that padding and air
    count as the first row says. A value above the last one is an error, since metal may be any denser.

    Parameters
    ----------
    table : array_like, shape (n, 2)
        Rows of a grey value and a density, ascending by the value: the calibration of the scanner.

    Returns
    -------
    callable
        Takes the values of an image and returns densities of the same shape. It is a `density` of
        ``RigidBody.from_file``.

    Examples
    --------
    >>> from polhode.images import grey_value_density
    >>> density = grey_value_density([(-1000, 0.0), (0, 1000.0), (2000, 2200.0)])
    >>> density([-3024, -500, 0, 100])
    array([   0.,  500., 1000., 1060.])
    """
    rows = _core.real_numbers(table, "table")
    if rows.ndim != 2 or rows.shape[1] != 2 or len(rows) < 2:
        raise ValueError(
            f"table: expected rows of a value and a density, shape (n, 2), n of 2 or more, got {rows.shape}"
        )
    values, densities = rows.T
    for what, wrong in (
        ("finite", ~np.isfinite(rows).all(axis=1)),
        ("above the value before it", np.append(False, np.diff(values) <= 0.0)),
        ("of a density of 0 or more", densities < 0.0),
    ):
        if wrong.any():
            row = int(np.argmax(wrong))
            raise PolhodeError(
                f"table: row {row} must be {what}, got {values[row]:g}, {densities[row]:g}; correct it"
            )

    def density(image: ArrayLike) -> Floats:
        grey = np.asarray(image, dtype=np.float64)
        highest = float(grey.max(initial=-math.inf))
        if not highest <= values[-1]:
            raise PolhodeError(
                f"table: it ends at {values[-1]:g}, and the image has the value {highest:g}; add a row for it"
            )
        found: Floats = np.interp(grey, values, densities)
        return found

    return density


def body_of_image(
    image: Image,
    density: Number | Mapping[Any, float] | Callable[[NDArray[Any]], ArrayLike] | None = None,
    mass: Number | None = None,
    scale: float = 1.0,
) -> RigidBody:
    """Make the body of an image, its voxels homogeneous cells.

    Parameters
    ----------
    image : Image
    density : float, mapping or callable
        A number that the values are multiplied by, where they are a mask or fractions; ``{value: number}``
        with the density of
        the voxels of each value, ``"*"`` for all other values but 0; or a function of the values, such as
        :func:`grey_value_density`. Values that the mapping does not name have no matter.
    mass : float
        Instead of a density: the total mass, spread in proportion to the values.
    scale : float
        Factor of all lengths.

    Returns
    -------
    RigidBody

    Examples
    --------
    >>> import numpy as np
    >>> from polhode.images import Image, body_of_image
    >>> mask = np.zeros((4, 4, 4))
    >>> mask[1:3, 1:3, 1:3] = 1
    >>> round(body_of_image(Image(mask, np.diag([2.0, 2.0, 2.0, 1.0]), "mm"), 1000.0, scale=1e-3).mass, 9)
    6.4e-05
    """
    if (density is None) == (mass is None):
        raise TypeError("give exactly one of mass= and density=")
    values = image.values
    weight: Any = 1.0
    if density is None or not (callable(density) or isinstance(density, Mapping)):
        found: Any = values
        weight = 1.0 if density is None else density
        _check_factors(values, weight)
    elif callable(density):
        # Arithmetic on the 16-bit numbers of a scan would wrap around.
        found = np.asarray(density(values.astype(np.float64, copy=False)), dtype=np.float64)
        if found.shape != values.shape:
            raise ValueError(
                f"density: expected it to return shape {values.shape}, a number for each voxel, got "
                f"{found.shape}"
            )
    else:
        found = np.zeros(values.shape)
        for value, number in _by_value(density, np.unique(values).tolist()).items():
            found[values == value] = number
    affine = np.array(image.affine, dtype=np.float64)
    affine[:3] *= scale
    if found.dtype.kind == "b":
        found = found.astype(np.float64)
    body = _core.RigidBody.from_voxels(found, affine=affine)
    if mass is not None:
        return body.scaled(mass=1.0 / float(body.mass)).scaled(mass=mass)
    return body if isinstance(weight, float) and weight == 1.0 else body.scaled(mass=weight)


def _check_factors(values: NDArray[Any], weight: Number) -> None:
    """Refuse to multiply labels and grey values, which are whole numbers above 1."""
    highest = values.max(initial=0)
    if isinstance(weight, float | int) and weight == 1.0:  # the values are densities themselves
        return
    if highest > 1 and (values.dtype.kind in "biu" or bool((values == np.round(values)).all())):
        raise PolhodeError(
            Argument("density"),
            f": a number multiplies the values, and these are whole numbers up to {highest:g}, such as "
            "labels and grey values; give the density of each value, of '*' for all but 0, or a function of "
            "them",
        )


def _by_value(density: Mapping[Any, Any], present: list[Any]) -> dict[Any, float]:
    """Return the density of each value that has one; a name may be a text that is a number."""
    found: dict[Any, float] = {}
    for name, number in density.items():
        if name == _OTHERS:
            continue
        try:
            value = float(name)
        except (TypeError, ValueError):
            value = math.nan
        if value not in present:
            known = ", ".join(f"{x:g}" for x in present[:_SHOWN]) + (" …" if len(present) > _SHOWN else "")
            raise PolhodeError(
                Argument("density"), f": no voxel has the value {name!r}; the values are {known}"
            )
        found[value] = number
    if _OTHERS in density:
        found |= {value: density[_OTHERS] for value in present if value not in found and value != _BACKGROUND}
    return found


def unit_of(image: Image, path: str | os.PathLike[str], length_unit: str | None) -> str | None:
    """Return the unit of an image: that of its file, or the one that is stated."""
    if length_unit is None or image.unit in (None, length_unit):
        return length_unit or image.unit
    metres_per(length_unit)
    raise PolhodeError(
        Argument("length_unit"),
        f": {os.fspath(path)} says itself that its unit is {image.unit!r}, not {length_unit!r}; leave ",
        Argument("length_unit"),
        " out",
    )


def metres_per_unit(image: Image, path: str | os.PathLike[str], length_unit: str | None) -> float:
    """Return the metres in a unit of an image for Python, where a scan without a unit is refused."""
    unit = unit_of(image, path, length_unit)
    if unit is not None:
        return metres_per(unit)
    if not os.fspath(path).lower().endswith(".npy"):
        raise PolhodeError(
            Argument("length_unit"),
            f": {os.fspath(path)} states no unit of length; give ",
            Argument("length_unit", "mm"),
            ", as scanners have it, or the one it is in",
        )
    return 1.0


def bodies_of_labels(
    labels: ArrayLike | os.PathLike[str],
    density: ArrayLike | Mapping[int | str, float],
    spacing: ArrayLike | None = None,
    origin: ArrayLike | None = None,
    affine: ArrayLike | None = None,
    length_unit: str | None = None,
) -> tuple[NDArray[np.int64], RigidBody]:
    """Make a body for each label of an image, with the parameters of ``RigidBody.from_labelled_voxels``."""
    if isinstance(labels, (str, os.PathLike)):
        asked = {"spacing": spacing, "origin": origin, "affine": affine}
        name = next((name for name, value in asked.items() if value is not None), None)
        if name is not None:
            raise PolhodeError(
                Argument(name), f": {os.fspath(labels)} says itself where its voxels are; leave it out"
            )
        image = read_image(labels)
        step = image.affine.copy()
        step[:3] *= metres_per_unit(image, labels, length_unit)
        from polhode.io.mesh_solid import naming_file

        with naming_file(labels):
            return bodies_of_labels(image.values, density, affine=step)
    if length_unit is not None:
        raise PolhodeError(
            Argument("length_unit"), ": is for files; lengths of arrays are those of spacing or affine"
        )
    own = _label_array(labels)
    weights = density if isinstance(density, Mapping) else _core.real_numbers(density, "density")
    is_image = not isinstance(weights, Mapping) and weights.ndim > 0
    if not isinstance(weights, Mapping) and weights.shape not in ((), own.shape):
        raise ValueError(
            f"density: expected one number, a mapping of labels, or an array of the shape of labels "
            f"{own.shape}, got {weights.shape}"
        )
    if own.flags.f_contiguous and not own.flags.c_contiguous and not is_image:  # as nibabel reads it
        own, spacing, origin, affine = _turned_round(own, spacing, origin, affine)
    try:
        own = np.require(own, requirements=("C", "A"))
    except MemoryError as error:
        raise MemoryError(f"labels: {error}; take a part of the image") from None
    ranges: dict[int, NDArray[np.uint64]] = {}

    def choose(names: NDArray[np.int64], _: NDArray[np.uint64], of: NDArray[np.uint64]) -> Floats | None:
        known = names.tolist()
        if is_image:
            ranges.update((name, box) for name, box in zip(known, of, strict=True) if name != _BACKGROUND)
            return None
        if isinstance(weights, Mapping):
            found = _by_value(weights, known)
            return np.array([found.get(name, 0.0) for name in known])
        if float(weights) == 0.0:
            raise PolhodeError(Argument("density"), ": must be positive, got 0.0")
        return np.where(names == _BACKGROUND, 0.0, float(weights))

    made = _core.labelled_voxels(own, spacing, origin, affine, choose)
    if made is not None:
        return made
    assert not isinstance(weights, Mapping)
    step = _affine_of(spacing, origin, affine)
    found = [_body_of_label(own, weights, step, name, box) for name, box in ranges.items()]
    if not found:
        return np.empty(0, np.int64), _core.RigidBody.from_labelled_particles([], np.zeros((0, 3)), [])
    return np.array([*ranges], np.int64), _core.RigidBody.stack(found)


def _body_of_label(
    labels: NDArray[Any], density: Floats, affine: Floats, name: int, box: NDArray[np.uint64]
) -> RigidBody:
    """Return the body of one label of an image of densities, from the cells around it alone."""
    part = tuple(slice(int(first), int(end)) for first, end in box)
    own = affine.copy()
    own[:3, 3] += affine[:3, :3] @ box[:, 0].astype(np.float64)
    try:
        return _core.RigidBody.from_voxels(np.where(labels[part] == name, density[part], 0.0), affine=own)
    except PolhodeError as error:
        error.args = (f"label {name}: ", *error.args)
        raise


def _affine_of(spacing: ArrayLike | None, origin: ArrayLike | None, affine: ArrayLike | None) -> Floats:
    if affine is not None:
        return np.vstack([np.asarray(affine, dtype=np.float64)[:3], [0.0, 0.0, 0.0, 1.0]])
    assert spacing is not None  # what is missing the compiled library has refused
    made = np.diag([*np.broadcast_to(np.asarray(spacing, dtype=np.float64), (3,)), 1.0])
    made[:3, 3] = 0.0 if origin is None else np.asarray(origin, dtype=np.float64)
    return made


def _turned_round(
    labels: NDArray[Any], spacing: ArrayLike | None, origin: ArrayLike | None, affine: ArrayLike | None
) -> tuple[NDArray[Any], ArrayLike | None, ArrayLike | None, ArrayLike | None]:
    """Exchange the first and the last axis, so that labels need not be copied, where arguments fit."""
    try:
        known = _affine_of(spacing, origin, affine)
    except (ValueError, TypeError, AssertionError):
        return labels, spacing, origin, affine
    is_fit = (spacing is None) != (affine is None) and (origin is None or affine is None)
    if not is_fit or known.shape != (4, 4) or (spacing is not None and not (np.asarray(spacing) > 0.0).all()):
        return labels, spacing, origin, affine
    if (
        affine is not None
        and np.shape(affine) == (4, 4)
        and not np.array_equal(np.asarray(affine)[3], [0, 0, 0, 1])
    ):
        return labels, spacing, origin, affine
    return labels.T, None, None, known[:, [2, 1, 0, 3]]


def _label_array(labels: ArrayLike) -> NDArray[Any]:
    """Return labels as an array of numbers that the compiled library takes."""
    own = np.asarray(labels)
    if own.dtype.kind == "b":
        return own.view(np.uint8)
    if own.dtype.kind not in "iuf":
        raise TypeError(f"labels: expected whole numbers, got {own.dtype}")
    if own.dtype.kind == "f" and own.dtype.itemsize not in (4, 8):
        return own.astype(np.float64)
    return own.astype(own.dtype.newbyteorder("="), copy=False)
