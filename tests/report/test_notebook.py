"""What a notebook shows of a plan: all of its text escaped, the first holes of many, findings, one picture."""

from __future__ import annotations

import base64
import io
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image

from zerorev.model import shown
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, LostMotion
from zerorev.report.figures.spin import spin_profile
from zerorev.report.notebook import ROWS

TAGS = {"div", "p", "b", "table", "thead", "tbody", "tr", "th", "td", "br", "pre", "img"}
NASTY = "<script>alert(1)</script>\"'&\x1b[31m\u202e"


class _Read(HTMLParser):
    """Tags, attributes and the text of each cell."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.tags, self.attributes, self.rows, self.text = [], [], [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_data(self, data):
        self.text += data
        if self.rows and self.rows[-1]:
            self.rows[-1][-1] += data


def test_the_table_says_what_the_plan_says(published):
    deep = replace(published.holes[0], deepest=0.0625)
    read = _Read(replace(published, holes=(deep, *published.holes[1:]))._repr_html_())
    head, first, _, _, lost = read.rows
    assert [part for part in head if "[" in part] == ["depth [mm]", "travel [deg]", "margin [mm]", "deepest [mm]"]
    score = published.holes[0].score
    before = published.holes[0].baseline.reversals
    travel = f"{np.rad2deg(score.travel):.1f}"
    assert first == ["position 1", "50", f"{before} → 0", travel, "12.5", "62.5", "no"]
    assert lost[:4] == ["far", "50", "infeasible", "–"]
    assert "plan of 4 holes, KUKA KR 6 R700-2, thesis_drill" in read.text


def test_the_lost_motion_is_there_with_what_it_rests_on(published):
    assert "guesses" not in _Read(published._repr_html_()).text
    weighed = replace(published.holes[0], lost_motion=LostMotion(0.0000674, 0.0001523))
    for answer in (weighed, replace(published, holes=(weighed, *published.holes[1:]))):
        read = _Read(answer._repr_html_())
        assert "lost motion(swapped) [mm]" in read.rows[0]
        assert read.rows[1][-2] == "0.067 (0.152)"
        assert all(len(row) == len(read.rows[0]) for row in read.rows)
        assert read.text.count("guesses") == read.text.count("a foot on the part") == 1


def test_the_picture_is_of_the_first_hole_that_has_a_motion(published):
    html = replace(published, holes=(published.holes[3], *published.holes[1:3]))._repr_html_()
    (data,) = re.findall(r'src="data:image/png;base64,([^"]+)"', html)
    with Image.open(io.BytesIO(base64.b64decode(data))) as image:
        assert image.size == (1200, 840)
    assert 'alt="Joint angles of hole position 2 along the motion"' in html


def test_without_matplotlib_there_is_no_picture(published, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    read = _Read(published._repr_html_())
    assert "img" not in read.tags
    assert len(read.rows) == 5


def test_every_text_is_escaped_and_visible(published, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    hole = published.holes[0]
    hole = replace(hole, hole=replace(hole.hole, id=NASTY), findings=(Finding("warning", "limit", NASTY, NASTY),))
    plan = replace(
        published, name=NASTY, holes=(hole,), findings=(Finding("error", "unfinished", NASTY),),
        tool=replace(published.tool, name=NASTY), robot=replace(published.robot, manufacturer=NASTY, model=NASTY),
    )  # fmt: skip
    for answer in (plan, hole):
        html = answer._repr_html_()
        read = _Read(html)
        assert set(read.tags) <= TAGS
        assert {name for name, _ in read.attributes} <= {"style"}
        assert read.text.count("<script>alert(1)</script>\"'&\\x1b[31m\\u202e") == html.count("&lt;script&gt;") >= 3
        assert "\x1b" not in html
        assert "\u202e" not in html


def test_the_picture_of_a_hole_with_a_nasty_name_ends_no_attribute(make_plan):
    read = _Read(make_plan(name='"><script>alert(1)</script>')._repr_html_())
    assert set(read.tags) <= TAGS
    assert {name for name, _ in read.attributes} == {"style", "src", "alt"}


def test_of_many_holes_the_first_are_shown_and_the_rest_counted(published, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    hole = published.holes[0]
    many = [replace(hole, hole=replace(hole.hole, id=f"h{n}")) for n in range(ROWS + 1234)]
    read = _Read(replace(published, holes=tuple(many))._repr_html_())
    assert [row[0] for row in read.rows[1:]] == [f"h{n}" for n in range(ROWS)]
    assert "and 1,234 more" in read.text
    read = _Read(replace(published, holes=tuple(many[:ROWS]))._repr_html_())
    assert "more" not in read.text


def test_findings_of_the_plan_its_holes_and_its_check_are_shown(published):
    hole = replace(published.holes[3], findings=(Finding("error", "unreachable", "no branch reaches it", "far"),))
    plan = replace(published, holes=(hole,), findings=(Finding("warning", "unfinished", "2 holes are missing"),))
    text = _Read(plan._repr_html_()).text
    assert re.search(r"error +unreachable +hole far: no branch reaches it\nwarning +unfinished +2 holes", text)


def test_depths_say_so(published):
    assert "depths of 4 holes" in _Read(replace(published, strokes="deepest")._repr_html_()).text


def test_one_hole_shows_its_spin(published):
    read = _Read(published.holes[0]._repr_html_())
    assert [row[0] for row in read.rows] == ["hole", "position 1"]
    assert ("alt", "Spin of hole position 1 along the motion") in read.attributes
    assert "img" not in _Read(published.holes[3]._repr_html_()).tags


def test_the_spin_is_the_planned_one_with_its_reversals(make_plan):
    # the five-point motion turns A6 round twice within the plunge
    hole = make_plan((50, 20, 0, 30, 50), (14, 4, -5.9, -15, -30)).holes[0]
    figure = spin_profile(hole)
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    np.testing.assert_allclose(lines["planned"].get_data(), [(0, 30, 50, 80, 100), (14, 4, -5.9, -15, -30)])
    x, y = lines["reversals"].get_data()
    expected = [50 - 1e3 * e.standoff if e.leg == "plunge" else 50 + 1e3 * e.standoff for e in hole.score.events]
    np.testing.assert_allclose(x, expected, atol=1e-9)
    assert len(x) == hole.score.reversals > 0
    assert np.all((y >= -30) & (y <= 14))
    assert "reversal of joint" in figure.legends[0].get_texts()[-1].get_text()


def test_a_model_alone_shows_nothing(monkeypatch, published):
    monkeypatch.setattr(shown, "_look", None)
    assert published._repr_html_() is None
    assert HolePlan._repr_html_(published.holes[0]) is None


@pytest.mark.parametrize("n", [0, 3])
def test_a_plan_without_a_motion_has_no_picture(published, n):
    read = _Read(replace(published, holes=published.holes[3:][:n])._repr_html_())
    assert "img" not in read.tags
    assert "0 holes" in read.text or "1 hole," in read.text
