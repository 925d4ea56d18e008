"""Reading and writing the files of zerorev: robot, tool, job (YAML, CSV) and plan (JSON).

A file becomes plain data (`text`), a checked form (`schema`, `validation`) and then a noun in SI (`conversion`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from zerorev.errors import InputError
from zerorev.files.cad.as_listed import Asked, CadHoles, cad_holes, is_cad, read_cad
from zerorev.files.cad.chosen import ALL
from zerorev.files.cad.listed_points import points_on
from zerorev.files.cad.part_surface import surface_of
from zerorev.files.cad.select_form import SelectForm
from zerorev.files.conversion import frame_from, robot_from, settings_from, tool_from, with_feeds
from zerorev.files.job_holes import cad_holes_of, holes_of
from zerorev.files.named import named_document, shipped
from zerorev.files.other_kinds import refuse_another_kind, refuse_map_folder
from zerorev.files.output import write_text
from zerorev.files.part import part_document
from zerorev.files.plan_conversion import plan_from
from zerorev.files.plan_data import FORMS, plan_data
from zerorev.files.plan_schema import DepthFile, PlanFile
from zerorev.files.robot_schema import RobotFile, ToolFile
from zerorev.files.schema import JobFile, SettingsForm
from zerorev.files.solids import obstacles_from
from zerorev.files.stated_forms import Form
from zerorev.files.table_units import Unit
from zerorev.files.text import Document, json_document, json_text, read_bytes, read_text
from zerorev.files.tool_uses import used, uses_of
from zerorev.files.validation import checked, inside
from zerorev.files.yaml_text import yaml_document
from zerorev.model.job import Job
from zerorev.model.plan import Plan
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = [
    "job_from_dict",
    "job_from_text",
    "plan_from_text",
    "plan_text",
    "plan_to_json",
    "read_cad_holes",
    "read_job",
    "read_plan",
    "read_points",
    "read_robot",
    "read_tool",
    "robot_names",
    "tool_names",
    "write_plan",
    "write_schemas",
]


def robot_names() -> list[str]:
    """Names of the robots that ship with zerorev."""
    return shipped("robots")


def tool_names() -> list[str]:
    """Names of the tools that ship with zerorev."""
    return shipped("tools")


def read_robot(name_or_path: str | Path, folder: str | Path | None = ".") -> Robot:
    """A robot that ships with zerorev, by name, or one of a robot file.

    Args:
        name_or_path: a shipped name, or a path: it has a separator or ends in .yaml, .yml or .json.
        folder: where a relative path starts; None: no file is opened, only what ships is taken.

    Raises:
        InputError: an unknown name, no such file, or a file that is not a robot.
    """
    document = named_document(name_or_path, folder, "robots")
    form = checked(RobotFile, document)
    with inside(document.file):
        return robot_from(
            form,
            _folder_of(document, folder),
            sources=form.sources,
            second_sources=tuple(form.second_sources),
            caveats=tuple(form.caveats),
        )


def read_tool(name_or_path: str | Path, folder: str | Path | None = ".") -> Tool:
    """A tool that ships with zerorev, by name, or one of a tool file.

    Args:
        name_or_path: a shipped name, or a path: it has a separator or ends in .yaml, .yml or .json.
        folder: where a relative path starts; None: no file is opened, only what ships is taken.

    Raises:
        InputError: an unknown name, no such file, or a file that is not a tool.
    """
    document = named_document(name_or_path, folder, "tools")
    form = checked(ToolFile, document)
    with inside(document.file):
        return tool_from(form, _folder_of(document, folder), sources=form.sources)


def _folder_of(document: Document, folder: str | Path | None) -> Path | None:
    """Where paths in a file start; None where no file may be opened."""
    return None if folder is None else Path(document.file).parent


def read_job(path: str | Path, *, depth_needed: bool = True, options: Mapping[str, Any] | None = None) -> Job:
    """The job of a job file, its holes in the base frame; paths in it are relative to it.

    Args:
        path: of the file.
        depth_needed: whether each hole must have its depth; else those without have one of 1 mm, for nobody to look at.
        options: keys of the settings that take the place of the file's own.

    Raises:
        InputError: anything in the options, the file, its CSV, its robot or its tool that cannot be used.
    """
    path = Path(path)
    refuse_map_folder(path)
    document = yaml_document(read_text(path, "a job file (YAML)"), str(path))
    if options and isinstance(document.data, dict):
        checked(SettingsForm, Document("options", dict(options)))
        for key, value in options.items():
            there = document.data.get(key)
            nested = isinstance(value, Mapping) and isinstance(there, Mapping)
            document.data[key] = dict(there or {}) | dict(value) if nested else value
    return _job(document, path.parent, path.stem, depth_needed=depth_needed)


def job_from_text(text: str, file: str) -> Job:
    """The job of a job file's text, for which no other file is opened: its robot and its tool ship with zerorev.

    Args:
        text: of the file; its tool may stand in it, its holes must.
        file: how messages name it; a job without a name is called so.

    Raises:
        InputError: anything in it that cannot be used; a path.
    """
    return _job(yaml_document(text, file), None, Path(file).stem)


def job_from_dict(mapping: Mapping[str, Any], folder: str | Path = ".") -> Job:
    """The job of a mapping with the keys of a job file; paths in it are relative to `folder`.

    Raises:
        InputError: anything in it that cannot be used.
    """
    return _job(Document("job", dict(mapping)), Path(folder), "job")


def read_cad_holes(path: str | Path, *, select: str | None = None, unit: Unit | None = None) -> CadHoles:
    """The holes of a CAD file, or of a job whose holes are in one.

    Args:
        path: of a STEP or DXF file, or of a job file.
        select: YAML, in place of that of the job.
        unit: of the file's numbers, in place of that of the job.

    Raises:
        InputError: a file that cannot be read, a job without such a file, or nothing that is selected.
    """
    path = Path(path)
    chosen = None if select is None else yaml_document(select, "--select")
    form = None if chosen is None else checked(SelectForm, chosen)
    if is_cad(path):
        content = read_bytes(path, "a STEP or DXF file")
        with inside(str(path)):
            asked = Asked(form or ALL, unit)
            return cad_holes(read_cad(content, path.name, asked), asked, None)
    document = yaml_document(read_text(path, "a STEP file, a DXF file or a job file (YAML)"), str(path))
    refuse_another_kind(document.data, document.file)
    job = checked(JobFile, document)
    if not (isinstance(job.holes, str) and is_cad(job.holes)):
        accepted = "a STEP or DXF file, or a job with the path of one under holes"
        raise InputError("its holes are not in a CAD file", where=document.where(("holes",)), accepted=accepted)
    given = {key: value for key, value in (("select", form), ("unit", unit)) if value is not None}
    with inside(document.where(("robot",))):
        robot = read_robot(job.robot, path.parent)
    return cad_holes_of(job.model_copy(update=given), document, path.parent, robot, frame_from(job.part_frame))


def read_points(path: str | Path, surface: str | Path, *, unit: Unit | None = None) -> CadHoles:
    """The holes of a table of points, drilled against the normals of a part's surface.

    Args:
        path: of a CSV file.
        surface: path of the part: a mesh, in millimetres, or a STEP file.
        unit: of the lengths of the table; None: as it says, or mm.

    Raises:
        InputError: as `surface_of` and `points_on`.
    """
    vertices, faces = surface_of(Path(surface))
    with inside(str(path)):
        return points_on(read_bytes(Path(path), "a CSV file of points"), vertices, faces, unit)


def read_plan(path: str | Path) -> Plan:
    """The plan of a plan file or a depth file, or of a part of one that `zerorev.files.part` keeps.

    Raises:
        InputError: another kind of file, cut short, altered, or with values that cannot be used.
    """
    return plan_from_text(plan_text(path), str(path))


def plan_text(path: str | Path) -> str:
    """The text of a plan file or a depth file.

    Raises:
        InputError: as `read_text` has it.
    """
    return read_text(Path(path), "a plan file (JSON)")


def plan_from_text(text: str, file: str) -> Plan:
    """The plan of a plan file's text, as `read_plan` has it.

    Args:
        text: of the file.
        file: how messages name it.

    Raises:
        InputError: another kind of file, cut short, altered, or with values that cannot be used.
    """
    document = part_document(text, file) or json_document(text, file)
    form = checked(_form_of(document), document)
    with inside(document.file):
        return plan_from(form)


def _form_of(document: Document) -> type[PlanFile] | type[DepthFile]:
    depth = isinstance(document.data, dict) and document.data.get("format") == "zerorev.depth/1"
    return DepthFile if depth else PlanFile


def plan_to_json(plan: Plan) -> dict[str, Any]:
    """The plan as plain data, exactly as its file holds it: a plan file, or a depth file by the plan's `strokes`.

    Raises:
        InputError: a number that no plan file may hold (NaN or infinite where a number is needed).
    """
    data = plan_data(plan)
    checked(FORMS[plan.strokes], Document("plan", data))
    return data


def write_plan(plan: Plan, path: str | Path) -> None:
    """Write a plan file, or a depth file by the plan's `strokes`, whole or not at all.

    Raises:
        InputError: the plan holds a number that no plan file may hold.
        OutputError: the file cannot be written.
    """
    write_text(path, json_text(plan_to_json(plan)))


def write_schemas(folder: str | Path) -> None:
    """Write the JSON Schemas of job, plan, depth, map and cell files, job.schema.json and so on, into a folder."""
    from zerorev.files.cell_file import CellFile
    from zerorev.files.map_schema import MapFile

    forms: dict[str, type[Form]] = {
        "job": JobFile, "plan": PlanFile, "depth": DepthFile, "map": MapFile, "cell": CellFile
    }  # fmt: skip
    for name, form in forms.items():
        schema = {"$schema": "https://json-schema.org/draft/2020-12/schema"} | form.model_json_schema()
        write_text(Path(folder) / f"{name}.schema.json", json_text(schema))


def _job(document: Document, folder: Path | None, name: str, *, depth_needed: bool = True) -> Job:
    """The job of a document; paths in it start in the folder, or are refused where there is none."""
    refuse_another_kind(document.data, document.file)
    form = checked(JobFile, document)
    with inside(document.where(("robot",))):
        robot = read_robot(form.robot, folder)
    with inside(document.file):
        settings, T_base_part = with_feeds(form, settings_from(form)), frame_from(form.part_frame)
        around = obstacles_from(form.part, form.fixtures, form.floor_mm, folder, T_base_part)
        settings = replace(settings, surroundings=around)
    reference = form.psi_reference if isinstance(form.psi_reference, str) else tuple(form.psi_reference)
    jobs = []
    for n, (at, use) in enumerate(uses_of(form, document)):
        with inside(document.where((*at, "tool"))):
            tool = read_tool(use.tool, folder) if isinstance(use.tool, str) else tool_from(use.tool, folder)
        holes, notes, said = holes_of(form, document, folder, robot, tool, T_base_part, depth_needed=depth_needed)
        called = (form.name or name) + (f"_tool_{n + 1}" if n else "")
        job = Job(robot, tool, holes, settings, T_base_part, called, reference, notes, said)
        with inside(document.where(at) if at else document.file):
            jobs.append(used(job, use))
    return replace(jobs[0], further=tuple(jobs[1:]))
