"""The page of two recordings: its figures hold what was measured, and it asks for nothing from elsewhere."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from oracles.published import POSITIONS
from oracles.recordings import kick, run_of
from zerorev.cell.recordings.metrics import metrics
from zerorev.cell.recordings.run import drilling_run
from zerorev.cell.recordings.tip import PlannedHole
from zerorev.model.plan import Motion
from zerorev.motion.drilling import Drilling
from zerorev.report.figures.recordings import Compared, deviations, joints, paths, postures, profiles, torques
from zerorev.report.figures.recordings_page import comparison_rows, recordings_page


@pytest.fixture(scope="module")
def compared(robot, tool):
    position = POSITIONS[2]
    motion = Motion(position.profile, position.branch, np.zeros((3, 6)))
    planned = PlannedHole(Drilling(robot, tool, position.hole), motion, 5e-3, 1e-3)
    found = []
    for held, share, feed in ((True, 1.0, 0.04), (False, 0.5, 0.03)):
        run = run_of(
            robot, tool, position, held=held, feed=feed, error=lambda path, k=share: [k * e for e in kick(path)]
        )
        cut = drilling_run(run.recording, planned)
        found.append((cut, metrics(cut)))
    return Compared(*found, planned)


def without(compared, **members):
    """The same recordings without some of their members."""
    pairs = []
    for run, found in (compared.baseline, compared.optimised):
        pairs.append((replace(run, recording=replace(run.recording, **members)), found))
    return Compared(*pairs, compared.planned)


def test_the_table_holds_what_was_measured(compared):
    rows = {what: cells for what, *cells in comparison_rows(compared)}
    before, after = (found.deviation_max * 1e3 for _, found in (compared.baseline, compared.optimised))
    found = rows["precision: greatest deviation from the mean [mm]"]
    assert found == [f"{before:.3f}", f"{after:.3f}", f"−{100 * (1 - after / before):.0f} %"]
    assert rows["reversals A1 to A6"][:2] == ["1 1 1 1 1 1", "0 0 0 0 0 0"]
    assert rows["feed [mm/s]"] == ["40.0", "30.0", "−25 %"]
    run, measured = compared.baseline
    inside = run.recording.torque[run.rows][np.abs(run.path) <= measured.window, 3]
    assert rows["swing of the torque of A4 in the window [Nm]"][0] == f"{np.ptp(inside):.3g}"


def test_the_figures_draw_the_data(compared):
    run, found = compared.optimised
    angles = joints(compared)
    for n, axes in enumerate(angles.axes):
        (line,) = [
            each for each in axes.lines if len(each.get_xdata()) == len(run.path) and each.get_linestyle() == "-"
        ]
        assert np.allclose(line.get_xdata(), run.path * 1e3)
        assert np.allclose(line.get_ydata(), np.rad2deg(run.recording.joints[run.rows, n]))
        # what was planned lies on what was commanded, in the same turn
        planned = axes.lines[-1]
        assert (
            np.abs(np.interp(run.path * 1e3, planned.get_xdata(), planned.get_ydata()) - line.get_ydata()).max() < 0.5
        )
    drawn = max(line.get_ydata().max() for line in deviations(compared).axes[0].lines)
    assert drawn == pytest.approx(
        max(each.deviation.max() for _, each in (compared.baseline, compared.optimised)) * 1e3
    )
    for n, axes in enumerate(profiles(compared).axes):
        plunge, retract, mean = axes.lines[3:6]
        together = np.concatenate([plunge.get_ydata(), retract.get_ydata()])
        assert np.allclose(together, found.lateral[:, n] * 1e3)
        assert np.allclose(mean.get_ydata(), found.mean[n] * 1e3)
    time = paths(compared).axes[0].lines[-1].get_xdata()
    assert time[0] == pytest.approx(0, abs=0.005)
    assert torques(compared) is not None


def test_postures_end_at_the_tip(compared):
    run, hole = compared.optimised[0], compared.planned.drilling.hole
    side, above = postures(compared).axes
    for axes, y in ((side, 2), (above, 1)):
        start, turn, end, stroke = axes.lines
        for line, row in ((start, 0), (turn, int(np.argmin(np.abs(run.path)))), (end, -1)):
            assert line.get_xydata()[-1] == pytest.approx(run.tip[row][[0, y]] * 1e3, abs=1e-6)
            assert line.get_xydata()[0] == pytest.approx([0, 0], abs=1e-9)
        assert stroke.get_xydata()[1] == pytest.approx(hole.target[[0, y]] * 1e3)
    assert postures(Compared(compared.baseline, compared.optimised)) is None


def test_the_page_stands_alone(compared):
    page = recordings_page(compared)
    assert set(re.findall(r'(?:src|href)="(.{5})', page)) == {"data:"}
    assert "http" not in re.sub(r'src="data:[^"]*"', "", page)
    assert "<script" not in page
    assert page.count("<img") == 6
    assert "different speeds, 40 and 30 mm/s" in page
    assert "Not recorded" not in page
    assert "Recorded runs of hole position 3" in page


def test_what_was_not_recorded_is_said(compared):
    bare = without(compared, torque=None)
    assert torques(bare) is None
    only_tips = []
    for run, found in (bare.baseline, bare.optimised):
        tips = np.zeros((run.recording.time.size, 3))
        name = "<script>alert(1)</script>"
        recording = replace(run.recording, joints=None, joints_commanded=None, tcp=tips, source=name)
        only_tips.append((replace(run, recording=recording), found))
    page = recordings_page(Compared(*only_tips, compared.planned))
    assert page.count("Not recorded") == 3
    assert page.count("<img") == 3
    assert "<script" not in page
    assert "&lt;script&gt;" in page  # names are not markup
