"""Solids in STEP and IGES files, made by OCCT, with the closed forms of their moments."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode.io.cad_files import (
    CadFile,
    Pair,
    near_pairs,
    overlaps_told,
    read_with_shapes,
    volume_shared,
)

__all__ = ["SOLIDS", "Known", "read_here", "write_assembly", "write_iges", "write_step"]

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Known:
    """A solid and what is known of it, in its own unit, of density 1.

    Attributes
    ----------
    make : callable
        Gives the shape.
    volume : float
    center : tuple of float
    moments : tuple of float
        Ixx, Iyy, Izz about the centre of mass.
    exact : bool
        Whether the file has it as it is: curves in which curved faces meet are mostly laid through points.
    """

    make: Callable[[], Any]
    volume: float
    center: Triple
    moments: Triple
    exact: bool = True


def occt(module: str) -> Any:
    return pytest.importorskip(f"OCP.{module}")


def read_here(path: Path, _packed: int | None = None) -> CadFile:
    """Read a file in this process instead of one of its own, which takes seconds to start."""
    cad, shapes = read_with_shapes(path)
    pairs = [
        Pair(i, k, volume_shared(shapes[i], shapes[k], cad.parts[k].moments.volume))
        for i, k in near_pairs(cad.parts)
    ]
    return replace(cad, overlaps=overlaps_told(cad, pairs, ""))


def primitive(name: str, *sizes: float) -> Callable[[], Any]:
    return lambda: getattr(occt("BRepPrimAPI"), f"BRepPrimAPI_Make{name}")(*sizes).Shape()


def nurbs(make: Callable[[], Any]) -> Callable[[], Any]:
    return lambda: occt("BRepBuilderAPI").BRepBuilderAPI_NurbsConvert(make(), True).Shape()


def moved(make: Callable[[], Any], x: float, y: float, z: float, angle: float = 0.0) -> Callable[[], Any]:
    return lambda: (
        occt("BRepBuilderAPI").BRepBuilderAPI_Transform(make(), place(x, y, z, angle), True).Shape()
    )


def place(x: float, y: float, z: float, angle: float = 0.0) -> Any:
    """Turned about z, then moved."""
    gp = occt("gp")
    turned, shifted = gp.gp_Trsf(), gp.gp_Trsf()
    turned.SetRotation(gp.gp_Ax1(gp.gp_Pnt(0, 0, 0), gp.gp_Dir(0, 0, 1)), angle)
    shifted.SetTranslation(gp.gp_Vec(x, y, z))
    return shifted.Multiplied(turned)


def boolean(kind: str, first: Callable[[], Any], second: Callable[[], Any]) -> Callable[[], Any]:
    return lambda: getattr(occt("BRepAlgoAPI"), f"BRepAlgoAPI_{kind}")(first(), second()).Shape()


def stretched() -> Any:
    """A unit sphere stretched to semi-axes 3, 2, 1: splines."""
    transform = occt("gp").gp_GTrsf()
    for axis, factor in ((1, 3.0), (2, 2.0), (3, 1.0)):
        transform.SetValue(axis, axis, factor)
    return (
        occt("BRepBuilderAPI").BRepBuilderAPI_GTransform(primitive("Sphere", 1.0)(), transform, True).Shape()
    )


def rounded_box() -> Any:
    """A box of 4, 3, 2 with all edges rounded by 0.5: what a box of 3, 2, 1 sweeps with a ball."""
    box = primitive("Box", 4.0, 3.0, 2.0)()
    fillet = occt("BRepFilletAPI").BRepFilletAPI_MakeFillet(box)
    edges = occt("TopExp").TopExp_Explorer(box, occt("TopAbs").TopAbs_ShapeEnum.TopAbs_EDGE)
    while edges.More():
        fillet.Add(0.5, occt("TopoDS").TopoDS.Edge(edges.Current()))
        edges.Next()
    return fillet.Shape()


def prism() -> Any:
    """A square of side 2 around the z axis, extruded by 3 as a face of OCCT, not as a box."""
    gp, api = occt("gp"), occt("BRepBuilderAPI")
    polygon = api.BRepBuilderAPI_MakePolygon()
    for x, y in ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)):
        polygon.Add(gp.gp_Pnt(x, y, 0.0))
    polygon.Close()
    face = api.BRepBuilderAPI_MakeFace(polygon.Wire()).Face()
    return occt("BRepPrimAPI").BRepPrimAPI_MakePrism(face, gp.gp_Vec(0.0, 0.0, 3.0)).Shape()


def revolved() -> Any:
    """A parabola x = z² of height 2 turned about z: a paraboloid, whose face is a surface of revolution."""
    gp, api = occt("gp"), occt("BRepBuilderAPI")
    poles = occt("collections").Array1_gp_Pnt(1, 3)
    for number, (x, z) in enumerate(((0.0, 0.0), (1.0, 0.0), (2.0, 4.0)), start=1):
        poles.SetValue(number, gp.gp_Pnt(x, 0.0, z))  # z = x², as a Bézier curve
    curve = api.BRepBuilderAPI_MakeEdge(occt("Geom").Geom_BezierCurve(poles)).Edge()
    top = api.BRepBuilderAPI_MakeEdge(gp.gp_Pnt(2.0, 0.0, 4.0), gp.gp_Pnt(0.0, 0.0, 4.0)).Edge()
    axis = api.BRepBuilderAPI_MakeEdge(gp.gp_Pnt(0.0, 0.0, 4.0), gp.gp_Pnt(0.0, 0.0, 0.0)).Edge()
    wire = api.BRepBuilderAPI_MakeWire(curve, top, axis).Wire()
    face = api.BRepBuilderAPI_MakeFace(wire).Face()
    line = gp.gp_Ax1(gp.gp_Pnt(0.0, 0.0, 0.0), gp.gp_Dir(0.0, 0.0, 1.0))
    return occt("BRepPrimAPI").BRepPrimAPI_MakeRevol(face, line).Shape()


def shelled() -> Any:
    """A box of 6, 5, 4 with walls of 0.25, open on top."""
    box = primitive("Box", 6.0, 5.0, 4.0)()
    faces = occt("TopExp").TopExp_Explorer(box, occt("TopAbs").TopAbs_ShapeEnum.TopAbs_FACE)
    removed = occt("collections").List_TopoDS_Shape()
    while faces.More():
        top = faces.Current()
        faces.Next()
    removed.Append(top)
    maker = occt("BRepOffsetAPI").BRepOffsetAPI_MakeThickSolid()
    maker.MakeThickSolidByJoin(box, removed, -0.25, 1e-6)
    return maker.Shape()


def _box(a: float, b: float, c: float) -> Triple:
    v = a * b * c
    return v * (b * b + c * c) / 12, v * (c * c + a * a) / 12, v * (a * a + b * b) / 12


def _less(whole: Triple, hole: Triple) -> Triple:
    return whole[0] - hole[0], whole[1] - hole[1], whole[2] - hole[2]


def _rounded(index: int) -> float:
    """∫x² dV of the rounded box along one axis, about its middle: box, slabs, quarter rods and the ball."""
    r, sides = 0.5, [3.0, 2.0, 1.0]
    a = sides[index]
    b, c = (side for place_, side in enumerate(sides) if place_ != index)
    far = a / 2
    # of a half disk, and of a half ball: volume, first and second moment from the flat side
    rod, rod1, rod2 = pi * r**2 / 2, 2 * r**3 / 3, pi * r**4 / 8
    ball, ball1, ball2 = 2 * pi * r**3 / 3, pi * r**4 / 4, 2 * pi * r**5 / 15
    whole = b * c * a**3 / 12 + 2 * r * (b + c) * a**3 / 12 + pi * r**2 * a**3 / 12
    ends = b * c * ((far + r) ** 3 - far**3) / 3
    ends += (b + c) * (rod * far**2 + 2 * rod1 * far + rod2) + (ball * far**2 + 2 * ball1 * far + ball2)
    return whole + 2 * ends


def _of_spread(x: float, y: float, z: float) -> Triple:
    return y + z, z + x, x + y


def _without(a: float, b: float, c: float, t: float) -> Triple:
    """Moments of a box without a lid, with walls of thickness t, about its centre of mass."""
    x, y, z = a - 2 * t, b - 2 * t, c - t
    outer, inner, above = a * b * c, x * y * z, t + z / 2
    volume = outer - inner
    height = (outer * c / 2 - inner * above) / volume
    along_x = (outer * a * a - inner * x * x) / 12
    along_y = (outer * b * b - inner * y * y) / 12
    along_z = outer * (c * c / 12 + (c / 2) ** 2) - inner * (z * z / 12 + above**2) - volume * height**2
    return _of_spread(along_x, along_y, along_z)


_CYLINDER = (2 * pi, (0.0, 0.0, 1.0), (2 * pi * (3 + 4) / 12, 2 * pi * (3 + 4) / 12, pi))
_TORUS = 2 * pi**2 * 3
_TORUS_MOMENTS = (_TORUS * (9 / 2 + 5 / 8), _TORUS * (9 / 2 + 5 / 8), _TORUS * (9 + 3 / 4))
_TUBE = (2 * pi * 3, (0.0, 0.0, 1.0), (6 * pi * (3 * 5 + 4) / 12, 6 * pi * (3 * 5 + 4) / 12, 6 * pi * 5 / 2))
_CONE = pi * 4 * 3 / 3
# Of the frustum with radii 2 and 1 and height 3: ∫πr² dz, and the like, with r = 2 - z/3.
_F0, _F1, _F2, _F4 = 7 * pi, 33 * pi / 4, 72 * pi / 5, 93 * pi / 5
_PLATE = 4 * 3 * 1 - pi * 0.25

SOLIDS = {
    "box": Known(primitive("Box", 1.0, 2.0, 3.0), 6.0, (0.5, 1.0, 1.5), _box(1.0, 2.0, 3.0)),
    "prism": Known(prism, 12.0, (0.0, 0.0, 1.5), _box(2.0, 2.0, 3.0)),
    "cylinder": Known(primitive("Cylinder", 1.0, 2.0), *_CYLINDER),
    "cylinder as splines": Known(nurbs(primitive("Cylinder", 1.0, 2.0)), *_CYLINDER),
    "cone": Known(
        primitive("Cone", 2.0, 0.0, 3.0),
        _CONE,
        (0.0, 0.0, 0.75),
        (_CONE * 3 / 80 * (16 + 9), _CONE * 3 / 80 * (16 + 9), _CONE * 0.3 * 4),
    ),
    "frustum": Known(
        primitive("Cone", 2.0, 1.0, 3.0),
        _F0,
        (0.0, 0.0, _F1 / _F0),
        (_F4 / 4 + _F2 - _F1**2 / _F0, _F4 / 4 + _F2 - _F1**2 / _F0, _F4 / 2),
    ),
    "sphere": Known(primitive("Sphere", 2.0), 32 * pi / 3, (0.0, 0.0, 0.0), (256 * pi / 15 * 1.0,) * 3),
    "torus": Known(primitive("Torus", 3.0, 1.0), _TORUS, (0.0, 0.0, 0.0), _TORUS_MOMENTS),
    "torus as splines": Known(nurbs(primitive("Torus", 3.0, 1.0)), _TORUS, (0.0, 0.0, 0.0), _TORUS_MOMENTS),
    "ellipsoid as splines": Known(
        stretched, 8 * pi, (0.0, 0.0, 0.0), (8 * pi * 5 / 5, 8 * pi * 10 / 5, 8 * pi * 13 / 5)
    ),
    "rounded box": Known(
        rounded_box,
        6 + 2 * 0.5 * (6 + 3 + 2) + pi * 0.25 * 6 + 4 * pi / 3 * 0.125,
        (2.0, 1.5, 1.0),
        _of_spread(_rounded(0), _rounded(1), _rounded(2)),
    ),
    "paraboloid": Known(
        revolved, 8 * pi, (0.0, 0.0, 8 / 3), (8 * pi * (4 / 6 + 16 / 18),) * 2 + (8 * pi * 4 / 3,)
    ),
    "box without a lid": Known(
        shelled,
        120.0 - 5.5 * 4.5 * 3.75,
        (3.0, 2.5, (240.0 - 5.5 * 4.5 * 3.75 * (0.25 + 1.875)) / (120.0 - 5.5 * 4.5 * 3.75)),
        _without(6.0, 5.0, 4.0, 0.25),
    ),
    "tube": Known(boolean("Cut", primitive("Cylinder", 2.0, 2.0), primitive("Cylinder", 1.0, 2.0)), *_TUBE),
    "plate with a hole": Known(
        boolean(
            "Cut",
            moved(primitive("Box", 4.0, 3.0, 1.0), -2.0, -1.5, -0.5),
            moved(primitive("Cylinder", 0.5, 3.0), 0, 0, -1),
        ),
        _PLATE,
        (0.0, 0.0, 0.0),
        _less(
            _box(4.0, 3.0, 1.0),
            (pi * 0.25 * (3 * 0.25 + 1) / 12, pi * 0.25 * (3 * 0.25 + 1) / 12, pi * 0.25 * 0.25 / 2),
        ),
    ),
    "two cylinders crossed": Known(
        boolean(
            "Common",
            moved(primitive("Cylinder", 1.0, 6.0), 0.0, 0.0, -3.0),
            lambda: (
                occt("BRepPrimAPI")
                .BRepPrimAPI_MakeCylinder(
                    occt("gp").gp_Ax2(occt("gp").gp_Pnt(-3, 0, 0), occt("gp").gp_Dir(1, 0, 0)), 1.0, 6.0
                )
                .Shape()
            ),
        ),
        16 / 3,
        (0.0, 0.0, 0.0),
        (16 / 15 + 64 / 45, 2 * 64 / 45, 16 / 15 + 64 / 45),
        exact=False,
    ),
}
"""By name; lengths in the unit of the file."""


def write_step(shape: Any, path: Path, unit: str = "MM") -> Path:
    """Write a shape, in millimetres, as a STEP file whose numbers are in another unit."""
    silence()
    writer = occt("STEPControl").STEPControl_Writer()
    occt("Interface").Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(shape, occt("STEPControl").STEPControl_StepModelType.STEPControl_AsIs)
    assert writer.Write(str(path)) == occt("IFSelect").IFSelect_ReturnStatus.IFSelect_RetDone
    occt("Interface").Interface_Static.SetCVal_s("write.step.unit", "MM")
    return path


def write_assembly(
    path: Path, densities: dict[str, float], names: tuple[str, ...] = ("block", "ball")
) -> Path:
    """Write a block, and two balls at other places, as an assembly with names and materials (g/cm^3)."""
    silence()
    tools, text = occt("XCAFDoc"), occt("TCollection")
    document = occt("TDocStd").TDocStd_Document(text.TCollection_ExtendedString("test"))
    shapes = tools.XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    materials = tools.XCAFDoc_DocumentTool.MaterialTool_s(document.Main())
    tools.XCAFDoc_DocumentTool.SetLengthUnit_s(document, 0.001)
    labels = [
        shapes.AddShape(primitive("Box", 10.0, 20.0, 30.0)(), False),
        shapes.AddShape(primitive("Sphere", 5.0)(), False),
    ]
    word = text.TCollection_HAsciiString
    whole = shapes.NewShape()
    for label, name in zip([*labels, whole], [*names, "thing"], strict=True):
        occt("TDataStd").TDataStd_Name.Set_s(label, text.TCollection_ExtendedString(name))
    for name, density in densities.items():
        words = (
            word(f"stuff of {name}"),
            word(""),
            density,
            word("density measure"),
            word("POSITIVE_RATIO_MEASURE"),
        )
        materials.SetMaterial(labels[names.index(name)], *words)
    location = occt("TopLoc").TopLoc_Location
    for label, where in (
        (0, (0, 0, 0, 0.0)),
        (1, (50, 0, 0, 0.0)),
        (1, (0, 70, 0, 1.0)),
        (0, (0, 0, 90, pi / 2)),
    ):
        shapes.AddComponent(whole, labels[label], location(place(*where)))
    shapes.UpdateAssemblies()
    writer = occt("STEPCAFControl").STEPCAFControl_Writer()
    writer.SetMaterialMode(True)
    writer.SetNameMode(True)
    writer.Transfer(document)
    assert writer.Write(str(path)) == occt("IFSelect").IFSelect_ReturnStatus.IFSelect_RetDone
    return path


def write_iges(path: Path, named: list[tuple[str, Any]]) -> Path:
    """Write solids side by side, each with its name."""
    silence()
    tools, text = occt("XCAFDoc"), occt("TCollection")
    document = occt("TDocStd").TDocStd_Document(text.TCollection_ExtendedString("test"))
    shapes = tools.XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    tools.XCAFDoc_DocumentTool.SetLengthUnit_s(document, 0.001)
    for name, solid in named:
        label = shapes.AddShape(solid, False)
        occt("TDataStd").TDataStd_Name.Set_s(label, text.TCollection_ExtendedString(name))
    occt("IGESControl").IGESControl_Controller.Init_s()
    occt("Interface").Interface_Static.SetIVal_s("write.iges.brep.mode", 1)
    writer = occt("IGESCAFControl").IGESCAFControl_Writer()
    writer.SetNameMode(True)
    assert writer.Transfer(document)
    assert writer.Write(str(path))
    return path


def silence() -> None:
    occt("Message").Message.DefaultMessenger_s().ChangePrinters().Clear()


def tensor(known: Known) -> np.ndarray[Any, Any]:
    return np.diag(known.moments)
