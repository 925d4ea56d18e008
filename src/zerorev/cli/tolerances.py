"""The options of `zerorev check` that say within which tolerance of the part's placement to certify."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from zerorev.cli.common import FINE, FOUND
from zerorev.errors import InputError

if TYPE_CHECKING:
    from zerorev.model.plan import Plan

__all__ = ["Tolerances"]


class Tolerances(NamedTuple):
    """The options as they were given.

    Attributes:
        largest: `--tolerance`.
        mm: `--tolerance-mm`.
        deg: `--tolerance-deg`.
        ratio: `--tolerance-ratio` [mm/deg].
    """

    largest: bool
    mm: float | None
    deg: float | None
    ratio: float | None

    def check(self, *, certify: bool, program: bool) -> None:
        """Refuse options that contradict each other, or values that are not a tolerance.

        Raises:
            InputError: they do, or are not.
        """
        for name, value in (("--tolerance-mm", self.mm), ("--tolerance-deg", self.deg)):
            if value is not None and not (math.isfinite(value) and value >= 0):
                raise InputError(f"{value:g} is not a tolerance", where=name, accepted="a finite number, 0 or more")
        if self.ratio is not None and not (math.isfinite(self.ratio) and self.ratio > 0):
            raise InputError(
                f"{self.ratio:g} is not a ratio",
                where="--tolerance-ratio",
                accepted="a finite number of mm per deg above 0",
            )
        if (self.mm is None) != (self.deg is None):
            missing = "--tolerance-mm" if self.mm is None else "--tolerance-deg"
            raise InputError("is missing", where=missing, accepted="--tolerance-mm and --tolerance-deg, or --tolerance")
        if self.largest and self.mm is not None:
            raise InputError(
                "finds the largest tolerance, but one is given",
                where="--tolerance",
                accepted="either --tolerance or --tolerance-mm with --tolerance-deg",
            )
        if self.ratio is not None and not self.largest:
            raise InputError("has no use", where="--tolerance-ratio", accepted="--tolerance beside it")
        if not (self.largest or self.mm is not None):
            return
        if not certify:
            raise InputError("a tolerance is only certified", where="--tolerance", accepted="--certify beside it")
        if program:
            raise InputError(
                "a program sets out from axis values, which do not move with the part",
                where="--program",
                accepted="a tolerance without --program: the plan is certified within it",
            )

    def certified(self, plan: Plan) -> Plan:
        """The plan with its certificates, and with what is certified within a tolerance."""
        from zerorev.model.plan import Within
        from zerorev.verify.certificate.within import RATIO, certify_plan_again, certify_plan_within

        if self.mm is not None and self.deg is not None:
            return certify_plan_within(plan, Within(self.mm * 1e-3, math.radians(self.deg)))
        if self.largest:
            ratio = RATIO if self.ratio is None else self.ratio * 1e-3 / math.radians(1)
            return certify_plan_within(plan, ratio=ratio)
        return certify_plan_again(plan)

    def verdict(self, plan: Plan) -> int:
        """The exit code: whether every hole is certified within a tolerance that was given."""
        return FOUND if self.mm is not None and any(hole.certified_within is None for hole in plan.holes) else FINE
