"""Robotic drilling without joint reversals: robot, tool and holes in; the best motion and its proof out.

The names below are the public ones. They are imported when first used, so that `import zerorev` is quick; the kernels
behind `plan` are compiled on first use, which says so once, and cached. `zerorev.figures` is a module of its own, since
it needs matplotlib.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from zerorev.model import shown

if TYPE_CHECKING:
    from zerorev import figures as figures
    from zerorev.errors import InputError, NotExportableError, OutputError, ZerorevError
    from zerorev.files.io import read_job, read_plan, read_robot, read_tool, robot_names, tool_names, write_plan
    from zerorev.model.finding import Finding
    from zerorev.model.hole import Hole
    from zerorev.model.job import Job, Settings
    from zerorev.model.plan import HolePlan, Plan, Score
    from zerorev.model.profile import Profile
    from zerorev.model.robot import ArmGeometry, JointLimits, Robot
    from zerorev.model.tool import Tool
    from zerorev.motion.evaluation import evaluate
    from zerorev.planning.hole import plan, plan_deepest
    from zerorev.planning.job import plan_job
    from zerorev.planning.restated import check_plan
    from zerorev.program.export import export
    from zerorev.search.deepest import Deepest, deepest_stroke
    from zerorev.verify.check import verify_plan

__all__ = [
    "ArmGeometry",
    "Deepest",
    "Finding",
    "Hole",
    "HolePlan",
    "InputError",
    "Job",
    "JointLimits",
    "NotExportableError",
    "OutputError",
    "Plan",
    "Profile",
    "Robot",
    "Score",
    "Settings",
    "Tool",
    "ZerorevError",
    "check_plan",
    "deepest_stroke",
    "evaluate",
    "export",
    "plan",
    "plan_deepest",
    "plan_job",
    "read_job",
    "read_plan",
    "read_robot",
    "read_tool",
    "robot_names",
    "tool_names",
    "verify_plan",
    "write_plan",
]

_HOMES = {
    "errors": ("InputError", "NotExportableError", "OutputError", "ZerorevError"),
    "files.io": (
        "read_job", "read_plan", "read_robot", "read_tool", "robot_names", "tool_names", "write_plan",
    ),
    "model.hole": ("Hole",),
    "model.job": ("Job", "Settings"),
    "model.finding": ("Finding",),
    "model.plan": ("HolePlan", "Plan", "Score"),
    "model.profile": ("Profile",),
    "model.robot": ("ArmGeometry", "JointLimits", "Robot"),
    "model.tool": ("Tool",),
    "motion.evaluation": ("evaluate",),
    "planning.hole": ("plan", "plan_deepest"),
    "planning.job": ("plan_job",),
    "planning.restated": ("check_plan",),
    "program.export": ("export",),
    "search.deepest": ("Deepest", "deepest_stroke"),
    "verify.check": ("verify_plan",),
}  # fmt: skip


def __getattr__(name: str) -> Any:
    """Import a public name from its home when it is first asked for (PEP 562)."""
    if name == "figures":
        return import_module("zerorev.figures")
    for home, names in _HOMES.items():
        if name in names:
            value = getattr(import_module(f"zerorev.{home}"), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module 'zerorev' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*__all__, "figures"])


def _in_notebook(answer: Any) -> str:
    from zerorev.report.notebook import html_of  # only when something is shown

    return html_of(answer)


shown.register(_in_notebook)
