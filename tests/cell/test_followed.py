"""The arm along a motion over time: its masses, and what a load adds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.cell.motions import compared
from zerorev.cell.reference import Manner
from zerorev.errors import InputError


def reference_of(published_plan, number=0, name="plan", **manner):
    hole = published_plan.holes[number]
    return compared(published_plan, hole, Manner(**manner), (name,)).followed[name]


def test_an_arm_without_masses(published_plan):
    bare = replace(published_plan, robot=replace(published_plan.robot, dynamics=None))
    with pytest.raises(InputError, match="the masses of the robot kuka_kr6_r700_2 are not known"):
        compared(bare, bare.holes[0], Manner())


def test_a_load_is_linear_in_its_mass_and_a_parabola_in_its_place(published_plan):
    found = reference_of(published_plan, feed=0.1, corner=5e-3)
    tool = found.drilling.tool
    from zerorev.model.dynamics import Load

    for mass, lever in ((0.4, 0.3), (2.5, 0.62)):
        load = Load(mass, lever * tool.T_flange_tcp[:3, 3], np.zeros((3, 3)))
        own = replace(found, drilling=replace(found.drilling, tool=replace(tool, load=load)))
        torque, masses, stiffening = own.loaded
        np.testing.assert_allclose(found.of_load(found.torques, mass, lever), torque, rtol=0, atol=1e-10)
        np.testing.assert_allclose(found.of_load(found.masses, mass, lever), masses, rtol=0, atol=1e-12)
        np.testing.assert_allclose(found.of_load(found.stiffenings, mass, lever), stiffening, rtol=0, atol=1e-6)
        np.testing.assert_allclose(stiffening, np.swapaxes(stiffening, 1, 2), rtol=0, atol=1e-5)  # of one potential
