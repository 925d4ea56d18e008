"""From a file, or what was uploaded of one, to what a page shows of it."""

from __future__ import annotations

from dataclasses import replace
from importlib import resources
from pathlib import Path

from zerorev.files.io import read_job, read_plan
from zerorev.files.other_kinds import is_plan
from zerorev.files.text import read_text
from zerorev.model.job import Job
from zerorev.model.plan import Plan
from zerorev.web.files import parsed
from zerorev.web.state import State, opened_job, opened_map, opened_plan

__all__ = ["demo", "opened", "opened_text", "shown", "with_meshes"]

ACCEPTED = "a job file (YAML), a plan file (JSON) or a folder of a workspace map (zarr)"


def demo() -> State:
    """The three positions at which the thesis drilled, not planned yet."""
    text = (resources.files("zerorev.web") / "demo.yaml").read_text(encoding="utf-8")
    return opened_text(text, "demo.yaml")


def opened(path: Path) -> State:
    """A job, a plan or a map that the user of this machine named.

    Args:
        path: of a job file, whose relative paths start beside it; of a plan file; or of a map's folder.

    Raises:
        InputError: none of these, or one that cannot be used.
    """
    if path.is_dir():
        return _opened_map(path)
    if is_plan(read_text(path, ACCEPTED), path.name):
        return opened_plan(read_plan(path))
    return opened_job(read_job(path))


def opened_text(text: str, name: str) -> State:
    """A job or a plan that came from the browser; no file of this machine is opened but what ships with zerorev.

    Args:
        text: of the file.
        name: that it had, for messages.

    Raises:
        InputError: neither, or one that cannot be used.
    """
    return shown(parsed(text, name))


def shown(found: Job | Plan) -> State:
    """What a page shows of a job or a plan."""
    return opened_plan(found) if isinstance(found, Plan) else opened_job(found)


def with_meshes(state: State, urdf: Path) -> State:
    """The robot is shown with the meshes of a URDF file that the user of this machine named.

    Raises:
        InputError: not a URDF file, or not one of this robot.
    """
    from zerorev.report.scene.urdf_meshes import read_meshes

    return state if state.job is None else replace(state, meshes=read_meshes(urdf, state.job.robot))


def _opened_map(path: Path) -> State:
    from zerorev.maps.workspace import read_workspace_map
    from zerorev.report.scene.map_slice import slice_of

    return opened_map(slice_of(read_workspace_map(path)))
