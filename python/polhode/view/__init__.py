"""Windows in three dimensions with pyvista (extra ``view``).

Every function takes ``plotter=`` and returns it. ``plotter.show()`` opens the window, in a notebook too;
without a screen, ``plotter.screenshot(path)`` of a ``pyvista.Plotter(off_screen=True)`` draws a picture. The
colours are those of :mod:`polhode.plot`.
"""

from __future__ import annotations

from polhode.view._bodies import body, ellipsoid, principal_axes, rigid_body
from polhode.view._motion import motion

__all__ = ["body", "ellipsoid", "motion", "principal_axes", "rigid_body"]
