"""A FANUC, and what its programs are proven by."""

import math

import pytest

from zerorev.files.io import read_robot
from zerorev.program.as_exported import as_exported
from zerorev.program.tp.dialect import TP
from zerorev.verify.certificate.program import certify_program

# three decimals need joints that move, and room to their limits: [rad/m], [rad]
THRESHOLD, MARGIN = math.radians(10.0), math.radians(0.1)


@pytest.fixture(scope="session")
def fanuc():
    return read_robot("fanuc_lrmate200id")


@pytest.fixture(scope="session")
def for_tp():
    """Settings of a plan for TP."""
    return {"controller": "tp", "tool_number": 3, "min_rate": THRESHOLD, "limit_margin": MARGIN}


@pytest.fixture(scope="session")
def certificates():
    def certificates(plan, exported, name=""):
        program = TP.read(exported.files)
        return [hole.certificate for hole in certify_program(plan, program, as_exported(plan, program, TP, name)).holes]

    return certificates
