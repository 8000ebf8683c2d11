"""A motion as one interactive page that needs nothing from the network."""

from __future__ import annotations

import html
import json
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode._scene.shape import longest

if TYPE_CHECKING:
    from polhode._scene.scene import Scene

__all__ = ["page"]

_DIGITS = 7
_BODY = 0.8


def page(scene: Scene) -> str:
    """Write the page: what is in ``page.html``, with the motion in it.

    Parameters
    ----------
    scene : Scene
        What is shown.
    """
    vertices = scene.shape.vertices
    size = longest(vertices)
    inside = scene.inside
    strongest = longest(scene.momentum if inside is None else np.concatenate([scene.momentum, inside]))
    motion = {
        "title": scene.title,
        "time_unit": scene.time_unit,
        "duration": scene.duration,
        "t": scene.t.tolist(),
        "quaternion": _rounded(scene.quaternion),
        "omega": _rounded(scene.omega / longest(scene.omega)),
        "momentum": _rounded(scene.momentum / strongest),
        "inside": None if inside is None else _rounded(inside / strongest),
        "ellipsoid": _rounded(scene.ellipsoid / longest(scene.omega)),
        "axes": _rounded(scene.axes.T),
        "shape": {
            "vertices": _rounded(vertices * (_BODY / size)),
            "faces": scene.shape.faces.tolist(),
            "colors": scene.shape.colors.tolist(),
        },
    }
    # Inside a script element only "</" could end it early.
    text = json.dumps(motion, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    template = files("polhode.animation").joinpath("page.html").read_text(encoding="utf-8")
    named = template.replace("<title>polhode</title>", f"<title>{html.escape(scene.title)}</title>")
    return named.replace("@MOTION@", text)


def _rounded(numbers: np.ndarray[Any, np.dtype[np.float64]]) -> list[Any]:
    """Round numbers to as many decimals as a screen can show."""
    rounded: list[Any] = np.round(numbers, _DIGITS).tolist()
    return rounded
