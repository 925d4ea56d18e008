"""Shapes of STEP files, by OpenCASCADE: the only file that imports OCP, to be imported in a process of its own.

It crashes on some files, prints, and needs half a second to be imported: `zerorev.files.cad.step` runs it apart.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.IFSelect import IFSelect_RetDone
from OCP.Message import Message, Message_Printer
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

from zerorev.errors import InputError
from zerorev.model._arrays import Array

__all__ = ["Triangles", "faces_lost", "read_shape", "triangles_of"]

Triangles = tuple[Array, npt.NDArray[np.uint32]]

TURN = 0.5  # [rad] between the normals of neighbouring triangles, where a deflection allows more
FACE = re.compile(rb"=\s*ADVANCED_FACE\s*\(")
SAME = 1e-6  # [mm] within which vertices of neighbouring faces are one


def read_shape(content: bytes) -> Any:
    """The shape of a STEP file, in millimetres whichever unit the file has.

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
    return shape


def faces_lost(shape: Any, content: bytes) -> int:
    """How many faces of a STEP file are missing in its shape: what the reader does not understand it leaves out.

    Args:
        shape: as `read_shape` has it.
        content: of the file.
    """
    found = {face.TShape() for face in faces_of(shape)}  # one for all places of an assembly where it stands
    return max(0, len(FACE.findall(content)) - len(found))


def triangles_of(shape: Any, deflection: float) -> Triangles:
    """The surface of a shape as triangles, their normals out of the material.

    Args:
        shape: as `read_shape` has it.
        deflection: how far a triangle may be from the surface [mm], as it is asked of the mesher.

    Returns:
        vertices [mm], shape (N, 3); faces as numbers of vertices, shape (M, 3).
    """
    BRepMesh_IncrementalMesh(shape, deflection, False, TURN, False)
    places, corners, count = list[Array](), list[Array](), 0
    for face in faces_of(shape):
        where = TopLoc_Location()
        found = BRep_Tool.Triangulation_s(face, where)
        if found is None:
            continue
        move = where.Transformation()
        nodes = (found.Node(n).Transformed(move) for n in range(1, found.NbNodes() + 1))
        places.append(np.array([(node.X(), node.Y(), node.Z()) for node in nodes]))
        numbers = np.array([found.Triangle(n).Get() for n in range(1, found.NbTriangles() + 1)]) - 1
        inwards = (face.Orientation() == TopAbs_REVERSED) != move.IsNegative()
        corners.append(count + (numbers[:, ::-1] if inwards else numbers))
        count += len(places[-1])
    if not places:
        raise InputError("holds no surface", accepted="a STEP file of a solid")
    return _joined(np.concatenate(places), np.concatenate(corners))


def faces_of(shape: Any) -> Iterator[Any]:
    """The faces of a shape."""
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        yield TopoDS.Face(explorer.Current())
        explorer.Next()


def _joined(places: Array, corners: Array) -> Triangles:
    """The same with one vertex where several are, and without triangles that have two corners in one."""
    _, first, number = np.unique(np.round(places / SAME), axis=0, return_index=True, return_inverse=True)
    faces = number.reshape(-1)[corners]
    flat = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    return places[first], faces[~flat].astype(np.uint32)
