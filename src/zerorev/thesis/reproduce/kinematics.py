"""Tables 1 and 2 of the thesis and its check of the forward kinematics (sec. 3.3 to 3.5).

The two Denavit-Hartenberg chains are multiplied out here from the printed tables alone, with none of zerorev's own
kinematics, so that they stand for themselves.
"""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import Array
from zerorev.motion.kinematics import forward, inverse, tcp_pose
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.published import MODIFIED_DH, POSITIONS, STANDARD_DH, TOOL_AS_NEEDED
from zerorev.thesis.reproduce.section import Column, Result, Section, Table

__all__ = ["Chain", "appendix_b", "make", "modified_chain", "standard_chain", "tool_of", "worst_tip"]

JOINTS_EXAMINED = 2000
FRAME_6 = np.diag([-1.0, 1.0, -1.0, 1.0])  # of the thesis, in KUKA's flange frame

Chain = Array


def modified_chain(joints: Array, *, height_sign: float = 1.0) -> Chain:
    """T_base_6 [mm] of Table 1 (eq. 3.3 and 3.4), shape (..., 4, 4), at controller angles [rad], shape (..., 6).

    Args:
        joints: A1 to A6.
        height_sign: of the entry in row 3, column 4 of eq. 3.3; -1 as printed.
    """
    T = np.broadcast_to(np.eye(4), (*joints.shape[:-1], 4, 4))
    for i, (alpha, a, d, theta) in enumerate(MODIFIED_DH):
        c, s = np.cos(joints[..., i] + np.deg2rad(theta)), np.sin(joints[..., i] + np.deg2rad(theta))
        ca, sa = np.cos(np.deg2rad(alpha)), np.sin(np.deg2rad(alpha))
        step = np.zeros((*joints.shape[:-1], 4, 4))
        step[..., 0, 0], step[..., 0, 1], step[..., 0, 3] = c, -s, a
        step[..., 1, 0], step[..., 1, 1], step[..., 1, 2], step[..., 1, 3] = s * ca, c * ca, -sa, -d * sa
        step[..., 2, 0], step[..., 2, 1], step[..., 2, 2] = s * sa, c * sa, ca
        step[..., 2, 3], step[..., 3, 3] = height_sign * d * ca, 1.0
        T = T @ step
    return T


def standard_chain(joints: Array, *, third: float = -1.0) -> Chain:
    """The product of Table 2 [mm], shape (..., 4, 4), at controller angles [rad], shape (..., 6).

    Args:
        joints: A1 to A6.
        third: the sense in which joint 3 is counted.
    """
    T = np.broadcast_to(np.eye(4), (*joints.shape[:-1], 4, 4))
    for i, (theta, d, a, alpha) in enumerate(STANDARD_DH):
        q = (third if i == 2 else 1.0) * joints[..., i] + np.deg2rad(theta)
        c, s = np.cos(q), np.sin(q)
        ca, sa = np.cos(np.deg2rad(alpha)), np.sin(np.deg2rad(alpha))
        step = np.zeros((*joints.shape[:-1], 4, 4))
        step[..., 0, 0], step[..., 0, 1], step[..., 0, 2], step[..., 0, 3] = c, -s * ca, s * sa, a * c
        step[..., 1, 0], step[..., 1, 1], step[..., 1, 2], step[..., 1, 3] = s, c * ca, -c * sa, a * s
        step[..., 2, 1], step[..., 2, 2], step[..., 2, 3], step[..., 3, 3] = sa, ca, d, 1.0
        T = T @ step
    return T


def tool_of(ee: tuple[float, float]) -> Array:
    """T_6_tcp [mm] of eq. 3.10, shape (4, 4), with EEa and EEb [mm]."""
    return np.array([[0, 0, 1, -ee[0]], [0, 1, 0, 0], [-1, 0, 0, -ee[1]], [0, 0, 0, 1.0]])


def appendix_b() -> tuple[Array, Array]:
    """The nine joint targets [rad], shape (9, 6), and where the tool tip should be at each [mm], shape (9, 3)."""
    joints: list[tuple[float, ...]] = []
    tips: list[Array] = []
    for position in POSITIONS:
        target = np.array(position.target_mm, dtype=float)
        start = target - [position.depth_mm, 0, 0]
        joints += position.axis_deg
        tips += [start, target, start]
    return np.deg2rad(np.array(joints)), np.array(tips)


def worst_tip(T_base_tcp: Array, tips: Array) -> float:
    """Greatest distance [mm] of the tip from where it should be."""
    return float(np.linalg.norm(T_base_tcp[..., :3, 3] - tips, axis=-1).max())


def make(context: Context) -> Section:
    """Both tables, the arm of zerorev and the nine joint targets of Appendix B against each other."""
    joints, tips = appendix_b()
    many = np.random.default_rng(0).uniform(-np.pi, np.pi, (JOINTS_EXAMINED, 6))
    table_1 = modified_chain(many)
    ours = forward(context.robot, many) @ FRAME_6
    ours[..., :3, 3] *= 1e3
    arm = _difference(ours, table_1)
    base, flange = _constant_transforms()
    both = _difference(base @ table_1 @ flange, standard_chain(many))
    tip = worst_tip(modified_chain(joints) @ tool_of(TOOL_AS_NEEDED), tips)
    back, rows = _inverse_again(context)
    digits = "the printed digits, 0.0001 deg, are worth about 0.001 mm at the tip"
    results = (
        Result(
            "Table 1 and Table 2 describe the same arm",
            "the same robot in two conventions",
            "sec. 3.3, Tables 1, 2",
            f"the same to {both:.1e}, with joint 3 counted the other way in Table 2",
            "",
            "Table 2 turns joint 3 the other way and leaves out the base height; constant transforms at base and"
            " flange take up the rest.",
        ),
        Result(
            "Table 1 and the arm of zerorev",
            "–",
            "Table 1",
            f"the same to {arm:.1e} at {JOINTS_EXAMINED:,} poses",
            "",
            "zerorev knows the arm by other numbers (ortho-parallel, from KUKA's data); both are one robot.",
        ),
        Result(
            "tip at the nine joint targets of Appendix B [mm]",
            '"the TCP coordinates agreed"',
            "sec. 3.4",
            f"off by {tip:.4f} at most",
            "",
            f"Agrees: {digits}. It takes the readings listed under Errata.",
        ),
        Result(
            "inverse kinematics: the joints of Appendix B among the eight solutions [deg]",
            "8 solutions, one of them used",
            "sec. 3.5, Appendix B",
            f"off by {back:.4f} at most",
            "",
            "The published spins and joints are rounded to four digits each, and that is what is left.",
        ),
    )
    angles = [Column(f"A{i}", "deg", 4) for i in range(1, 7)]
    columns = (Column("position"), Column("point"), *angles, Column("tip off", "mm", 5), Column("joints off", "deg", 5))
    text = (
        "Both tables are multiplied out as printed and compared at random poses, then against the joint angles that"
        " the thesis sent to its robot (Appendix B): there the tool tip has to come out at the target, and one stroke"
        " behind it.",
        "The last column goes the other way: the inverse kinematics of the published spin, and the nearest of its"
        " eight solutions.",
    )
    caption = "The nine joint targets of Appendix B, and how far forward and inverse kinematics miss them."
    return Section(text, results, (*_printed(), Table("appendix_b", caption, columns, rows)))


def _difference(one: Array, other: Array) -> float:
    """Greatest difference of entries; lengths counted in metres."""
    scale = np.ones((4, 4))
    scale[:3, 3] = 1e-3
    return float((np.abs(one - other) * scale).max())


def _constant_transforms() -> tuple[Array, Array]:
    """What stands before and behind Table 1 to make it Table 2: turned base without its height, turned flange.

    One pose fixes their product, and that the base is turned half round X and lowered fixes the rest.
    """
    rest = np.zeros((1, 6))
    base = np.diag([1.0, -1.0, -1.0, 1.0]) @ np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -400.0], [0, 0, 0, 1]])
    flange = np.linalg.inv(base @ modified_chain(rest)[0]) @ standard_chain(rest)[0]
    return base, flange


def _inverse_again(context: Context) -> tuple[float, tuple[tuple[str | float, ...], ...]]:
    T_tcp_flange = np.linalg.inv(context.tool.T_flange_tcp)
    rows: list[tuple[str | float, ...]] = []
    for position in POSITIONS:
        standoff = np.array([position.depth_mm, 0.0, position.depth_mm]) / 1e3
        poses = tcp_pose(position.hole, standoff, np.deg2rad(position.psi_deg))
        solutions = np.rad2deg(inverse(context.robot, poses @ T_tcp_flange))
        printed = np.array(position.axis_deg)
        T = modified_chain(np.deg2rad(printed)) @ tool_of(TOOL_AS_NEEDED)
        for i, point in enumerate(("start", "target", "end")):
            off = np.abs((solutions[i] - printed[i] + 180) % 360 - 180).max(axis=1).min()
            tip = np.linalg.norm(T[i, :3, 3] - poses[i, :3, 3] * 1e3)
            rows.append((position.name, point, *printed[i].tolist(), float(tip), float(off)))
    return max(float(row[-1]) for row in rows), tuple(rows)


def _printed() -> tuple[Table, Table]:
    def columns(first: str, *names: str) -> tuple[Column, ...]:
        lengths = ("a(i−1)", "a(i)", "d(i)")
        return (Column(first), *(Column(name, "mm" if name in lengths else "deg", 0) for name in names))

    modified = columns("joint", "α(i−1)", "a(i−1)", "d(i)", "θ(i)")
    standard = columns("link", "θ(i)", "d(i)", "a(i)", "α(i)")
    return (
        Table("table_1", "Table 1 of the thesis: modified DH parameters.", modified, _numbered(MODIFIED_DH)),
        Table("table_2", "Table 2 of the thesis: standard DH parameters.", standard, _numbered(STANDARD_DH)),
    )


def _numbered(rows: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    return tuple((i, *row) for i, row in enumerate(rows, 1))
