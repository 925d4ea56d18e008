"""Meshes: out of the files of CAD systems, and as they stand in files of answers."""

from __future__ import annotations

import base64
import binascii
import io
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.files.cad.needed import need_trimesh
from zerorev.files.cad.step import triangles
from zerorev.files.text import MAX_BYTES, read_bytes
from zerorev.model._arrays import Array
from zerorev.model.body import MOST_TRIANGLES, Mesh

__all__ = ["DEFLECTION", "MESH_FORMATS", "STEP_FORMATS", "loaded", "mesh_from_text", "mesh_text", "read_mesh"]

MESH_FORMATS = ("stl", "obj", "ply", "glb")
STEP_FORMATS = ("step", "stp")
DEFLECTION = 0.1e-3  # [m] triangles may be so far from the surface of a STEP file
UNITS = {"mm": 1.0, "m": 1e3, "in": 25.4}  # [mm]
MOST_TEXT = 64 * 2**20  # bytes of the numbers of a mesh in a file of answers


def read_mesh(path: str | Path, unit: str | None = None) -> Mesh:
    """The triangles of a file, to single precision.

    Args:
        path: of an STL, OBJ, PLY, GLB or STEP file; a mesh need not be closed.
        unit: of its lengths: mm, m or in; None: that of STEP as it says, of the others mm.

    Raises:
        InputError: no such file, another kind, cut short, no triangles, too many; what reads it is not installed.
    """
    path = Path(path)
    kind = path.suffix.lower().lstrip(".")
    if kind in STEP_FORMATS:
        if unit is not None:
            raise InputError("stands beside a STEP file, which states its unit", where="unit", accepted="no unit")
        vertices, faces = triangles(path, DEFLECTION)
        return _single(vertices * 1e3, faces, str(path))
    if kind not in MESH_FORMATS:
        accepted = f"{', '.join(MESH_FORMATS)}, {', '.join(STEP_FORMATS)}"
        raise InputError(f"a mesh of the kind .{kind}", where=str(path), accepted=accepted)
    need_trimesh()
    found = loaded(path, MAX_BYTES)
    return _single(np.asarray(found.vertices, dtype=float) * UNITS[unit or "mm"], np.asarray(found.faces), str(path))


def loaded(path: Path, most: int) -> Any:
    """The triangles of a mesh file; what it says of materials, and other files that it names, is not examined.

    Args:
        path: its ending says of which kind it is.
        most: bytes that it may have.

    Raises:
        InputError: another kind, not readable, no triangles.
    """
    import trimesh

    kind = path.suffix.lower().lstrip(".")
    if kind not in MESH_FORMATS:
        raise InputError(
            f"a mesh of the kind .{kind}", where=str(path),
            accepted=f"{', '.join(MESH_FORMATS)}; convert it, e.g. to STL",
        )  # fmt: skip
    try:
        stream = io.BytesIO(read_bytes(path, "a mesh", most))
        found = trimesh.load(stream, file_type=kind, force="mesh", resolver=None, skip_materials=True)
    except InputError:
        raise
    except Exception as error:  # any error of its readers
        raise InputError(f"cannot be read: {error}", where=str(path), accepted="a sound mesh") from None
    if not isinstance(found, trimesh.Trimesh) or not len(found.faces) or not np.isfinite(found.vertices).all():
        raise InputError("holds no triangles", where=str(path), accepted="a sound mesh")
    return found


def _single(vertices_mm: Array, faces: npt.ArrayLike, where: str) -> Mesh:
    """The mesh with its numbers as files of answers hold them: single precision, millimetres."""
    count = len(np.asarray(faces))
    if not 0 < count <= MOST_TRIANGLES:
        raise InputError(f"has {count:,} triangles", where=where, accepted=f"1 to {MOST_TRIANGLES:,}: a coarser mesh")
    single = np.asarray(vertices_mm, dtype=np.float32)
    if not np.isfinite(single).all():
        raise InputError("a number is too large", where=where, accepted="a part of any real size")
    return Mesh(single.astype(np.float64) * 1e-3, np.asarray(faces, dtype=np.int32))


def mesh_text(mesh: Mesh) -> dict[str, str]:
    """A mesh as it stands in a file of answers: two texts of compressed numbers."""
    vertices = np.asarray(mesh.vertices * 1e3, dtype="<f4").tobytes()
    faces = np.asarray(mesh.faces, dtype="<i4").tobytes()
    return {"vertices": _packed(vertices), "faces": _packed(faces)}


def mesh_from_text(vertices: str, faces: str) -> Mesh:
    """The mesh of such texts.

    Raises:
        InputError: they are not what `mesh_text` writes.
    """
    points = np.frombuffer(_unpacked(vertices, "vertices", 12), dtype="<f4").reshape(-1, 3)
    corners = np.frombuffer(_unpacked(faces, "faces", 12), dtype="<i4").reshape(-1, 3)
    return _single(points.astype(np.float64), corners, "mesh")


def _packed(content: bytes) -> str:
    return base64.b64encode(zlib.compress(content, 6)).decode("ascii")


def _unpacked(text: str, where: str, step: int) -> bytes:
    accepted = "what zerorev wrote"
    try:
        unpacking = zlib.decompressobj()
        content = unpacking.decompress(base64.b64decode(text.encode("ascii"), validate=True), MOST_TEXT)
    except (binascii.Error, UnicodeEncodeError, zlib.error) as error:
        raise InputError(f"was altered: {error}", where=where, accepted=accepted) from None
    if not unpacking.eof or len(content) % step:
        raise InputError("was cut short, or altered", where=where, accepted=accepted)
    return content
