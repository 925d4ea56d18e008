"""The certificate of an exported program: what its printed, rounded numbers do, and that it is the plan's program."""

import re
from dataclasses import replace

import numpy as np
import py_opw_kinematics as opw
import pytest
from scipy.spatial.transform import Rotation

import zerorev as zr
import zerorev.verify.certificate.proof as proof
from oracles.places import JOBS
from zerorev.model.profile import Profile
from zerorev.motion import kinematics
from zerorev.motion.critical import kappa_of
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.program.as_exported import as_exported
from zerorev.program.krl.dialect import KRL
from zerorev.program.krl.read import read_krl
from zerorev.program.krl.write import to_krl
from zerorev.program.neutral import build_program
from zerorev.verify.as_planned import places
from zerorev.verify.certificate.certify import certify_hole
from zerorev.verify.certificate.moves import written_motion
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.certificate.program import certify_program, certify_program_hole
from zerorev.verify.printed import joints_of

TURN_ROUND = re.compile(r"A\d turns round: it moves the other way")


def written(plan):
    """The program's text, without the check that `export` makes: a spoiled plan is written as well."""
    return to_krl(build_program(plan), findings=(), version="test")


def certify(plan, text=None):
    program = read_krl(text or written(plan))
    return [hole.certificate for hole in certify_program(plan, program, as_exported(plan, program, KRL)).holes]


def certify_motion_alone(plan, text):
    """The proof without the comparison with the plan: of the last hole."""
    program, hole_plan = read_krl(text), plan.holes[-1]
    (*_, hole) = program.holes
    axes = joints_of(plan.robot, hole.start)[None]
    with ball_arithmetic():
        at = places(plan, hole_plan, program, hole)
        motion = written_motion(plan, program, hole, hole_plan.hole, at)
        return proof.prove(plan.robot, motion, axes)


def edited(text, line, name, change):
    """The text with one number of one line changed by so much."""
    lines = text.split("\n")
    old = re.search(rf"\b{name} (-?[\d.]+)", lines[line - 1])
    lines[line - 1] = lines[line - 1].replace(old[0], f"{name} {float(old[1]) + change:.4f}")
    return "\n".join(lines)


def line_of(text, comment):
    return next(n for n, line in enumerate(text.split("\n"), 1) if line.startswith("LIN") and comment in line)


# --- what holds -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [1, 2, 3])
@pytest.mark.parametrize(
    "settings",
    [{}, {"lead_in": 0.0}, {"blend": 2e-3, "lead_in": 3e-3}, {"blend": 0.0}, {"feed_retract": 1e-3}],
    ids=str,
)
def test_published_plans(number, settings, published, plan_of):
    (certificate,) = certify(plan_of(published(number), **settings))
    assert certificate.reasons == ()
    assert (certificate.min_rate > 0).all()
    assert (certificate.limit_distance > 0).all()


@pytest.mark.parametrize("number", [1, 2, 3])
def test_on_a_tilted_part(number, published, plan_of):
    T = np.eye(4)
    T[:3, :3] = Rotation.from_euler("ZYX", (25, -40, 15), degrees=True).as_matrix()
    T[:3, 3] = 0.3, 0.2, 0.1
    (certificate,) = certify(plan_of(published(number), T_base_part=T))
    assert certificate.verdict == "certified"


@pytest.mark.parametrize("job", ["thesis_published", "thesis_positions", "panel"])
def test_jobs_of_the_examples(job):
    asked = zr.read_job(JOBS / f"{job}.yaml")
    plan = zr.plan_job(replace(asked, holes=asked.holes[:: max(1, len(asked.holes) // 5)]))
    plan = replace(plan, holes=tuple(hole for hole in plan.holes if hole.motion is not None))
    assert len(plan.holes) >= 3
    certificates = certify(plan, zr.export(plan).text)
    assert [certificate.reasons for certificate in certificates] == [()] * len(plan.holes)
    for hole, certificate in zip(plan.holes, certificates, strict=True):
        # the printed numbers shift the rates by less than a tenth of a thousandth of a degree a millimetre
        assert (certificate.min_rate > hole.score.min_rate * (1 - 1e-3) - np.deg2rad(0.1)).all()


def many_moves(published, planned, seed, breakpoints):
    """Position 1 with a spin that bends at so many breakpoints a leg, by up to a tenth of a degree."""
    rng, first = np.random.default_rng(seed), published(1)
    legs = [np.sort(rng.uniform(0.1, 0.9, breakpoints)) for _ in range(2)]
    share = np.concatenate([[1], legs[0][::-1], [0], legs[1], [1]])
    corner = breakpoints + 1
    straight = np.where(np.arange(share.size) < corner, 22.0, -27.0) * share - 5.9388
    psi = straight + rng.uniform(-0.1, 0.1, share.size) * (np.arange(share.size) != corner)
    profile = Profile(share * 0.05, np.deg2rad(psi))
    return planned(first.hole, profile, near=np.rad2deg(first.motion.joints[0]))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("breakpoints", [3, 4, 5])
def test_legs_of_several_moves(published, planned, plan_of, seed, breakpoints):
    hole = many_moves(published, planned, seed, breakpoints)
    plan = plan_of(hole)
    legs = certify_hole(plan.robot, plan.tool, plan.settings, modest(hole))
    (certificate,) = certify(plan)
    assert legs.verdict == certificate.verdict  # so far from the edge rounding decides nothing
    assert (legs.verdict == "certified") == (hole.score.reversals == 0)
    np.testing.assert_allclose(certificate.min_rate, legs.min_rate, rtol=1e-3, atol=np.deg2rad(0.1))


def modest(hole):
    return replace(hole, score=replace(hole.score, min_rate=hole.score.min_rate * 0.5))


def test_several_moves_are_among_the_certified(published, planned):
    found = [many_moves(published, planned, seed, breakpoints) for seed in range(4) for breakpoints in (3, 4, 5)]
    assert sum(hole.score.reversals == 0 for hole in found) >= 4
    assert sum(hole.score.reversals > 0 for hole in found) >= 1


# --- an oracle of another make ----------------------------------------------------------------------------------------


class Numbers:
    """Joints of a program in floats: read by the other reader, interpolated by SciPy, solved by opw_kinematics."""

    def __init__(self, krl, robot, text):
        arm = robot.arm
        model = opw.KinematicModel(*arm[:7], offsets=arm.offset, flip_axes=tuple(sign < 0 for sign in arm.sign))
        self.arm = opw.Robot(model, degrees=False)
        self.ptp, *self.moves = krl.read(text).holes()[0]
        self.tool = self.ptp.state["$TOOL"] * np.array([[1, 1, 1, 1e-3]] * 3 + [[1] * 4])
        start = self.arm.forward(np.deg2rad(self.ptp.axes)).as_matrix() @ self.tool
        poses = [start, *(move.T_base_tool * np.array([[1, 1, 1, 1e-3]] * 3 + [[1] * 4]) for move in self.moves)]
        self.tips = [pose[:3, 3] for pose in poses]
        self.turns = Rotation.from_matrix([pose[:3, :3] for pose in poses])
        self.lengths = [np.linalg.norm(b - a) for a, b in zip(self.tips, self.tips[1:], strict=False)]

    def joints(self, tips, turns, near):
        """Of poses, each solution nearest to the one before."""
        T = np.tile(np.eye(4), (len(tips), 1, 1))
        T[:, :3, :3], T[:, :3, 3] = turns.as_matrix(), tips
        solutions = self.arm.reach(opw.RigidTransform.from_matrix(T @ np.linalg.inv(self.tool))).joints
        found = []
        for eight in solutions:
            eight = eight - 2 * np.pi * np.round((eight - near) / (2 * np.pi))
            near = eight[np.nanargmin(np.abs(eight - near).max(axis=1))]
            found.append(near)
        return np.array(found)

    def on_move(self, k, shares, near):
        way = self.tips[k] + shares[:, None] * (self.tips[k + 1] - self.tips[k])
        whole = (self.turns[k + 1] * self.turns[k].inv()).as_rotvec()
        return self.joints(way, Rotation.from_rotvec(shares[:, None] * whole) * self.turns[k], near)

    def in_blend(self, k, t, near):
        """At the end of move k: of the two turns the first dies away while the second sets in."""
        cut = min(self.moves[k].state["$APO.CDIS"] * 1e-3, self.lengths[k] / 2, self.lengths[k + 1] / 2)
        first, last = cut / self.lengths[k], cut / self.lengths[k + 1]
        here, before, behind = self.tips[k + 1], self.tips[k], self.tips[k + 2]
        fade, rise = ((1 - t) ** 2)[:, None], (t**2)[:, None]
        way = here + fade * first * (before - here) + rise * last * (behind - here)
        left = (self.turns[k] * self.turns[k + 1].inv()).as_rotvec() * first
        right = (self.turns[k + 2] * self.turns[k + 1].inv()).as_rotvec() * last
        turns = Rotation.from_rotvec(rise * right) * Rotation.from_rotvec(fade * left) * self.turns[k + 1]
        return self.joints(way, turns, near), 2 * cut


def slopes(joints, step):
    """Central differences of the fourth order, at all but two joints at either end."""
    return (8 * (joints[3:-1] - joints[1:-3]) - (joints[4:] - joints[:-4])) / (12 * step)


def profiles_of(published, planned, name):
    return many_moves(published, planned, 2, 4) if name == "many" else published(name)


@pytest.mark.parametrize("name", [1, 2, 3, "many"])
def test_sampled_rates_lie_above_the_bounds(name, krl, published, planned, plan_of):
    hole = profiles_of(published, planned, name)
    plan = plan_of(hole)
    text = written(plan)
    (certificate,) = certify(plan, text)
    assert certificate.verdict == "certified"
    numbers = Numbers(krl, plan.robot, text)
    signs, least, least_blended = np.zeros((6, 2), dtype=bool), np.full(6, np.inf), np.full(6, np.inf)
    near, steps = np.deg2rad(numbers.ptp.axes), 400
    shares = np.arange(-2, steps + 3) / steps  # two points beyond either end, so that the differences reach it
    for k, length in enumerate(numbers.lengths):
        joints = numbers.on_move(k, shares, near)
        rates = slopes(joints, length / steps)
        signs |= np.stack([(rates > 0).any(axis=0), (rates < 0).any(axis=0)], axis=1)
        if k:  # the lead-in has no bound of its own
            least = np.minimum(least, np.abs(rates).min(axis=0))
        if k + 1 < len(numbers.lengths):
            cut, length = numbers.in_blend(k, shares, joints[-1])
            rates = slopes(cut, length / steps)
            signs |= np.stack([(rates > 0).any(axis=0), (rates < 0).any(axis=0)], axis=1)
            least_blended = np.minimum(least_blended, np.abs(rates).min(axis=0))
        near = joints[-3]
    assert (signs.sum(axis=1) == 1).all()
    slack = 1e-6  # [rad/m] of the differences
    assert (least > certificate.min_rate * (1 - 1e-6) - slack).all()
    assert (least_blended > certificate.blend_min_rate * (1 - 1e-6) - slack).all()
    # and hardly above
    assert (least < certificate.min_rate * 1.002 + slack).all()


# --- reversals --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("change", [1.0, -2.0, 20.0])
def test_a_coordinate_edited_so_that_a_joint_reverses(change, published, plan_of):
    """The published slopes at position 1 leave 0.014 and 0.010 deg/mm: a degree over 50 mm is too much."""
    plan = plan_of(published(1))
    text = written(plan)
    assert certify_motion_alone(plan, text).verdict == "certified"
    spoiled = edited(text, line_of(text, "target"), "C", change)
    alone = certify_motion_alone(plan, spoiled)
    assert alone.verdict == "refuted"
    assert any(TURN_ROUND.match(reason) for reason in alone.reasons)
    (certificate,) = certify(plan, spoiled)
    assert certificate.verdict == "refuted"
    assert "stands where the plan has 'LIN" in certificate.reasons[0]
    assert "off the planned axis" in certificate.reasons[1]


@pytest.mark.parametrize("seed", range(12))
def test_a_reversal_planted_between_two_of_40_000_samples(seed, krl, published, planned, plan_of):
    """A twitch of the spin, 0.8 thousandths of a millimetre long, that the plan has too: its points are the plan's."""
    rng = np.random.default_rng(seed)
    first = published(1)
    standoff, psi = first.motion.profile.standoff * 1e3, np.rad2deg(first.motion.profile.psi)
    at, width, leg = round(rng.uniform(2, 48), 3) + 0.0013, 0.0004, int(rng.integers(2))
    outer = 2 * leg
    slope = (psi[outer] - psi[1]) / standoff[outer]
    places = at + width * np.array([1, 0, -1])
    spins = psi[1] + slope * places + np.array([0, rng.choice([-1, 1]) * 0.01, 0])
    if leg == 0:
        profile = Profile(np.array([50, *places, 0, 50]) * 1e-3, np.deg2rad([psi[0], *spins, psi[1], psi[2]]))
    else:
        profile = Profile(np.array([50, 0, *places[::-1], 50]) * 1e-3, np.deg2rad([*psi[:2], *spins[::-1], psi[2]]))
    twitching = planned(first.hole, profile, near=np.rad2deg(first.motion.joints[0]))
    # nothing in the claims betrays it
    twitching = replace(twitching, score=first.score)
    plan = plan_of(twitching)
    (certificate,) = certify(plan)
    assert certificate.verdict == "refuted"
    leg_name = "retract" if leg else "plunge"
    assert any(TURN_ROUND.match(reason) and f"on the {leg_name} (line" in reason for reason in certificate.reasons)


def test_rounding_alone_can_make_a_joint_reverse(kuka, drill, published, planned, plan_of):
    """Slopes a ten-millionth of a deg/mm outside the bracket: the legs hold, and only some of their programs do."""
    first, psi = published(1), np.deg2rad(-5.9388)
    kappa = np.sort(kappa_of(*joint_rates(Drilling(kuka, drill, first.hole), 0.0, psi))[4])
    hair, verdicts = np.deg2rad(1e-7) * 1e3, []
    for depth in np.arange(5e-3, 13e-3, 1e-3):
        profile = Profile.straight(depth, psi + (kappa[0] - hair) * depth, psi, psi + (kappa[-1] + 2.0) * depth)
        near = np.rad2deg(first.motion.joints[1])
        hole = planned(replace(first.hole, depth=depth), profile, near=near)
        plan = plan_of(hole, min_rate=0.0)
        assert certify_hole(kuka, drill, plan.settings, modest(hole)).verdict == "certified"
        verdicts.append(certify(plan)[0].verdict)
    assert set(verdicts) == {"certified", "refuted"}


def test_what_is_claimed_to_reverse_is_not_certified(published, planned, plan_of):
    first = published(1)
    still = planned(first.hole, Profile.straight(0.05, 0.2, 0.19, 0.2), near=np.rad2deg(first.motion.joints[0]))
    assert still.score.reversals > 0
    (certificate,) = certify(plan_of(still))
    assert certificate.verdict == "undecided"
    assert "claimed to reverse" in certificate.reasons[0]


def test_it_says_when_it_gives_up(published, plan_of, monkeypatch):
    monkeypatch.setattr(proof, "PIECES", 20)
    (certificate,) = certify(plan_of(published(1)))
    assert certificate.verdict == "undecided"
    assert certificate.reasons[0].startswith("given up after 20 pieces ")


def test_a_limit(kuka, published, plan_of):
    """Moved to within the rounding of where joint 2 comes: passed by the program, or by a hair not."""
    plan = plan_of(published(1))
    (free,) = certify(plan)
    lower = kuka.limits.lower.copy()
    for by, verdict in ((1e-9, "certified"), (-1e-9, "refuted")):
        lower[1] = kuka.limits.lower[1] + free.limit_distance[1] - by
        tight = replace(plan, robot=replace(kuka, limits=replace(kuka.limits, lower=lower)))
        (certificate,) = certify(tight, written(plan))
        assert certificate.verdict == verdict


# --- another program --------------------------------------------------------------------------------------------------


def swapped(text, old, new):
    assert text.count(old) >= 1
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda t: swapped(t, "X 100.0000,Y", "X 100.0010,Y"), r"the tool frame of the program is 0\.001 mm"),
        (lambda t: swapped(t, "C 0.000000}\n$BASE", "C 0.000010}\n$BASE"), r"the tool frame of the program is"),
        (lambda t: swapped(t, "$BASE={FRAME: X 0.0000", "$BASE={FRAME: X 0.0010"), r"the part frame of the program is"),
        (lambda t: edited(t, line_of(t, "target"), "X", 5e-3), "do not lead in to one deepest point"),
        (lambda t: edited(t, line_of(t, "target"), "Y", 1e-3), "off the planned axis"),
        (lambda t: edited(t, line_of(t, "target"), "B", 1e-3), "off the planned axis"),
        (lambda t: edited(t, line_of(t, "target"), "C", 1e-3), "off the planned axis"),
        (lambda t: edited(t, line_of(t, "end of"), "X", 1e-1), "beyond the plan|off the planned axis"),
        (lambda t: swapped(t, "$APO.CDIS=1.0000", "$APO.CDIS=1.5000"), "is blended by 1.5 mm, the plan asks for 1 mm"),
        (lambda t: swapped(t, " C_DIS ; target", " ; target"), "stops, the plan asks for 1 mm of blend"),
        (lambda t: swapped(t, "$VEL.CP=0.005000", "$VEL.CP=0.006000"), "has a feed of 6 mm/s, the plan 5 mm/s"),
        (lambda t: re.sub(r"A6 (-?[\d.]+)", lambda m: f"A6 {float(m[1]) - 360:.5f}", t, count=1), "A6 .* stands"),
        (lambda t: re.sub(r"A2 (-?[\d.]+)", lambda m: f"A2 {float(m[1]) + 0.1:.5f}", t, count=1), "off the planned"),
        (lambda t: re.sub(r"(LIN .*target)\n(.*\n)(LIN .*)", r"\1\n\2\3\n\1\n\3", t), "do not lead in to one deepest"),
    ],
)  # fmt: skip
def test_what_is_not_the_plans_program_is_refused(change, reason, published, plan_of):
    plan = plan_of(published(1))
    text = written(plan)
    assert certify(plan, text)[0].verdict == "certified"
    assert change(text) != text
    (certificate,) = certify(plan, change(text))
    assert certificate.verdict == "refuted"
    assert any(re.search(reason, each) for each in certificate.reasons)


def test_another_posture(kuka, published, plan_of):
    """The wrist flipped: the same poses, another branch."""
    plan = plan_of(published(1), lead_in=0.0)
    hole = plan.holes[0]
    flipped = np.rad2deg(kinematics.inverse(kuka, kinematics.forward(kuka, hole.motion.joints[0]))[5])
    values = ",".join(f"A{k} {angle:.5f}" for k, angle in enumerate(flipped, 1))
    (certificate,) = certify(plan, re.sub(r"\{AXIS: .*\}", f"{{AXIS: {values}}}", written(plan)))
    assert certificate.verdict == "refuted"
    assert "stands where the plan has 'PTP" in certificate.reasons[0]
    assert "are of branch 5, the plan says 4" in certificate.reasons[1]


def test_a_stale_program(published, planned, plan_of):
    first = published(1)
    turned = Profile(first.motion.profile.standoff, first.motion.profile.psi + np.deg2rad(0.002))
    later = planned(first.hole, turned, near=np.rad2deg(first.motion.joints[0]))
    (certificate,) = certify(plan_of(later), written(plan_of(first)))
    assert certificate.verdict == "refuted"


def test_turns_are_proven_and_not_only_compared(published, plan_of):
    """Without the comparison of the statements: another turn of joint 6 comes out at the start of the stroke."""
    plan = plan_of(published(1))
    program = read_krl(re.sub(r"A6 (-?[\d.]+)", lambda m: f"A6 {float(m[1]) - 360:.5f}", written(plan), count=1))
    certificate = certify_program_hole(plan, plan.holes[0], program, program.holes[0])
    assert certificate.verdict == "refuted"
    assert any(reason.startswith("A6 is at") for reason in certificate.reasons)


def test_holes_left_out_and_added(published, plan_of):
    one, two, three = (published(number) for number in (1, 2, 3))
    text = written(plan_of(one, three))
    found = certify(plan_of(one, two, three), text)
    assert [certificate.verdict for certificate in found] == ["certified", "refuted", "certified"]
    assert found[1].reasons == ("the program does not drill this hole",)
    # the second hole is another one; the holes are in another order
    assert [certificate.verdict for certificate in certify(plan_of(one, two), text)] == ["certified", "refuted"]
    assert [certificate.verdict for certificate in certify(plan_of(three, one), text)] == ["refuted", "refuted"]
    with pytest.raises(zr.InputError, match=r"line \d+: a hole that the plan does not have: .* 3, the plan 2"):
        certify(plan_of(one, two), written(plan_of(one, two, three)))


def test_a_hole_that_export_refuses(published, plan_of):
    """The program was written before the hole failed its check."""
    plan = plan_of(published(1), published(2))
    failed = replace(
        published(2), verified=replace(published(2).verified, passed=False, failures=("joint 3 reverses",))
    )
    certificates = certify(replace(plan, holes=(plan.holes[0], failed)), written(plan))
    assert [certificate.verdict for certificate in certificates] == ["certified", "refuted"]
    assert "which export refuses: it did not pass the check: joint 3 reverses" in certificates[1].reasons[0]
    (certificate,) = certify(replace(plan, holes=(failed,)), written(plan_of(published(2))))
    assert certificate.verdict == "refuted"


def test_the_speed_of_the_turn_is_that_of_the_holes_that_are_drilled(published, plan_of):
    """It is the greatest that any of them needs; hole 2 needs 287 deg/s at this feed, the others less."""
    three = plan_of(*(published(number) for number in (1, 2, 3)), feed_retract=0.12)
    some = plan_of(published(1), published(3), feed_retract=0.12)
    assert re.search(r"ORI1=.*", written(three))[0] != re.search(r"ORI1=.*", written(some))[0]
    assert [each.verdict for each in certify(three, written(some))] == ["certified", "refuted", "certified"]
    stale = written(some).replace(*(re.search(r"ORI1=.*", written(plan))[0] for plan in (some, three)))
    assert [each.verdict for each in certify(three, stale)] == ["refuted"] * 3


def test_a_plan_without_a_score(published, plan_of):
    plan = plan_of(published(1))
    program = read_krl(written(plan))
    bare = replace(plan.holes[0], score=None)
    assert certify_program_hole(plan, bare, program, program.holes[0]).verdict == "refuted"
