"""The mass properties of a body as other programs take or print them: sign, order, axes and point of each.

Ours are the elements of the tensor, I_xy = −∫ x y dm, about C, in the axes of the body. What each program
means by its numbers, and where it says so, stands in ``docs/other_programs.md``. Every number is printed with
all its digits: reading it gives the same float.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from polhode._core import RigidBody
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["PROGRAMS", "to_text"]


class _Numbers(NamedTuple):
    """Of one body: the elements xx yy zz xy xz yz about C and about O, the axes as rows."""

    mass: float
    center: list[float]
    own: list[float]
    origin: list[float]
    moments: list[float]
    axes: list[list[float]]
    quaternion: list[float]


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

    Examples
    --------
    >>> from polhode import RigidBody, forms
    >>> body = RigidBody(2.0, [(3.0, -0.5, 0), (-0.5, 4.0, 0), (0, 0, 5.0)], (0, 0, 0.1))
    >>> print(forms.to_text(body, "urdf"))
    <inertial>
      <origin xyz="0.0 0.0 0.1" rpy="0 0 0"/>
      <mass value="2.0"/>
      <inertia ixx="3.0" ixy="-0.5" ixz="0.0" iyy="4.0" iyz="0.0" izz="5.0"/>
    </inertial>
    >>> print(forms.to_text(body, "adams"))
    PART/1, MASS=2.0, CM=2, IP=3.0, 4.0, 5.0, 0.5, 0.0, 0.0
    MARKER/2, PART=1, QP=0.0, 0.0, 0.1
    """
    if not isinstance(body, RigidBody):
        raise TypeError(f"body: expected a RigidBody, got {type(body).__name__}")
    if not isinstance(program, str) or program not in _WRITERS:
        raise PolhodeError(f"program: there is no form for {program!r}; give one of {', '.join(PROGRAMS)}")
    if body.shape:
        raise PolhodeError(f"body: expected one body, got a stack of shape {body.shape}; index it")
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
        )
    )


def _six(tensor: Floats) -> list[float]:
    six: list[float] = (tensor[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)] + 0.0).tolist()
    return six


def _positive(six: list[float]) -> list[float]:
    """Give products of inertia ∫ x y dm in place of elements."""
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


def _check_definite(n: _Numbers) -> None:
    if not n.moments[0] > 0.0:
        raise PolhodeError(
            f"MuJoCo takes no body with a moment of {n.moments[0]:g} about an axis; give it a thickness"
        )


def _mjcf(n: _Numbers) -> str:
    _check_definite(n)
    return f'<inertial pos="{_row(n.center)}" mass="{n.mass!r}" fullinertia="{_row(n.own)}"/>'


def _mujoco(n: _Numbers) -> str:
    _check_definite(n)
    return f"""# body: a mujoco.MjsBody, of MjSpec
body.mass = {n.mass!r}
body.ipos = {_list(n.center)}
body.fullinertia = {_list(n.own)}
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
