"""What the terminal shows of an answer: a row per hole while they are few, the whole in figures where they are many."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.model.finding import Finding
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Plan, Transition
from zerorev.report.words import tables, terminal
from zerorev.report.words.lost_motion import PREDICTED

__all__ = ["ROWS", "Shown", "how_deep", "minutes", "sequence_line"]

ROWS = 60  # of a table that can still be read


class Shown:
    """Takes one hole's answer after the other, and keeps no more of them than it will show.

    Attributes:
        sound: whether every hole has a checked motion, and nothing is found that is an error.
        certified: whether, besides, every one is certified.
    """

    def __init__(self, plan: Plan, answers: Iterable[HolePlan] = ()) -> None:
        """Begin.

        Args:
            plan: all but its holes.
            answers: to take at once.
        """
        self._plan, self._rows = plan, list[HolePlan]()
        self._lines = 0  # of the table, with those of strokes
        self._findings: list[Finding] = [
            *plan.findings, *(finding for move in plan.transitions for finding in move.findings)
        ]  # fmt: skip
        self._status, self._reversals = Counter[str](), Counter[int]()
        self._proven, self._bounded, self._weighed = 0, 0, False
        self._before, self._after, self._fixed = 0, 0, 0
        self._worst: tuple[tuple[int, float], HolePlan] | None = None
        self._figures = {name: _Figure() for name in ("travel [deg]", "slowest joint [deg/mm]", "deepest [mm]",
                                                      "deepest beyond depth [mm]", "lost motion [mm]",
                                                      "certified within [mm]", "time [s]")}  # fmt: skip
        self.sound, self.certified = not any(finding.level == "error" for finding in self._findings), True
        for answer in answers:
            self.add(answer)

    def add(self, answer: HolePlan) -> None:
        """Take the next hole's answer."""
        found = tables.hole_findings(answer)
        self._findings += found
        self.sound &= answer.verified is not None and answer.verified.passed
        self.sound &= not any(finding.level == "error" for finding in answer.findings)
        self.certified &= answer.certificate is not None and answer.certificate.verdict == "certified"
        self._weighed |= answer.lost_motion is not None
        self._status[answer.status] += 1
        self._bounded += answer.optimality is not None
        self._proven += answer.optimality is not None and answer.optimality.proven
        if self._lines <= ROWS:
            self._rows.append(answer)
        self._lines += 1 + len(answer.strokes)
        for name, value in self._values(answer):
            self._figures[name].add(value, answer.hole.id)
        if answer.score is not None:
            self._reversals[answer.score.reversals] += 1
            self._after += answer.score.reversals
            self._before += 0 if answer.baseline is None else answer.baseline.reversals
            self._fixed += answer.baseline is None
            slow = tables.slowest(answer.score, self._plan.settings)
            bad = answer.score.reversals, -np.inf if slow is None else -slow[0]
            if self._worst is None or bad > self._worst[0]:
                self._worst = bad, answer

    def say(self, findings: Iterable[Finding]) -> None:
        """Take findings of the whole plan that are known only at its end."""
        found = tuple(findings)
        self._findings += found
        self.sound &= not any(finding.level == "error" for finding in found)

    def _values(self, answer: HolePlan) -> Iterator[tuple[str, float]]:
        if answer.score is not None:
            yield "travel [deg]", float(np.rad2deg(answer.score.travel))
        if slow := tables.slowest(answer.score, self._plan.settings):
            yield "slowest joint [deg/mm]", float(np.rad2deg(slow[0]) / 1e3)
        if answer.lost_motion is not None:
            yield "lost motion [mm]", answer.lost_motion.at_tip * 1e3
        if answer.cycle_time is not None:
            yield "time [s]", answer.cycle_time
        if answer.certified_within is not None:
            yield "certified within [mm]", answer.certified_within.position * 1e3
        if answer.deepest is not None:
            yield "deepest [mm]", answer.deepest * 1e3
            if self._plan.strokes == "asked":
                yield "deepest beyond depth [mm]", (answer.deepest - answer.hole.depth) * 1e3

    def show(self) -> None:
        """Print it."""
        terminal.out().print(self.table())
        terminal.print_lines(self.lines())

    def table(self) -> Table:
        """A row per hole and stroke or, of many, a row per figure."""
        if self._lines <= ROWS:
            return tables.plan_table(replace(self._plan, holes=tuple(self._rows)))
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        table.add_column(Text("over all holes"))
        for heading in ("least", "mean", "greatest"):
            table.add_column(Text(heading), justify="right")
        for name, figure in self._figures.items():
            if figure.count:
                table.add_row(Text(name), *map(Text, figure.cells()))
        return table

    def lines(self) -> list[Text]:
        """How many holes of which kind, where they are many; what the deepest strokes are held to; what was found."""
        lines = []
        if self._lines > ROWS:
            kinds = ", ".join(f"{count} {status}" for status, count in sorted(self._status.items()))
            counts = ", ".join(f"{count} with {n} reversals" for n, count in sorted(self._reversals.items()))
            lines = [Text(f"{sum(self._status.values())} holes: {kinds}; {counts or 'no motion'}")]
        elif tables.no_baseline(self._rows):
            lines = [Text(tables.NO_BASELINE)]
        if self._worst is not None:
            lines += [Text(line) for line in self._summary(self._worst[1])]
        if self._bounded:
            lines.append(Text(f"optimum of straight legs: proven for {self._proven} of {self._bounded} holes"))
        if self._figures["deepest [mm]"].count:
            lines.append(Text(f"deepest without a reversal: {how_deep(self._plan.settings)}"))
        if self._weighed:
            lines.append(Text(f"lost motion: {PREDICTED}"))
        if self._plan.transitions:
            lines.append(Text(sequence_line(self._plan.transitions, self._plan.cycle_time)))
        return lines + tables.finding_lines(self._findings)

    def _summary(self, worst: HolePlan) -> Iterator[str]:
        """Reversals before and after, and the hole that is worst off, where there are several."""
        holes = sum(self._reversals.values())
        without = f" ({self._fixed} of {holes} holes cannot be run so)" if self._fixed else ""
        yield f"reversals: {self._before} at constant spin{without}, {self._after} as planned"
        if holes > 1 and worst.score is not None:
            slow, count = tables.slowest(worst.score, self._plan.settings), worst.score.reversals
            why = f"{count} reversal{'' if count == 1 else 's'}"
            if count == 0 and slow is not None:
                rate = np.rad2deg(slow[0]) / 1e3
                why = f"{self._plan.robot.joint_names[slow[1]]} moves {rate:.4f} deg/mm at its slowest"
            yield f"worst hole: {worst.hole.id} ({why})"


def sequence_line(moves: Sequence[Transition], cycle_time: float | None = None) -> str:
    """The moves between holes, and what all of a plan takes.

    Args:
        moves: between the holes.
        cycle_time: of holes and moves together [s]; None: not to be said.
    """
    changes = sum(move.changes_posture for move in moves)
    text = (
        f"{len(moves)} move{'s' if len(moves) > 1 else ''} between holes, {sum(move.time for move in moves):.1f} s, "
        f"{changes or 'no'} change{'' if changes == 1 else 's'} of posture"
    )
    return text if cycle_time is None else f"{text}; cycle time {minutes(cycle_time)}"


def minutes(seconds: float) -> str:
    """A time as people read it."""
    if seconds < 60:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


class _Figure:
    """Least, mean and greatest of a figure, and where."""

    def __init__(self) -> None:
        self.count, self.total = 0, 0.0
        self.least, self.greatest = (np.inf, ""), (-np.inf, "")

    def add(self, value: float, hole: str) -> None:
        self.count, self.total = self.count + 1, self.total + value
        if value < self.least[0]:
            self.least = value, hole
        if value > self.greatest[0]:
            self.greatest = value, hole

    def cells(self) -> tuple[str, str, str]:
        (least, at_least), (greatest, at_most) = self.least, self.greatest
        return f"{least:.4g} ({at_least})", f"{self.total / self.count:.4g}", f"{greatest:.4g} ({at_most})"


def how_deep(settings: Settings) -> str:
    """What the deepest strokes are held to, to be said wherever they are shown."""
    twist = f", twist at most {np.rad2deg(settings.max_twist) / 1e3:g} deg/mm" if settings.legs == "free" else ""
    rate = (
        f"every joint moves {np.rad2deg(settings.min_rate) / 1e3:g} deg/mm or more at every point"
        if settings.min_rate
        else ""
    )
    spin = "spin periodic" if settings.psi_bound is None else f"spin within +-{np.rad2deg(settings.psi_bound):g} deg"
    chips = "" if settings.cycle.kind != "chip_break" else "; breaking chips: the deepest found, not proven"
    return f"{settings.legs} legs{twist}; {rate or 'no motion threshold'}; {spin}{chips}"
