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

if TYPE_CHECKING:
    from polhode._scene.scene import Scene

__all__ = ["page"]

_MODULES: Final = (
    "vectors", "double", "elliptic", "free", "frames", "trail", "labels", "camera", "theme", "solid", "views",
    "live", "clock", "main",
)  # fmt: skip
"""Of the folder ``page``, each after those that it imports; a browser reads them as one."""


def page(scene: Scene) -> str:
    """Write the page: what is in the folder ``page`` as one text, with the motion in it.

    Parameters
    ----------
    scene : Scene
        What is shown.
    """
    shape, pivot = scene.shape, scene.pivot
    motion = {
        "title": scene.title,
        "time_unit": scene.time_unit,
        "duration": scene.duration,
        "t": _packed(scene.t, "<f8"),
        "quaternion": _packed(scene.quaternion, "<f4"),
        "omega": _packed(scene.omega, "<f4"),
        "inside": None if scene.inside is None else _packed(scene.inside, "<f4"),
        "axes": scene.axes.T.tolist(),
        "moments": scene.moments.tolist(),
        "free": _start(scene),
        "top": None
        if pivot is None
        else {
            "axis": pivot.axis.tolist(),
            "down": pivot.down.tolist(),
            "weight": pivot.weight,
            "limits": pivot.limits,
            "path": pivot.path,
        },
        "vertices": _packed(shape.vertices, "<f4"),
        "faces": _packed(shape.faces, "<u4"),
        "colors": _packed(shape.colors, "u1"),
    }
    # Inside a script element only "</" could end it early.
    text = json.dumps(motion, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    before, middle, after = re.split("@TITLE@|@MOTION@", _template())
    return f"{before}{html.escape(scene.title)}{middle}{text}{after}"


def _start(scene: Scene) -> dict[str, list[float]] | None:
    """Give the start of a free body, from which the page computes its motion itself; None of a rod."""
    if not scene.is_free or not scene.moments[0] > 0.0:
        return None
    return {
        "moments": scene.moments.tolist(),
        "omega": (scene.omega[0] @ scene.axes).tolist(),
        "quaternion": scene.quaternion[0].tolist(),
    }


def _packed(numbers: np.ndarray[Any, Any], kind: str) -> str:
    """Write numbers as the text of their bytes."""
    return base64.b64encode(np.ascontiguousarray(numbers, dtype=kind).tobytes()).decode("ascii")


@cache
def _template() -> str:
    """Join the page's files: its style, and its modules without what they import from each other."""
    folder = files("polhode.animation").joinpath("page")

    def read(name: str) -> str:
        return folder.joinpath(name).read_text(encoding="utf-8")

    joined = "\n".join(re.sub(r"(?m)^import .*\n", "", read(f"{name}.js")) for name in _MODULES)
    script = re.sub(r"(?m)^export ", "", joined)
    return read("page.html").replace("@STYLE@", read("page.css")).replace("@SCRIPT@", script)
