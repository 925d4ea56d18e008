from __future__ import annotations

import json
import re
import sys
from dataclasses import replace

import pytest

from zerorev.errors import InputError
from zerorev.model.plan import LostMotion
from zerorev.report.scene import replay
from zerorev.report.scene.replay import replay_page

pytest.importorskip("nicegui", reason="the replay takes three.js from NiceGUI (pip install 'zerorev[view]')")
NASTY = "</script><script>alert(1)</script><!-- & {{data}} '\"\u2028!"


def data_of(page):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)[1])


def renamed(plan, name):
    return replace(plan, name=name, holes=tuple(replace(a, hole=replace(a.hole, id=name)) for a in plan.holes[:1]))


def test_it_holds_the_holes_and_what_is_known_of_them(published):
    holes = data_of(replay_page(published))["holes"]
    assert [hole["id"] for hole in holes] == [answer.hole.id for answer in published.holes]
    assert [hole["verdict"] for hole in holes] == ["0 reversals"] * 3 + ["no motion"]
    assert [hole["motion"] is None for hole in holes] == [False] * 3 + [True]
    figures = {name: (planned, constant) for name, planned, constant in holes[0]["figures"]}
    assert figures["reversals"] == ("0", "6")
    assert figures["travel [deg]"] == ("107.1", "52.5")  # the thesis


def test_the_lost_motion_is_there_with_what_it_rests_on(published):
    assert data_of(replay_page(published))["note"] == ""
    weighed = replace(published.holes[0], lost_motion=LostMotion(0.0000674, 0.0001523))
    data = data_of(replay_page(replace(published, holes=(weighed, *published.holes[1:]))))
    figures, others = ({name: value for name, value, _ in hole["figures"]} for hole in data["holes"][:2])
    assert figures["lost motion at the tip [mm]"] == "0.067"
    assert figures["... with the legs swapped [mm]"] == "0.152"
    assert not any("lost" in name for name in others)
    assert "are guesses" in data["note"]
    assert "must let the tool turn" in data["note"]


def test_only_some_holes(published):
    wanted = published.holes[1].hole.id
    data = data_of(replay_page(published, [wanted]))
    assert [hole["id"] for hole in data["holes"]] == data["scene"]["ids"] == [wanted]


def test_it_asks_nothing_of_anyone(published):
    page = replay_page(published)
    markup = re.sub(r"data:text/javascript;base64,[A-Za-z0-9+/=]*", "", page)
    assert "http" not in re.sub(r"http-equiv", "", markup)
    assert "src=" not in markup.replace("script-src", "")
    assert "default-src 'none'" in markup


@pytest.mark.parametrize("where", ["hole", "tool", "robot", "findings"])
def test_what_users_write_stays_text(published, where):
    plan = renamed(published, "P")
    if where == "hole":
        plan = renamed(published, NASTY)
    elif where == "tool":
        plan = replace(plan, tool=replace(plan.tool, name=NASTY))
    elif where == "robot":
        plan = replace(plan, robot=replace(plan.robot, model=NASTY, manufacturer=""))
    else:
        from zerorev.model.finding import Finding

        answer = plan.holes[0]
        plan = replace(plan, holes=(replace(answer, findings=(Finding("info", "note", NASTY, "P"),)),))
    page = replay_page(plan)
    plain = replay_page(renamed(published, "P"))
    assert "alert(1)</script>" not in page
    assert "<!--" not in page
    for tag in ("<script", "</script", "<style", "<"):
        assert page.count(tag) == plain.count(tag), tag
    assert any(NASTY in text for text in _texts(data_of(page)))


def _texts(data):
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list):
        return [text for entry in data for text in _texts(entry)]
    return [data] if isinstance(data, str) else []


def test_unknown_holes_are_refused(published):
    with pytest.raises(InputError, match=r"no hole 'nix'.*accepted: "):
        replay_page(published, ["nix"])


def test_a_plan_without_motion_is_refused(published):
    with pytest.raises(InputError, match="no motion to replay"):
        replay_page(published, [published.holes[-1].hole.id])


def test_too_many_holes_are_refused(published, monkeypatch):
    monkeypatch.setattr(replay, "MOST_HOLES", 3)
    with pytest.raises(InputError, match=r"4 holes.*3 or less"):
        replay_page(published)


def test_many_holes_have_fewer_samples(published, monkeypatch):
    full = len(replay_page(published))
    monkeypatch.setattr(replay, "POINTS", 100)
    few = replay_page(published)
    assert len(few) < full
    assert data_of(few)["holes"][0]["motion"]["planned"]["reversals"] == 0


def test_without_nicegui_it_says_so(published, monkeypatch):
    monkeypatch.setitem(sys.modules, "nicegui", None)
    monkeypatch.setattr(replay, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"zerorev\[view\]"):
        replay_page(published)
