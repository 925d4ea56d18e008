"""How good the prediction from critical rates is: `python -m benchmarks.prediction_study --holes 300 --seed 1000`.

Random holes are predicted and then solved exactly: the deepest stroke by `zerorev.deepest_stroke`, and the least twist
|psi_start - psi_end| of a motion without a reversal by an own scan over all spins and slopes. The motion threshold is
off. Writes docs/img/prediction.png and out/prediction.json, and prints the tables of docs/explanation/prediction.md.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from scipy.stats import spearmanr

from benchmarks.cases import NO_THRESHOLD, Case, random_place
from zerorev.files.output import write_bytes, write_text
from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import flip_sign, twist_field
from zerorev.kernels.layout import LONGEST_TWIST
from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import inverse, tcp_pose
from zerorev.report.figures import style
from zerorev.search.deepest import deepest_stroke
from zerorev.search.line import golden
from zerorev.search.prediction import earlier_root, first_order_root, predict, second_order_root
from zerorev.search.straight import LEAST_RATE, target_spins

ROOT = Path(__file__).parents[1]
SHARES = (0.5, 0.9)  # of the deepest stroke, at which the least twist is looked for
ROOTS = {"first order": first_order_root, "second order": second_order_root, "the earlier of both": earlier_root}
DEEPEST_BY, TWIST_BY = "the earlier of both", "second order"  # what `predict` takes
SPINS, SLOPES, BISECTIONS, NODES = 180, 40, 24, 129

# --- the exact least twist --------------------------------------------------------------------------------------------


@kernel
def runs(arm, plane, branch, psi, slope, sense, at_target, limits, depth):  # type: ignore[no-untyped-def]
    """Whether a leg keeps the wanted signs of all six rates and the limits (lower, upper) at every node to a depth."""
    cs, theta_s, theta_psi, before = np.empty((6, 2)), np.empty(6), np.empty(6), np.empty(6)
    angle, step = at_target.copy(), depth / (NODES - 1)
    for n in range(NODES):
        if not twist_field(arm, plane, n * step, psi + slope * n * step, branch // 2, cs, theta_s, theta_psi):
            return False
        for i in range(6):
            rate = theta_s[i] + slope * theta_psi[i]
            if i == 4:
                rate *= flip_sign(arm, branch)
            if not sense[i] * rate > LEAST_RATE:
                return False
            if n > 0:
                angle[i] += 0.5 * step * (before[i] + rate)
            if not limits[0][i] <= angle[i] <= limits[1][i]:
                return False
            before[i] = rate
    return True


@kernel
def bracket_twist(arm, plane, branch, psi, at_target, limits, depth):  # type: ignore[no-untyped-def]
    """Least twist [rad] of two legs out of one place that keep all six joints; inf where there are none."""
    cs, theta_s, theta_psi = np.empty((6, 2)), np.empty(6), np.empty(6)
    if not twist_field(arm, plane, 0.0, psi, branch // 2, cs, theta_s, theta_psi) or np.isnan(theta_psi[0]):
        return np.inf
    kappa, sense = -theta_s / theta_psi, np.sign(theta_psi)
    sense[4] *= flip_sign(arm, branch)
    twist = 0.0
    for side in (1.0, -1.0):
        bad, good = side * np.max(side * kappa), np.nan
        edge, span = bad, max(LONGEST_TWIST / depth - side * bad, 0.0)
        for j in range(SLOPES):
            slope = edge + side * span * 1e-4 ** (1.0 - j / (SLOPES - 1.0))
            if runs(arm, plane, branch, psi, slope, side * sense, at_target, limits, depth):
                good = slope
                break
            bad = slope
        if np.isnan(good):
            return np.inf
        for _ in range(BISECTIONS):
            slope = 0.5 * (good + bad)
            if runs(arm, plane, branch, psi, slope, side * sense, at_target, limits, depth):
                good = slope
            else:
                bad = slope
        twist += side * good * depth
    return twist


def least_twist(case: Case, depth: float) -> float:
    """Least |psi_start - psi_end| [rad] of two straight legs without a reversal, over all branches and spins."""
    robot, tool, hole = case.robot, case.tool, case.hole
    limits, plane, spins = robot.limits, Drilling(robot, tool, hole).plane, target_spins(None, SPINS)

    def twist(branch: int, psi: float) -> float:
        joints = inverse(robot, tcp_pose(hole, 0.0, psi) @ np.linalg.inv(tool.T_flange_tcp))[branch]
        joints += 2 * np.pi * np.round(((limits.lower + limits.upper) / 2 - joints) / (2 * np.pi))
        if not ((joints > limits.lower) & (joints < limits.upper)).all():
            return float("inf")
        return float(bracket_twist(robot.arm, plane, branch, psi, joints, (limits.lower, limits.upper), depth))

    seen = sorted((twist(branch, psi), branch, float(psi)) for branch in range(8) for psi in spins)
    step = spins[1] - spins[0]
    found = []
    for value, branch, psi in seen[:3]:
        at = golden(lambda x, branch=branch: twist(branch, x), psi - step, psi + step, 20)
        found.append(min(value, twist(branch, at)))
    return min(found)


# --- the study --------------------------------------------------------------------------------------------------------


def studied(seed: int) -> dict[str, Any]:
    """One random hole: what is predicted and what is so; lengths in m, angles in rad."""
    case = random_place(seed)
    hole = case.hole
    predicted = {
        name: predict(Drilling(case.robot, case.tool, hole), NO_THRESHOLD, root=root) for name, root in ROOTS.items()
    }
    cheapest = predicted[DEEPEST_BY].cheapest
    deepest = deepest_stroke(case.robot, case.tool, hole, NO_THRESHOLD).depth
    return {
        "seed": seed,
        "spread": np.nan if cheapest is None else cheapest.spread,
        "deepest": deepest,
        "predicted_deepest": {name: each.deepest for name, each in predicted.items()},
        "twists": [studied_twist(case, share * deepest) for share in SHARES] if deepest > 0 else [],
    }


def studied_twist(case: Case, depth: float) -> dict[str, Any]:
    """The least twist at one depth."""
    hole = replace(case.hole, depth=depth)
    predicted = {
        name: predict(Drilling(case.robot, case.tool, hole), NO_THRESHOLD, root=root) for name, root in ROOTS.items()
    }
    cheapest = predicted[DEEPEST_BY].cheapest
    return {
        "depth": depth,
        "least_twist": least_twist(case, depth),
        "spread times depth": np.nan if cheapest is None else cheapest.width * depth,
        **{name: each.least_twist for name, each in predicted.items()},
    }


def judged(predicted: Array, exact: Array) -> dict[str, float]:
    """How good a prediction is; infinite or nil ones count as misses, and are ranked last or first."""
    usable = np.isfinite(predicted) & (predicted > 0)
    ratio = predicted[usable] / exact[usable]
    error = np.where(usable, np.abs(predicted / exact - 1), np.inf)
    return {
        "rank correlation": float(spearmanr(np.where(np.isfinite(predicted), predicted, 1e9), exact).statistic),
        "median ratio": float(np.median(ratio)),
        "median error": float(np.median(error)),
        "within 25 %": float(np.mean(error <= 0.25)),
        "within a factor of 2": float(np.mean((predicted <= 2 * exact) & (predicted >= exact / 2))),
        "none predicted": float(np.mean(~usable)),
    }


def tables(found: list[dict[str, Any]]) -> dict[str, dict[str, dict[str, float]]]:
    """Each way of predicting judged over all holes that have a stroke without a reversal at all."""
    some = [each for each in found if each["deepest"] > 0]
    exact = np.array([each["deepest"] for each in some])
    inverse_spread = 1 / np.array([each["spread"] for each in some])
    deepest = {
        f"{np.rad2deg(scale := np.median(exact / inverse_spread)):.0f} deg / twist spread": scale * inverse_spread
    }
    deepest |= {name: np.array([each["predicted_deepest"][name] for each in some]) for name in ROOTS}
    out = {"deepest stroke": {name: judged(values, exact) for name, values in deepest.items()}}
    for k, share in enumerate(SHARES):
        twists = [each["twists"][k] for each in some]
        least = np.array([twist["least_twist"] for twist in twists])
        there = np.isfinite(least)
        ways = {name: np.array([twist[name] for twist in twists]) for name in ("spread times depth", *ROOTS)}
        out[f"least twist at {share:g} of it"] = {
            name: judged(values[there], least[there]) for name, values in ways.items()
        }
    return out


def markdown(judgements: dict[str, dict[str, dict[str, float]]]) -> Iterator[str]:
    """The tables as docs/explanation/prediction.md shows them."""
    for what, ways in judgements.items():
        yield f"| {what} | " + " | ".join(next(iter(ways.values()))) + " |"
        yield "|---" * (1 + len(next(iter(ways.values())))) + "|"
        for name, values in ways.items():
            correlation, ratio, *shares = values.values()
            yield (
                f"| {name} | {correlation:.3f} | {ratio:.2f} | "
                + " | ".join(f"{x:.0%}" if np.isfinite(x) else "none" for x in shares)
                + " |"
            )
        yield ""


def picture(found: list[dict[str, Any]]) -> bytes:
    """Predicted against exact, deepest stroke and least twist."""
    figure = style.headed_figure(
        "What the critical rates predict, before any search", f"{len(found)} random holes, no motion threshold", 4.4
    )
    left, right = figure.subplots(1, 2)
    some = [each for each in found if each["deepest"] > 0]
    pairs = [(each["deepest"] * 1e3, each["predicted_deepest"][DEEPEST_BY] * 1e3) for each in some]
    _scatter(left, pairs, style.JOINT_COLOURS[0])
    style.label(left, "deepest stroke [mm]", "predicted [mm]")
    for k in range(len(SHARES)):
        pairs = [np.rad2deg((each["twists"][k]["least_twist"], each["twists"][k][TWIST_BY])) for each in some]
        _scatter(right, pairs, style.JOINT_COLOURS[1 + 2 * k])
    style.label(right, "least twist [deg]", "predicted [deg]")
    handles = [
        Line2D([], [], color=style.MUTED, linewidth=1, label="exact"),
        Line2D([], [], color=style.MUTED, linewidth=1, linestyle=":", label="25 % off"),
    ] + [
        Line2D([], [], marker="o", linestyle="none", markersize=5, color=style.JOINT_COLOURS[1 + 2 * k],
               label=f"at {share:g} of the deepest stroke")
        for k, share in enumerate(SHARES)
    ]  # fmt: skip
    style.legend_below(figure, handles, columns=4)
    return style.png(figure)


def _scatter(axes: Axes, pairs: list[Any], colour: str) -> None:
    exact, predicted = np.array([pair for pair in pairs if np.isfinite(pair).all() and min(pair) > 0]).T
    style.bare_axes(axes)
    axes.loglog(exact, predicted, "o", color=colour, markersize=3.2, alpha=0.55, markeredgewidth=0, zorder=3)
    ends = np.array([exact.min(), exact.max()])
    for factor, dash in ((1.0, "-"), (1.25, ":"), (0.75, ":")):
        axes.plot(ends, factor * ends, color=style.MUTED, linewidth=1, linestyle=dash, zorder=2)


def main(arguments: list[str] | None = None, say: Callable[[str], None] = print) -> int:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--holes", type=int, default=300, help="how many random holes")
    parser.add_argument("--seed", type=int, default=1000, help="of the first; the others count up from it")
    parser.add_argument("--out", type=Path, default=ROOT / "out", help="folder of prediction.json")
    parser.add_argument("--figure", type=Path, default=ROOT / "docs" / "img" / "prediction.png")
    asked = parser.parse_args(arguments)
    found = []
    for n in range(asked.holes):
        found.append(studied(asked.seed + n))
        if (n + 1) % 20 == 0:
            sys.stderr.write(f"{n + 1} of {asked.holes} holes\n")
    judgements = tables(found)
    asked.out.mkdir(parents=True, exist_ok=True)
    report = {"holes": asked.holes, "seed": asked.seed, "judged": judgements, "found": found}
    write_text(asked.out / "prediction.json", json.dumps(report, indent=1) + "\n")
    write_bytes(asked.figure, picture(found))
    say("\n".join(markdown(judgements)))
    without = sum(each["deepest"] == 0 for each in found)
    wrong = sum(each["deepest"] == 0 and each["predicted_deepest"][DEEPEST_BY] > 0 for each in found)
    say(f"holes without any stroke: {without}; of those, {wrong} were predicted one")
    below = [t["least_twist"] / t["spread times depth"] for each in found for t in each["twists"]]
    say(f"least of exact twist / (spread times depth): {min(below, default=np.nan):.6f}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
