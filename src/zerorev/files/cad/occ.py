"""Shapes of STEP files, by OpenCASCADE: the only file that imports OCP, to be imported in a process of its own.

It crashes on some files, prints, and needs half a second to be imported: `zerorev.files.cad.step` runs it apart.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.collections import Sequence_TCollection_AsciiString
from OCP.GeomAbs import GeomAbs_Cone, GeomAbs_Cylinder, GeomAbs_Line, GeomAbs_Plane, GeomAbs_Sphere, GeomAbs_Torus
from OCP.gp import gp_Cone, gp_Cylinder, gp_Pnt, gp_Vec
from OCP.IFSelect import IFSelect_RetDone
from OCP.Message import Message, Message_Printer
from OCP.ShapeAnalysis import ShapeAnalysis_CanonicalRecognition
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_IN, TopAbs_REVERSED, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

from zerorev.errors import InputError
from zerorev.files.cad.found import Solid, Wall
from zerorev.model._arrays import Array
from zerorev.visible import one_line

__all__ = ["StepFile", "Triangles", "read_step"]

Triangles = tuple[Array, npt.NDArray[np.uint32]]

TURN = 0.5  # [rad] between the normals of neighbouring triangles, where a deflection allows more
SAME = 1e-6  # [mm] within which vertices of neighbouring faces are one
ROUND = 1e-3  # [mm] within which a free-form surface is a cylinder or a cone
SAMPLES = 33  # points of an edge that is not straight
MOST_NAME = 60  # characters
FACE = re.compile(rb"=\s*ADVANCED_FACE\s*\(")
FLAT_OR_ROUND = (GeomAbs_Plane, GeomAbs_Sphere, GeomAbs_Torus)  # never the wall of a hole


@dataclass(frozen=True)
class StepFile:
    """A STEP file that was read.

    Attributes:
        content: of the file.
        reader: with what the file says beside its shape.
        shape: in millimetres whichever unit the file has.
    """

    content: bytes
    reader: Any
    shape: Any

    def faces_lost(self) -> int:
        """How many faces of the file are missing in the shape: what the reader does not understand it leaves out."""
        found = {face.TShape() for face in _faces(self.shape)}  # one for all places of an assembly where it stands
        return max(0, len(FACE.findall(self.content)) - len(found))

    def units(self) -> tuple[str, ...]:
        """Names of the units of length that the file states, without doubles."""
        lengths, angles, solid_angles = (Sequence_TCollection_AsciiString() for _ in range(3))
        self.reader.FileUnits(lengths, angles, solid_angles)
        return tuple(dict.fromkeys(one_line(name.ToCString()) for name in lengths))

    def solids(self, scale: float) -> Iterator[Solid]:
        """Its solids, in the order of the file.

        Args:
            scale: by which all lengths are multiplied, where the file states another unit than its numbers have.
        """
        for count, (faces, solid) in enumerate(_numbered(self.shape), 1):
            yield _solid(solid, scale, faces, self._name(solid) or f"solid {count}")

    def face_at(self, place: Sequence[float]) -> tuple[int, float]:
        """The face that is nearest to a place.

        Args:
            place: [mm], shape (3,).

        Returns:
            its number; how far it is [mm].
        """
        vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*place)).Vertex()
        least = (0, float("inf"))
        for numbers, solid in _numbered(self.shape):
            for face, number in zip(_faces(solid), numbers, strict=True):
                found = BRepExtrema_DistShapeShape(vertex, face)
                if found.IsDone() and found.NbSolution() and found.Value() < least[1]:
                    least = (number, found.Value())
        return least

    def triangles(self, deflection: float) -> Triangles:
        """The surface as triangles, their normals out of the material.

        Args:
            deflection: how far a triangle may be from the surface [mm], as it is asked of the mesher.

        Returns:
            vertices [mm], shape (N, 3); faces as numbers of vertices, shape (M, 3).
        """
        BRepMesh_IncrementalMesh(self.shape, deflection, False, TURN, False)
        places, corners, count = list[Array](), list[Array](), 0
        for face in _faces(self.shape):
            where = TopLoc_Location()
            found = BRep_Tool.Triangulation_s(face, where)
            if found is None:
                continue
            move = where.Transformation()
            nodes = (found.Node(n).Transformed(move) for n in range(1, found.NbNodes() + 1))
            places.append(np.array([_three(node) for node in nodes]))
            numbers = np.array([found.Triangle(n).Get() for n in range(1, found.NbTriangles() + 1)]) - 1
            inwards = (face.Orientation() == TopAbs_REVERSED) != move.IsNegative()
            corners.append(count + (numbers[:, ::-1] if inwards else numbers))
            count += len(places[-1])
        if not places:
            raise InputError("holds no surface", accepted="a STEP file of a solid")
        return _joined(np.concatenate(places), np.concatenate(corners))

    def _name(self, solid: Any) -> str:
        """What the file calls a solid, regardless of where an assembly puts it."""
        entity = self.reader.WS().TransferReader().EntityFromShapeResult(solid.Located(TopLoc_Location()), 1)
        name = entity.Name() if hasattr(entity, "Name") else None
        return one_line(name.ToCString())[:MOST_NAME].strip() if name is not None else ""


def read_step(content: bytes) -> StepFile:
    """The shape of a STEP file.

    Args:
        content: of the file.

    Raises:
        InputError: not STEP, cut short, or without a shape.
    """
    Message.DefaultMessenger_s().RemovePrinters(Message_Printer.get_type_descriptor_s())  # it prints on standard output
    reader = STEPControl_Reader()
    # asking more of a reader that did not understand its file crashes the process
    if reader.ReadStream("", io.BytesIO(content)) != IFSelect_RetDone:
        raise InputError("cannot be read as STEP: it is cut short or damaged", accepted="a sound STEP file")
    if reader.NbRootsForTransfer() < 1 or reader.TransferRoots() < 1 or (shape := reader.OneShape()).IsNull():
        raise InputError("holds no shape", accepted="a STEP file of a solid")
    return StepFile(content, reader, shape)


def _explored(shape: Any, kind: Any) -> Iterator[Any]:
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def _faces(shape: Any) -> Iterator[Any]:
    return map(TopoDS.Face, _explored(shape, TopAbs_FACE))


def _numbered(shape: Any) -> Iterator[tuple[range, Any]]:
    """The solids of a shape, and the numbers of their faces, which are counted through all of it."""
    start = 0
    for solid in _explored(shape, TopAbs_SOLID):
        end = start + sum(1 for _ in _faces(solid))
        yield range(start, end), solid
        start = end


def _three(point: Any) -> tuple[float, float, float]:
    return point.X(), point.Y(), point.Z()


def _solid(solid: Any, scale: float, numbers: range, name: str) -> Solid:
    """What matters of a solid whose faces have these numbers, its lengths multiplied by `scale`."""
    known: dict[Any, int] = {}  # an edge by what it is made of, which is one object for both of its faces
    shapes: dict[int, Any] = {}
    faces, edges_of, outer_of = dict(zip(numbers, _faces(solid), strict=True)), {}, {}
    beside: dict[int, set[int]] = {}
    for number, face in faces.items():
        found = set()
        for edge in _explored(face, TopAbs_EDGE):
            edge_number = known.setdefault(edge.TShape(), len(known))
            shapes.setdefault(edge_number, edge)
            found.add(edge_number)
            beside.setdefault(edge_number, set()).add(number)
        edges_of[number] = frozenset(found)
    everted = _is_everted(solid)
    walls = [
        replace(wall, point=wall.point * scale, radius=None if wall.radius is None else wall.radius * scale)
        for number, face in faces.items()
        if (wall := _wall(face, number, edges_of[number], everted)) is not None
    ]
    points = {}
    for edge_number in {each for wall in walls for each in wall.edges}:
        edge = TopoDS.Edge(shapes[edge_number])
        if not BRep_Tool.Degenerated_s(edge):
            points[edge_number] = _samples(edge) * scale
    inside = _inside_of(solid)
    near = {face for edge_number in points for face in beside[edge_number]}
    for number in near:
        wire = BRepTools.OuterWire_s(faces[number])
        outer_of[number] = frozenset(known[edge.TShape()] for edge in _explored(wire, TopAbs_EDGE))
    rims = {number: frozenset(each for each in found if beside[each] != {number}) for number, found in edges_of.items()}
    return Solid(
        name, tuple(walls), points, {number: frozenset(found) for number, found in beside.items()}, rims, outer_of,
        lambda place: inside(place / scale),
    )  # fmt: skip


def _is_everted(solid: Any) -> bool:
    """Whether the normals of a solid point into its material: then what is infinitely far away lies in it."""
    classifier = BRepClass3d_SolidClassifier(solid)
    classifier.PerformInfinitePoint(SAME)
    return bool(classifier.State() == TopAbs_IN)


def _inside_of(solid: Any) -> Callable[[Array], bool]:
    @cache
    def classifier() -> Any:
        return BRepClass3d_SolidClassifier(solid)

    def inside(place: Array) -> bool:
        classifier().Perform(gp_Pnt(*map(float, place)), SAME)
        return bool(classifier().State() == TopAbs_IN)

    return inside


def _wall(face: Any, number: int, edges: frozenset[int], everted: bool) -> Wall | None:
    """A face as the wall of a hole; None where it is neither a cylinder nor a cone, or the material lies inside."""
    surface = BRepAdaptor_Surface(face)
    kind = surface.GetType()
    if kind in FLAT_OR_ROUND:
        return None
    found: Any = None
    if exact := kind in (GeomAbs_Cylinder, GeomAbs_Cone):
        found = surface.Cylinder() if kind == GeomAbs_Cylinder else surface.Cone()
    else:
        recognition = ShapeAnalysis_CanonicalRecognition(face)
        cylinder, cone = gp_Cylinder(), gp_Cone()
        if recognition.IsCylinder(ROUND, cylinder):
            found = cylinder
        elif recognition.IsCone(ROUND, cone):
            found = cone
    if found is None:
        return None
    is_cone = isinstance(found, gp_Cone)
    point = np.array(_three(found.Apex() if is_cone else found.Location()))
    axis = np.array(_three(found.Axis().Direction()))
    place, normal = _middle(surface)
    outwards = place - point - ((place - point) @ axis) * axis
    if (normal @ outwards < 0) == ((face.Orientation() == TopAbs_REVERSED) != everted):
        return None
    radius = None if is_cone else float(found.Radius())
    return Wall(number, point, axis, radius, abs(found.SemiAngle()) if is_cone else 0.0, tuple(sorted(edges)), exact)


def _middle(surface: Any) -> tuple[Array, Array]:
    """A place in the middle of a surface's parameters, and a normal there of any length."""
    u = (surface.FirstUParameter() + surface.LastUParameter()) / 2
    v = (surface.FirstVParameter() + surface.LastVParameter()) / 2
    place, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
    surface.D1(u, v, place, along_u, along_v)
    return np.array(_three(place)), np.cross(_three(along_u), _three(along_v))


def _samples(edge: Any) -> Array:
    """Points of an edge [mm], shape (N, 3)."""
    curve = BRepAdaptor_Curve(edge)
    count = 2 if curve.GetType() == GeomAbs_Line else SAMPLES
    return np.array([_three(curve.Value(t)) for t in np.linspace(curve.FirstParameter(), curve.LastParameter(), count)])


def _joined(places: Array, corners: Array) -> Triangles:
    """The same with one vertex where several are, and without triangles that have two corners in one."""
    _, first, number = np.unique(np.round(places / SAME), axis=0, return_index=True, return_inverse=True)
    faces = number.reshape(-1)[corners]
    flat = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    return places[first], faces[~flat].astype(np.uint32)
