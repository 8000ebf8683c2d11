"""Windows in three dimensions with pyvista (extra ``view``).

Every function takes the argument ``plotter=`` and returns the plotter. ``plotter.show()`` opens the window,
in a notebook too. Without a screen, use ``pyvista.Plotter(off_screen=True)`` and its method
``screenshot(path)``. The colours are those of :mod:`polhode.plot`.
"""

from __future__ import annotations

from polhode.draw.view.bodies import body, ellipsoid, principal_axes, rigid_body
from polhode.draw.view.motion import motion

__all__ = ["body", "ellipsoid", "motion", "principal_axes", "rigid_body"]
