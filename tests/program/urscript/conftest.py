"""Plans for a stand-in of the maker, which has no arm among those that ship yet."""

import pytest

from oracles.makers import free_leg_plan, panel_plan, position_plan, stand_in

PLANS = {
    "position 1": lambda robot, **settings: position_plan(robot, 1, **settings),
    "position 2": lambda robot, **settings: position_plan(robot, 2, **settings),
    "position 3": lambda robot, **settings: position_plan(robot, 3, **settings),
    "free leg": free_leg_plan,
    "panel": panel_plan,
}


@pytest.fixture(scope="session")
def robot():
    return stand_in("Universal Robots")


@pytest.fixture(scope="session")
def plan_called(robot):
    """A plan by its name, with settings."""

    def plan_called(name, **settings):
        return PLANS[name](robot, **settings)

    return plan_called
