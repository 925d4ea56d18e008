"""STEP files made by the tests, with OpenCASCADE: what is in them is known from how they were made."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_NurbsConvert,
    BRepBuilderAPI_Transform,
)
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
)
from OCP.collections import Array2_gp_Pnt, List_TopoDS_Shape
from OCP.GeomAPI import GeomAPI_PointsToBSplineSurface
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.Interface import Interface_Static
from OCP.Message import Message, Message_Printer
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TopoDS import TopoDS_Compound

THICK = 12.0  # [mm] of the curved panel
OUT = 30.0  # [mm] that cutters stand out of it


@dataclass(frozen=True)
class Made:
    """A hole as it was cut.

    Attributes:
        kinds: as the reader is to call it.
        mouth: a point of the axis on the surface, or near it [mm].
        direction: into the material.
        diameter: [mm].
        depth: below `mouth` [mm]; None: through.
    """

    kinds: tuple[str, ...]
    mouth: np.ndarray
    direction: np.ndarray
    diameter: float
    depth: float | None = None


def written(shape, path: Path, unit: str = "MM") -> Path:
    """A shape, whose numbers are millimetres, as a STEP file in another unit."""
    Message.DefaultMessenger_s().RemovePrinters(Message_Printer.get_type_descriptor_s())
    writer = STEPControl_Writer()
    assert Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(str(path))
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    return path


def box(size, corner=(0.0, 0.0, 0.0)):
    return BRepPrimAPI_MakeBox(gp_Pnt(*corner), *size).Shape()


def _at(place, direction) -> gp_Ax2:
    return gp_Ax2(gp_Pnt(*map(float, place)), gp_Dir(*map(float, direction)))


def rod(place, direction, radius: float, length: float, angle: float = 2 * np.pi):
    """A cylinder, or a sector of one, that begins at a place and runs along a direction."""
    return BRepPrimAPI_MakeCylinder(_at(place, direction), radius, length, angle).Shape()


def taper(place, direction, first: float, last: float, length: float):
    """A cone between two radii."""
    return BRepPrimAPI_MakeCone(_at(place, direction), first, last, length).Shape()


def cut(shape, *tools):
    """A shape without others."""
    operation, arguments, cutters = BRepAlgoAPI_Cut(), List_TopoDS_Shape(), List_TopoDS_Shape()
    arguments.Append(shape)
    for tool in tools:
        cutters.Append(tool)
    operation.SetArguments(arguments)
    operation.SetTools(cutters)
    operation.Build()
    return operation.Shape()


def fused(first, second):
    return BRepAlgoAPI_Fuse(first, second).Shape()


def together(*shapes):
    """Several shapes that stay solids of their own."""
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


def moved(shape, move: gp_Trsf):
    return BRepBuilderAPI_Transform(shape, move, True).Shape()


def as_splines(shape):
    """The same shape, all of its surfaces and curves as B-splines."""
    return BRepBuilderAPI_NurbsConvert(shape, True).Shape()


def height(x, y):
    """Of the upper surface of the curved panel [mm]."""
    return 30 * np.sin(x / 90) + 18 * np.cos(y / 70) + 0.0004 * x * y


def curved_panel():
    """A panel whose surfaces are one B-spline, moved by `THICK`: x from -160 to 160, y from -120 to 120 mm."""
    xs, ys = np.linspace(-160, 160, 17), np.linspace(-120, 120, 13)
    grid = Array2_gp_Pnt(1, len(xs), 1, len(ys))
    for i, x in enumerate(xs, 1):
        for j, y in enumerate(ys, 1):
            grid.SetValue(i, j, gp_Pnt(float(x), float(y), float(height(x, y))))
    surface = GeomAPI_PointsToBSplineSurface(grid).Surface()
    face = BRepBuilderAPI_MakeFace(surface, 1e-6).Face()
    return BRepPrimAPI_MakePrism(face, gp_Vec(0, 0, -THICK)).Shape()


def normal(x, y):
    """Out of the upper surface of the curved panel."""
    step = 1e-4
    slope = [
        (height(x + step, y) - height(x - step, y)) / (2 * step),
        (height(x, y + step) - height(x, y - step)) / (2 * step),
    ]
    found = np.array([-slope[0], -slope[1], 1.0])
    return found / np.linalg.norm(found)


def cutters_of(made: Made) -> list:
    """What is to be cut out for a hole: the drill, and what makes its mouth."""
    mouth, d, r = made.mouth, made.direction, made.diameter / 2
    above = mouth - OUT * d
    if made.depth is None:
        tools = [rod(above, d, r, 2 * OUT + THICK)]
    else:
        straight = made.depth - r / np.tan(np.deg2rad(59))
        tools = [rod(above, d, r, OUT + straight), taper(mouth + straight * d, d, r, 0.0, made.depth - straight)]
    if "countersunk" in made.kinds:  # 100 deg, as wide as twice the hole at the point on the surface
        spread = np.tan(np.deg2rad(50))
        tools.append(taper(mouth - 5 * d, d, 2 * r + 5 * spread, r * 0.9, (1.1 * r + 5 * spread) / spread))
    if "counterbored" in made.kinds:
        tools.append(rod(above, d, 1.8 * r, OUT + 3.0))
    return tools


def twenty_holes() -> list[Made]:
    """Five each: through, countersunk, blind with a drill point, counterbored; each normal to the curved panel."""
    rng, made = np.random.default_rng(5), []
    kinds = [("through",), ("through", "countersunk"), ("blind",), ("through", "counterbored")]
    for n in range(20):
        x, y = -128 + 64 * (n % 5) + rng.uniform(-8, 8), -84 + 56 * (n // 5) + rng.uniform(-8, 8)
        which = kinds[n % 4]
        depth = 8.0 if which == ("blind",) else None
        diameter = (4.0, 5.0, 6.0)[n % 3]
        made.append(Made(which, np.array([x, y, height(x, y)]), -normal(x, y), diameter, depth))
    return made


def with_holes(shape, holes: Iterable[Made] | Sequence[Made]):
    return cut(shape, *(tool for made in holes for tool in cutters_of(made)))


def perforated(across: int, along: int, pitch: float, radius: float, thick: float):
    """A plate with a grid of through holes in one solid, made without cutting, which takes minutes for a thousand."""
    outline = BRepBuilderAPI_MakePolygon()
    for x, y in ((0, 0), (across, 0), (across, along), (0, along)):
        outline.Add(gp_Pnt(x * pitch, y * pitch, 0.0))
    outline.Close()
    face = BRepBuilderAPI_MakeFace(outline.Wire(), True)
    for i in range(across):
        for j in range(along):
            circle = gp_Circ(_at(((i + 0.5) * pitch, (j + 0.5) * pitch, 0), (0, 0, -1)), radius)
            face.Add(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire())
    return BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0, 0, thick)).Shape()
