"""`zerorev replay`: the motions of a plan as one HTML file to be sent around."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, Whole, app, check_outputs, need, of_tool
from zerorev.report.words import terminal

__all__ = ["replay"]


@app.command
def replay(
    plan: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    hole: tuple[str, ...] = (),
    tool: Whole | None = None,
    urdf: Path | None = None,
) -> int:
    """Write the motions of a plan as one HTML file that plays them in any browser, with no network.

    Args:
        plan: The plan file (JSON).
        output: The HTML file.
        hole: Only this hole; may be given several times. By default all holes of the plan.
        tool: Of a plan of several tools: what this one does, from 1; by default the first.
        urdf: Description of the plan's robot (URDF), whose meshes are shown; they lie in the same folder, or
            in a folder above it that is called as the package they name (package://).
    """
    from zerorev.files.io import read_plan
    from zerorev.files.output import write_text

    need("nicegui", "NiceGUI, whose three.js draws the robot,", "replay", "view")
    if urdf is not None:
        need("trimesh", "trimesh", "--urdf", "view")
    check_outputs((output,), plan, *([urdf] if urdf else []))
    answer = of_tool(read_plan(plan), tool)

    from zerorev.report.scene.replay import replay_page
    from zerorev.report.scene.urdf_meshes import read_meshes

    with terminal.busy("writing"):
        page = replay_page(answer, hole or None, None if urdf is None else read_meshes(urdf, answer.robot))
    write_text(output, page)
    terminal.say(f"replay written to {output}; it opens in a browser, from disk")
    return FINE
