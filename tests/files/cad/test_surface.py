"""Normals of the nearest triangle: as trying every triangle finds them, as near as the surface is fine, and flagged."""

from __future__ import annotations

import numpy as np
import pytest

from zerorev.files.cad.surface import FAR, normals_at


def grid(height, size=100.0, cells=20):
    """Triangles of z = height(x, y) over a square, normals upwards."""
    line = np.linspace(0, size, cells + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), height(x, y).ravel()])
    at = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = (each.ravel() for each in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    return vertices, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def nearest_by_samples(place, corners):
    """The least distance to points of each triangle: not nearer than it is, and a little further."""
    shares = np.array([(i, j, 60 - i - j) for i in range(61) for j in range(61 - i)]) / 60
    points = np.einsum("sk,mkd->msd", shares, corners)
    return np.linalg.norm(points - place, axis=2).min(axis=1)


def bump(x, y):
    return 5 * np.sin(x / 30) * np.cos(y / 40)


def test_the_nearest_triangle_is_that_of_all_tried():
    """Triangles of very different sizes, some slivers, at random."""
    rng = np.random.default_rng(1)
    corners = rng.uniform(-30, 30, (80, 1, 3)) + rng.normal(0, 1, (80, 3, 3)) * 10 ** rng.uniform(-1, 1.5, (80, 1, 1))
    vertices, faces = corners.reshape(-1, 3), np.arange(240).reshape(80, 3)
    places = rng.uniform(-25, 25, (60, 3))
    found = normals_at(places, vertices, faces)
    for n, place in enumerate(places):
        sampled = nearest_by_samples(place, corners)
        slack = np.linalg.norm(corners - corners.mean(axis=1)[:, None], axis=2).max() / 20
        if not np.isfinite(found.off[n]):
            assert sampled.min() > FAR - slack
            continue
        assert found.off[n] <= sampled.min() + 1e-9
        assert found.off[n] >= sampled.min() - slack
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = across / np.linalg.norm(across, axis=1)[:, None]
        likely = sampled <= found.off[n] + slack
        assert np.abs(normals[likely] - found.normals[n]).max(axis=1).min() < 1e-9


@pytest.mark.parametrize("cells", [10, 80])
def test_normals_are_as_near_as_the_bend_says(cells):
    vertices, faces = grid(bump, cells=cells)
    rng = np.random.default_rng(2)
    places = np.column_stack([rng.uniform(10, 90, (200, 2)), np.zeros(200)])
    places[:, 2] = bump(places[:, 0], places[:, 1])
    found = normals_at(places, vertices, faces)
    x, y = places[:, 0], places[:, 1]
    slope = (5 / 30 * np.cos(x / 30) * np.cos(y / 40), -5 / 40 * np.sin(x / 30) * np.sin(y / 40))
    true = np.column_stack([-slope[0], -slope[1], np.ones(200)])
    true /= np.linalg.norm(true, axis=1)[:, None]
    wrong = np.arccos(np.clip((true * found.normals).sum(axis=1), -1, 1))
    assert (wrong <= found.bend * 1.1 + 1e-3).all()
    assert np.rad2deg(wrong).max() < (1.0 if cells == 80 else 5.0)
    assert (np.rad2deg(found.bend) > 2).any() == (cells == 10)
    assert not found.at_edge.any()
    assert found.off.max() < 0.3


def test_edges_of_the_part_are_not_bends():
    """Two triangles of a plate, and its side: a place in the middle is sound, one at the rim is marked."""
    vertices = np.array([[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0], [0, 0, -10], [100, 0, -10]], dtype=float)
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 1], [4, 1, 0]])
    found = normals_at(np.array([[50.0, 30.0, 0.1], [50.0, 0.4, 0.0], [50.0, 30.0, 500.0]]), vertices, faces)
    assert np.array_equal(found.normals[:2], [[0, 0, 1], [0, 0, 1]])
    assert found.off[0] == pytest.approx(0.1)
    assert list(found.at_edge) == [False, True, False]
    assert list(found.bend) == [0, 0, 0]
    assert found.off[2] == np.inf
    assert np.isnan(found.normals[2]).all()


def test_vertices_need_not_be_shared():
    """As an STL file has them: three for each triangle."""
    vertices, faces = grid(bump)
    places = np.array([[33.0, 47.0, 3.0]])
    one = normals_at(places, vertices, faces)
    other = normals_at(places, vertices[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3))
    assert np.array_equal(one.normals, other.normals)
    assert one.bend[0] == other.bend[0] > 0


def test_a_hundred_thousand_triangles(record_property):
    import time

    vertices, faces = grid(bump, cells=224)
    places = np.column_stack([np.random.default_rng(3).uniform(5, 95, (2000, 2)), np.zeros(2000)])
    began = time.process_time()
    found = normals_at(places, vertices, faces)
    seconds = time.process_time() - began
    record_property("measured", f"normals at 2,000 places of {len(faces):,} triangles: {seconds:.1f} s")
    assert np.isfinite(found.off).all()
    assert seconds < 10
