"""The libraries that read CAD files: whether they are installed, and in a version that is read with."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

from zerorev.errors import InputError

__all__ = ["need_ezdxf", "need_ocp", "need_trimesh"]

OCP = (8, 0)  # the version of OCP whose names `zerorev.files.cad.occ` uses
WHEELS = ("cadquery-ocp-novtk", "cadquery-ocp")  # that bring it
CURE = "pip install 'zerorev[cad]'"


def need_ocp() -> None:
    """Refuse to read STEP where OCP is missing or another version; nothing is imported, which takes half a second.

    Raises:
        InputError: it names the extra that brings it.
    """
    _need("OCP", "a STEP file")
    for wheel in WHEELS:
        try:
            found = version(wheel)
        except PackageNotFoundError:
            continue
        if tuple(found.split(".")[:2]) != tuple(map(str, OCP)):
            raise InputError(
                f"a STEP file is read with OCP {OCP[0]}.{OCP[1]}, and OCP {found} is installed ({wheel})",
                accepted=f"{CURE}, in an environment without CadQuery or build123d, which ask for other versions",
            )
        return


def need_ezdxf() -> None:
    """Refuse to read DXF where ezdxf is missing.

    Raises:
        InputError: it names the extra that brings it.
    """
    _need("ezdxf", "a DXF file")


def need_trimesh() -> None:
    """Refuse to read STL where trimesh is missing.

    Raises:
        InputError: it names the extra that brings it.
    """
    _need("trimesh", "an STL file")


def _need(module: str, file: str) -> None:
    if find_spec(module) is None:
        raise InputError(f"{file} is read with {module}, which is not installed", accepted=CURE)
