"""VTK's files (``.vtk``, ``.vtu``, ``.vtp``): the surface of what they hold, read by PyVista."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._optional import require
from polhode.errors import FileFormatError
from polhode.io.budget import read_bytes
from polhode.io.mesh import Mesh, weld

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.io.budget import Budget

__all__ = ["read_vtk"]

_MOST_CORNERS: Final = 10_000
"""Of a face: VTK divides it in a time that grows with the square of them."""
_PROMISES: Final = re.compile(
    rb"\b(NumberOf(?:Points|Cells|Verts|Lines|Strips|Polys)|(?:Whole)?Extent)\s{0,9}=\s{0,9}[\"']([\s\d-]{0,200})"
    rb"|^[ ]{0,9}(POINTS|CELLS|POLYGONS|VERTICES|LINES|TRIANGLE_STRIPS|DIMENSIONS|[XYZ]_COORDINATES)"
    rb"[ \t]([\d \t]{1,200})",
    re.MULTILINE | re.IGNORECASE,
)
"""Counts in the heads of XML files and of legacy files."""


def read_vtk(path: Path, budget: Budget) -> Mesh:
    """Read the triangles of a file of VTK: of a surface its own, of cells in space those around them.

    Parameters
    ----------
    path : pathlib.Path
    budget : Budget
    """
    _check_counts(read_bytes(path), budget)
    pyvista: Any = require("pyvista", extra="view", purpose=f"{path}: reading {path.suffix.lower()} files")
    vtk: Any = require("vtkmodules.vtkCommonCore", extra="view", purpose=f"{path}: reading VTK's files")
    vtk.vtkObject.GlobalWarningDisplayOff()  # it would speak on standard error
    try:
        held = pyvista.read(str(path))
    except MemoryError:
        raise
    except Exception as error:  # a damaged file can raise anything in there
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FileFormatError(path, f": not a readable VTK file: {reason[:200]}; export it again") from None
    finally:
        vtk.vtkObject.GlobalWarningDisplayOn()
    if not isinstance(held, pyvista.DataSet) or isinstance(held, pyvista.ImageData):
        raise FileFormatError(
            path, f": holds {type(held).__name__}, no surface or cells; RigidBody.from_voxels takes voxels"
        )
    promised = held.n_cells
    surface = held if isinstance(held, pyvista.PolyData) else _around(held, pyvista)
    if surface.n_lines or surface.n_verts:
        raise FileFormatError(path, ": holds points or lines where triangles are needed; export triangles")
    if (corners := surface.GetPolys().GetMaxCellSize()) > _MOST_CORNERS:
        raise FileFormatError(
            path,
            f": a face has {corners} corners, more than the {_MOST_CORNERS} that are divided into "
            "triangles; export triangles",
        )
    triangles = surface.triangulate()
    faces = np.asarray(triangles.faces, dtype=np.int64).reshape(-1, 4)[:, 1:]
    if not promised or not len(faces):
        raise FileFormatError(path, ": holds no triangles and no cells; is it cut short?")
    return weld(np.asarray(triangles.points, dtype=np.float64), faces, "VTK")


def _check_counts(source: bytes, budget: Budget) -> None:
    """Count what a file promises: VTK takes memory for all of it, and ends the process where it gets none."""
    for promise in _PROMISES.finditer(source):
        name, text = promise[1] or promise[3], promise[2] or promise[4] or b""
        counts = [int(word[:19]) for word in re.findall(rb"\d+", text)]
        if name.upper() == b"DIMENSIONS":
            counts = [math.prod(counts)]
        elif name.endswith(b"Extent"):
            ends = zip(counts[::2], counts[1::2], strict=False)
            counts = [math.prod(abs(high - low) + 1 for low, high in ends)]
        for count in counts:
            budget.spend("points or cells", count)


def _around(cells: Any, pyvista: Any) -> Any:
    """Return the surface around cells in space."""
    filters: Any = require("vtkmodules.vtkFiltersGeometry", extra="view", purpose="reading VTK's files")
    surface = filters.vtkDataSetSurfaceFilter()
    surface.SetInputData(cells)
    surface.Update()
    return pyvista.wrap(surface.GetOutput())
