"""Taylor models against the numbers that they stand for, computed to 128 bits at points of the domain."""

import numpy as np
import pytest
from flint import arb

from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.certificate.range import least, lowest_at
from zerorev.verify.certificate.taylor import BOX, VARIABLES, Taylor, no_terms

COLUMNS = 5


@pytest.fixture(autouse=True)
def exact():
    with ball_arithmetic():
        yield


def random_model(rng, middle, spread, rest=0.0, *, bent=True):
    """Models about a middle, with linear and quadratic terms of some spread."""
    terms = no_terms(COLUMNS)
    terms[0] = rng.uniform(-spread, spread, (VARIABLES, COLUMNS))
    square = rng.uniform(-spread, spread, (VARIABLES, VARIABLES, COLUMNS)) * spread * bent
    terms[1:] = square + square.swapaxes(0, 1)
    return Taylor.polynomial(middle + rng.uniform(-0.3, 0.3, COLUMNS), terms, rest)


def point(rng, *, on_the_edge):
    """A point of the domain."""
    x = rng.uniform(-1, 1, VARIABLES)
    ball = x[BOX:] / np.linalg.norm(x[BOX:])
    x[BOX:] = ball * (1 if on_the_edge else rng.uniform())
    if on_the_edge:
        x[:BOX] = np.sign(x[:BOX])
    return x


def polynomial(model, column, x):
    """Value of a model's polynomial at a point, as a ball."""
    v = [arb(float(part)) for part in x]
    total = arb(float(model.c[column]))
    if model.terms is None:
        return total
    terms = model.terms[..., column]
    total += sum((arb(float(terms[0, i])) * v[i] for i in range(VARIABLES)), arb(0))
    pairs = ((i, j) for i in range(VARIABLES) for j in range(VARIABLES))
    return total + sum((arb(float(terms[1 + i, j])) * v[i] * v[j] for i, j in pairs), arb(0))


def contains(model, column, x, value):
    return abs(polynomial(model, column, x) - value) <= arb(float(model.rest[column]))


OPERATIONS = {
    "sum": (lambda a, b: a + b, lambda a, b: a + b),
    "difference": (lambda a, b: 2 - a - b, lambda a, b: 2 - a - b),
    "product": (lambda a, b: a * b, lambda a, b: a * b),
    "quotient": (lambda a, b: a / b, lambda a, b: a / b),
    "quotient by a negative": (lambda a, b: a / (-b), lambda a, b: a / (-b)),
    "root": (lambda a, b: a.sqrt() * b, lambda a, b: a.sqrt() * b),
    "sine": (lambda a, b: a.sin_cos()[0] * b, lambda a, b: a.sin() * b),
    "cosine": (lambda a, b: a.sin_cos()[1] - b, lambda a, b: a.cos() - b),
    "angle": (lambda a, b: (a - 1.2).atan2(b), lambda a, b: arb.atan2(a - arb(1.2), b)),
    "numbers": (lambda a, b: 3 * a - arb(1) / 3 * b + 1 / a, lambda a, b: 3 * a - arb(1) / 3 * b + 1 / a),
}


@pytest.mark.parametrize("name", OPERATIONS)
@pytest.mark.parametrize("bent", [False, True])
@pytest.mark.parametrize(("spread", "rest"), [(1e-9, 0.0), (1e-3, 1e-9), (0.04, 0.0), (0.04, 1e-3)])
def test_what_is_computed_holds_everywhere(name, spread, rest, bent):
    model_of, ball_of = OPERATIONS[name]
    rng = np.random.default_rng(7)
    a, b = (random_model(rng, middle, spread, rest, bent=bent) for middle in (1.4, 1.9))
    answer = model_of(a, b)
    for k in range(30):
        x, column = point(rng, on_the_edge=k % 2 == 0), k % COLUMNS
        # the operands stand for any numbers within their rests
        u, v = (polynomial(model, column, x) + arb(float(model.rest[column] * rng.choice([-1, 1]))) for model in (a, b))
        assert contains(answer, column, x, ball_of(u, v))


@pytest.mark.parametrize("name", OPERATIONS)
def test_what_is_left_out_is_of_third_degree(name):
    rests = []
    for spread in (0.02, 0.01):
        rng = np.random.default_rng(3)
        a, b = random_model(rng, 1.4, spread), random_model(rng, 1.9, spread)
        rests.append(OPERATIONS[name][0](a, b).rest)
    assert (rests[0] < 10 * rests[1]).all()


def test_what_cannot_be_computed_is_not_finite():
    rng = np.random.default_rng(0)
    with np.errstate(all="ignore"):
        near, safe = random_model(rng, 0.2, 0.2), random_model(rng, 1.4, 0.01)
        for answer in (safe / near, near.sqrt(), -safe.sqrt() + (-safe).sqrt(), near.atan2(near)):
            assert not np.isfinite(answer.rest).any()
            assert not (least(answer) > -np.inf).any()


@pytest.mark.parametrize("bent", [0.0, 0.05, 0.5, 5.0])
@pytest.mark.parametrize("seed", range(4))
def test_the_least_value_is_a_bound_and_close(seed, bent):
    rng = np.random.default_rng(seed)
    terms = no_terms(COLUMNS)
    terms[0] = rng.uniform(0.4, 1, (VARIABLES, COLUMNS)) * rng.choice([-1, 1], (VARIABLES, COLUMNS))
    square = bent * rng.uniform(-1, 1, (VARIABLES, VARIABLES, COLUMNS)) / VARIABLES
    terms[1:] = square + square.swapaxes(0, 1)
    model = Taylor.polynomial(rng.uniform(-1, 1, COLUMNS), terms, 0.0)
    bound = least(model)
    for column in range(COLUMNS):
        points = [point(rng, on_the_edge=k % 2 == 0) for k in range(200)] + [lowest_at(model, column)]
        met = min(float(polynomial(model, column, x)) for x in points)
        assert bound[column] <= met
        if bent <= 0.05:
            assert bound[column] >= met - 2 * bent**2 - 1e-12
