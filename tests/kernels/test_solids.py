"""Distances of solids: against the distances of an outside library, and against the check's own."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from zerorev.collision.arms import _solids
from zerorev.kernels import solids
from zerorev.kernels._jit import kernel
from zerorev.model.body import Box, Capsule, Mesh
from zerorev.verify.heaps import heap_of
from zerorev.verify.solids import nearest

SLOW = bool(numba.config.DISABLE_JIT)
CASES, FINE = (60, 8) if SLOW else (300, 40)  # uncompiled, the distance of two fine meshes takes seconds


@kernel
def _many(one, solid, Ts, other, obstacle, beyond, room, out):
    hint = np.full(2, -1)
    for k in range(Ts.shape[0]):
        out[k] = solids.between(one, solid, Ts[k], other, obstacle, beyond, room, hint)


def panel(n=FINE):
    x, y = np.linspace(0, 1.2, n), np.linspace(-0.6, 0.6, n)
    X, Y = np.meshgrid(x, y, indexing="ij")
    vertices = np.c_[X.ravel(), Y.ravel(), (0.05 * np.sin(3 * X) + 0.08 * Y**2).ravel()]
    i = np.arange(n * n).reshape(n, n)
    a, b, c, d = i[:-1, :-1].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel(), i[:-1, 1:].ravel()
    return Mesh(vertices, np.r_[np.c_[a, b, c], np.c_[a, c, d]].astype(np.int32))


CAPSULE = Capsule(np.array([[0.0, 0.0, -0.15], [0.0, 0.0, 0.15]]), 0.08)
BOX, BLOCK = Box(np.array([0.2, 0.1, 0.3])), Box(np.array([0.4, 0.3, 0.2]))
SHAPES = {"capsule": CAPSULE, "box": BOX, "mesh": panel(6 if SLOW else 12)}
OBSTACLES = {"block": BLOCK, "panel": panel()}


@pytest.fixture(scope="module")
def poses():
    rng = np.random.default_rng(0)
    q = rng.normal(size=(CASES, 4))
    w, x, y, z = (q / np.linalg.norm(q, axis=1)[:, None]).T
    R = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)  # fmt: skip
    place = np.c_[rng.uniform(-0.4, 1.2, CASES), rng.uniform(-0.6, 0.6, CASES), rng.uniform(-0.4, 0.6, CASES)]
    return R, place


def distances(shape, obstacle, poses, beyond=np.inf):
    R, place = poses
    both, out = _solids([shape, obstacle]), np.empty(CASES)
    Ts = np.ascontiguousarray(np.concatenate([R.reshape(CASES, 9), place], axis=1))
    _many(both, 0, Ts, both, 1, beyond, solids.room(), out)
    return out


@pytest.mark.parametrize("obstacle", OBSTACLES)
@pytest.mark.parametrize("shape", ["capsule", "box"])
def test_as_far_apart_as_an_outside_library_finds(shape, obstacle, poses):
    fcl = pytest.importorskip("fcl")

    def model(one):
        if isinstance(one, Capsule):
            return fcl.Capsule(one.radius, 0.3)
        if isinstance(one, Box):
            return fcl.Box(*one.size)
        found = fcl.BVHModel()
        found.beginModel(len(one.vertices), len(one.faces))
        found.addSubModel(one.vertices, one.faces)
        found.endModel()
        return found

    R, place = poses
    ours = distances(SHAPES[shape], OBSTACLES[obstacle], poses)
    moving, still = fcl.CollisionObject(model(SHAPES[shape])), fcl.CollisionObject(model(OBSTACLES[obstacle]))
    theirs = np.empty(CASES)
    for k in range(CASES):
        moving.setTransform(fcl.Transform(R[k], place[k]))
        theirs[k] = fcl.distance(moving, still, fcl.DistanceRequest(), fcl.DistanceResult())
    free = theirs > 0
    # the library stops within 1e-6 of its own answer, and finds a little too much
    assert ((ours > 0) == free).all()
    assert np.abs(ours - theirs)[free].max() < 2e-4
    assert (ours - theirs)[free].max() < 1e-9
    assert CASES / 30 < free.sum() < CASES * 29 / 30


@pytest.mark.parametrize("obstacle", OBSTACLES)
@pytest.mark.parametrize("shape", SHAPES)
def test_the_check_finds_the_same_distances_by_its_own_way(shape, obstacle, poses):
    R, place = poses
    heap, ours = heap_of([SHAPES[shape], OBSTACLES[obstacle]]), distances(SHAPES[shape], OBSTACLES[obstacle], poses)
    theirs = np.array([nearest(heap, 0, np.append(R[k].ravel(), place[k]), 1, np.inf) for k in range(CASES)])
    # the check sees surfaces: what is wholly inside a box touches nothing
    inside = (ours <= 0) & (theirs > 0)
    assert inside.sum() < CASES / 10
    apart = ours > 0
    assert np.abs(ours - theirs)[apart].max() < 1e-8
    assert (theirs[~apart & ~inside] <= 1e-9).all()


def test_a_bound_is_given_where_more_does_not_matter(poses):
    whole, cut = (distances(CAPSULE, panel(), poses, beyond) for beyond in (np.inf, 0.05))
    assert (cut == np.where(whole < 0.05, cut, 0.05)).all()
    free = whole > 0  # how deep solids are within each other has no meaning
    assert np.abs(cut - np.minimum(whole, 0.05))[free].max() < 1e-9
