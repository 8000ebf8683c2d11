"""Mass properties of a body for other programs, each with its own signs, order, axes and point.

Ours are the elements of the tensor, I_xy = −∫ x y dm, about C, in the axes of the body. What each program
means by its numbers, and where it says so, stands in ``docs/other_programs.md``. Every number is printed with
all its digits: reading it gives the same float.

Engines test I1 + I2 >= I3 without a tolerance, on moments that they compute themselves. A body on that edge,
such as a lamina, is therefore written inside it, by less than what they round.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode._core import RigidBody, principal_axes, principal_moments
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["LEAST_MOMENT", "PROGRAMS", "inside_edge", "mjcf_tensor", "to_text"]

LEAST_MOMENT: Final = {"MJCF": 1e-15, "URDF": 1e-14}
"""Limits in kg m^2. Up to the first (mjMINVAL, for masses in kg too) MuJoCo refuses moments of moving bodies;
up to the second it refuses eigenvalues of tensors that are not in principal axes, as in every URDF."""
# Of the trace. MuJoCo diagonalises, turns and joins tensors to 4 ε, in 24,000 random laminae.
_CLEAR: Final = 5.0 * 2.0**-52
_INSIDE: Final = 8.0 * 2.0**-52
# MuJoCo leaves elements up to 1e-12 kg m^2 beside the diagonal: below this moment they would count.
_SMALL: Final = 1e-6


def inside_edge(inertia: Floats) -> Floats:
    """Return a tensor that is still possible after an engine has rounded it.

    On the edge I1 + I2 = I3, as of a lamina or a rod, all three moments grow alike, by no more than 6e-15 of
    their sum, so that the axes stay. A tensor clear of the edge is returned as it is, the same object.
    """
    moments = np.asarray(principal_moments(inertia))
    largest = float(moments[2])
    if not largest > 0.0:
        return inertia
    first, second, _ = moments / largest
    margin, trace = first + second - 1.0, first + second + 1.0
    if margin >= _CLEAR * trace:
        return inertia
    inside: Floats = inertia + (_INSIDE * trace - margin) * largest * np.eye(3)
    return inside


def mjcf_tensor(inertia: Floats) -> dict[str, list[float]]:
    """Return a tensor as attributes of ``<inertial>``: in principal axes where MuJoCo loses digits."""
    moments = np.asarray(principal_moments(inertia))
    xx, yy, zz, *beside = _six(inertia)
    if not any(beside):
        return {"diaginertia": [xx, yy, zz]}
    if moments[0] >= _SMALL:
        return {"fullinertia": [xx, yy, zz, *beside]}
    principal = principal_axes(inertia)
    x, y, z, w = (principal.quaternion + 0.0).tolist()
    return {"quat": [w, x, y, z], "diaginertia": principal.moments.tolist()}


class _Numbers(NamedTuple):
    """Numbers of one body: elements xx yy zz xy xz yz about C and about O, axes as rows, tensor about C."""

    mass: float
    center: list[float]
    own: list[float]
    origin: list[float]
    moments: list[float]
    axes: list[list[float]]
    quaternion: list[float]
    tensor: Floats


def to_text(body: RigidBody, program: str) -> str:
    """Write the mass properties of a body for another program.

    Parameters
    ----------
    body : RigidBody
        One body, in kg and m.
    program : str
        ``"urdf"``, ``"sdf"``, ``"mjcf"``: the element for such a file. ``"mujoco"``, ``"drake"``,
        ``"pinocchio"``, ``"pybullet"``: lines of Python. ``"simulink"``: the fields of Simscape Multibody.
        ``"adams"``: statements of the solver. ``"solidworks"``: the printout of its mass properties.
        ``"onshape"``: the fields of its REST interface. ``"matlab"``: a ``rigidBody``, about its origin.

    Returns
    -------
    str
        Numbers with all their digits. The moments of a body on the edge I1 + I2 = I3, such as a lamina, are
        larger by less than 6e-15 of their sum, all three alike, so that the rounding of an engine does not
        make it impossible.

    Raises
    ------
    PolhodeError
        For ``"mjcf"`` and ``"mujoco"``, if the mass or a moment is up to 1e-15, which MuJoCo refuses.

    Examples
    --------
    >>> from polhode import RigidBody
    >>> from polhode import interop
    >>> body = RigidBody(2.0, [(3.0, -0.5, 0), (-0.5, 4.0, 0), (0, 0, 5.0)], (0, 0, 0.1))
    >>> print(interop.to_text(body, "urdf"))
    <inertial>
      <origin xyz="0.0 0.0 0.1" rpy="0 0 0"/>
      <mass value="2.0"/>
      <inertia ixx="3.0" ixy="-0.5" ixz="0.0" iyy="4.0" iyz="0.0" izz="5.0"/>
    </inertial>
    >>> print(interop.to_text(body, "adams"))
    PART/1, MASS=2.0, CM=2, IP=3.0, 4.0, 5.0, 0.5, 0.0, 0.0
    MARKER/2, PART=1, QP=0.0, 0.0, 0.1
    """
    if not isinstance(body, RigidBody):
        raise TypeError(f"body: expected a RigidBody, got {type(body).__name__}")
    if not isinstance(program, str) or program not in _WRITERS:
        raise PolhodeError(f"program: there is no form for {program!r}; give one of {', '.join(PROGRAMS)}")
    if body.shape:
        raise PolhodeError(f"body: expected one body, got a stack of shape {body.shape}; index it")
    if program in ("mjcf", "mujoco"):
        _check_least(body)
    tensor = body.inertia
    inside = inside_edge(tensor)
    # A rod has no moment about itself, and is written so.
    if inside is not tensor and body.principal_moments[0] > 0.0:
        body = RigidBody(float(body.mass), inside, body.center_of_mass)
    principal = body.principal
    return _WRITERS[program](
        _Numbers(
            mass=float(body.mass),
            center=(body.center_of_mass + 0.0).tolist(),
            own=_six(body.inertia),
            origin=_six(body.inertia_about("origin")),
            moments=principal.moments.tolist(),
            axes=(principal.axes.T + 0.0).tolist(),
            quaternion=(principal.quaternion + 0.0).tolist(),
            tensor=body.inertia,
        )
    )


def _six(tensor: Floats) -> list[float]:
    six: list[float] = (tensor[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)] + 0.0).tolist()
    return six


def _positive(six: list[float]) -> list[float]:
    """Return products of inertia ∫ x y dm in place of elements."""
    return [*six[:3], *(0.0 - x for x in six[3:])]


def _row(numbers: Iterable[float], between: str = " ") -> str:
    return between.join(map(repr, numbers))


def _list(numbers: Iterable[float]) -> str:
    return f"[{_row(numbers, ', ')}]"


def _urdf(n: _Numbers) -> str:
    xx, yy, zz, xy, xz, yz = map(repr, n.own)
    return f"""<inertial>
  <origin xyz="{_row(n.center)}" rpy="0 0 0"/>
  <mass value="{n.mass!r}"/>
  <inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" iyy="{yy}" iyz="{yz}" izz="{zz}"/>
</inertial>"""


def _sdf(n: _Numbers) -> str:
    xx, yy, zz, xy, xz, yz = map(repr, n.own)
    return f"""<inertial>
  <pose>{_row(n.center)} 0 0 0</pose>
  <mass>{n.mass!r}</mass>
  <inertia>
    <ixx>{xx}</ixx> <ixy>{xy}</ixy> <ixz>{xz}</ixz>
    <iyy>{yy}</iyy> <iyz>{yz}</iyz>
    <izz>{zz}</izz>
  </inertia>
</inertial>"""


def _check_least(body: RigidBody) -> None:
    """Refuse moments that MuJoCo refuses; no larger moment is written instead."""
    least = LEAST_MOMENT["MJCF"]
    moment, mass = float(body.principal_moments[0]), float(body.mass)
    if not moment > least:
        raise PolhodeError(
            f"body: its smallest moment is {moment:.6g}, and MuJoCo refuses moments up to {least:g} kg m^2 "
            "(mjMINVAL) of what moves; give it a thickness, or state it in units that make it larger"
        )
    if not mass > least:
        raise PolhodeError(
            f"body: its mass is {mass:.6g}, and MuJoCo refuses masses up to {least:g} kg (mjMINVAL) of what "
            "moves; state it in units that make it larger"
        )


def _mjcf(n: _Numbers) -> str:
    tensor = " ".join(f'{name}="{_row(values)}"' for name, values in mjcf_tensor(n.tensor).items())
    return f'<inertial pos="{_row(n.center)}" mass="{n.mass!r}" {tensor}/>'


def _mujoco(n: _Numbers) -> str:
    names = {"diaginertia": "inertia", "fullinertia": "fullinertia", "quat": "iquat"}
    lines = (f"body.{names[name]} = {_list(values)}" for name, values in mjcf_tensor(n.tensor).items())
    tensor = "\n".join(lines)
    return f"""# body: a mujoco.MjsBody, of MjSpec
body.mass = {n.mass!r}
body.ipos = {_list(n.center)}
{tensor}
body.explicitinertial = True"""


def _drake(n: _Numbers) -> str:
    names = ("Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
    elements = ", ".join(f"{name}={value!r}" for name, value in zip(names, n.own, strict=True))
    return f"""from pydrake.multibody.tree import RotationalInertia, SpatialInertia

inertia = SpatialInertia.MakeFromCentralInertia(
    mass={n.mass!r},
    p_PScm_E={_list(n.center)},
    I_SScm_E=RotationalInertia({elements}),
)"""


def _pinocchio(n: _Numbers) -> str:
    xx, yy, zz, xy, xz, yz = n.own
    rows = ", ".join(map(_list, ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))))
    return f"""import numpy as np
import pinocchio

inertia = pinocchio.Inertia({n.mass!r}, np.array({_list(n.center)}), np.array([{rows}]))"""


def _pybullet(n: _Numbers) -> str:
    return f"""import pybullet

body = pybullet.createMultiBody(
    baseMass={n.mass!r},
    baseInertialFramePosition={_list(n.center)},
    baseInertialFrameOrientation={_list(n.quaternion)},
)
pybullet.changeDynamics(body, -1, localInertiaDiagonal={_list(n.moments)})"""


def _simulink(n: _Numbers) -> str:
    xx, yy, zz, xy, xz, yz = n.own
    return f"""Type: Custom
Mass: {n.mass!r} kg
Center of Mass: {_list(n.center)} m
Moments of Inertia: {_list((xx, yy, zz))} kg*m^2
Products of Inertia: {_list((yz, xz, xy))} kg*m^2"""


def _adams(n: _Numbers) -> str:
    return f"""PART/1, MASS={n.mass!r}, CM=2, IP={_row(_positive(n.own), ", ")}
MARKER/2, PART=1, QP={_row(n.center, ", ")}"""


def _solidworks(n: _Numbers) -> str:
    lines = [f"Mass = {n.mass!r} kilograms", "", "Center of mass: ( meters )"]
    lines += [f"\t{name} = {value!r}" for name, value in zip("XYZ", n.center, strict=True)]
    lines += [
        "",
        "Principal axes of inertia and principal moments of inertia: ( kilograms * square meters )",
        "Taken at the center of mass.",
    ]
    for name, axis, moment in zip("xyz", n.axes, n.moments, strict=True):
        lines.append(f"\tI{name} = ({_row(axis, ', ')})\tP{name} = {moment!r}")
    places = (("L", "center of mass and aligned with the output coordinate system", n.own),)
    for letter, place, six in (*places, ("I", "output coordinate system", n.origin)):
        xx, yy, zz, xy, xz, yz = _positive(six)
        lines += [
            "",
            "Moments of inertia: ( kilograms * square meters )",
            f"Taken at the {place}. (Using positive tensor notation.)",
        ]
        rows = (("x", (xx, xy, xz)), ("y", (xy, yy, yz)), ("z", (xz, yz, zz)))
        for name, row in rows:
            cells = (f"{letter}{name}{other} = {value!r}" for other, value in zip("xyz", row, strict=True))
            lines.append("\t" + "\t".join(cells))
    return "\n".join(lines)


def _onshape(n: _Numbers) -> str:
    xx, yy, zz, xy, xz, yz = n.own
    rows = ",\n    ".join(_row(row, ", ") for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
    return f"""{{
  "mass": [{n.mass!r}],
  "centroid": {_list(n.center)},
  "inertia": [
    {rows}
  ]
}}"""


def _matlab(n: _Numbers) -> str:
    xx, yy, zz, xy, xz, yz = n.origin
    return f"""body = rigidBody("body");
body.Mass = {n.mass!r};
body.CenterOfMass = {_list(n.center)};
body.Inertia = {_list((xx, yy, zz, yz, xz, xy))};"""


_WRITERS: Final[dict[str, Callable[[_Numbers], str]]] = {
    "urdf": _urdf,
    "sdf": _sdf,
    "mjcf": _mjcf,
    "mujoco": _mujoco,
    "drake": _drake,
    "pinocchio": _pinocchio,
    "pybullet": _pybullet,
    "simulink": _simulink,
    "adams": _adams,
    "solidworks": _solidworks,
    "onshape": _onshape,
    "matlab": _matlab,
}
PROGRAMS: Final = tuple(_WRITERS)
