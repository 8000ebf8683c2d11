"""A motion as one interactive page that needs nothing from the network."""

from __future__ import annotations

import base64
import html
import json
import re
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode.draw.sampling import RATE, SECONDS, TURN
from polhode.draw.shape import BOX_TINTS, longest
from polhode.draw.wheels import RINGS, SPOKE, SPOKES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.draw.scene import Scene
    from polhode.draw.surface import Surface
    from polhode.draw.wheels import Disc

    Floats = NDArray[np.float64]

__all__ = ["page"]

_MODULES: Final = (
    "vectors", "double", "elliptic", "free", "frames", "trail", "labels", "camera", "theme", "surface",
    "solid", "clock", "wheels", "views", "ground", "energy", "live", "main",
)  # fmt: skip
"""Modules of the folder ``web``, each after those that it imports; a browser reads them as one."""
_SHARED: Final = {
    "SECONDS": SECONDS,
    "PICTURES": RATE,
    "TURN": TURN,
    "SPOKES": SPOKES,
    "SPOKE": SPOKE,
    "RINGS": RINGS,
    "TINTS": BOX_TINTS.tolist(),
}
"""Constants that the package and the page share, written as the page's module ``shared``."""

_SHORT: Final = (1e-30, 1e30)
"""Sizes that keep their digits in floats of four bytes."""


def page(scene: Scene) -> str:
    """Write the page: the files of the folder ``web`` and the motion, as one text.

    Parameters
    ----------
    scene : Scene
        What is shown.
    """
    shape, pivot = scene.shape, scene.pivot
    vertices, shape_unit = _in_reach(shape.vertices)
    omega, omega_unit = _in_reach(scene.omega)
    inside, inside_unit = (None, 1.0) if scene.inside is None else _in_reach(scene.inside)
    motion = {
        "title": scene.title,
        "time_unit": scene.time_unit,
        "duration": scene.duration,
        "t": _encode(scene.t, "<f8"),
        "quaternion": _encode(scene.quaternion, "<f4"),
        "omega": _encode(omega, "<f4"),
        "omega_unit": omega_unit,
        "inside": None if inside is None else _encode(inside, "<f4"),
        "inside_unit": inside_unit,
        "axes": scene.axes.T.tolist(),
        "moments": scene.moments.tolist(),
        "free": _start(scene),
        "surface": _surface(scene.surface),
        "top": None
        if pivot is None
        else {
            "axis": pivot.axis.tolist(),
            "down": pivot.down.tolist(),
            "limits": pivot.limits,
            "path": pivot.path,
        },
        "ground": _ground(scene, shape_unit),
        "wheels": [_wheel(disc, shape_unit) for disc in scene.discs],
        "energy": _energy(scene),
        "vertices": _encode(vertices, "<f4"),
        "faces": _encode(shape.faces, "<u4"),
        "colors": _encode(shape.colors, "u1"),
    }
    # Inside a script element "</script" ends it, and after "<!--" and "<script" its own end does not.
    text = json.dumps(motion, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    before, middle, after = re.split("@TITLE@|@MOTION@", _template())
    return f"{before}{html.escape(scene.title)}{middle}{text}{after}"


def _start(scene: Scene) -> dict[str, list[float]] | None:
    """Return the start of a free body, from which the page computes its motion itself; None of a rod."""
    if not scene.is_free or not scene.moments[0] > 0.0:
        return None
    return {
        "moments": scene.moments.tolist(),
        "omega": (scene.omega[0] @ scene.axes).tolist(),
        "quaternion": scene.quaternion[0].tolist(),
    }


def _ground(scene: Scene, unit: float) -> dict[str, Any] | None:
    """Return the plane on which a body rolls, and centre of mass and contact at the frames, in this unit."""
    ground = scene.ground
    if ground is None:
        return None
    return {
        "normal": ground.normal.tolist(),
        "middle": (ground.middle / unit).tolist(),
        "turntable": ground.turntable,
        "center": _encode(ground.center[scene.sample] / unit, "<f8"),
        "contact": _encode(ground.contact[scene.sample] / unit, "<f8"),
        "friction": _encode(ground.friction[scene.sample], "<f4"),
    }


def _surface(surface: Surface) -> dict[str, Any]:
    """Return the surface of the path in the body: the kind of motion, marks and curves of a gyrostat."""
    return {
        "kind": surface.kind,
        "momentum": None if surface.momentum is None else surface.momentum.tolist(),
        "level": surface.level,
        "is_reduced": surface.is_reduced,
        "marks": [
            {
                "kind": mark.kind,
                "direction": mark.direction.tolist(),
                "circle": None if mark.circle is None else mark.circle.tolist(),
                "level": mark.level,
                "curve": None if mark.curve is None else _encode(mark.curve, "<f4"),
            }
            for mark in surface.marks
        ],
    }


def _in_reach(vectors: Floats) -> tuple[Floats, float]:
    """Return vectors in a unit in which single precision holds them, and this unit: a power of two."""
    size = longest(vectors)
    unit = 1.0 if _SHORT[0] < size < _SHORT[1] else float(2.0 ** np.floor(np.log2(size)))
    return vectors / unit, unit


def _wheel(disc: Disc, unit: float) -> dict[str, Any]:
    """Return a wheel; of a constant speed as one number, of none without a speed."""
    rate, angle = disc.rate, disc.angle
    is_constant = rate is not None and bool((rate == rate[0]).all())
    return {
        "name": disc.name,
        "axis": disc.axis.tolist(),
        "middle": (disc.middle / unit).tolist(),
        "radius": disc.radius / unit,
        "half": disc.half / unit,
        "constant": float(rate[0]) if rate is not None and is_constant else None,
        "rate": None if rate is None or is_constant else _encode(rate, "<f4"),
        "angle": None if angle is None or is_constant else _encode(angle, "<f8"),
    }


def _energy(scene: Scene) -> dict[str, Any]:
    """Return the energy at the frames, in all digits, so that a drift is the motion's own."""
    energy = scene.energy
    return {
        "kinetic": None if scene.is_free else _encode(energy.kinetic, "<f8"),
        "potential": None if energy.potential is None else _encode(energy.potential, "<f8"),
        "why": energy.why,
        "size": energy.size,
        "travel": energy.travel,
    }


def _encode(numbers: np.ndarray[Any, Any], kind: str) -> str:
    """Write numbers as the text of their bytes."""
    return base64.b64encode(np.ascontiguousarray(numbers, dtype=kind).tobytes()).decode("ascii")


@cache
def _template() -> str:
    """Join the page's files: its style, and its modules without what they import from each other."""
    folder = files("polhode.draw.animation").joinpath("web")

    def read(name: str) -> str:
        return folder.joinpath(name).read_text(encoding="utf-8")

    shared = [f"const {name} = {json.dumps(value)};" for name, value in _SHARED.items()]
    modules = [re.sub(r"(?m)^import .*\n", "", read(f"{name}.js")) for name in _MODULES]
    joined = "\n".join([*shared, *modules])
    script = re.sub(r"(?m)^export ", "", joined)
    return read("page.html").replace("@STYLE@", read("page.css")).replace("@SCRIPT@", script)
