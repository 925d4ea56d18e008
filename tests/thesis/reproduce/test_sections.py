"""What the sections say, against figures known from elsewhere; the whole page once, with few seeds."""

import re

import numpy as np
import pytest

from oracles.published import POSITIONS as KNOWN
from zerorev.thesis.reproduce import Context, fig26, reproduce, strokes, twist
from zerorev.thesis.reproduce.chapters import parts_of
from zerorev.thesis.reproduce.published import TRIALS
from zerorev.thesis.swarm import TABLE_3

CONTEXT = Context(seeds=2, map_size=12)


def columns(table):
    return {column.heading: [row[k] for row in table.rows] for k, column in enumerate(table.columns)}


def test_the_map_has_its_mirror_when_the_turns_are_chosen_for_the_whole_path():
    section = fig26.make(CONTEXT)
    (table,) = section.tables
    found = columns(table)["cells that differ from their mirror [%]"]
    assert found[0] == 0
    assert found[1] > 0.5
    example = section.results[1]
    assert "3 reversals and none can be run" in example.own  # as the thesis says in sec. 4.7
    assert "3 reversals and 3 reversals" in example.exact


def test_symmetry_chaining_and_drill_speed():
    section = twist.make(CONTEXT)
    mirror, chain, split, speed = map(columns, section.tables)
    assert mirror["reversals"] == [0] * 6
    travels = np.array(mirror["travel [deg]"]).reshape(3, 2)
    np.testing.assert_allclose(travels[:, 0], travels[:, 1], atol=1e-9)  # eq. 4.12
    np.testing.assert_allclose(travels[:, 0], [position.travel_deg for position in KNOWN], atol=0.06)
    assert chain["reversals"] == [0] * len(chain["hole"])
    assert chain["ψs [deg]"][1:] == chain["ψe [deg]"][:-1]  # eq. 4.13
    for n in range(3):
        published, twin, _, least = range(4 * n, 4 * n + 4)
        plunge, retract = split["|ψt − ψs|, plunge [deg]"], split["|ψe − ψt|, retract [deg]"]
        assert plunge[twin] == retract[published]
        assert plunge[least] <= min(plunge[published], plunge[twin]) + 1e-9
        assert split["reversals"][least] == 0
    # a plunge of 50 mm at 0.2 m/s takes 0.25 s
    assert speed["at 0.2 m/s (Appendix B) [rev/min]"][0] == pytest.approx(20.1034 / 360 / 0.25 * 60, rel=1e-4)


@pytest.mark.parametrize("deepest", [0.3, 21.9, 90.0, 199.9])
def test_bisection_and_steps_come_as_near_as_they_say(deepest):
    asked = []

    def succeeds(depth):
        asked.append(depth)
        return depth <= deepest

    found, tried = strokes.bisect(succeeds, 0.0, 200.0, 1.0)
    assert tried == len(asked) == 8  # eq. 4.10
    assert asked[0] == 100.0  # eq. 4.9
    assert found <= deepest < found + 1.0
    asked.clear()
    found, tried = strokes.step_down(succeeds, 200.0, 5.0)
    assert tried == len(asked)
    assert found <= deepest < found + 5.0


def test_every_trial_has_its_settings():
    assert [trial.number for trial in TRIALS] == list(TABLE_3)
    assert [trial.figure for trial in TRIALS] == list(range(12, 20))


@pytest.mark.long
def test_the_whole_chapter(tmp_path):
    page = reproduce("chapter4", tmp_path / "out", CONTEXT).read_text(encoding="utf-8")
    names = {path.stem for path in (tmp_path / "out" / "figures").iterdir()}
    assert {"fig_05", "fig_07", "fig_10", "fig_11", "fig_26", *(f"fig_{n}" for n in range(12, 20))} <= names
    assert {"table_1", "table_2", "table_3", "table_4"} <= {
        path.stem for path in (tmp_path / "out" / "tables").iterdir()
    }
    for part in parts_of("chapter4"):
        html = re.search(rf'<section id="{part.key}">(.*?)</section>', page, re.S).group(1)
        rows = re.findall(
            r'<td class="thesis">(.*?)<span class="where">(.*?)</span></td>\s*'
            r'<td class="own">(.*?)</td>(?:<td class="exact">(.*?)</td>)?',
            html,
            re.S,
        )
        assert rows, part.key
        for thesis, source, own, exact in rows:
            assert thesis
            assert source
            assert re.search(r"\d", own + exact), (part.key, own, exact)
    assert len(page) < 12e6
