"""How a motion shows itself: in notebooks below its cell, elsewhere in the browser."""

from __future__ import annotations

import html
import sys
import warnings
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._hints import with_hints

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.trajectory import Trajectory

    Floats = NDArray[np.float64]

__all__ = ["Shown", "repr_html", "show"]

_HEIGHT: Final = 460
_LEAST: Final = 240
_WIDTH: Final = 640
_TALL: Final = 150
_POINTS: Final = 400
_DASHES: Final = ("6 4", "none", "2 3")


class Shown:
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
def show(self: Trajectory, *, height: int = _HEIGHT, **options: Any) -> Shown:
    """Show the motion of one body as an interactive page: in a notebook below the cell, else in the browser.

    Parameters
    ----------
    height : int
        Of the frame in a notebook, in pixels.
    **options
        `shape`, `duration`, `title` and `time_label`, see :func:`polhode.animation.animate`.

    Returns
    -------
    Shown
        Outside a notebook its ``path`` is the page, in the folder for temporary files.

    Examples
    --------
    >>> from polhode import solids
    >>> motion = solids.box((3, 2, 1), mass=1.0).simulate([0.0, 20.0], omega=(0.01, 3, 0))
    >>> motion.show(title="The tennis racket")  # doctest: +SKIP
    """
    from polhode.animation import page_of

    if isinstance(height, bool) or not isinstance(height, int) or height < _LEAST:
        raise ValueError(f"height: {height!r} is not a whole number of pixels from {_LEAST} on")
    page, notes = page_of(self, **options)
    for note in notes:
        warnings.warn(note, stacklevel=2)
    if "ipykernel" in sys.modules:
        return Shown(page, height)
    # For this alone, and not when the package is imported.
    import tempfile
    import webbrowser
    from pathlib import Path

    from polhode.files.writing import write_bytes

    path = Path(tempfile.mkdtemp(prefix="polhode-")) / "motion.html"
    write_bytes(path, page.encode())
    webbrowser.open(path.as_uri())
    return Shown(page, height, path)


def repr_html(self: Trajectory) -> str:
    """Show a motion at the end of a notebook's cell: ω over time as a drawing, and the page below it."""
    from polhode._scene.pivot import top_of
    from polhode.animation import page_of

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
    """Put a page into another, whole: it asks for nothing else."""
    return (
        f'<iframe title="moving picture of the motion" srcdoc="{html.escape(page, quote=True)}" width="100%" '
        f'height="{height}" loading="lazy" allowfullscreen style="border:0;max-width:900px"></iframe>'
    )


def _omega_svg(t: Floats, omega: Floats) -> str:
    """Draw the components of ω in the body over time, an ``svg`` element."""
    from polhode._scene.style import AXIS_COLORS

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
