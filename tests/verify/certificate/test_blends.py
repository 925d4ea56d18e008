"""Of which curves of a blend a motion is proven: the widest set that can be shown."""

import numpy as np
import pytest

from oracles.makers import position_plan, stand_in
from zerorev.files.io import read_robot
from zerorev.model.plan import Certificate
from zerorev.verify import check
from zerorev.verify.certificate.blends import for_the_widest
from zerorev.verify.certificate.certify import certify_hole, certify_motion

NAN = np.full(6, np.nan)


def proofs(*holds):
    """A proof that holds for some kinds of blends, and what it was asked."""
    asked = []

    def proof(*, mixes):
        asked.append(mixes)
        return Certificate("certified" if mixes in holds else "refuted", 1, NAN, NAN, NAN)

    return proof, asked


@pytest.mark.parametrize(
    ("holds", "known", "verdict", "curve"),
    [
        (("any", "one_way", None), False, "certified", "any"),
        (("one_way", None), False, "certified", "one_way"),
        ((None,), True, "certified", "parabola"),
        ((None,), False, "undecided", "parabola"),
        ((), True, "refuted", None),
    ],
)
def test_the_widest_set_that_holds_is_stated(holds, known, verdict, curve):
    found = for_the_widest(proofs(*holds)[0], blended=True, curve_known=known)
    assert (found.verdict, found.curve) == (verdict, curve)
    assert ("not known" in " ".join(found.reasons)) == (verdict == "undecided")


def test_without_a_blend_nothing_is_said_of_curves():
    proof, asked = proofs(None)
    assert for_the_widest(proof, blended=False, curve_known=False).curve is None
    assert asked == [None]


@pytest.mark.parametrize(("blend", "curve"), [(1e-3, "any"), (10e-3, "one_way")])
def test_a_wide_blend_holds_for_fewer_curves(blend, curve):
    """At 10 mm a curve that goes back and forth between the two velocities would turn a joint round."""
    plan = position_plan(read_robot("kuka_kr6_r700_2"), 1, min_rate=np.deg2rad(10), blend=blend)
    (hole,) = plan.holes
    certificate = certify_hole(plan.robot, plan.tool, plan.settings, hole)
    assert (certificate.verdict, certificate.curve) == ("certified", curve)
    if curve == "one_way":
        motion = hole.motion
        answer = certify_motion(
            plan.robot, plan.tool, hole.hole, motion.profile, motion.joints, blend=blend, mixes="any"
        )
        assert answer.verdict == "refuted"


def test_joint_moves_have_no_curve_to_be_known():
    plan = position_plan(stand_in("ABB"), 1, min_rate=np.deg2rad(10))
    (hole,) = plan.holes
    assert certify_hole(plan.robot, plan.tool, plan.settings, hole).curve is None


def test_another_controller_blends_straight_moves_by_any_curve():
    plan = position_plan(stand_in("ABB"), 1, min_rate=np.deg2rad(10), corner="blend")
    assert not plan.settings.curve_known
    certificate = certify_hole(plan.robot, plan.tool, plan.settings, plan.holes[0])
    assert (certificate.verdict, certificate.curve) == ("certified", "any")


def test_the_check_asks_for_every_curve_where_the_controllers_is_not_known(monkeypatch):
    """So that planning takes another motion where one of them turns a joint round; a KUKA's is taken for a parabola."""
    plans = {
        maker: position_plan(stand_in(maker), 1, min_rate=np.deg2rad(10), corner="blend") for maker in ("ABB", "KUKA")
    }
    asked = []
    monkeypatch.setattr(check, "mix_holds", lambda *blend: asked.append(blend[-1]) or ["A1 turns round"])
    for maker, times in (("ABB", 1), ("KUKA", 0)):
        asked.clear()
        plan = plans[maker]
        verified = check.verify_hole(plan.robot, plan.tool, plan.settings, plan.holes[0])
        assert asked == ["one_way"] * times
        assert ("A1 turns round" in verified.failures) == bool(times)
