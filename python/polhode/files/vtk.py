"""VTK's files (``.vtk``, ``.vtu``, ``.vtp``): the surface of what they hold, read by PyVista."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._extras import require
from polhode.errors import FileFormatError
from polhode.files.mesh import Mesh, weld

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["VTK_SUFFIXES", "read_vtk"]

VTK_SUFFIXES: Final = (".vtk", ".vtu", ".vtp")


def read_vtk(path: Path) -> Mesh:
    """Read the triangles of a file of VTK: of a surface its own, of cells in space those around them.

    Parameters
    ----------
    path : pathlib.Path
    """
    pyvista: Any = require("pyvista", extra="view", purpose=f"{path}: reading {path.suffix.lower()} files")
    vtk: Any = require("vtkmodules.vtkCommonCore", extra="view", purpose=f"{path}: reading VTK's files")
    vtk.vtkObject.GlobalWarningDisplayOff()  # it would speak on standard error
    try:
        held = pyvista.read(str(path))
    except MemoryError:
        raise
    except Exception as error:  # a damaged file can raise anything in there
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FileFormatError(f"{path}: not a readable VTK file: {reason[:200]}; export it again") from None
    finally:
        vtk.vtkObject.GlobalWarningDisplayOn()
    if not isinstance(held, pyvista.DataSet) or isinstance(held, pyvista.ImageData):
        raise FileFormatError(
            f"{path}: holds {type(held).__name__}, no surface or cells; RigidBody.from_voxels takes voxels"
        )
    promised = held.n_cells
    surface = held if isinstance(held, pyvista.PolyData) else _around(held, pyvista)
    if surface.n_lines or surface.n_verts:
        raise FileFormatError(f"{path}: holds points or lines where triangles are needed; export triangles")
    triangles = surface.triangulate()
    faces = np.asarray(triangles.faces, dtype=np.int64).reshape(-1, 4)[:, 1:]
    if not promised or not len(faces):
        raise FileFormatError(f"{path}: holds no triangles and no cells; is it cut short?")
    return weld(np.asarray(triangles.points, dtype=np.float64), faces, "VTK")


def _around(cells: Any, pyvista: Any) -> Any:
    """Give the surface around cells in space."""
    filters: Any = require("vtkmodules.vtkFiltersGeometry", extra="view", purpose="reading VTK's files")
    surface = filters.vtkDataSetSurfaceFilter()
    surface.SetInputData(cells)
    surface.Update()
    return pyvista.wrap(surface.GetOutput())
