"""`zerorev.figures`: every figure of the command line, called as a user calls it, also among a user's own axes."""

from __future__ import annotations

import inspect
import subprocess
import sys

import numpy as np
import pytest
from matplotlib.figure import Figure

import zerorev as zr
from oracles.made_map import made_map
from oracles.made_study import made_study
from zerorev import figures
from zerorev.errors import InputError
from zerorev.model.job import Job
from zerorev.placement.freedom import Freedom
from zerorev.placement.room import Slice
from zerorev.placement.search import Placement
from zerorev.placement.tool_offset import LeastOffset, OffsetCurve
from zerorev.thesis.compare import Comparison, Rescored
from zerorev.thesis.methods import METHODS, Outcome
from zerorev.thesis.parameter_map import parameter_map

WAYS = np.array([[1.0, 0, 0], [0.8, 0.6, 0], [0.8, -0.6, 0]])


@pytest.fixture(scope="module")
def answers(published, robot, tool, positions):
    """The arguments of each public figure, made of small answers."""
    job = Job(robot, tool, tuple(position.hole for position in positions), name="thesis")
    offsets, angles = np.array([0.05, 0.1, 0.15]), np.deg2rad([0.0, 90.0, 180.0])
    deepest = np.arange(27.0).reshape(3, 3, 3) * 4e-3
    curve = OffsetCurve(offsets, angles, deepest, np.full(3, 0.03))
    least = LeastOffset(0.1, 0.0, tool, deepest[1, 0], 0.05)
    freedom = Freedom(y=(-0.1, 0.1), z=(-0.3, 0.0))
    grid = tuple(freedom.values(axis, 3) for axis in range(4))
    pictured = Slice(
        ("y", "z"), (freedom.values(1, 4), freedom.values(2, 4)), np.linspace(-0.05, 0.02, 16).reshape(4, 4)
    )
    margins = np.array([0.02, 0.01, 0.01])
    placed = Placement(
        np.array([0, -0.02, -0.2, 0]), margins, margins - 0.1, grid, np.full([axis.size for axis in grid], np.nan),
        np.array([[-0.01, 0.02]] * 4), slices=(pictured,), strokes=17, finished=True,
    )  # fmt: skip
    workspace = made_map(
        robot, tool, ([300, 400], [-100, 0, 100], [600, 700]), WAYS,
        lambda x, y, z, way: x / 10 + abs(y) / 20 + z / 50 + 10 * abs(way[1]), branch=4, psi_deg=(5, 0, -5),
    )  # fmt: skip
    outcome = Outcome(np.zeros(3), 4, 0.01, 0, 100, 7)
    runs = tuple(Rescored("position 1", "swarm", seed, outcome, 0.01, 0, 1.7, 0.2) for seed in range(3))
    compared = Comparison(job, job.holes, {"swarm": METHODS["swarm"]}, (0, 1, 2), 100, runs=runs)
    hole, studied = positions[0].hole, made_study("position 1")
    return {
        "comparison_boxes": (compared,),
        "critical_rates": (published, "position 2"),
        "drilled_holes": ((studied,),),
        "drive_torques": (studied, robot.joint_names),
        "joint_angles": (published, "position 2"),
        "map_cell": (workspace,),
        "map_difference": (workspace, workspace.assign(deepest_mm=workspace["deepest_mm"] + 3.0)),
        "map_planes": (workspace,),
        "map_rose": (workspace, (400, 0, 700)),
        "map_surface": (workspace,),
        "map_views": (workspace,),
        "parameter_slices": ({"after extents": parameter_map(robot, tool, hole, size=6, psi_target=[0.0])},),
        "placement_map": (job, placed),
        "robot_catalogue": ([robot, *map(zr.read_robot, ("yaskawa_gp8", "staubli_tx2_90l"))],),
        "study_gains": ((studied,),),
        "tip_deviation": (studied,),
        "tool_offset": (job, curve, least),
        "twist_plane": (published, "position 2"),
        "zero_volume": (parameter_map(robot, tool, hole, size=6),),
    }


AMONG_OTHERS = [name for name in figures.__all__ if "ax" in inspect.signature(getattr(figures, name)).parameters]
IN_3D = {"map_cell", "map_surface", "zero_volume"}


@pytest.mark.parametrize("name", figures.__all__)
def test_each_draws_its_answer_and_shows_itself_in_a_notebook(answers, name):
    figure = getattr(figures, name)(*answers[name])
    assert isinstance(figure, Figure)
    assert figure._repr_png_().startswith(b"\x89PNG")
    assert figure.texts[0].get_text()
    assert any(axes.has_data() for axes in figure.axes)


def test_the_names_are_these_and_all_are_documented(answers):
    assert figures.__all__ == sorted(figures.__all__) == sorted(answers)
    for name in figures.__all__:
        reported = inspect.getdoc(getattr(figures, name))
        assert all(f"    {each}:" in reported for each in inspect.signature(getattr(figures, name)).parameters), name


def test_figures_of_one_axes_are_these():
    assert set(AMONG_OTHERS) == {
        "critical_rates",
        "map_rose",
        "robot_catalogue",
        "study_gains",
        "tool_offset",
        "twist_plane",
        *IN_3D,
    }


@pytest.mark.parametrize("name", AMONG_OTHERS)
def test_it_can_stand_among_a_user_s_own(answers, name):
    mine = Figure()
    part, _ = mine.subfigures(1, 2)
    axes = part.add_subplot(projection="3d" if name in IN_3D else None)
    assert getattr(figures, name)(*answers[name], ax=axes) is mine
    assert axes.has_data()
    assert mine.texts == part.texts == mine.legends == []  # no heading, and the legend is the axes' own
    assert axes.get_legend() is not None or name == "zero_volume"


@pytest.mark.parametrize("name", AMONG_OTHERS)
def test_axes_of_another_projection_are_refused(answers, name):
    axes = Figure().add_subplot(projection=None if name in IN_3D else "3d")
    with pytest.raises(InputError, match="ax: has the projection"):
        getattr(figures, name)(*answers[name], ax=axes)


def test_a_hole_may_be_named_given_or_left_out(published):
    def title(*hole):
        return figures.critical_rates(published, *hole).texts[1].get_text()

    assert title("position 3") == title(published.holes[2]) != title() == title("position 1")
    with pytest.raises(InputError, match=r"has no hole 'x' .*position 1, position 2"):
        title("x")
    with pytest.raises(InputError, match="hole far: has no motion"):
        title("far")


def test_a_row_of_cells_is_not_a_surface(robot, tool):
    row = made_map(robot, tool, ([300], [0, 100], [600]), WAYS[:1], lambda *_: 5.0)
    for draw in (figures.map_surface, figures.map_views):
        with pytest.raises(InputError, match="is a row of cells"):
            draw(row)
    with pytest.raises(InputError, match="has one direction"):
        figures.map_rose(row)


def test_it_is_found_in_the_package_and_loads_matplotlib_only_then():
    assert zr.figures is figures
    assert "figures" in dir(zr)
    code = "import sys, zerorev as zr; before = 'matplotlib' in sys.modules; zr.figures.joint_angles; print(before)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_without_matplotlib_it_says_what_to_install():
    code = "import sys; sys.modules['matplotlib'] = None; import zerorev; zerorev.figures"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "ImportError: zerorev.figures needs matplotlib" in done.stderr
    assert "pip install 'zerorev[figures]'" in done.stderr
