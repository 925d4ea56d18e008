"""Out of a hole in which the robot has stopped: the program is run by a small interpreter, from places in the hole."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from zerorev.cli import main
from zerorev.errors import InputError, NotExportableError
from zerorev.files.io import write_plan
from zerorev.motion.kinematics import tcp_pose
from zerorev.program.export import export, retract_program

AS_WRITTEN = np.array([[0, 0, 1.0, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])


PLAIN = (
    "DECL FRAME HERE,BACK,GOAL", "WAIT SEC 0.0", "END", "$IPO_MODE=#BASE", "$ORI_TYPE=#CONSTANT", "$ADVANCE=0"
)  # fmt: skip


class Run:
    """What the statements of a retract program do, of a robot whose tool stands somewhere.

    Attributes:
        moves: kind and pose of the tool in the robot's base, [mm].
        halted: whether it stopped by itself.
    """

    def __init__(self, text, T_base_tool, krl):
        self.krl, self.here, self.moves, self.halted = krl, T_base_tool, [], False
        self.frames, self.state, self.path = {}, {}, []
        skipping, inside = False, 0
        for line in (line.partition(";")[0].strip() for line in text.splitlines()):
            if line.startswith("IF "):
                skipping = not self.condition(line[3:].removesuffix(" THEN"))
                inside += 1
            elif line == "ELSE":
                skipping = not skipping
            elif line == "ENDIF":
                skipping, inside = False, inside - 1
            elif line and not skipping:
                self.do(line)
        assert inside == 0

    def condition(self, text):
        x, y, z, a, b, _ = self.frames["HERE"]
        values = {
            "HERE.X": x,
            "HERE.Y*HERE.Y+HERE.Z*HERE.Z": y * y + z * z,
            "HERE.A*HERE.A+HERE.B*HERE.B": a * a + b * b,
        }
        found = []
        for part in text.split(" OR "):
            name, sign, bound = re.fullmatch(r"\(([A-Z.*+]+) ([<>]) (-?[\d.]+)\)", part).groups()
            found.append(values[name] < float(bound) if sign == "<" else values[name] > float(bound))
        return any(found)

    def do(self, line):
        if match := re.fullmatch(r"\$(TOOL|BASE)=(\{.*\})", line):
            self.state[match[1]] = self.krl.frame(self.krl.aggregate(match[2], "FRAME", 0))
        elif line == "PTP $AXIS_ACT":
            assert {"TOOL", "BASE", "VEL"} <= self.state.keys()
        elif match := re.fullmatch(r"\$VEL\.CP=([\d.]+)", line):
            self.state["VEL"] = float(match[1])
        elif line == "HERE=$POS_ACT":
            T = np.linalg.inv(self.state["BASE"]) @ self.here
            angles = Rotation.from_matrix(T[:3, :3]).as_euler("ZYX", degrees=True)
            self.frames["HERE"] = [*T[:3, 3], *angles]
        elif line == "BACK={FRAME: X 0.0,Y 0.0,Z 0.0,A 0.0,B 0.0,C 0.0}":
            self.frames["BACK"] = [0.0] * 6
        elif match := re.fullmatch(r"BACK\.X=(-?[\d.]+)-HERE\.X", line):
            self.frames["BACK"][0] = float(match[1]) - self.frames["HERE"][0]
        elif line == "GOAL=HERE:BACK":
            self.frames["GOAL"] = self.pose("HERE") @ self.pose("BACK")
        elif line == "LIN GOAL":
            self.moves.append(self.state["BASE"] @ self.frames["GOAL"])
        elif line == "HALT":
            self.halted = True
        else:
            assert line.startswith(("&", "DEF ", "EXT BAS", "BAS (")) or line in PLAIN, line

    def pose(self, name):
        return self.krl.frame(dict(zip("XYZABC", self.frames[name], strict=True)))


def standing(plan, hole, standoff, psi, off=(0, 0, 0), turn=(0, 0, 0)):
    """Pose of the tool in the robot's base [mm], somewhat beside the hole's axis [mm, deg]."""
    T = tcp_pose(hole, standoff, psi) @ AS_WRITTEN
    T[:3, 3] *= 1e3
    beside = np.eye(4)
    beside[:3, :3], beside[:3, 3] = Rotation.from_euler("xyz", turn, degrees=True).as_matrix(), off
    return T @ beside


@pytest.fixture(params=["base", "tilted"])
def plan(request, published, plan_of):
    T = np.eye(4)
    if request.param == "tilted":
        T[:3, :3], T[:3, 3] = Rotation.from_euler("ZYX", (25, -40, 15), degrees=True).as_matrix(), (0.3, 0.2, 0.1)
    return plan_of(published(1), published(3), T_base_part=T, name="panel")


@pytest.mark.parametrize("share", [0.0, 0.3, 0.7, 1.0])
@pytest.mark.parametrize("beside", [((0, 0, 0), (0, 0, 0)), ((0, 0.6, -0.6), (3, 0.3, -0.3))])
def test_the_drill_comes_out_straight_from_anywhere(share, beside, plan, krl):
    for answer in plan.holes:
        text = retract_program(plan, answer.hole.id).text
        depth, psi = answer.hole.depth, float(np.interp(share, [0, 1], answer.motion.profile.psi[:2]))
        T = standing(plan, answer.hole, depth * share, psi, *beside)
        run = Run(text, T, krl)
        assert not run.halted
        (end,) = run.moves
        np.testing.assert_allclose(end[:3, :3], T[:3, :3], rtol=0, atol=1e-6)  # the spin stays
        way = T[:3, :3].T @ (end[:3, 3] - T[:3, 3])  # in the tool
        assert way[0] < 0
        np.testing.assert_allclose(way[1:], 0, atol=1e-3)
        out = (answer.hole.target * 1e3 - end[:3, 3]) @ answer.hole.direction
        assert depth * 1e3 + 5 - 0.1 < out < depth * 1e3 + 6


ELSEWHERE = {
    "beside the axis": {"off": (0, 1.2, 0)}, "tilted": {"turn": (0, 0.7, 0)}, "turned about": {"turn": (0, 0, -0.7)},
    "behind the hole": {"standoff": -0.002}, "before the hole": {"standoff": 0.08}, "far away": {"off": (0, 300, 0)},
    "the other way": {"turn": (0, 180, 0)},
}  # fmt: skip


@pytest.mark.parametrize("place", ELSEWHERE.values(), ids=ELSEWHERE)
def test_where_the_tool_is_not_in_the_hole_nothing_moves(place, plan, krl):
    answer = plan.holes[0]
    text = retract_program(plan, answer.hole.id).text
    run = Run(text, standing(plan, answer.hole, **{"standoff": 0.02, "psi": 0.2} | place), krl)
    assert run.halted
    assert not run.moves
    other = Run(text, standing(plan, plan.holes[1].hole, 0.01, 0.2), krl)
    assert other.halted
    assert not other.moves


def test_what_it_says_and_sets(plan, krl):
    exported = retract_program(plan, "position 3", plan_file="panel.json", version="1")
    assert exported.name == "panel_out_2"
    text = " ".join(line.lstrip("; ") for line in exported.text.splitlines())
    for words in (
        "Out of hole 2 of 2: position 3",
        "It moves only if",
        "the tool not turning",
        "The spindle is not switched",
    ):
        assert words in text
    assert "\n$VEL.CP=0.005000 ; 5 mm/s\n" in exported.text
    assert exported.text.isascii()
    assert max(map(len, exported.text.splitlines())) <= 200
    root = replace(plan, settings=replace(plan.settings, robroot="$ROBROOT", tool_number=2))
    text = retract_program(root, "position 3").text
    assert "\n$BASE=$ROBROOT:{FRAME: " in text
    assert "\n$ACT_TOOL=2\n$LOAD=" in text


def test_a_hole_that_nobody_has_checked(plan):
    spoiled = replace(plan, holes=(replace(plan.holes[0], verified=None), plan.holes[1]))
    with pytest.raises(NotExportableError, match="position 1: it was not verified"):
        retract_program(spoiled, "position 1")
    assert retract_program(spoiled, "position 3")
    with pytest.raises(InputError, match=r"retract: no hole is called 'x' .*position 1, position 3"):
        retract_program(plan, "x")


# --- a part of a job again --------------------------------------------------------------------------------------------


@pytest.fixture
def four(published, plan_of):
    holes = [published(number) for number in (1, 3, 1, 2)]
    named = [replace(hole, hole=replace(hole.hole, id=f"h{n}")) for n, hole in enumerate(holes)]
    return replace(plan_of(*named, name="panel"), order=("h2", "h0", "h3", "h1"))


def folds(exported, krl):
    return [fold for fold in krl.read(exported.text).folds if fold.startswith("Hole")]


def test_from_a_hole_on(four, krl):
    exported = export(four, start="h0")
    assert folds(exported, krl) == ["Hole 1 of 4: h0", "Hole 4 of 4: h3", "Hole 2 of 4: h1"]
    assert exported.name == "panel_from_1"
    (found,) = [finding for finding in exported.findings if finding.kind == "incomplete"]
    assert (found.level, found.message) == ("info", "only 3 of 4 holes are wanted: hole h0 and those after it")
    assert export(four, start="h2", name="x").text.count(";FOLD Hole") == 4


def test_some_holes_alone_in_the_order_of_the_plan(four, krl):
    exported = export(four, only=["h3", "h2"])
    assert folds(exported, krl) == ["Hole 3 of 4: h2", "Hole 4 of 4: h3"]
    assert exported.name == "panel_only_3_4"
    assert exported.holes == 2


def test_a_hole_that_is_not_wanted_need_not_be_good(four):
    spoiled = replace(four, holes=(replace(four.holes[0], verified=None), *four.holes[1:]))
    assert export(spoiled, only=["h1"]).holes == 1
    with pytest.raises(NotExportableError, match="h0: it was not verified"):
        export(spoiled, only=["h0", "h1"])


@pytest.mark.parametrize(
    ("part", "what"),
    [
        ({"start": "x"}, r"from: no hole is called 'x' \(accepted: ids of the plan: h2, h0, h3, h1\)"),
        ({"only": ["h1", "x"]}, "only: no hole is called 'x'"),
        ({"only": []}, "only: names no hole"),
        ({"only": ["h1"], "start": "h1"}, "stands beside only"),
    ],
)
def test_parts_that_there_are_not(part, what, four):
    with pytest.raises(InputError, match=what):
        export(four, **part)


def test_the_command(four, tmp_path, capsys):
    plan = tmp_path / "plan.json"
    write_plan(replace(four, order=(), name="panel"), plan)
    assert main(["export", str(plan), "--from", "h2"]) == 0
    assert main(["export", str(plan), "--only", "h2, h3"]) == 0
    assert main(["export", str(plan), "--retract", "h1"]) == 0
    assert main(["export", str(plan), "--retract", "h1"]) == 0
    names = sorted(path.name for path in tmp_path.glob("*.src"))
    assert names == ["panel_from_3.src", "panel_only_3_4.src", "panel_out_2.src"]
    capsys.readouterr()
    for wrong in (["--from", "x"], ["--only", "h1,x"], ["--retract", "x"], ["--retract", "h1", "--from", "h1"]):
        assert main(["export", str(plan), *wrong]) == 2
        assert capsys.readouterr().err


def test_a_part_is_certified_hole_by_hole(four, tmp_path):
    from zerorev.program.as_exported import as_exported
    from zerorev.program.krl.dialect import KRL
    from zerorev.program.krl.read import read_krl
    from zerorev.verify.certificate.program import certify_program

    program = read_krl(export(four, only=["h1", "h2"]).text)
    drilled = as_exported(four, program, KRL, "panel_only_2_3")
    verdicts = [hole.certificate.verdict for hole in certify_program(four, program, drilled).holes]
    assert verdicts == ["refuted", "certified", "certified", "refuted"]


def test_a_home_position_beyond_the_part_does_not_keep_the_drill_in_the_hole(published, plan_of):
    """The program makes no move to the hole or away from it, so that none of them can refuse it."""
    plan = plan_of(published(1))
    beside = tuple(np.deg2rad([-60.0, -60, 60, 0, 0, 0]))
    through = replace(plan, settings=replace(plan.settings, home_joints=beside, safe_height=0.0))
    with pytest.raises(NotExportableError, match="home position"):
        export(through)
    (hole,) = plan.holes
    assert retract_program(through, hole.hole.id).text == retract_program(plan, hole.hole.id).text
