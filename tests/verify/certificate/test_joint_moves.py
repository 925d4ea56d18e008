"""Programs whose corner is passed by joint moves: the points are poses or joints, with the turns that are printed."""

from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from oracles.makers import free_leg_plan, position_plan, stand_in
from zerorev.model.written import Drilled, Pace, WrittenFrame, WrittenHole, WrittenJoints, WrittenMove, WrittenProgram
from zerorev.program.neutral import build_program
from zerorev.verify.certificate.program import certify_program


def frame(T):
    w, x, y, z = np.roll(Rotation.from_matrix(T[:3, :3]).as_quat(), 1)
    return WrittenFrame(printed(T[:3, 3] * 1e3, 4), printed((w, x, y, z), 8), "quaternion")


def joints(values):
    return WrittenJoints(printed(np.rad2deg(values), 5))


def printed(values, decimals):
    return tuple(Decimal(f"{value:.{decimals}f}") for value in values)


def written(plan):
    """A plan as a language may print it: straight moves to poses, the others to joints with a time."""
    program = build_program(plan)
    holes = [
        WrittenHole(
            1,
            joints(hole.start.joints),
            tuple(
                WrittenMove(
                    line,
                    frame(move.end.T_part_tcp) if move.linear else joints(move.end.joints),
                    Pace(Decimal(f"{move.feed:.6f}")) if move.linear else Pace(Decimal(f"{move.time:.6f}"), "s"),
                    Decimal(f"{move.blend * 1e3:.4f}"),
                    move.linear,
                )
                for line, move in enumerate(hole.moves, start=2)
            ),
            (),
        )
        for hole in program.holes
    ]
    return WrittenProgram("test", frame(plan.tool.T_flange_tcp), frame(plan.T_base_part), tuple(holes), ())


def certificate(plan, program):
    (hole,) = certify_program(plan, program, [Drilled(program.holes[0])]).holes
    return hole.certificate


PLANS = {**{f"position {n}": lambda n=n: position_plan(stand_in("ABB"), n) for n in (1, 2, 3)},
         "free legs": lambda: free_leg_plan(stand_in("ABB"))}  # fmt: skip


@pytest.mark.parametrize("plan", PLANS.values(), ids=PLANS)
def test_a_corner_of_joint_moves_is_certified(plan):
    plan = plan()
    program = written(plan)
    assert sum(not move.linear for move in program.holes[0].moves) == 2
    proof = certificate(plan, program)
    assert (proof.verdict, proof.reasons) == ("certified", ())
    assert (proof.min_rate >= 0).all()


@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("turns", [-1, 1])
def test_a_joint_that_is_sent_whole_turns_away_is_refuted(joint, turns):
    plan = position_plan(stand_in("ABB"), 1)
    program = written(plan)
    (hole,) = program.holes
    moves = list(hole.moves)
    for k, move in enumerate(moves):
        if not move.linear:
            values = list(move.end.values)
            values[joint] += 360 * turns
            moves[k] = replace(move, end=WrittenJoints(tuple(values)))
    proof = certificate(plan, replace(program, holes=(replace(hole, moves=tuple(moves)),)))
    assert proof.verdict == "refuted"
    assert any("sent whole turns away" in reason for reason in proof.reasons)


def test_a_joint_that_is_sent_the_other_way_is_refuted():
    """Joint 6 alone, the other way: it turns the tool and hardly moves the tip."""
    plan = position_plan(stand_in("ABB"), 1)
    program = written(plan)
    (hole,) = program.holes
    at = next(k for k, move in enumerate(hole.moves) if not move.linear)
    values = list(hole.moves[at].end.values)
    ahead = hole.moves[at + 1].end.values[5] - values[5]
    values[5] += 3 * ahead
    moves = (*hole.moves[:at], replace(hole.moves[at], end=WrittenJoints(tuple(values))), *hole.moves[at + 1 :])
    assert certificate(plan, replace(program, holes=(replace(hole, moves=moves),))).verdict == "refuted"
