"""Formulas of interval arithmetic: written as expressions, differentiated by the spin, and compiled into a tape.

An expression is a node that other expressions share, so that what occurs twice is computed once. `kernels.intervals`
runs the tape.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels import intervals as ops

__all__ = ["Expression", "Number", "Sheet", "Tape", "added"]


class Number(NamedTuple):
    """A constant that is known by name: one tape serves all values.

    Attributes:
        name: what it is called where the tape is run.
        sign: 1 or -1.
    """

    name: str
    sign: float = 1.0

    def __neg__(self) -> Number:
        return Number(self.name, -self.sign)

    def times(self, sign: float) -> Number:
        """Itself, or its opposite."""
        return Number(self.name, sign * self.sign)


Constant = float | Number
Key = tuple[int, tuple[int, ...], Constant | None]


@dataclass(frozen=True, eq=False)
class Expression:
    """One quantity on a sheet; the operators write more of them."""

    sheet: Sheet
    number: int

    def __add__(self, other: Expression | Constant) -> Expression:
        return self.sheet.sum(self, other)

    def __sub__(self, other: Expression) -> Expression:
        return self.sheet.write(ops.SUB, self, other)

    def __neg__(self) -> Expression:
        return -1.0 * self

    def __mul__(self, other: Expression) -> Expression:
        return self.sheet.write(ops.MUL, self, other)

    def __rmul__(self, constant: Constant) -> Expression:
        return self if constant == 1.0 else self.sheet.write(ops.SCALE, self, constant=constant)

    def squared(self) -> Expression:
        """Its square."""
        return self.sheet.write(ops.SQR, self)

    def root(self, row: int) -> Expression:
        """The square root of the part that is not negative; a lane without one is marked in a row of `unknown`."""
        return self.sheet.write(ops.SQRT, self, constant=float(row))

    def clipped(self) -> Expression:
        """Itself, known to lie within -1 and 1."""
        return self.sheet.write(ops.CLIP, self)

    def ratio(self, divisor: Expression) -> Expression:
        """Itself by a divisor that is not negative, where the quotient is known to lie within -1 and 1."""
        return self.sheet.write(ops.RATIO, self, divisor)

    def over(self, divisor: Expression) -> Expression:
        """Itself by a divisor that is not negative; unbounded where that may be zero."""
        return self.sheet.write(ops.QUOTIENT, self, divisor)

    def spread(self, slope: Expression, half: Expression) -> Expression:
        """Itself, more or less by `half` (the lower end of it counts) of a slope."""
        return self.sheet.write(ops.SPREAD, self, slope, half)

    def met(self, other: Expression) -> Expression:
        """What it has in common with another enclosure, which is used where all derivatives are bounded."""
        return self.sheet.write(ops.MEET, self, other)

    def arc(self, sine: Expression) -> Expression:
        """The angle whose cosine this is, and whose sine is the other, up to a common positive factor [rad]."""
        return self.sheet.write(ops.ARC, self, sine)


@dataclass(frozen=True)
class Tape:
    """A compiled sheet.

    Attributes:
        code: operations, shape (T, 5), as `kernels.intervals.run` reads them.
        constants: what it uses, in order; numbers by name.
        inputs: rows that are to be filled in first, by name.
        outputs: rows that hold the results, by name.
        rows: how many there are.
    """

    code: npt.NDArray[np.int64]
    constants: tuple[Constant, ...]
    inputs: dict[str, int]
    outputs: dict[str, int]
    rows: int

    def values(self, numbers: dict[str, float]) -> list[float]:
        """The constants, given the numbers by name."""
        return [
            constant.sign * numbers[constant.name] if isinstance(constant, Number) else constant
            for constant in self.constants
        ]


@dataclass
class Sheet:
    """Where expressions are written."""

    lines: list[Key] = field(default_factory=list)
    inputs: dict[str, int] = field(default_factory=dict)
    known: dict[Key, int] = field(default_factory=dict)
    slopes: dict[int, Expression | None] = field(default_factory=dict)
    outward: dict[int, Expression | None] = field(default_factory=dict)

    def input(self, name: str) -> Expression:
        """A row that is filled in before the tape runs; its derivatives by the spin and by the stand-off are 0."""
        self.lines.append((-1, (), None))
        self.inputs[name] = len(self.lines) - 1
        self.slopes[self.inputs[name]] = self.outward[self.inputs[name]] = None
        return Expression(self, self.inputs[name])

    def turning(self, cosine: str, sine: str) -> tuple[Expression, Expression]:
        """Cosine and sine of the spin, as inputs."""
        c, s = self.input(cosine), self.input(sine)
        self.slopes[c.number], self.slopes[s.number] = -s, c
        return c, s

    def moving(self, standoff: str, one: str) -> Expression:
        """The stand-off, as an input; another input is its derivative by itself, to be filled with 1."""
        s = self.input(standoff)
        self.outward[s.number] = self.input(one)
        return s

    def write(self, op: int, *arguments: Expression, constant: Constant | None = None) -> Expression:
        """An expression, or the one that says the same already."""
        numbers = tuple(argument.number for argument in arguments)
        if op in (ops.ADD, ops.MUL) and numbers[0] > numbers[1]:
            numbers = numbers[::-1]
        inner = self.lines[numbers[0]]
        if op == ops.SCALE and inner[0] == ops.SCALE:  # k (l x), where the product is exact
            for sign, other in ((constant, inner[2]), (inner[2], constant)):
                if isinstance(sign, float) and abs(sign) == 1.0 and other is not None:
                    product = other.times(sign) if isinstance(other, Number) else sign * other
                    return product * Expression(self, inner[1][0])
        key = (op, numbers, constant)
        if key not in self.known:
            self.lines.append(key)
            self.known[key] = len(self.lines) - 1
        return Expression(self, self.known[key])

    def sum(self, a: Expression, b: Expression | Constant) -> Expression:
        """Of two expressions, or of one and a constant."""
        return self.write(ops.ADD, a, b) if isinstance(b, Expression) else self.write(ops.SHIFT, a, constant=b)

    def slope(self, expression: Expression) -> Expression | None:
        """The derivative by the spin; None where it is 0 for certain."""
        return self._derivative(expression, self.slopes)

    def outward_slope(self, expression: Expression) -> Expression | None:
        """The derivative by the stand-off; None where it is 0 for certain."""
        return self._derivative(expression, self.outward)

    def _derivative(self, expression: Expression, known: dict[int, Expression | None]) -> Expression | None:
        number = expression.number
        if number not in known:
            known[number] = self._slope(expression, known)
        return known[number]

    def _slope(self, expression: Expression, known: dict[int, Expression | None]) -> Expression | None:
        op, numbers, constant = self.lines[expression.number]
        parts = [Expression(self, number) for number in numbers]
        by = [self._derivative(part, known) for part in parts]
        if all(slope is None for slope in by):
            return None
        if op == ops.ADD:
            return added(*by)
        if op == ops.SUB:
            return added(by[0], None if by[1] is None else -by[1])
        if op == ops.MUL:
            (a, b), (da, db) = parts, by
            return added(None if da is None else da * b, None if db is None else a * db)
        (first, *_), (slope, *_) = parts, by
        if op == ops.SCALE:
            assert slope is not None
            assert constant is not None
            return constant * slope
        if op in (ops.SHIFT, ops.CLIP):
            return slope
        if op == ops.SQR:
            assert slope is not None
            return 2.0 * (first * slope)
        if op == ops.SQRT:
            assert slope is not None
            return self._divided(0.5 * slope, expression, ops.DERIVATIVE)
        if op in (ops.RATIO, ops.SLOPE):
            divisor, change = parts[1], by[1]
            less = None if change is None else -(expression * change)
            top = added(slope, less)
            assert top is not None
            return self._divided(top, divisor, ops.DERIVATIVE)
        raise AssertionError(f"operation {op} has no derivative here")

    def divided(self, a: Expression, b: Expression) -> Expression:
        """One by another that is not negative; a lane where that may be zero becomes unknown."""
        return self._divided(a, b, ops.VALUE)

    def slope_divided(self, a: Expression, b: Expression) -> Expression:
        """One by another that is not negative, for a derivative; a lane where that may be zero has none."""
        return self._divided(a, b, ops.DERIVATIVE)

    def _divided(self, a: Expression, b: Expression, row: int) -> Expression:
        return self.write(ops.SLOPE, a, b, constant=float(row))

    def compiled(self, outputs: dict[str, Expression]) -> Tape:
        """What it takes to compute the outputs; a row is used again once what it holds is read no more."""
        needed = self._needed([expression.number for expression in outputs.values()])
        last_read = {number: len(self.lines) for number in (e.number for e in outputs.values())}
        for number in needed:
            for part in self.lines[number][1]:
                last_read[part] = max(last_read.get(part, 0), number)
        row_of, free, count = dict[int, int](), list[int](), 0
        constants: dict[Constant, int] = {}
        code: list[tuple[int, int, int, int, int]] = []
        for number in needed:
            op, parts, constant = self.lines[number]
            # an operation must not write where it reads, or it is not vectorised
            if op == -1 or not free:
                row_of[number], count = count, count + 1
            else:
                row_of[number] = free.pop()
            for part in set(parts):
                if last_read[part] == number and self.lines[part][0] != -1:
                    free.append(row_of[part])
            if op == -1:
                continue
            read = [row_of[part] for part in parts] + [0, 0, 0]
            if op in (ops.SCALE, ops.SHIFT):
                assert constant is not None
                read[1] = constants.setdefault(constant, len(constants))
            elif op in (ops.SLOPE, ops.SQRT):
                assert isinstance(constant, float)
                read[2] = int(constant)
            code.append((op, row_of[number], read[0], read[1], read[2]))
        return Tape(
            code=np.array(code, dtype=np.int64).reshape(-1, 5),
            constants=tuple(constants),
            inputs={name: row_of[number] for name, number in self.inputs.items() if number in row_of},
            outputs={name: row_of[expression.number] for name, expression in outputs.items()},
            rows=count,
        )

    def _needed(self, wanted: list[int]) -> list[int]:
        """Lines that the wanted ones are made of, in order; inputs are kept."""
        found = set(self.inputs.values())
        rest = list(wanted)
        while rest:
            number = rest.pop()
            if number not in found:
                found.add(number)
                rest += self.lines[number][1]
        return sorted(found)


def added(a: Expression | None, b: Expression | None) -> Expression | None:
    """A sum in which None stands for 0."""
    if a is None or b is None:
        return a if b is None else b
    return a + b
