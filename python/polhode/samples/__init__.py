"""Sample files in the package: meshes, molecules, a robot, a ledger, an assembly.

``polhode samples FOLDER`` copies them into a folder. They were made for this package, by formulas or by hand,
and have the licence of the package.
"""

from __future__ import annotations

from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Final

from polhode.errors import PolhodeError
from polhode.io.budget import status_of

if TYPE_CHECKING:
    from os import PathLike

__all__ = ["about", "copy", "names", "path"]

_FOLDER: Final = Path(__file__).parent

_ABOUT: Final = {
    "asteroid.obj": "an asteroid with two lobes, 476 m long, by a formula; metres",
    "benzene.xyz": "benzene, an oblate top",
    "bracket.ply": "an angle bracket, coordinates as text; inches",
    "craft.csv": "a ledger: the parts of a spacecraft with their standard deviations",
    "robot.sdf": "the robot as SDFormat",
    "robot.urdf": "a robot of three links, one of which holds a placeholder; its mesh is t-handle.stl",
    "rover.toml": "an assembly: a rover on six wheels of wheel.toml",
    "t-handle.stl": "the steel T-handle that flips: a bar of 100 x 16 x 16 on a stem of 50; millimetres",
    "torus.obj": "a ring of radii 40 and 10; millimetres",
    "tumble.csv": "a record of a tumbling body: times, attitudes, angular velocities; moments 2, 3, 4",
    "water.xyz": "water, an asymmetric top",
    "wheel.toml": "an assembly: a wheel with its motor",
}


def names() -> tuple[str, ...]:
    """Return the names of the files.

    Examples
    --------
    >>> from polhode import samples
    >>> "t-handle.stl" in samples.names()
    True
    """
    return tuple(_ABOUT)


def about(name: str) -> str:
    """Describe a file in one line, with the unit of its lengths if the file does not state it.

    Parameters
    ----------
    name : str
        One of `names`.
    """
    if name not in _ABOUT:
        near = get_close_matches(str(name), _ABOUT, 1)
        way_out = f"did you mean {near[0]}?" if near else f"there are {', '.join(_ABOUT)}"
        raise PolhodeError(f"name: {str(name)[:60]!r} is no sample; {way_out}")
    return _ABOUT[name]


def path(name: str) -> Path:
    """Return the path of a file, for functions that read one.

    Parameters
    ----------
    name : str
        One of `names`.

    Returns
    -------
    pathlib.Path
        Path in the installed package. The file should be read, not changed.

    Examples
    --------
    >>> from polhode import RigidBody, samples
    >>> handle = RigidBody.from_file(samples.path("t-handle.stl"), density=7850, length_unit="mm")
    >>> round(handle.mass, 4), handle.principal.top
    (0.3014, 'asymmetric')
    """
    about(name)
    return _FOLDER / name


def copy(folder: str | PathLike[str]) -> tuple[Path, ...]:
    """Copy all files into a folder, which is created if needed.

    Parameters
    ----------
    folder : str or os.PathLike

    Returns
    -------
    tuple of pathlib.Path
        Paths of the copies.

    Raises
    ------
    PolhodeError
        If a file of one of these names exists there with another content. Nothing is written then.
    """
    from polhode.io.writing import write_bytes

    target = Path(folder)
    with suppress(FileNotFoundError):  # the folder is made
        status_of(target)
    if target.exists() and not target.is_dir():
        raise PolhodeError(f"folder: {target} is a file; name a folder")
    contents = {target / name: (_FOLDER / name).read_bytes() for name in _ABOUT}
    for place, content in contents.items():
        if place.exists() and not (place.is_file() and place.read_bytes() == content):
            raise PolhodeError(f"folder: {place} is there already, with other content; name another folder")
    target.mkdir(parents=True, exist_ok=True)
    for place, content in contents.items():
        write_bytes(place, content)
    return tuple(contents)
