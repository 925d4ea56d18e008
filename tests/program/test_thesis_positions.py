"""The three published positions, written and read back, against Appendix B of the thesis."""

import numpy as np
import pytest

from zerorev.program.export import export

# Appendix B: axis values of jSpaceStart [deg], and the increments of its two linear moves: X [mm] and C [deg]
APPENDIX_B = {
    1: ((143.1752, -107.9003, -79.0638, 11.3008, 88.3939, 217.3562), (50, 20.1033), (-50, 24.5212)),
    2: ((-78.6901, -86.9817, 87.6934, 0.0, 89.2884, 101.3099), (20, 1.8999), (-20, 35.6083)),
    3: ((115.5591, -64.3099, -87.1047, 12.4793, 43.6965, 236.7431), (30, 24.7906), (-30, 5.1428)),
}
TARGETS = {1: (500, 300, 800), 2: (200, 400, 600), 3: (200, 200, 1000)}


@pytest.mark.parametrize("number", APPENDIX_B)
def test_without_lead_in_the_file_says_what_appendix_b_says(number, krl, published, plan_of):
    start, *increments = APPENDIX_B[number]
    ptp, plunge, retract = krl.read(export(plan_of(published(number), lead_in=0.0)).text).moves
    np.testing.assert_allclose(ptp.axes, start, rtol=0, atol=0.005)
    assert plunge.blended
    assert not retract.blended
    x, y, z = TARGETS[number]
    np.testing.assert_allclose([plunge.values[n] for n in "XYZAB"], [x, y, z, 0, 0], rtol=0, atol=1e-9)
    # X of the written tool is the thesis' plunge, and C turns about it the way that psi does not
    (depth, first), (back, second) = increments
    assert retract.values["X"] - plunge.values["X"] == pytest.approx(back, abs=1e-3)
    assert retract.values["C"] - plunge.values["C"] == pytest.approx(second, abs=2e-4)
    assert depth == -back
    # the plunge begins where the PTP ends
    start_in_file = np.deg2rad(plunge.values["C"] - first)
    assert np.cos(start_in_file + np.deg2rad({1: 14.1646, 2: 180.0, 3: 20.2431}[number])) == pytest.approx(1, abs=1e-9)


def test_the_written_tool_is_the_flange_turned_the_simple_way(krl, published, plan_of):
    tool = krl.read(export(plan_of(published(1))).text).moves[0].state["$TOOL"]
    # the thesis' drill points along the flange's +X, which is X of the tool as written
    np.testing.assert_allclose(tool, [[1, 0, 0, 100], [0, 1, 0, 0], [0, 0, 1, 65], [0, 0, 0, 1]], atol=1e-12)


def test_with_lead_in_the_stroke_keeps_the_increments(krl, published, plan_of):
    ptp, start, target, end = krl.read(export(plan_of(published(1), lead_in=5e-3)).text).moves
    assert start.values["X"] == 450
    for a, b, (x, c) in ((start, target, (50, 20.1033)), (target, end, (-50, 24.5212))):
        assert b.values["X"] - a.values["X"] == pytest.approx(x, abs=1e-3)
        assert b.values["C"] - a.values["C"] == pytest.approx(c, abs=2e-4)
    # Appendix B's start lies between the lead-in point and the target, on the way in
    assert (ptp.axes[1] - -107.9003) * (-107.9003 - -120.7634) > 0


def test_the_state_of_the_controller(krl, published, plan_of):
    plan = plan_of(*(published(n) for n in (1, 2, 3)), blend=1e-3, feed_plunge=4e-3, feed_retract=15e-3)
    program = krl.read(export(plan).text)
    assert len(program.holes()) == 3
    for hole in program.holes():
        assert [move.kind for move in hole] == ["PTP", "LIN", "LIN", "LIN"]
        assert [move.blended for move in hole] == [False, True, True, False]
        for move in hole[1:]:
            assert (move.state["$IPO_MODE"], move.state["$ORI_TYPE"], move.state["$ADVANCE"]) == ("#BASE", "#VAR", 3)
            assert min(move.state["$VEL.ORI1"], move.state["$VEL.ORI2"]) >= 200
        entry, corner, _ = hole[1:]
        # at the entry it is clipped to half the lead-in, which position 3's published spins let run 0.43 mm only
        assert corner.state["$APO.CDIS"] == 1.0
        assert 0 < entry.state["$APO.CDIS"] <= 1.0
        assert [move.state["$VEL.CP"] for move in hole[1:]] == [0.004, 0.004, 0.015]


def test_nothing_at_the_corner_stops_the_advance_run(krl, published, plan_of):
    statements = krl.read(export(plan_of(published(1))).text).statements
    first = next(i for i, statement in enumerate(statements) if statement.startswith("PTP"))
    assert all(s.startswith(("$VEL.CP=", "$APO.CDIS=", "LIN {")) for s in statements[first + 1 : -1])
