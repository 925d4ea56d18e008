"""What nobody would drill, but somebody types: an answer or one clear message, and no warning of NumPy."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from oracles.places import CASES
from zerorev.cli import main
from zerorev.errors import InputError
from zerorev.files.io import read_job
from zerorev.model._arrays import unit
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.planning.hole import plan

X = np.array([1.0, 0.0, 0.0])


class TestDirections:
    @pytest.mark.parametrize("length", [1e-300, 1e-200, 1e-13, 1e-3, 1.0, 7.0, 1e200, 1e307])
    def test_of_any_length_are_accepted(self, length):
        given = np.array([0.6, 0.0, 0.8])
        np.testing.assert_allclose(unit(given * length, "direction"), given, atol=1e-15)
        hole = Hole("h", X, np.array([length, 0, 0]), 0.01, psi_zero=np.array([length, length, 0]))
        np.testing.assert_array_equal(hole.direction, X)
        np.testing.assert_allclose(hole.psi_zero, [0, 1, 0], atol=1e-15)

    def test_a_unit_vector_stays_as_it_is_digit_for_digit(self):
        given = np.array([0.6000000000001, 0.0, 0.8])
        assert unit(given, "direction") is not given
        np.testing.assert_array_equal(unit(given, "direction"), given)

    @pytest.mark.parametrize("nothing", [[0, 0, 0], [0.0, -0.0, 0.0]])
    def test_the_zero_vector_is_refused(self, nothing):
        with pytest.raises(InputError, match="the zero vector has no direction"):
            unit(nothing, "direction")

    def test_huge_ones_of_a_job_file(self):
        (hole,) = read_job(CASES / "robust_dirhuge.yaml").holes
        np.testing.assert_allclose(hole.direction, np.array([10, 1, 0]) / np.sqrt(101), atol=1e-15)


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="whole searches")
class TestDepths:
    @pytest.mark.parametrize("legs", ["straight", "free"])
    @pytest.mark.parametrize("depth_mm", [1e-300, 1e-9, 1e-6, 6e-5, 8e-5, 1e-3, 1.0])
    def test_of_any_size_are_drilled_or_refused_in_one_sentence(self, robot, tool, legs, depth_mm):
        hole = Hole("h", np.array([0.5, 0.3, 0.8]), X, depth_mm * 1e-3)
        answer = plan(robot, tool, hole, Settings(legs=legs))
        if depth_mm > 7.1e-5:  # a ten-millionth of the reach, 0.7 m
            assert (answer.status, answer.score.reversals) == ("planned", 0)
            assert answer.verified.passed, answer.verified.failures
        else:
            assert answer.status == "infeasible"
            assert [(finding.level, finding.kind) for finding in answer.findings] == [("error", "depth")]
            assert f"a depth of {depth_mm:g} mm is too short" in answer.findings[0].message
            assert "0.000070 mm or more" in answer.findings[0].message

    @pytest.mark.parametrize("depth_mm", [1300.0, 1600.0, 1e6, 1e300])
    def test_beyond_the_reach_say_so(self, robot, tool, depth_mm):
        answer = plan(robot, tool, Hole("h", np.array([0.5, 0.3, 0.8]), X, depth_mm * 1e-3))
        assert answer.status == "infeasible"
        assert [finding.kind for finding in answer.findings] == ["unreachable"]

    @pytest.mark.parametrize("name", ["robust_depth_1e-9", "robust_depth_1e-6", "robust_dirhuge"])
    def test_the_command_line_ends_without_a_traceback(self, name, tmp_path, capsys):
        code = main(["plan", str(CASES / f"{name}.yaml"), "-o", str(tmp_path / "plan.json")])
        said = capsys.readouterr()
        assert code == (0 if name == "robust_dirhuge" else 1)
        assert "Traceback" not in said.out + said.err
        assert ("too short" in said.out + said.err) == (code == 1)
