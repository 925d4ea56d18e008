"""The surface of a part as triangles, out of a mesh or a STEP file."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from zerorev.errors import InputError
from zerorev.files.cad.needed import need_trimesh
from zerorev.files.cad.step import triangles
from zerorev.files.cad.surface import Faces
from zerorev.files.text import MAX_BYTES, read_bytes
from zerorev.model._arrays import Array

__all__ = ["surface_of"]

MESHES = ("stl", "obj", "ply")
DEFLECTION = 0.02e-3  # [m] triangles may be so far from the surface of a STEP file
MOST_TRIANGLES = 2_000_000


def surface_of(path: Path) -> tuple[Array, Faces]:
    """The triangles of a mesh, whose numbers are millimetres, or of a STEP file.

    Args:
        path: of the file.

    Returns:
        vertices [mm], shape (V, 3); faces as numbers of vertices, shape (M, 3).

    Raises:
        InputError: the extra `cad` is not installed; another kind of file, damaged, without triangles, too large.
    """
    kind = path.suffix.casefold().lstrip(".")
    if kind in ("step", "stp"):
        vertices, faces = triangles(path, DEFLECTION)
        return vertices * 1e3, faces
    if kind not in MESHES:
        accepted = f"{', '.join(MESHES)}, step or stp"
        raise InputError(f"a surface of the kind .{kind}", where=str(path), accepted=accepted)
    need_trimesh()
    import trimesh

    stream = io.BytesIO(read_bytes(path, "a mesh", MAX_BYTES))
    try:
        found = trimesh.load(stream, file_type=kind, force="mesh", resolver=None, skip_materials=True)
    except Exception as error:  # any error of its readers
        raise InputError(f"cannot be read: {error}", where=str(path), accepted="a sound mesh") from None
    if not isinstance(found, trimesh.Trimesh) or not len(found.faces) or not np.isfinite(found.vertices).all():
        raise InputError("holds no triangles", where=str(path), accepted="a sound mesh")
    if len(found.faces) > MOST_TRIANGLES:
        what = f"has {len(found.faces):,} triangles"
        raise InputError(what, where=str(path), accepted=f"{MOST_TRIANGLES:,} at most: a coarser mesh")
    return np.asarray(found.vertices, dtype=np.float64), np.asarray(found.faces)
