"""How a job is planned and run: each setting is stated here, once."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Literal

from zerorev.errors import InputError
from zerorev.model.controller import Calls, ExternalAxis, check_controller
from zerorev.model.corner import CONTROLLERS, ControllerName, CornerKind, Turning, known_controller, turning_of
from zerorev.model.cycle import Cycle
from zerorev.model.measures import CRITERIA, Measures
from zerorev.model.stated import Choice, Nest, Number, Six, Switch, Weighed, Whole, check, with_attributes
from zerorev.model.surroundings import NOTHING_AROUND, Surroundings
from zerorev.model.units import DEG, DEG_PER_MM, MM, MM_S, NEWTON, NM_PER_RAD, Unit

if TYPE_CHECKING:
    from zerorev.model.hole import Hole

__all__ = ["Settings", "Weights"]

Objective = Literal["travel", "margin", "plunge_rotation"]
Weights = tuple[tuple[str, float], ...]
Legs = Literal["straight", "free"]

GOOD = "What counts as a good motion"
RUN = "How it is run"
SEQUENCE = "How the holes follow each other"
PROGRAM = "How the program fits the controller"
NO_CALLS = Calls()
IN_ONE_GO = Cycle()
CREEP = 0.1  # of the feed, at most
AS_TURNED = "Each joint against the link before it: of a FANUC, J3 as its pendant shows it plus J2"
FEED = Nest("feed_mm_s", "Feeds of the tip.")
LAST = Nest("breakthrough", "The last millimetres of the way in, where the drill comes out at the back.")
SINK = Nest("countersink", "What the drill leaves at the mouth of the hole.")


@dataclass(frozen=True)
class Settings:
    """How to plan and how to run the motion; SI and radians here, millimetres and degrees in files.

    Attributes:
        robroot: where the robot's own base stands in the controller's world: the name of a variable that says so, or
            x, y, z [m], roll, pitch, yaw [rad]; None: they are the same.
        external_axes: where axes besides the robot's six stand.
        calls: programs of the controller that are called where the robot stands still.
        header: lines that begin with &, which a controller keeps before the program.
        cycle: how each hole is drilled that does not say so itself.
        surroundings: what stands around the arm, which no body of it may touch.
    """

    min_rate: Annotated[
        float,
        Number(
            "least motion of every joint along the path; 0 switches it off",
            DEG_PER_MM,
            least=0,
            note="The motion threshold; joints that reverse are not counted (theory §5)",
            group=GOOD,
            label="motion threshold",
        ),
    ] = math.radians(10.0)
    min_rate_rule: Annotated[
        Literal["pointwise", "mean"],
        Choice(
            words={"pointwise": "at every point", "mean": "on the average of each leg"},
            note="How the motion threshold is kept",
            label="kept",
        ),
    ] = "pointwise"
    psi_bound: Annotated[
        float | None,
        Number(
            "spins stay within +- this", DEG, none="the spin is periodic", above=0, most=3_600, label="spins within ±"
        ),
    ] = None
    legs: Annotated[
        Legs,
        Choice(words={"straight": "spin linear along each leg", "free": "spin varying freely along it"}),
    ] = "straight"
    max_twist: Annotated[
        float,
        Number(
            "greatest twist rate of free legs",
            DEG_PER_MM,
            above=0,
            note="With `legs: straight` it does not count",
            label="greatest twist of free legs",
        ),
    ] = math.radians(5e3)
    objective: Annotated[
        Objective,
        Choice(
            "decides among plans of equal reversals",
            words={
                "travel": "least joint travel",
                "margin": "greatest slowest motion",
                "plunge_rotation": "least spin during the plunge",
            },
            note="The mapping is of [criteria](#criteria), whose weighted sum is to be least",
            label="among equal reversals",
        ),
    ] = "travel"
    weights: Annotated[
        Weights,
        Weighed(
            "pairs of a criterion and its weight, whose weighted sum is to be least instead of the objective",
            instead_of="objective",
            of=Measures,
            label="a weighted sum of criteria",
        ),
    ] = ()
    joint_stiffness: Annotated[
        tuple[float, ...] | None,
        Six(
            "stiffness of the joints, for the compliance at the tip",
            NM_PER_RAD,
            none="unknown",
            above=0,
            note="Needed to weigh compliance, and to state it",
        ),
    ] = None
    reversal_weights: Annotated[tuple[float, ...], Six("what a reversal of each joint costs", above=0)] = (1.0,) * 6
    near_joints: Annotated[
        tuple[float, ...] | None,
        Six(
            "controller angles to which free turns are chosen nearest",
            DEG,
            none="the turns farthest from the limits",
            note=AS_TURNED,
        ),
    ] = None
    limit_margin: Annotated[
        float,
        Number(
            "room that every joint keeps to its limits, in the lead-in, too",
            DEG,
            least=0,
            note="A part that stands off where it was measured brings joints nearer to their limits than planned",
            label="room at the joint limits",
        ),
    ] = 0.0
    controller: Annotated[
        ControllerName | None,
        Choice(
            "which controller runs the program",
            words={name: each.maker for name, each in CONTROLLERS.items()},
            none="that of the robot's maker",
            note="The depth lost at the corner depends on it",
            group=RUN,
            label="controller",
        ),
    ] = None
    corner: Annotated[
        CornerKind | None,
        Choice(
            "how the motion turns round at the target",
            words={
                "blend": "straight moves of the tip that are blended",
                "joint": "the last of the plunge and the first of the retract as joint moves that are blended",
                "spin": "joint moves as with joint, between which the tool spins on for the time of the dwell",
                "stop": "an exact stop, with all joints at rest",
            },
            none="as usual for the controller: blend for krl, joint for the others; stop where blend_mm is 0 or "
            "the tool dwells, spin where it dwells moving",
            note="In the space of the joints the corner of a motion without reversals is less than a right angle",
            label="corner",
        ),
    ] = None
    corner_tolerance: Annotated[
        float,
        Number(
            "how far the tip may leave the drill axis at a corner of joint moves, which are made shorter for it",
            MM,
            above=0,
            note="The axis may tilt by 0.01 deg",
            label="joint moves leave the axis by",
        ),
    ] = 20e-6
    blend: Annotated[
        float,
        Number(
            "radius of the blend at the corner, or how far from it joint moves begin, at most",
            MM,
            least=0,
            note="`$APO.CDIS`; 0 stops there exactly, with all joints at rest",
            label="blend at the corner",
        ),
    ] = 1e-3
    blend_shortfall: Annotated[
        float | None,
        Number(
            "depth lost at the corner as measured",
            MM,
            none="half of the blend",
            least=0,
            up_to="blend",
            label="depth lost to it",
            empty="half of the blend",
        ),
    ] = None
    deepen_corner: Annotated[
        bool,
        Switch(
            "whether the corner lies deeper by the shortfall, so that the depth is met",
            off="at the target, depth lost to the blend",
            on="deeper, so that the depth is met",
            label="the corner lies",
        ),
    ] = False
    lead_in: Annotated[
        float,
        Number("length run along the plunge leg before the drill enters", MM, least=0, label="lead-in"),
    ] = 5e-3
    approach: Annotated[
        float,
        Number(
            "length run along the drill axis at constant spin before the lead-in; the arm stops where that begins",
            MM,
            note="Reversals there are in the air and are not counted; at the feed of the retract",
            least=0,
            label="approach",
        ),
    ] = 0.0
    retract: Annotated[
        float,
        Number(
            "length run along the drill axis at constant spin after the stroke, once the arm has stopped",
            MM,
            note="Likewise",
            least=0,
            label="retract",
        ),
    ] = 0.0
    safe_height: Annotated[
        float | None,
        Number(
            "height over the surface through which the arm moves from hole to hole",
            MM,
            none="only where it would dip behind it",
            note="Through a point on the drill axis of each hole, that far from where its stroke begins; a move that "
            "would dip behind the surface all the same rises further, but with 0",
            least=0,
            label="safe height",
        ),
    ] = None
    clearance: Annotated[
        float,
        Number(
            "least distance of any body from the part and the fixtures; on the moves between holes there is a finding "
            "where one comes nearer, and none drills nearer",
            MM,
            least=0,
            label="clearance from the part",
        ),
    ] = 0.0
    part_thickness: Annotated[
        float | None,
        Number(
            "how far the part goes on behind its surface; 0: there is no part that the moves between holes could meet",
            MM,
            none="everything behind the surface counts as part",
            least=0,
            label="thickness of the part",
        ),
    ] = None
    keep_lead_in: Annotated[
        bool,
        Switch(
            "whether only motions count whose whole lead-in runs without a reversal; false: it is shortened "
            "where it cannot",
            note="Within reach and limits, too; where it is shortened, there is a finding",
            off="it is shortened",
            on="the motion is another one",
            label="where a joint would reverse on it",
        ),
    ] = False
    feed_plunge: Annotated[float, Number("feed of the plunge", MM_S, nest=FEED, key="plunge", above=0)] = 5e-3
    feed_retract: Annotated[float, Number("feed of the retract", MM_S, nest=FEED, key="retract", above=0)] = 20e-3
    breakthrough_length: Annotated[
        float,
        Number(
            "how much of the way in has a feed of its own",
            MM,
            nest=LAST,
            key="last_mm",
            least=0,
            note="Counted from the target; at a corner that is placed deeper, that much more",
            label="last of the way in, with its own feed",
        ),
    ] = 0.0
    breakthrough_feed: Annotated[
        float | None,
        Number(
            "its feed",
            MM_S,
            nest=LAST,
            key="feed_mm_s",
            none="that of the plunge",
            above=0,
            label="feed of the last of the way in",
        ),
    ] = None
    sink_diameter: Annotated[
        float | None,
        Number(
            "diameter of the countersink",
            MM,
            nest=SINK,
            key="diameter_mm",
            none="none",
            above=0,
            note="It is as wide as the drill is deep, so that it takes a measured depth",
            label="countersink",
        ),
    ] = None
    sink_angle: Annotated[
        float,
        Number("its full angle", DEG, nest=SINK, key="angle_deg", least=10, to=170, label="angle of the countersink"),
    ] = math.radians(100.0)
    spindle_rpm: Annotated[
        float | None,
        Number(
            "speed of the spindle",
            Unit("rev/min", si="rev/min"),
            none="the program need not know it",
            above=0,
            note="Used for the finding on the drill's change of speed; the program does not switch the spindle",
            label="spindle",
        ),
    ] = None
    thrust: Annotated[
        float,
        Number(
            "thrust of the drill while it plunges; 0: none, or one that a foot on the part takes",
            NEWTON,
            note="Counts in the predicted lost motion and in the virtual cell (theory §9)",
            least=0,
            label="thrust",
        ),
    ] = 0.0
    order: Annotated[
        Literal["listed", "best", "groups"],
        Choice(
            words={
                "listed": "as the job lists them",
                "best": "as the time between holes is least that is found",
                "groups": "group after group as the job first names them, best within each",
            },
            note="The order in which the holes are drilled",
            before="listed",
            group=SEQUENCE,
            label="order",
        ),
    ] = "listed"
    posture_freedom: Annotated[
        float,
        Number(
            "share by which the joints of all holes together may travel more than the least, so that the arm keeps its "
            "posture and its turns from hole to hole",
            note="A motion with more reversals, or below the motion threshold, is never taken for it; 0: each hole "
            "keeps its own best motion",
            before=0.0,
            least=0,
            most=1e3,
            label="more travel for one posture",
        ),
    ] = 0.1
    home_joints: Annotated[
        tuple[float, ...] | None,
        Six(
            "controller angles where the job begins and ends",
            DEG,
            none="it begins and ends at its holes",
            note=AS_TURNED,
        ),
    ] = None
    proof_boxes: Annotated[
        int,
        Whole(
            "how many boxes of legs each hole's proof may examine; 0: no proof",
            note="The proof of the optimum, or of the deepest stroke; of free legs it may examine twice as many cells "
            "of the twist plane",
            before=0,
            least=0,
            most=100_000_000,
            group=GOOD,
            label="boxes of a proof",
        ),
    ] = 100_000
    tool_number: Annotated[
        int | None,
        Whole(
            "number of the tool on the controller",
            none="the program sets none",
            least=1,
            to=16,
            note="KRL: `$ACT_TOOL`, and `$LOAD` by the mass of the tool, or of that number where that is not known. "
            "TP, INFORM: `UTOOL_NUM`, `///TOOL`, which they need; what must stand there is said in their comments",
            group=PROGRAM,
            label="tool number",
        ),
    ] = None
    base_number: Annotated[
        int | None,
        Whole(
            "number of the base on the controller",
            none="the program sets none",
            least=1,
            to=32,
            note="KRL: `$ACT_BASE`. TP: `UFRAME_NUM`, in place of the world frame",
            label="base number",
        ),
    ] = None
    holes_per_program: Annotated[
        int | None,
        Whole(
            "most holes of one file: a longer program is split into parts, which it calls",
            none="all are in one file",
            least=1,
            most=1_000_000,
            label="holes per program",
        ),
    ] = None
    robroot: str | tuple[float, ...] | None = None
    external_axes: tuple[ExternalAxis, ...] = ()
    calls: Calls = NO_CALLS
    header: tuple[str, ...] = ()
    cycle: Cycle = IN_ONE_GO
    surroundings: Surroundings = NOTHING_AROUND

    def __post_init__(self) -> None:
        """Check ranges."""
        check(self)
        check_controller(self.robroot, self.external_axes, self.header)
        self._check_weights()
        if self.cycle.kind != "single" and self.legs == "free":
            raise InputError("free legs drill in one go", where="cycle", accepted="legs: straight, or kind: single")
        if self.turning.kind == "spin" and self.legs == "free":
            raise InputError("free legs do not spin on at the target", where="corner", accepted="legs: straight")

    def _check_weights(self) -> None:
        weights = dict(self.weights)
        known = len(weights) == len(self.weights) and set(weights) <= set(CRITERIA)
        if not known:
            raise InputError("out of range", where="objective", accepted=f"each once: {', '.join(CRITERIA)}")
        if not all(0 < weight < math.inf for weight in weights.values()):
            raise InputError("out of range", where="objective", accepted="weights above 0")
        for name in weights:
            if CRITERIA[name].needs_stiffness and self.joint_stiffness is None:
                raise InputError(
                    f"{name} needs the stiffness of the joints, which is not given",
                    where="objective",
                    accepted="joint_stiffness_nm_per_rad beside it, six numbers above 0 [N m/rad]",
                )

    def of(self, hole: Hole) -> Settings:
        """The same for one hole, which may have a cycle of its own.

        Raises:
            InputError: the cycle does not fit to the settings.
        """
        if hole.cycle is None:
            return self
        try:
            return replace(self, cycle=hole.cycle)
        except InputError as wrong:
            raise InputError(wrong.what, where=f"hole {hole.id}, {wrong.where}", accepted=wrong.accepted) from None

    @property
    def without_proof(self) -> Settings:
        """The same without the proof of the optimum, for those who ask of very many places."""
        return replace(self, proof_boxes=0)

    @property
    def passing_blend(self) -> float:
        """Radius of the blend [m] at inner points other than the corner.

        Where the job asks for an exact stop at the corner, it is 1 mm all the same: a stop within a leg would put every
        joint at rest with the drill in the material.
        """
        return self.blend or 1e-3

    @property
    def turning(self) -> Turning:
        """How the motion turns round at the corner, and how much of the depth is lost to it."""
        return turning_of(
            self.controller, self.corner, self.blend, self.blend_shortfall, self.cycle, self.creep_in(self.cycle.dwell)
        )

    def creep_in(self, time: float) -> float:
        """How far the tool creeps in while it spins on [m]: within the tolerance of the corner, at a tenth of the feed.

        Args:
            time: for which it spins on [s].
        """
        return min(self.corner_tolerance, CREEP * self.feed_inwards(0.0) * time)

    @property
    def creep(self) -> float:
        """How far the tool creeps in while it spins on for as long as asked for [m]; 0 where it does not."""
        return self.creep_in(self.cycle.dwell) if self.turning.kind == "spin" else 0.0

    @property
    def standing(self) -> float:
        """For which the tool stands at the target [s]."""
        return 0.0 if self.turning.kind == "spin" else self.cycle.dwell

    def feed_inwards(self, standoff: float) -> float:
        """Feed of a move towards the target [m/s].

        Args:
            standoff: at which it begins [m].
        """
        last = standoff <= self.breakthrough_length * (1 + 1e-9)
        return self.breakthrough_feed if last and self.breakthrough_feed is not None else self.feed_plunge

    @property
    def blend_share(self) -> float:
        """Share of the shorter move that a blend may take, at most."""
        return known_controller(self.controller).share

    @property
    def sized(self) -> bool:
        """Whether a program says how large a blend is."""
        return known_controller(self.controller).sized

    @property
    def curve_known(self) -> bool:
        """Whether the controller is taken to blend straight moves by a parabola; else by any curve."""
        return known_controller(self.controller).parabola

    @property
    def corner_blend(self) -> float:
        """Radius of the blend of straight moves at the corner [m]; 0 where they are not blended there."""
        return self.blend if self.turning.kind == "blend" else 0.0

    @property
    def corner_standoff(self) -> float:
        """Stand-off of the programmed corner [m]: 0, or below 0 where it is placed deeper."""
        return -self.turning.shortfall if self.deepen_corner else 0.0


Settings.__doc__ = with_attributes(Settings)
