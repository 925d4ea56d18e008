"""The certificate: what holds is certified with true bounds, what does not is never certified."""

from dataclasses import replace

import numpy as np
import pytest
from flint import arb, ctx

from zerorev.model.hole import Hole
from zerorev.model.plan import Event
from zerorev.model.profile import Profile
from zerorev.model.tool import Tool
from zerorev.verify.arm import posture_of as sampled_posture
from zerorev.verify.certificate.arm import Setting, body_at, posture_of, rates
from zerorev.verify.certificate.certify import certify_hole, certify_motion
from zerorev.verify.certificate.legs import planned_motion
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.measure import reversals
from zerorev.verify.path import Track, follow, legs
from zerorev.verify.sound import limit_distances


def track_of(robot, tool, hole, profile, start, samples=20_000):
    path = legs(profile, samples)
    return Track(path, follow(robot, tool, hole, path, sampled_posture(robot.arm, start), start))


def joints_at(robot, tool, hole, profile, start):
    track = track_of(robot, tool, hole, profile, start, 2)
    return track.joints[list(track.path.knots)]


def with_profile(robot, tool, plan, profile):
    """The plan with another profile: the joints along it are right, the claims are left as they are."""
    joints = joints_at(robot, tool, plan.hole, profile, plan.motion.joints[0])
    return replace(plan, motion=replace(plan.motion, profile=profile, joints=joints))


def score(plan, **changes):
    return replace(plan, score=replace(plan.score, **changes))


def critical_rates(robot, tool, hole, psi, start):
    """Critical twist rates at the target [rad/m], shape (6,) (theory §2), and the greatest of the two fields."""
    with ball_arithmetic():
        setting = Setting(robot.arm, posture_of(robot.arm, start))
        along, around = (
            rates_at(
                setting, planned_motion(robot.arm, tool, hole, Profile.straight(1.0, psi + turn, psi, 0)).legs[0], 1.0
            )
            for turn in (0.0, 1.0)
        )  # per metre of moving in; and with a radian of spin less
        return np.array([float(a / (a - b)) for a, b in zip(along, around, strict=True)])


def rates_at(setting, arc, t):
    """Rates of the six joints, per metre of path, at one parameter of an arc."""
    ctx.cap = 1
    pose, twist = arc.around(arb(t), arb(1))
    return [rate[0] / arc.length for rate in rates(setting, body_at(setting, pose), twist)]


# --- what holds -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("position", [1, 2, 3])
def test_published_plans(prove, modest, position):
    assert prove(modest(position)).verdict == "certified"


def rates_met(robot, tool, plan, arcs, count=300):
    """The least |rate| of each joint at many points of arcs [rad/m], shape (6,)."""
    with ball_arithmetic():
        setting = Setting(robot.arm, posture_of(robot.arm, plan.motion.joints[0]))
        places = [(arc, float(t)) for arc in arcs for t in np.linspace(0, 1, count)]
        return np.min([[abs(float(rate)) for rate in rates_at(setting, *place)] for place in places], axis=0)


@pytest.mark.parametrize("position", [1, 2, 3])
def test_bounds_are_true_and_tight(kuka, drill, settings, prove, modest, position):
    plan = modest(position)
    of_a_parabola = kuka, drill, plan.hole, plan.motion.profile, plan.motion.joints
    answer = certify_motion(*of_a_parabola, blend=settings.blend, claims=plan.score)
    assert (prove(plan).blend_min_rate <= answer.blend_min_rate).all()  # of more curves
    with ball_arithmetic():
        motion = planned_motion(kuka.arm, drill, plan.hole, plan.motion.profile, settings.blend)
    for bound, arcs in ((answer.min_rate, motion.legs), (answer.blend_min_rate, [motion.blends[0].arc])):
        met = rates_met(kuka, drill, plan, arcs)
        assert (bound > 0).all()
        assert (bound <= met).all()
        assert (bound >= met * (1 - 2e-3)).all()
    track = track_of(kuka, drill, plan.hole, plan.motion.profile, plan.motion.joints[0])
    room = limit_distances(kuka, track.joints).min(axis=0)
    np.testing.assert_allclose(answer.limit_distance, room, rtol=0, atol=1e-9)


def test_the_mirrored_plan(kuka, drill, modest):
    plan = modest(3)
    profile, joints = plan.motion.profile.reversed(), plan.motion.joints[::-1]
    forth = certify_motion(kuka, drill, plan.hole, plan.motion.profile, plan.motion.joints, blend=1e-3)
    back = certify_motion(kuka, drill, plan.hole, profile, joints, blend=1e-3)
    assert back.verdict == "certified"
    np.testing.assert_allclose(back.min_rate, forth.min_rate, rtol=2e-3)
    np.testing.assert_allclose(back.limit_distance, forth.limit_distance, rtol=0, atol=1e-10)


def test_many_segments(kuka, drill, modest, prove):
    """A spin that bends a little at every breakpoint, each blended."""
    plan = modest(1)
    s, psi = plan.motion.profile.standoff, plan.motion.profile.psi
    standoff = np.concatenate([np.linspace(s[0], 0, 12), np.linspace(0, s[2], 12)[1:]])
    spin = np.concatenate([np.linspace(psi[0], psi[1], 12), np.linspace(psi[1], psi[2], 12)[1:]])
    spin[1:] += 1e-4 * np.random.default_rng(0).uniform(-1, 1, 22)
    answer = certify_motion(
        kuka, drill, plan.hole, Profile(standoff, spin), plan.motion.joints[:1], blend=1e-3, passing_blend=1e-2
    )
    assert answer.verdict == "certified"


def test_flint_is_left_as_it_was(prove, modest):
    before = ctx.prec, ctx.cap
    prove(modest(1))
    assert (ctx.prec, ctx.cap) == before


# --- reversals --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(16))
@pytest.mark.parametrize("width", [8e-7, 1e-7, 1e-8, 1e-9])
def test_a_reversal_planted_between_two_of_40_000_samples(kuka, drill, modest, prove, seed, width):
    """A twitch of the spin, 2 widths long, anywhere on either leg; nothing in the claims betrays it."""
    plan = modest(1 + seed % 3)
    s, psi = plan.motion.profile.standoff, plan.motion.profile.psi
    rng = np.random.default_rng(seed)
    sample = s[0] * 2 / 40_000
    at = (rng.integers(1, 19_999) + 0.5) * sample
    assert width < sample
    leg = int(rng.integers(2))  # the plunge, or the retract
    outer = 2 * leg
    slope = (psi[outer] - psi[1]) / s[outer]
    bump = rng.choice([-1, 1]) * 20 * abs(slope) * width
    places = at + width * np.array([1, 0, -1])
    spins = psi[1] + slope * places + np.array([0, bump, 0])
    if leg == 0:
        profile = Profile(np.array([s[0], *places, 0, s[2]]), np.array([psi[0], *spins, psi[1], psi[2]]))
    else:
        profile = Profile(np.array([s[0], 0, *places[::-1], s[2]]), np.array([psi[0], psi[1], *spins[::-1], psi[2]]))
    twitching = with_profile(kuka, drill, plan, profile)
    answer = prove(twitching)
    assert answer.verdict == "refuted"
    where = "plunge" if leg == 0 else "retract"
    assert any("turns round" in reason and where in reason for reason in answer.reasons)
    # the same breakpoints without the twitch
    calm = np.interp(np.arange(6), np.arange(6), profile.psi)
    calm[(1 if leg == 0 else 2) + 1] -= bump
    assert prove(with_profile(kuka, drill, plan, Profile(profile.standoff, calm))).verdict == "certified"


@pytest.mark.parametrize("psi_deg", [14.1646, -5.9388, 60.0])
def test_constant_spin(prove, modest, psi_deg):
    plan = score(modest(1, (psi_deg,) * 3), reversals_per_joint=(0,) * 6, events=())
    answer = prove(plan)
    assert answer.verdict == "refuted"
    for joint in range(1, 7):
        assert any(reason.startswith(f"A{joint} turns round") for reason in answer.reasons)
    assert np.isnan(answer.min_rate).all()


@pytest.mark.parametrize("beyond", [1e-4, 1e-6, 1e-8, 1e-9])
@pytest.mark.parametrize("side", ["plunge", "retract"])
@pytest.mark.parametrize("position", [1, 3])
def test_slopes_on_either_side_of_a_critical_rate(kuka, drill, modest, position, side, beyond):
    """The joint of the bracket's edge turns round at the corner as soon as the slope no longer passes its rate."""
    plan = modest(position)
    psi = float(plan.motion.profile.psi[1])
    hole = replace(plan.hole, depth=1e-3)
    kappa = np.sort(critical_rates(kuka, drill, hole, psi, plan.motion.joints[0]))
    low, high = kappa[0], kappa[-1]
    # the field of rates changes along the leg as well: look at both legs' slopes with this one at the edge
    verdicts = {}
    for sign in (1, -1):
        step = sign * beyond * (high - low)
        slopes = (
            (high + step, low - 0.5 * (high - low)) if side == "plunge" else (high + 0.5 * (high - low), low - step)
        )
        for u_p, u_r in (slopes, slopes[::-1]):
            profile = Profile.straight(1e-3, psi + u_p * 1e-3, psi, psi + u_r * 1e-3)
            start = joints_at(kuka, drill, plan.hole, profile, plan.motion.joints[1])[:1]
            start += 2 * np.pi * np.rint((plan.motion.joints[1] - start) / (2 * np.pi))
            answer = certify_motion(kuka, drill, hole, profile, start)
            verdicts.setdefault(sign, []).append(answer.verdict)
    assert "certified" not in verdicts[-1]
    if beyond > 1e-9:
        assert set(verdicts[-1]) == {"refuted"}


def test_a_joint_that_stops_in_the_corner_is_undecided(kuka, drill, modest):
    """Exactly at the critical rate, as nearly as floats have it."""
    plan = modest(1)
    psi = float(plan.motion.profile.psi[1])
    kappa = np.sort(critical_rates(kuka, drill, plan.hole, psi, plan.motion.joints[0]))
    depth = 2.0**-10
    profile = Profile.straight(depth, psi + kappa[-1] * depth, psi, psi + (kappa[0] - 2) * depth)
    start = joints_at(kuka, drill, plan.hole, profile, plan.motion.joints[1])[:1]
    answer = certify_motion(kuka, drill, plan.hole, profile, start)
    assert answer.verdict != "certified"


def test_what_is_claimed_to_reverse_is_not_certified(prove, modest):
    plan = modest(1, (14.1646,) * 3)
    assert plan.score.reversals == 6
    answer = prove(plan)
    assert answer.verdict == "undecided"
    assert answer.reasons == tuple(f"A{i} is claimed to reverse: not certified" for i in range(1, 7))
    assert (answer.limit_distance > 0).all()


def test_an_event_alone_is_a_claim(prove, modest):
    answer = prove(score(modest(1), events=(Event(4, "plunge", 0.01),)))
    assert answer.reasons == ("A4 is claimed to reverse: not certified",)
    assert np.isnan(answer.min_rate[3])
    assert (np.delete(answer.min_rate, 3) > 0).all()


def test_a_joint_that_never_moves_has_not_reversed(kuka, build, settings):
    """In the arm's plane of symmetry only joints 2, 3 and 5 move."""
    tool = Tool.from_mm_deg((0.0, 0.0, 150.0), (0.0, 180.0, 0.0))
    hole = Hole("in the plane", [0.5, 0.0, 0.5], [0, 0, -1], 0.02)
    start = np.deg2rad([0.0, -60.0, 90.0, 0.0, 60.0, 0.0])
    profile = Profile.straight(0.02, 0.0, 0.0, 0.0)
    plan = build(kuka, tool, hole, profile, start)
    assert plan.score.reversals_per_joint == (0, 1, 1, 0, 1, 0)
    answer = certify_hole(kuka, tool, settings, plan)
    assert answer.reasons == tuple(f"A{i} is claimed to reverse: not certified" for i in (2, 3, 5))
    assert answer.min_rate[[0, 3, 5]] == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_random_plans_against_samples(robot, drill, random_hole, seed):
    """Slopes about the edge of the bracket, so that some plans hold and some do not."""
    hole, profile, start = random_hole(robot, drill, seed)
    rng = np.random.default_rng(seed)
    at_target = joints_at(robot, drill, hole, profile, start)[1]
    psi = float(profile.psi[1])
    kappa = np.sort(critical_rates(robot, drill, hole, psi, start))
    spread = kappa[-1] - kappa[0]
    for _ in range(4):
        u = kappa[-1] + rng.uniform(-0.1, 0.4) * spread, kappa[0] - rng.uniform(-0.1, 0.4) * spread
        depth = min(rng.uniform(0.0005, 0.01), 0.3 / np.abs(u).max())
        edges = Profile.straight(depth, psi + u[0] * depth, psi, psi + u[1] * depth)
        track = track_of(robot, drill, hole, edges, at_target, 10_000)
        if not np.isfinite(track.joints).all():
            continue
        answer = certify_motion(robot, drill, hole, edges, track.joints[:1])
        found = [len(turned) for turned in reversals(track)]
        room = limit_distances(robot, track.joints).min(axis=0)
        if sum(found) or room.min() < 0:
            assert answer.verdict != "certified"
        if answer.verdict == "certified":
            assert (answer.min_rate <= track.moves.slowest * (1 + 1e-6) + 1e-9).all()
            assert (answer.limit_distance <= room + 1e-9).all()
        if answer.verdict == "refuted":
            assert sum(found) or room.min() < 0
        assert answer.verdict != "undecided"
