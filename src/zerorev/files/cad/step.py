"""STEP files: the shape as triangles. Each is read in a process of its own, with a limit of time and memory."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from zerorev.apart import Apart
from zerorev.errors import InputError
from zerorev.files.cad.needed import need_ocp
from zerorev.files.text import read_bytes
from zerorev.files.validation import inside
from zerorev.model._arrays import Array

__all__ = ["MOST_FACES", "check_step", "triangles"]

ACCEPTED = "a STEP file (.step, .stp)"
HEAD = b"ISO-10303-21"
MOST_FACES = 200_000  # of one file


def triangles(path: str | Path, deflection: float) -> tuple[Array, npt.NDArray[np.uint32]]:
    """The surface of the shape in a STEP file, in the file's own frame.

    Args:
        path: of the file.
        deflection: how far a triangle may be from the surface [m], as it is asked of the mesher.

    Returns:
        vertices [m], shape (N, 3); faces as numbers of vertices, shape (M, 3), their normals out of the material.

    Raises:
        InputError: the extra `cad` is not installed; not a STEP file, cut short, without a surface, too large.
    """
    need_ocp()
    content = read_bytes(Path(path), ACCEPTED)
    with inside(str(path)):
        check_step(content)
        ((vertices, faces),) = Apart(_triangles).results([content, deflection * 1e3])
    return vertices / 1e3, faces


def check_step(content: bytes) -> None:
    """Refuse what is not a whole STEP file, or has too many faces, before it is read.

    Raises:
        InputError: which of these.
    """
    if not content.lstrip().startswith(HEAD):
        raise InputError("is not a STEP file", accepted=ACCEPTED)
    if b"END-ISO-10303-21" not in content[-1000:]:
        raise InputError("is cut short: its last line is missing", accepted="the whole STEP file")
    if (count := content.count(b"ADVANCED_FACE")) > MOST_FACES:
        raise InputError(f"has {count:,} faces", accepted=f"{MOST_FACES:,} or less: export the part without the rest")


# --- tasks of `zerorev.apart` -----------------------------------------------------------------------------------------


def _triangles(given: Iterator[Any]) -> Iterator[Any]:
    from zerorev.files.cad import occ

    content, deflection = given
    shape = occ.read_shape(content)
    if lost := occ.faces_lost(shape, content):
        raise InputError(f"{lost} of its faces cannot be read", accepted="a sound STEP file: a body without gaps")
    yield occ.triangles_of(shape, deflection)
