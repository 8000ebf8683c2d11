"""Display of a body and of a motion in notebooks. No drawing library is needed."""

from __future__ import annotations

import html
import sys
import warnings
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._format import with_sigma
from polhode._hints import with_hints
from polhode.draw.style import AXIS_COLORS
from polhode.draw.surface import inertia_semi_axes

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode import RigidBody
    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]

__all__ = [
    "HtmlPage",
    "body_html",
    "ellipsoid_svg",
    "motion_html",
    "show",
]

_SIZE: Final = 200
_LETTER: Final = 14.0
"""Width of a name."""
_EDGE: Final = 0.5 * _SIZE - 0.6 * _LETTER
_REACH: Final = 0.36 * _SIZE
"""Length of the longest semi-axis in the drawing."""
_ELLIPSE_DASHES: Final = ("6 4", "none", "6 3 1.5 3")
# From which side the body is seen: rows are rightward and upward in the drawing and toward the viewer.
_AZIMUTH, _ELEVATION = np.deg2rad(-55.0), np.deg2rad(25.0)
_CA, _SA, _CE, _SE = np.cos(_AZIMUTH), np.sin(_AZIMUTH), np.cos(_ELEVATION), np.sin(_ELEVATION)
_VIEW: Final = np.array([[-_SA, _CA, 0.0], [-_SE * _CA, -_SE * _SA, _CE], [_CE * _CA, _CE * _SA, _SE]])


def body_html(body: RigidBody) -> str:
    """Write one body as a table and a drawing; a stack as its shape.

    Parameters
    ----------
    body : RigidBody
        What a notebook is about to show.
    """
    if body.shape:
        return f"<pre>{html.escape(repr(body))}</pre>"
    principal, sigma = body.principal, body.sigma
    centers = np.zeros(3) if sigma is None else sigma.center_of_mass
    deviations = np.zeros(3) if sigma is None else sigma.principal_moments
    rows = [
        ("mass", _number(body.mass, 0.0 if sigma is None else sigma.mass)),
        (
            "center of mass",
            "(" + ", ".join(_number(*one) for one in zip(body.center_of_mass, centers, strict=True)) + ")",
        ),
        *(
            (f"{_mark(color)}principal moment {k + 1}", _number(moment, deviation))
            for k, (color, moment, deviation) in enumerate(
                zip(AXIS_COLORS, principal.moments, deviations, strict=True)
            )
        ),
        *(
            (f"{_mark(color)}axis {k + 1}", _vector(axis))
            for k, (color, axis) in enumerate(zip(AXIS_COLORS, principal.axes.T, strict=True))
        ),
        ("top", html.escape(str(principal.top))),
        ("source", html.escape(str(body.provenance))),
    ]
    cells = "".join(
        f'<tr><th style="text-align:left">{name}</th><td style="text-align:left">{value}</td></tr>'
        for name, value in rows
    )
    drawing = ellipsoid_svg(body) if principal.moments.any() else ""
    return (
        '<div style="display:flex;flex-wrap:wrap;align-items:center;gap:16px">'
        f"{drawing}<table><caption>RigidBody</caption>{cells}</table></div>"
    )


def _mark(color: str) -> str:
    """Draw a patch of a colour of the drawing; words in it would be too pale to read."""
    return f'<span style="background:{color};display:inline-block;width:0.7em;height:0.7em"></span> '


def ellipsoid_svg(body: RigidBody) -> str:
    """Draw the ellipsoid of inertia, r·I r constant about the centre of mass, with the principal axes.

    Parameters
    ----------
    body : RigidBody
        One body, not a point.

    Returns
    -------
    str
        An ``svg`` element. The axes x, y, z of the body are grey.
    """
    moments, axes = body.principal.moments, body.principal.axes
    semi_axes = inertia_semi_axes(moments)
    semi_axes *= _REACH / semi_axes.max()
    seen = _VIEW @ axes  # columns: the principal axes as the viewer has them
    far, near, names = [], [], []
    places = [_beyond(seen[:, k] * (semi_axes[k] + 0.2 * _REACH)) for k in range(3)]
    for name, direction in zip("xyz", _VIEW.T, strict=True):
        far.append(_line(0.44 * _SIZE * direction, color="#bbb", width=1.0))
        places.append(_free_place(_beyond(0.44 * _SIZE * direction), places))
        names.append(_name(places[-1], name, "#767676"))
    for k, (color, dash) in enumerate(zip(AXIS_COLORS, _ELLIPSE_DASHES, strict=True)):
        tip = seen[:, k] * (semi_axes[k] + 0.2 * _REACH)
        far += [_line(end, color=color, dash=dash) for end in (-tip, tip)]
        if tip[2] > 0.0:  # it comes out of the surface toward the viewer
            near.append(_line(tip, start=seen[:, k] * semi_axes[k], color=color))
        names.append(_name(places[k], f"e{'₁₂₃'[k]}", color))
    rings = [part for k in range(3) for part in _ring(seen, semi_axes, (k + 1) % 3, (k + 2) % 3)]
    parts = [*far, _outline(seen[:2] * semi_axes), *rings, *near, *names]
    half = _SIZE / 2
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_SIZE}" height="{_SIZE}" '
        f'viewBox="{-half:g} {-half:g} {_SIZE} {_SIZE}" role="img" '
        'font-family="sans-serif" font-size="12" text-anchor="middle">'
        f"<title>ellipsoid of inertia and principal axes</title>{''.join(parts)}</svg>"
    )


def _outline(projected: Floats) -> str:
    """Draw the silhouette, the ellipse that a 2 x 3 matrix makes of the unit sphere."""
    directions, radii, _ = np.linalg.svd(projected)
    tilt = np.rad2deg(np.arctan2(-directions[1, 0], directions[0, 0]))
    return (
        f'<ellipse rx="{radii[0]:.2f}" ry="{radii[1]:.2f}" transform="rotate({tilt:.3f})" '
        'fill="#C9D6E8" fill-opacity="0.85" stroke="#4a5568" stroke-width="1.2"/>'
    )


def _ring(seen: Floats, semi_axes: Floats, i: int, j: int) -> list[str]:
    """Draw the ellipse in the plane of two principal axes, its far half faint."""
    # The normal cos a e_i/s_i + sin a e_j/s_j faces the viewer within a quarter turn of this angle.
    middle = np.arctan2(seen[2, j] / semi_axes[j], seen[2, i] / semi_axes[i])
    parts = []
    for begin, style in ((middle + np.pi / 2, 'stroke-opacity="0.25"'), (middle - np.pi / 2, "")):
        angle = begin + np.linspace(0.0, np.pi, 37)
        points = np.outer(np.cos(angle), semi_axes[i] * seen[:, i])
        points += np.outer(np.sin(angle), semi_axes[j] * seen[:, j])
        path = " ".join(f"{x:.2f},{-y:.2f}" for x, y, _ in points)
        parts.append(f'<polyline points="{path}" fill="none" stroke="#4a5568" stroke-width="0.8" {style}/>')
    return parts


def _line(
    end: Floats, *, start: Floats | None = None, color: str, width: float = 1.8, dash: str = "none"
) -> str:
    x0, y0 = (0.0, 0.0) if start is None else start[:2]
    return (
        f'<line x1="{x0:.2f}" y1="{-y0:.2f}" x2="{end[0]:.2f}" y2="{-end[1]:.2f}" stroke="{color}" '
        f'stroke-width="{width:g}" stroke-dasharray="{dash}"/>'
    )


def _beyond(tip: Floats) -> Floats:
    """Return the middle of a name beyond the tip of a line from the middle, within the drawing."""
    at: Floats = tip[:2] * (1.0 + 9.0 / (float(np.hypot(*tip[:2])) or 1.0))
    return np.clip(at, -_EDGE, _EDGE)


def _free_place(at: Floats, taken: list[Floats]) -> Floats:
    """Return this place for a name; if another name is there, a place to its left or right."""
    inward = -1.0 if at[0] > 0.0 else 1.0
    tried = [at + np.array([step * inward * _LETTER, 0.0]) for step in (0.0, 1.0, -1.0, 2.0)]
    return next((one for one in tried if all(np.abs(one - other).max() >= _LETTER for other in taken)), at)


def _name(at: Floats, name: str, color: str) -> str:
    """Write a name."""
    x, y = at
    return f'<text x="{x:.2f}" y="{-y + 4.0:.2f}" fill="{color}">{name}</text>'


def _number(value: float, sigma: float) -> str:
    # Adding zero makes a plain zero of a negative one.
    return with_sigma(value, sigma) if sigma > 0.0 else f"{value + 0.0:.6g}"


def _vector(components: Floats) -> str:
    # Adding zero makes a plain zero of a negative one.
    return "(" + ", ".join(f"{component + 0.0:.6g}" for component in components) + ")"


_HEIGHT: Final = 460
_LEAST: Final = 240
_WIDTH: Final = 640
_TALL: Final = 150
_POINTS: Final = 400
_DASHES: Final = ("6 4", "none", "2 3")


class HtmlPage:
    """A page that a notebook displays; ``path`` is the file, where one was written for the browser.

    Attributes
    ----------
    page : str
        The whole page.
    height : int
        In pixels, of the frame in a notebook.
    path : pathlib.Path or None
    """

    def __init__(self, page: str, height: int, path: Path | None = None) -> None:
        self.page, self.height, self.path = page, height, path

    def _repr_html_(self) -> str:
        return _frame(self.page, self.height)

    def __repr__(self) -> str:
        return "<page of a motion>" if self.path is None else f"<page of a motion: {self.path}>"


@with_hints
def show(self: Trajectory, *, height: int, **options: Any) -> HtmlPage:
    """Do what :meth:`polhode.Trajectory.show` says."""
    from polhode.animation import page_of

    if isinstance(height, bool) or not isinstance(height, int) or height < _LEAST:
        raise ValueError(f"height: {height!r} is not a whole number of pixels from {_LEAST} on")
    page, notes = page_of(self, **options)
    for note in notes:
        warnings.warn(note, stacklevel=2)
    if "ipykernel" in sys.modules:
        return HtmlPage(page, height)
    # For this alone, and not when the package is imported.
    import tempfile
    import webbrowser
    from pathlib import Path

    from polhode.io.writing import write_bytes

    path = Path(tempfile.mkdtemp(prefix="polhode-")) / "motion.html"
    write_bytes(path, page.encode())
    webbrowser.open(path.as_uri())
    return HtmlPage(page, height, path)


def motion_html(self: Trajectory) -> str:
    """Show a motion at the end of a notebook's cell: ω over time as a drawing, and the page below it."""
    from polhode.animation import page_of
    from polhode.draw.pivot import top_of

    words = f"<pre>{html.escape(repr(self))}</pre>"
    if self.omega.ndim != 2 or self.t.ndim != 1 or len(self.t) < 2:
        return words
    if not (np.isfinite(self.omega).all() and np.isfinite(self.quaternion).all()):
        return words
    t, omega = self.t, self.omega
    if (
        len(t) < _POINTS and (motion := self._exact() or top_of(self)) is not None
    ):  # known between samples too
        t = np.linspace(t[0], t[-1], _POINTS)
        omega = motion.at(t - t[0]).omega
    drawing = _omega_svg(t, omega)
    try:
        page, notes = page_of(self)
    except ValueError as error:  # turns too far from one sample to the next
        return f"{words}{drawing}<p>{html.escape(str(error))}</p>"
    told = "".join(f"<p>{html.escape(note)}</p>" for note in notes)
    return f"{words}{drawing}{_frame(page, _HEIGHT)}{told}"


def _frame(page: str, height: int) -> str:
    """Embed a whole page in another one; it loads no other file."""
    return (
        f'<iframe title="moving picture of the motion" srcdoc="{html.escape(page, quote=True)}" width="100%" '
        f'height="{height}" loading="lazy" allowfullscreen style="border:0;max-width:900px"></iframe>'
    )


def _omega_svg(t: Floats, omega: Floats) -> str:
    """Draw the components of ω in the body over time, an ``svg`` element."""
    from polhode.draw.style import AXIS_COLORS

    chosen = np.unique(np.linspace(0, len(t) - 1, min(len(t), _POINTS)).round().astype(int))
    span, size = float(t[-1] - t[0]) or 1.0, float(np.abs(omega).max()) or 1.0
    across = 8.0 + (_WIDTH - 60.0) * (t[chosen] - t[0]) / span
    end, middle = _WIDTH - 52, _TALL / 2
    parts = [f'<path d="M8 {middle}H{end}" stroke="#999" stroke-width="0.8"/>']
    for k, (color, dash) in enumerate(zip(AXIS_COLORS, _DASHES, strict=True)):
        down = middle - (middle - 12.0) * omega[chosen, k] / size
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, down, strict=True))
        line = f'fill="none" stroke="{color}" stroke-width="1.6" stroke-dasharray="{dash}"'
        parts.append(f'<polyline points="{points}" {line}/>')
        parts.append(f'<text x="{end + 6}" y="{30 + 22 * k}" fill="{color}">ω{"xyz"[k]}</text>')
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{_TALL}" '
        f'viewBox="0 0 {_WIDTH} {_TALL}" role="img" font-family="sans-serif" font-size="13">'
        f"<title>angular velocity in the body over time</title>{''.join(parts)}</svg><br>"
    )
