"""Plans for Yaskawa robots: one whose pulses are known, and the thesis' arm as if it were one."""

from dataclasses import replace

import numpy as np
import pytest

from oracles.makers import free_leg_plan, panel_plan, position_plan, stand_in
from zerorev.files.io import read_robot
from zerorev.model.cycle import Cycle

THRESHOLD = float(np.deg2rad(10))  # [rad/m] 0.01 deg/mm, as a job has it that says nothing


@pytest.fixture(scope="session")
def ma2010():
    return read_robot("yaskawa_ma2010")


@pytest.fixture(scope="session")
def yaskawas(ma2010):
    """By name: the robot, and how much nearer its holes lie than the reach of the arm alone would have them."""
    small = replace(stand_in("Yaskawa"), pulses_per_deg=(1341.4, -1907.7, 1592.9, -1022.9, 980.2, -454.8))
    return {"ma2010": (ma2010, 0.85), "stand_in": (small, 1.0)}


@pytest.fixture(scope="session")
def plan_for(yaskawas):
    """Plans by the name of a robot and what is drilled."""

    def plan_for(robot="ma2010", what=1, **settings):
        arm, nearer = yaskawas[robot]
        chosen = {"controller": "inform", "tool_number": 3, "min_rate": THRESHOLD, "nearer": nearer} | settings
        if what in (1, 2, 3):
            return position_plan(arm, what, **chosen)
        if what == "chip break":
            return position_plan(arm, 2, **(chosen | {"cycle": Cycle("chip_break", 5e-3, 0.3e-3)}))
        return (free_leg_plan if what == "free legs" else panel_plan)(arm, **chosen)

    return plan_for
