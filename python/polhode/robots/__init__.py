"""Robots from URDF, SDF and MJCF files: tests of the inertia of each link, and better values.

Simulators use the inertia that a file declares, without a test. :func:`check` compares each link with the
laws that every rigid body obeys, with the size of its geometry, and with that geometry filled uniformly.
:func:`fix` writes better values, and leaves every other byte of the file as it is.
"""

from __future__ import annotations

import os
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from polhode._format import Argument
from polhode._hints import check_kind
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.content import EXPECTED_CONTENT, content_format, rename
from polhode.io.xml_source import Edit, apply_edits, parse_xml
from polhode.robots import mjcf, sdf, urdf
from polhode.robots.geometry import GeometryReader
from polhode.robots.macros import expand, has_macros
from polhode.robots.model import Inertial, Joint, Link, Place, Robot, Shape, shorten
from polhode.robots.room import MARKER
from polhode.robots.sdf import check_version
from polhode.robots.sources import Addresses, Sources, own_root, read_source
from polhode.robots.verdict import FAILURES, Verdict, judge, replacement

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

__all__ = [
    "FAILURES",
    "Inertial",
    "Joint",
    "Link",
    "Place",
    "Robot",
    "Shape",
    "Verdict",
    "check",
    "fix",
    "parse_robot",
    "read_robot",
]

NO_ROBOT: Final = "no robot"
"""Kind of the error of a file that is no robot: of another root, without a link, or XML of something else."""
_FORMATS = {
    "robot": ("URDF", urdf),
    "sdf": ("SDF", sdf),
    "gazebo": ("SDF", sdf),  # of SDF 1.2
    "mujoco": ("MJCF", mjcf),
}


def read_robot(
    path: str | os.PathLike[str],
    packages: Sequence[str | os.PathLike[str]] = (),
    *,
    allow_outside: bool = False,
    arguments: Mapping[str, str] | None = None,
) -> Robot:
    """Read a robot file.

    Parameters
    ----------
    path : str or os.PathLike
        A URDF, SDF or MJCF file; its root element tells the format. Declarations of entities and document
        types are an error. Included files and attached models are read too; nothing is fetched from a
        network. Macros of xacro are expanded if xacro is installed (extra ``xacro``): it computes the
        expressions of the file and reads what the file includes, anywhere.
    packages : sequence of str or os.PathLike
        Folders that hold the packages of ``package://`` and ``model://`` addresses, see :func:`check`.
    allow_outside : bool
        Whether files that the robot file names may be in any folder. By default they are read only in the
        package of the model and in those of `packages`, see :func:`check`.
    arguments : mapping of str to str, optional
        Values of the arguments (``<xacro:arg>``) of a xacro file.

    Returns
    -------
    Robot

    Raises
    ------
    FileFormatError
        If the file has none of these formats, or is damaged.
    OSError
        If the file cannot be read.
    """
    file = Path(path)
    source = read_source(file)
    real, folder = Path(os.path.realpath(file)), file.absolute().parent
    roots = (own_root(real.parent),) if real.parent != Path(os.path.realpath(folder)) else ()
    homes = [*map(Path, packages), *roots]
    expansion = None
    if b"xacro:" in source and (tag := has_macros(parse_xml(source, str(file), remarks={}))):
        addresses = Addresses(folder, homes, allow_outside=allow_outside)
        name_of = partial(_relative, folder=Path(os.path.realpath(folder)))
        try:
            expansion = expand(file, addresses, dict(arguments or {}), name_of)
        except ModuleNotFoundError as error:
            raise FileFormatError(
                f"{file}: holds <{shorten(tag)}>; {error}; or expand it first: xacro {file} > out.urdf"
            ) from None
        source = expansion.source
    robot = parse_robot(source, name=str(file), folder=folder, packages=homes, allow_outside=allow_outside)
    if expansion is not None:
        robot = expansion.trace(robot, str(file))
    return replace(robot, roots=roots)


def _relative(path: Path, folder: Path) -> str:
    """Name a file as it is seen from a folder."""
    return Path(os.path.relpath(path, folder)).as_posix()


def parse_robot(
    source: bytes,
    *,
    name: str,
    folder: str | os.PathLike[str],
    packages: Sequence[str | os.PathLike[str]] = (),
    allow_outside: bool = False,
) -> Robot:
    """Read a robot from the bytes of its file.

    Parameters
    ----------
    source : bytes
        XML in UTF-8.
    name : str
        Name of the file in error messages.
    folder : str or os.PathLike
        Where relative addresses of meshes and included files start.
    packages : sequence of str or os.PathLike
        See :func:`check`.
    allow_outside : bool
        Whether files that the robot file names may be in any folder. By default they are read only in the
        package of the model and in those of `packages`, see :func:`check`.

    Returns
    -------
    Robot

    Examples
    --------
    >>> from polhode import robots
    >>> text = b'''<robot name="one"><link name="arm"><inertial><mass value="2"/>
    ... <inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'''
    >>> robot = robots.parse_robot(text, name="one.urdf", folder=".")
    >>> [(link.name, link.inertial.mass) for link in robot.links]
    [('arm', 2.0)]
    """
    if not isinstance(source, bytes):
        raise TypeError(
            f"source: expected the bytes of a file, got {type(source).__name__}; read_robot(path) reads one"
        )
    if not source.strip():
        raise _no_robot(f"{name}: the file is empty; check the file")
    body_format, _ = content_format(source[:4096], len(source))
    if body_format is not None:
        way_out = "polhode report reads it"
        if "gzip" in body_format:
            way_out = "unpack it with gunzip"
        elif body_format not in EXPECTED_CONTENT.get(Path(name).suffix.lower(), ()):
            way_out = f"{rename(Path(name), body_format, source[:4096])}, and {way_out}"
        raise _no_robot(f"{name}: is {body_format}, not a robot; {way_out}")
    home = Path(folder)
    addresses = Addresses(home, [Path(package) for package in packages], allow_outside=allow_outside)
    sources = Sources(home, addresses)
    try:
        root = parse_xml(source, name, budget=sources.budget, remarks=sources.notes)
    except FileFormatError as error:
        if not any(f"<{tag}".encode() in source for tag in _FORMATS):
            error.kind = NO_ROBOT
        raise
    if root.tag not in _FORMATS:
        raise _no_robot(
            f"{name}: its root is <{shorten(root.tag)}>, not <robot> (URDF), <sdf> or <mujoco> (MJCF); "
            "check the file"
        )
    check_version(root, name)
    format_name, reader = _FORMATS[root.tag]
    if unexpanded := has_macros(root):
        raise FileFormatError(
            f"{name}: holds <{shorten(unexpanded)}>; expand it first: xacro {name} > out.urdf"
        )
    try:
        links = tuple(reader.links(root, sources))
    except ValueError as error:
        raise FileFormatError(f"{name}: ", *error.args) from None
    if not links:
        if format_name == "MJCF" and any(root.all("body")):
            raise _no_robot(
                f"{name}: its bodies stand outside <worldbody>, as in a part that models include; check the "
                "model that includes it"
            )
        raise _no_robot(f"{name}: holds no link; check the file")
    read = f"read too: {', '.join(sources.names)}"
    notes = (*([read] if sources.names else []), *sources.notes)
    model = root if format_name != "SDF" else next(root.descendants("model"), root)
    title = sources.prefix(model.attributes.get("name", model.attributes.get("model", "")))
    joints = tuple(sources.joints)
    files = {name: next(iter(paths)) for name, paths in sources.names.items() if len(paths) == 1}
    return Robot(
        format_name,
        title,
        links,
        home,
        source,
        notes,
        joints=joints,
        total_mass=sources.total_mass,
        files=files,
    )


def _no_robot(message: str) -> FileFormatError:
    error = FileFormatError(message)
    error.kind = NO_ROBOT
    return error


def check(
    robot: Robot,
    packages: Sequence[str | os.PathLike[str]] = (),
    *,
    allow_outside: bool = False,
    density: float | None = None,
    mass: float | None = None,
) -> list[Verdict]:
    """Check the inertia of every link.

    Parameters
    ----------
    robot : Robot
        A robot from :func:`read_robot`.
    packages : sequence of str or os.PathLike
        Folders that hold the packages of ``package://`` and ``model://`` addresses; folders above the file,
        ``ROS_PACKAGE_PATH``, ``GZ_SIM_RESOURCE_PATH``, ``IGN_GAZEBO_RESOURCE_PATH``, ``GAZEBO_MODEL_PATH``,
        ``SDF_PATH`` and ``AMENT_PREFIX_PATH`` are searched too.
    allow_outside : bool
        Whether meshes may be in any folder. By default they are read only in these folders and where the
        model is: in the package that contains it (marked by ``package.xml``, ``manifest.xml`` or
        ``model.config``) or, without one, its checkout (``.git``, ``.hg``), its Python package, or its own
        folder. If the name of this folder is ``urdf``, ``sdf``, ``mjcf``, ``xml``, ``robots`` or ``worlds``,
        its parent folder is allowed too. Other packages above or beside it are read too, if they are marked
        as packages. Symbolic links to files elsewhere are not followed. The notes of the link name the files
        that were not read.
    density : float, optional
        Density in kg/m^3 of links for which the file states no mass; :func:`fix` writes the mass that
        follows.
    mass : float, optional
        Total mass in kg of these links, divided among them by volume; in place of `density`.

    Returns
    -------
    list of Verdict
        One for each link.

    Examples
    --------
    >>> from polhode import robots
    >>> text = b'''<robot name="one"><link name="arm"><inertial><mass value="2"/>
    ... <inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'''
    >>> (verdict,) = robots.check(robots.parse_robot(text, name="one.urdf", folder="."))
    >>> verdict.verdict
    'impossible'
    """
    check_kind(robot, "robot", "Robot")
    declared = [Path(package) for package in (*packages, *robot.roots)]
    addresses = Addresses(robot.folder, declared, allow_outside=allow_outside)
    if density is not None and mass is not None:
        raise ValueError("density and mass: give one of them, not both")
    for name, value in (("density", density), ("mass", mass)):
        if value is not None and not 0.0 < value < np.inf:
            raise ValueError(f"{name}: expected a finite number above 0, got {value!r}")
    if density is not None and density > MARKER:
        raise PolhodeError(
            Argument("density"),
            f": {density:.6g} kg/m^3, and no matter has more than {MARKER:g}; state the one of the material",
        )
    return judge(robot, GeometryReader(robot.folder, addresses), density, mass)


def fix(robot: Robot, verdicts: Sequence[Verdict], words: Collection[str] = FAILURES) -> bytes:
    """Write better values into the links that fail the test, or whose tensor is at the limit of the possible.

    What is written is a body's also after rounding: no engine finds I1 + I2 < I3 there. It is never computed
    from shapes in which the mass would be denser than 25,000 kg/m^3. In URDF and MJCF no moment is so small
    that MuJoCo refuses it. What is left as it is has a note that says why.

    Parameters
    ----------
    robot : Robot
    verdicts : sequence of Verdict
        Verdicts from :func:`check`.
    words : collection of str
        Links with one of these verdicts are corrected.

    Returns
    -------
    bytes
        The file; only the numbers of those links are changed.

    Examples
    --------
    >>> from polhode import robots
    >>> text = b'''<robot name="one"><link name="ball"><inertial><mass value="5"/>
    ... <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    ... <visual><geometry><sphere radius="0.1"/></geometry></visual></link></robot>'''
    >>> robot = robots.parse_robot(text, name="one.urdf", folder=".")
    >>> print(robots.fix(robot, robots.check(robot)).decode().splitlines()[1])
    <inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    """
    check_kind(robot, "robot", "Robot")
    edits: list[Edit] = []
    for link, verdict in zip(robot.links, verdicts, strict=True):
        better = replacement(verdict, words)
        if better is not None and link.rewrite is not None:
            edits += link.rewrite(robot.source, better)
    return apply_edits(robot.source, edits)


if not TYPE_CHECKING:

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        from polhode._hints import no_name

        raise no_name(__name__, name, __all__)
