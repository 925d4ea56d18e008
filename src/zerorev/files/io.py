"""Reading and writing the files of zerorev: robot, tool, job (YAML, CSV) and plan (JSON).

A file becomes plain data (`text`), a checked form (`schema`, `validation`) and then a noun in SI (`conversion`).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from zerorev.errors import InputError
from zerorev.files.conversion import frame_from, hole_from, robot_from, settings_from, tool_from, with_feeds
from zerorev.files.hole_list import all_of, given_of, in_base_frame, read_hole_list, text_of_list
from zerorev.files.hole_meaning import as_in_a_job, meaning_of
from zerorev.files.named import named_document, shipped
from zerorev.files.other_kinds import refuse_another_kind, refuse_map_folder
from zerorev.files.output import write_text
from zerorev.files.part import part_document
from zerorev.files.plan_conversion import plan_from
from zerorev.files.plan_data import FORMS, plan_data
from zerorev.files.plan_schema import DepthFile, PlanFile
from zerorev.files.robot_schema import RobotFile, ToolFile
from zerorev.files.schema import HoleForm, JobFile, SettingsForm
from zerorev.files.stated_forms import Form
from zerorev.files.text import Document, json_document, json_text, read_bytes, read_text
from zerorev.files.validation import checked, inside
from zerorev.files.yaml_text import yaml_document
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
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
    "read_job",
    "read_plan",
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
        return tool_from(form, sources=form.sources)


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
    with inside(document.where(("tool",))):
        tool = read_tool(form.tool, folder) if isinstance(form.tool, str) else tool_from(form.tool)
    with inside(document.file):
        settings, T_base_part = with_feeds(form, settings_from(form)), frame_from(form.part_frame)
    notes: tuple[str, ...] = ()
    if isinstance(form.holes, str):
        holes, notes = _table(form, document, folder, tool, T_base_part, depth_needed=depth_needed)
        notes = tuple(f"{form.holes}: {note}" for note in notes)
    else:
        _check_listed(form, document, depth_needed=depth_needed)
        holes = _holes(form, document, tool, T_base_part)
    reference = form.psi_reference if isinstance(form.psi_reference, str) else tuple(form.psi_reference)
    return Job(robot, tool, tuple(holes.values()), settings, T_base_part, form.name or name, reference, notes)


def _check_listed(form: JobFile, document: Document, *, depth_needed: bool) -> None:
    """Refuse what is missing in a list of holes that stands in a job, and keys that are for a CSV alone."""
    for key in ("columns", "unit", "decimal"):
        if getattr(form, key) is not None:
            what, accepted = "goes with a CSV file of holes", "holes: the path of a CSV file; or without this key"
            raise InputError(what, where=document.where((key,)), accepted=accepted)
    for n, hole in enumerate(form.holes):
        assert isinstance(hole, HoleForm)
        if depth_needed and hole.depth_mm is None and form.depth_mm is None:
            accepted = HoleForm.model_fields["depth_mm"].description or ""
            where = f"{document.where(('holes', n))}.depth_mm (hole {hole.id})"
            raise InputError("is missing", where=where, accepted=accepted)


def _holes(form: JobFile, document: Document, tool: Tool, T_base_part: Array) -> dict[str, Hole]:
    """The holes that stand in a job, by their ids."""
    holes: dict[str, Hole] = {}
    meaning = meaning_of(form)
    for n, listed in enumerate(form.holes):
        assert isinstance(listed, HoleForm)
        where = document.where(("holes", n))
        if listed.id in holes:
            raise InputError(f"the id '{listed.id}' is used twice", where=where, accepted="ids that differ")
        with inside(where):
            hole = as_in_a_job(listed, meaning)
            holes[hole.id] = hole_from(hole, form.psi_reference, tool, T_base_part)
    return holes


def _table(
    form: JobFile, document: Document, folder: Path | None, tool: Tool, T_base_part: Array, *, depth_needed: bool
) -> tuple[dict[str, Hole], tuple[str, ...]]:
    """The holes of a job's CSV, by their ids, and what was left out of it."""
    assert isinstance(form.holes, str)
    if folder is None:
        accepted = "a list of holes in the job itself"
        raise InputError("another file is not opened from here", where=document.where(("holes",)), accepted=accepted)
    path = folder / form.holes
    with inside(document.where(("holes",))):
        content = read_bytes(path, "a CSV file of holes, or a list of holes")
    with inside(str(path)):
        text = text_of_list(content)
        listed = read_hole_list(text, given_of(form), meaning_of(form), depth_needed=depth_needed)
        rows = all_of(in_base_frame(listed, form.psi_reference, tool, T_base_part))
    return {row.hole.id: row.hole for row in rows if row.hole is not None}, listed.notes
