"""The surface of a part as triangles, fine enough for normals, out of a mesh or a STEP file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from zerorev.errors import InputError
from zerorev.files.cad.needed import need_trimesh
from zerorev.files.cad.step import triangles
from zerorev.files.cad.surface import Faces
from zerorev.files.meshes import MESH_FORMATS, STEP_FORMATS, loaded
from zerorev.files.text import MAX_BYTES
from zerorev.model._arrays import Array
from zerorev.model.body import MOST_TRIANGLES

__all__ = ["surface_of"]

DEFLECTION = 0.02e-3  # [m] triangles may be so far from the surface of a STEP file: less than where bodies are shown


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
    if kind in STEP_FORMATS:
        vertices, faces = triangles(path, DEFLECTION)
        return vertices * 1e3, faces
    if kind not in MESH_FORMATS:
        accepted = f"{', '.join(MESH_FORMATS)}, {', '.join(STEP_FORMATS)}"
        raise InputError(f"a surface of the kind .{kind}", where=str(path), accepted=accepted)
    need_trimesh()
    found = loaded(path, MAX_BYTES)
    if len(found.faces) > MOST_TRIANGLES:
        what = f"has {len(found.faces):,} triangles"
        raise InputError(what, where=str(path), accepted=f"{MOST_TRIANGLES:,} at most: a coarser mesh")
    return np.asarray(found.vertices, dtype=np.float64), np.asarray(found.faces)
