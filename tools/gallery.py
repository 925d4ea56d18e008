"""The gallery of figures, docs/reference/gallery.md: every public figure, drawn of answers that are computed here.

`python tools/gallery.py` draws all of them and writes the page (some minutes); `python tools/gallery.py NAME` draws one
and writes the page. A test fails where the page lists other figures than `zerorev.figures` has.
"""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from functools import cache
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import zerorev as zr
from zerorev import figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

    from zerorev.cell.ensemble import HoleStudy

ROOT = Path(__file__).parents[1]
PAGE, PICTURES = ROOT / "docs/reference/gallery.md", ROOT / "docs/img/gallery"
COLOURS = 128  # of a picture: some 50 kB
HEAD = """\
# Figures

Every figure of the command line as a function of `zerorev.figures`, drawn here of answers that were computed
(`python tools/gallery.py`). Each takes the answer that it draws and returns matplotlib's `Figure`: a notebook shows it,
`figure.savefig(path)` keeps it. A figure with one axes takes `ax` and can stand among your own:

```python
import matplotlib.pyplot as plt
import zerorev as zr

job = zr.read_job("examples/jobs/thesis_positions.yaml")
plan = zr.plan_job(job)
figure, (left, right) = plt.subplots(1, 2, figsize=(16, 7), layout="constrained")
zr.figures.twist_plane(plan, "position_1", ax=left)
zr.figures.critical_rates(plan, "position_1", ax=right)
figure.savefig("position_1.png")
print("drawn:", plan.holes[0].hole.id)
```

"""
GROUPS = {
    "A hole of a plan": ("joint_angles", "twist_plane", "critical_rates"),
    "A study of possible arms": ("tip_deviation", "drive_torques", "study_gains", "drilled_holes"),
    "Where a part or a tool should stand": ("placement_map", "tool_offset"),
    "The robots that ship": ("robot_catalogue",),
    "A workspace map": ("map_planes", "map_surface", "map_views", "map_cell", "map_rose", "map_difference"),
    "The method of the thesis": ("parameter_slices", "zero_volume", "comparison_boxes"),
}


def text() -> str:
    """The whole page; signatures and explanations are put in from the docstrings when the site is built."""
    parts = [HEAD]
    for group, names in GROUPS.items():
        parts.append(f"## {group}\n\n")
        parts += [f"::: zerorev.figures.{name}\n\n![{name}](../img/gallery/{name}.png)\n\n" for name in names]
    return "".join(parts).rstrip() + "\n"


# --- the answers ------------------------------------------------------------------------------------------------------


def _job(name: str) -> zr.Job:
    return zr.read_job(ROOT / "examples/jobs" / f"{name}.yaml")


@cache
def _plan() -> zr.Plan:
    return zr.plan_job(_job("thesis_positions"))


@cache
def _study() -> tuple[HoleStudy, ...]:
    """The positions of the thesis on 60 possible arms, at 20 mm/s."""
    from zerorev.cell.ensemble import HoleStudy, study
    from zerorev.cell.possible import finished, possible_arms
    from zerorev.cell.reference import Manner
    from zerorev.model.ranges import Cell

    arms = finished(possible_arms(_plan(), Cell(), 60, 0))
    found = study(_plan(), arms.sets, manner=Manner(feed=0.02), motions=())
    return tuple(each for each in found if isinstance(each, HoleStudy))


def _tool_offset() -> Figure:
    from zerorev.placement.tool_offset import least_offset, offset_curve

    job, offsets, angles = _job("tool_offset"), np.arange(0, 161, 20) / 1e3, np.deg2rad(np.arange(0, 331, 30))
    curve = offset_curve(job.robot, job.tool, job.holes, job.settings, offsets, angles)
    return figures.tool_offset(job, curve, least_offset(job, curve))


def _placement() -> Figure:
    from zerorev.placement.freedom import Freedom
    from zerorev.placement.search import place

    job = _job("place_panel")
    return figures.placement_map(job, place(job, Freedom(y=(-0.1, 0.1), z=(-0.3, 0.0)), cells=13))


@cache
def _map(legs: str = "straight", tilts: tuple[float, ...] = (0.0,), x: tuple[float, ...] = (300, 400, 500)) -> Dataset:
    """Deepest strokes on planes across X, along +X and directions tilted from it [deg], on 100 mm."""
    from tempfile import TemporaryDirectory

    from zerorev.files.map_file import read_map_file
    from zerorev.maps.run import run_map
    from zerorev.maps.workspace import read_workspace_map

    ways = [[1.0, 0.0, 0.0]]
    for tilt in np.deg2rad([each for each in tilts if each]):
        turns = np.arange(0, 360, 60 if tilt < 0.6 else 30)
        ways += [[np.cos(tilt), np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn)] for turn in np.deg2rad(turns)]
    with TemporaryDirectory() as folder:
        file, store = Path(folder) / "map.yaml", Path(folder) / "map.zarr"
        file.write_text(
            f"robot: kuka_kr6_r700_2\ntool: thesis_drill\nquantity: deepest\nlegs: {legs}\ntargets:\n"
            f"  x_mm: {list(x)}\n  y_mm: {{start: -400, stop: 400, step: 100}}\n"
            f"  z_mm: {{start: 400, stop: 1200, step: 100}}\n"
            f"directions: {np.array(ways).round(6).tolist()}\n"
        )
        run_map(read_map_file(file), store)
        return read_workspace_map(store)


def _parameters(**given: Any) -> Dataset:
    from zerorev.thesis.parameter_map import parameter_map

    job = _job("thesis_positions")
    return parameter_map(job.robot, job.tool, job.holes[0], **given)


def _slices() -> Figure:
    from zerorev.thesis.parameter_map_lines import TURNS
    from zerorev.thesis.sampled import Weighing

    maps = {
        TURNS[turns]: _parameters(weighing=Weighing(turns=turns), size=100, psi_target=[0.0]) for turns in sorted(TURNS)
    }
    return figures.parameter_slices(maps)


def _comparison() -> Figure:
    from dataclasses import replace

    from zerorev.thesis.compare import comparison, runs

    job = _job("thesis_positions")
    asked = comparison(job, ["exact", "swarm", "differential_evolution"], range(10), hole="position_1")
    return figures.comparison_boxes(replace(asked, runs=tuple(runs(asked))))


DRAWN: dict[str, Callable[[], Figure]] = {
    "joint_angles": lambda: figures.joint_angles(_plan(), "position_1"),
    "twist_plane": lambda: figures.twist_plane(_plan(), "position_2"),
    "critical_rates": lambda: figures.critical_rates(_plan(), "position_1"),
    "tip_deviation": lambda: figures.tip_deviation(_study()[0]),
    "drive_torques": lambda: figures.drive_torques(_study()[0], _plan().robot.joint_names),
    "study_gains": lambda: figures.study_gains(_study()),
    "drilled_holes": lambda: figures.drilled_holes(_study()),
    "placement_map": _placement,
    "tool_offset": _tool_offset,
    "robot_catalogue": lambda: figures.robot_catalogue([zr.read_robot(name) for name in zr.robot_names()]),
    "map_planes": lambda: figures.map_planes(_map()),
    "map_surface": lambda: figures.map_surface(_map()),
    "map_views": lambda: figures.map_views(_map()),
    "map_cell": lambda: figures.map_cell(_map()),
    "map_rose": lambda: figures.map_rose(_map(tilts=(0, 20, 40, 60), x=(500,)), (500, 300, 800)),
    "map_difference": lambda: figures.map_difference(_map(x=(500,)), _map("free", x=(500,)), ("straight", "free")),
    "parameter_slices": _slices,
    "zero_volume": lambda: figures.zero_volume(_parameters(size=60)),
    "comparison_boxes": _comparison,
}


def _small(figure: Figure) -> bytes:
    """PNG with few colours."""
    from PIL import Image

    full, small = io.BytesIO(), io.BytesIO()
    figure.savefig(full, format="png")
    with Image.open(full) as image:
        image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(small, format="png", optimize=True)
    return small.getvalue()


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    for number, name in zip(count(1), sys.argv[1:] or DRAWN):
        print(f"{number}: {name}")  # noqa: T201
        (PICTURES / f"{name}.png").write_bytes(_small(DRAWN[name]()))
    PAGE.write_text(text(), encoding="utf-8")
