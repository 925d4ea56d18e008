"""STEP files made by the tests, with OpenCASCADE: what is in them is known from how they were made."""

from __future__ import annotations

from pathlib import Path

from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.Message import Message, Message_Printer
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer


def written(shape, path: Path, unit: str = "MM") -> Path:
    """A shape, whose numbers are millimetres, as a STEP file in another unit."""
    from OCP.Interface import Interface_Static

    Message.DefaultMessenger_s().RemovePrinters(Message_Printer.get_type_descriptor_s())
    writer = STEPControl_Writer()
    assert Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(str(path))
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    return path


def box(size, corner=(0.0, 0.0, 0.0)):
    return BRepPrimAPI_MakeBox(gp_Pnt(*corner), *size).Shape()


def rod(place, direction, radius: float, length: float):
    """A cylinder that begins at a place and runs along a direction."""
    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(*place), gp_Dir(*direction)), radius, length).Shape()


def cut(shape, tool):
    return BRepAlgoAPI_Cut(shape, tool).Shape()
