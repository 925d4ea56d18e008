"""The part of examples/jobs/cad_panel.yaml: a curved panel with rivet holes, as a STEP file made with OpenCASCADE.

`python tools/example_part.py` writes it again; it needs the extra `cad`.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

PART = Path(__file__).parents[1] / "examples/jobs/cad_panel.step"
RADIUS, THICK = 400.0, 8.0  # [mm] of the outer skin, about an axis along Y; its top is at Z = 0
ACROSS, ALONG = 160.0, 120.0  # [mm] in X and Y
RIVET, DOWEL = 4.8, 6.0  # [mm] diameters
POINT = np.deg2rad(59.0)  # half of the angle of a drill's point
DATE = re.compile(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'")


def panel():
    """Six through holes, two of them countersunk, and two blind ones; each normal to the skin."""
    shell = BRepAlgoAPI_Cut(_rod(RADIUS, ALONG), _rod(RADIUS - THICK, ALONG)).Shape()
    corner = gp_Pnt(-ACROSS / 2, -ALONG / 2, -RADIUS / 2)
    shape = BRepAlgoAPI_Common(shell, BRepPrimAPI_MakeBox(corner, ACROSS, ALONG, RADIUS).Shape()).Shape()
    for x in (-50.0, 0.0, 50.0):
        for y in (-40.0, 40.0):
            shape = _cut(shape, _drill(x, y, RIVET, 2 * THICK))
            if x == 0.0:
                shape = _cut(shape, _sink(x, y))
    for x in (-25.0, 25.0):
        shape = _cut(_cut(shape, _drill(x, 0.0, DOWEL, 5.0)), _tip(x, 0.0, DOWEL, 5.0))
    return shape


def _rod(radius: float, length: float):
    axis = gp_Ax2(gp_Pnt(0, -length / 2, -RADIUS), gp_Dir(0, 1, 0))
    return BRepPrimAPI_MakeCylinder(axis, radius, length).Shape()


def _cut(shape, tool):
    return BRepAlgoAPI_Cut(shape, tool).Shape()


def _axis(x: float, y: float, depth: float) -> gp_Ax2:
    """Below the skin at a place, into the material."""
    angle = np.arcsin(x / RADIUS)
    out = np.array([np.sin(angle), 0.0, np.cos(angle)])
    place = np.array([0.0, y, -RADIUS]) + (RADIUS - depth) * out
    return gp_Ax2(gp_Pnt(*map(float, place)), gp_Dir(*map(float, -out)))


def _drill(x: float, y: float, diameter: float, depth: float):
    return BRepPrimAPI_MakeCylinder(_axis(x, y, -5.0), diameter / 2, 5.0 + depth).Shape()


def _tip(x: float, y: float, diameter: float, depth: float):
    return BRepPrimAPI_MakeCone(_axis(x, y, depth), diameter / 2, 0.0, diameter / 2 / np.tan(POINT)).Shape()


def _sink(x: float, y: float):
    spread = float(np.tan(np.deg2rad(50.0)))
    return BRepPrimAPI_MakeCone(_axis(x, y, -1.0), RIVET + spread, RIVET / 2, 1.0 + RIVET / 2 / spread).Shape()


def main() -> None:
    """Write the part, without curves that a reader can find itself, and without the date."""
    writer = STEPControl_Writer()  # before its settings: it sets all of them
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    writer.Transfer(panel(), STEPControl_AsIs)
    writer.Write(str(PART))
    text = DATE.sub("'2026-01-01T00:00:00'", PART.read_text(encoding="utf-8"))
    PART.write_text(text.replace("MANIFOLD_SOLID_BREP(''", "MANIFOLD_SOLID_BREP('panel'"), encoding="utf-8")


if __name__ == "__main__":
    main()
