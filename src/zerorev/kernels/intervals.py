"""Interval arithmetic on rows of numbers, and the machine that runs a tape of it.

A row holds LANES intervals, the lower ends before the upper ones: shape (2 * LANES,). Each operation is one short loop
over separate rows, which the compiler vectorises; a formula is a tape of them (`search.bounds.expressions` writes it).

Rounding: every result is widened by 4.5e-16 of its size and 1e-300. Rounding to nearest errs by at most 1.12e-16 of
the result, the constants of a tape by as much again, and the widening by less than 1e-31 of it, so every enclosure is
rigorous without a change of the rounding mode; contraction of a * b + c only leaves roundings out (bounds: rounding).

NaN says that nothing is known. It must not be dropped on the way, and is not: no operation makes an infinity or a NaN
of finite numbers in the range that occurs here, because those that divide mark a lane as unknown instead.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.field import cos_sin

LANES = 32
INDEX = np.uint64  # an index that cannot be negative needs no test, so that the loops are vectorised
ROW = INDEX(LANES)

ADD, SUB, MUL, SCALE, SHIFT, SQR, SQRT, CLIP, RATIO, SLOPE, SPREAD, MEET, ARC, QUOTIENT = range(14)

WIDEN, TINY = 4.5e-16, 1e-300
TRIG = 1e-15  # absolute error of `cos_sin`, with room
LEAST_DIVISOR = 1e-24  # below it a derivative is taken for unbounded
UNKNOWN = 1e30  # ends of an interval of which nothing is known
ANGLE = 1e-12  # [rad] absolute error of `_angle`, with room

VALUE, DERIVATIVE, OUT_OF_REACH, NOWHERE = range(4)  # rows of `unknown`


@kernel
def _add(rows, out, a, b):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        lo, hi = rows[a, n] + rows[b, n], rows[a, m] + rows[b, m]
        rows[out, n] = lo - (abs(lo) * WIDEN + TINY)
        rows[out, m] = hi + (abs(hi) * WIDEN + TINY)


@kernel
def _sub(rows, out, a, b):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        lo, hi = rows[a, n] - rows[b, m], rows[a, m] - rows[b, n]
        rows[out, n] = lo - (abs(lo) * WIDEN + TINY)
        rows[out, m] = hi + (abs(hi) * WIDEN + TINY)


@kernel
def _mul(rows, out, a, b):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        al, ah, bl, bh = rows[a, n], rows[a, m], rows[b, n], rows[b, m]
        p, q, r, t = al * bl, al * bh, ah * bl, ah * bh
        x, y = (p if p < q else q), (r if r < t else t)
        lo = x if x < y else y
        x, y = (p if p > q else q), (r if r > t else t)
        hi = x if x > y else y
        rows[out, n] = lo - (abs(lo) * WIDEN + TINY)
        rows[out, m] = hi + (abs(hi) * WIDEN + TINY)


@kernel
def _scale(rows, out, a, k):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        p, q = k * rows[a, n], k * rows[a, m]
        lo, hi = (p if p < q else q), (p if p > q else q)
        rows[out, n] = lo - (abs(lo) * WIDEN + TINY)
        rows[out, m] = hi + (abs(hi) * WIDEN + TINY)


@kernel
def _shift(rows, out, a, k):  # type: ignore[no-untyped-def]
    more = abs(k) * WIDEN + TINY
    for n in range(ROW):
        m = n + ROW
        lo, hi = rows[a, n] + k, rows[a, m] + k
        rows[out, n] = lo - (abs(lo) * WIDEN + more)
        rows[out, m] = hi + (abs(hi) * WIDEN + more)


@kernel
def _sqr(rows, out, a):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        al, ah = rows[a, n], rows[a, m]
        p, q = al * al, ah * ah
        least, most = (p if p < q else q), (p if p > q else q)
        lo = least - (least * WIDEN + TINY)
        rows[out, n] = lo if (al > 0.0) | (ah < 0.0) else 0.0
        rows[out, m] = most + (most * WIDEN + TINY)


@kernel
def _sqrt(rows, out, a, unknown, row):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        al, ah = rows[a, n], rows[a, m]
        unknown[row, n] = 1.0 if ah < 0.0 else unknown[row, n]
        least, most = np.sqrt(al if al > 0.0 else 0.0), np.sqrt(ah if ah > 0.0 else 0.0)
        lo = least - (least * WIDEN + TINY)
        rows[out, n] = lo if lo > 0.0 else 0.0
        rows[out, m] = most + (most * WIDEN + TINY)


@kernel
def _clip(rows, out, a):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        lo, hi = rows[a, n], rows[a, m]
        lo = lo if lo > -1.0 else -1.0
        hi = hi if hi < 1.0 else 1.0
        rows[out, n] = lo if lo < 1.0 else 1.0
        rows[out, m] = hi if hi > -1.0 else -1.0


@kernel
def _ratio(rows, out, a, b):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        al, ah, bl, bh = rows[a, n], rows[a, m], rows[b, n], rows[b, m]
        some, per_bl, per_bh = bl > 0.0, 1.0 / (bl if bl > 0.0 else 1.0), 1.0 / bh
        p, q = al * (per_bh if al > 0.0 else per_bl), ah * (per_bl if ah > 0.0 else per_bh)
        p, q = p - (abs(p) * 2.0 * WIDEN + TINY), q + (abs(q) * 2.0 * WIDEN + TINY)
        p, q = (p if some | (al > 0.0) else -1.0), (q if some | (ah < 0.0) else 1.0)
        p, q = (p if p > -1.0 else -1.0), (q if q < 1.0 else 1.0)
        rows[out, n], rows[out, m] = (p if p < 1.0 else 1.0), (q if q > -1.0 else -1.0)


@kernel
def _slope(rows, out, a, b, unknown, row):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        al, ah, bl, bh = rows[a, n], rows[a, m], rows[b, n], rows[b, m]
        some = bl > LEAST_DIVISOR
        unknown[row, n] = unknown[row, n] if some else 1.0
        per_bl, per_bh = 1.0 / (bl if some else 1.0), 1.0 / (bh if some else 1.0)
        lo, hi = al * (per_bh if al > 0.0 else per_bl), ah * (per_bl if ah > 0.0 else per_bh)
        rows[out, n] = lo - (abs(lo) * 2.0 * WIDEN + TINY)
        rows[out, m] = hi + (abs(hi) * 2.0 * WIDEN + TINY)


@kernel
def _quotient(rows, out, a, b):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        al, ah, bl, bh = rows[a, n], rows[a, m], rows[b, n], rows[b, m]
        some = bl > LEAST_DIVISOR
        per_bl, per_bh = 1.0 / (bl if some else 1.0), 1.0 / (bh if some else 1.0)
        lo, hi = al * (per_bh if al > 0.0 else per_bl), ah * (per_bl if ah > 0.0 else per_bh)
        lo, hi = lo - (abs(lo) * 2.0 * WIDEN + TINY), hi + (abs(hi) * 2.0 * WIDEN + TINY)
        rows[out, n], rows[out, m] = (lo if some else -UNKNOWN), (hi if some else UNKNOWN)


@kernel
def _spread(rows, out, a, slope, half):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        p, q = abs(rows[slope, n]), abs(rows[slope, m])
        more = (p if p > q else q) * rows[half, n]
        lo, hi = rows[a, n] - more, rows[a, m] + more
        pad = more * WIDEN + TINY
        rows[out, n] = lo - (abs(lo) * WIDEN + pad)
        rows[out, m] = hi + (abs(hi) * WIDEN + pad)


@kernel
def _meet(rows, out, a, b, unknown, row):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        known = unknown[row, n] == 0.0
        al, ah, bl, bh = rows[a, n], rows[a, m], rows[b, n], rows[b, m]
        rows[out, n] = bl if known & (bl > al) else al
        rows[out, m] = bh if known & (bh < ah) else ah


@kernel
def _angle(c, s):  # type: ignore[no-untyped-def]
    """Angle of the point (c, s) [rad], without a branch; within ANGLE.

    The polynomial on [-0.4375, 0.4375] has fdlibm's coefficients.
    """
    ac, as_ = abs(c), abs(s)
    least, most = (as_ if as_ < ac else ac), (as_ if as_ > ac else ac)
    t = least / (most if most > 0.0 else 1.0)
    steep = t > 0.414213562373095
    x = (t - 1.0) / (t + 1.0) if steep else t
    z = x * x
    p = x - x * z * (
        3.33333333333329318027e-01
        + z * (-1.99999999998764832476e-01
        + z * (1.42857142725034663711e-01
        + z * (-1.11111104054623557880e-01
        + z * (9.09088713343650656196e-02
        + z * (-7.69187620504482999495e-02
        + z * (6.66107313738753120669e-02
        + z * (-5.83357013379057348645e-02
        + z * (4.97687799461593236017e-02
        + z * (-3.65315727442169155270e-02 + z * 1.62858201153657823623e-02)))))))))
    )  # fmt: skip
    p = p + 0.25 * np.pi if steep else p
    p = 0.5 * np.pi - p if as_ > ac else p
    p = np.pi - p if c < 0.0 else p
    return -p if s < 0.0 else p


@kernel
def _arc(rows, out, c, s):  # type: ignore[no-untyped-def]
    for n in range(ROW):
        m = n + ROW
        cm, sm = 0.5 * (rows[c, n] + rows[c, m]), 0.5 * (rows[s, n] + rows[s, m])
        # in a box of half diagonal r about a point at distance d an angle differs by asin(r / d) at most, which is
        # less than r / sqrt(d^2 - r^2)
        cr, sr = 0.5 * (rows[c, m] - rows[c, n]), 0.5 * (rows[s, m] - rows[s, n])
        r2, d2 = (cr * cr + sr * sr) * (1.0 + 1e-12) + TINY, (cm * cm + sm * sm) * (1.0 - 1e-12)
        known = d2 > 2.0 * r2
        r = np.sqrt(r2 / (d2 - r2 if known else 1.0)) * (1.0 + 1e-12) + ANGLE
        middle = _angle(cm, sm)
        rows[out, n], rows[out, m] = (middle - r if known else -UNKNOWN), (middle + r if known else UNKNOWN)


@kernel
def run(tape, constants, rows, unknown):  # type: ignore[no-untyped-def]
    """Run a tape of interval operations.

    Args:
        tape: operation, row to write, and what it reads: two rows, or a row and the number of a constant; one more row,
            or one of `unknown`; shape (T, 5).
        constants: shape (C,).
        rows: in and out, shape (R, 2 * LANES); see the module for the layout.
        unknown: in and out, shape (4, LANES): 1 where nothing is known of a VALUE, or of a DERIVATIVE, and where all of
            a lane is OUT_OF_REACH; NOWHERE is for what nobody reads.
    """
    for t in range(tape.shape[0]):
        op, o, a, b, c = tape[t, 0], INDEX(tape[t, 1]), INDEX(tape[t, 2]), INDEX(tape[t, 3]), INDEX(tape[t, 4])
        if op == MUL:
            _mul(rows, o, a, b)
        elif op == ADD:
            _add(rows, o, a, b)
        elif op == SUB:
            _sub(rows, o, a, b)
        elif op == SCALE:
            _scale(rows, o, a, constants[b])
        elif op == SHIFT:
            _shift(rows, o, a, constants[b])
        elif op == SQR:
            _sqr(rows, o, a)
        elif op == SQRT:
            _sqrt(rows, o, a, unknown, c)
        elif op == CLIP:
            _clip(rows, o, a)
        elif op == RATIO:
            _ratio(rows, o, a, b)
        elif op == SLOPE:
            _slope(rows, o, a, b, unknown, c)
        elif op == SPREAD:
            _spread(rows, o, a, b, c)
        elif op == MEET:
            _meet(rows, o, a, b, unknown, INDEX(DERIVATIVE))
        elif op == ARC:
            _arc(rows, o, a, b)
        elif op == QUOTIENT:
            _quotient(rows, o, a, b)


@kernel
def cos_sin_over(low, high, cosine, sine):  # type: ignore[no-untyped-def]
    """Ranges of cosine and sine over intervals of angles.

    Args:
        low: shape (LANES,) [rad].
        high: shape (LANES,) [rad], less than a turn above `low`.
        cosine: out, a row.
        sine: out, a row.
    """
    for n in range(LANES):
        a, b = low[n], high[n]
        ca, sa = cos_sin(a)
        cb, sb = cos_sin(b)
        least, most = (ca if ca < cb else cb) - TRIG, (ca if ca > cb else cb) + TRIG
        least = -1.0 if _passes(a, b, np.pi) else least
        most = 1.0 if _passes(a, b, 0.0) else most
        cosine[n], cosine[LANES + n] = (least if least > -1.0 else -1.0), (most if most < 1.0 else 1.0)
        least, most = (sa if sa < sb else sb) - TRIG, (sa if sa > sb else sb) + TRIG
        least = -1.0 if _passes(a, b, -0.5 * np.pi) else least
        most = 1.0 if _passes(a, b, 0.5 * np.pi) else most
        sine[n], sine[LANES + n] = (least if least > -1.0 else -1.0), (most if most < 1.0 else 1.0)


@kernel
def _passes(a, b, at):  # type: ignore[no-untyped-def]
    """Whether an angle lies between two others, up to whole turns, with a small tolerance."""
    return np.floor((b - at + 1e-12) * (0.5 / np.pi)) * (2.0 * np.pi) + at >= a - 1e-12
