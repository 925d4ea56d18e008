"""Sections are kept, taken up again, and made again when they are stale; the page is the same bytes every time."""

import re
from dataclasses import replace

import pytest

from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.errors import InputError
from zerorev.files.output import write_bytes
from zerorev.thesis.reproduce import CHAPTERS, PAGE, Context, chapters, kinematics, reproduce, twist
from zerorev.thesis.reproduce.chapters import Part
from zerorev.thesis.reproduce.section import Column, Picture, Result, Section, Table
from zerorev.thesis.reproduce.store import Store

CONTEXT = Context(seeds=2, map_size=6)


class Counted:
    """Cheap sections, how often each was made, and a fault that can be planted."""

    def __init__(self):
        self.made = []
        self.fault = None
        self.parts = tuple(
            Part(key, key.title(), "sec. 1", self.making(key, make))
            for key, make in (("kinematics", kinematics.make), ("twist", twist.make), ("last", kinematics.make))
        )

    def making(self, key, make):
        def made(context):
            if self.fault == key:
                raise KeyboardInterrupt
            self.made.append(key)
            return make(context)

        return made


@pytest.fixture
def counted(monkeypatch):
    found = Counted()
    monkeypatch.setitem(chapters.CHAPTERS, "chapter4", found.parts)
    return found


def test_resumes_after_an_interruption_and_ends_with_the_same_page(counted, tmp_path):
    whole = reproduce("chapter4", tmp_path / "whole", CONTEXT).read_bytes()
    counted.made, counted.fault = [], "last"
    with pytest.raises(KeyboardInterrupt):
        reproduce("chapter4", tmp_path / "broken", CONTEXT)
    assert not (tmp_path / "broken" / PAGE).exists()
    counted.fault = None
    again = reproduce("chapter4", tmp_path / "broken", CONTEXT).read_bytes()
    assert counted.made == ["kinematics", "twist", "last"]  # each once, the interruption notwithstanding
    assert again == whole
    assert reproduce("chapter4", tmp_path / "broken", CONTEXT).read_bytes() == whole
    assert counted.made == ["kinematics", "twist", "last"]


@pytest.mark.parametrize("other", [{"seeds": 3}, {"map_size": 7}])
def test_what_was_made_with_other_settings_is_made_again(counted, tmp_path, other):
    reproduce("chapter4", tmp_path / "out", CONTEXT)
    reproduce("chapter4", tmp_path / "out", replace(CONTEXT, **other))
    assert counted.made == ["kinematics", "twist", "last"] * 2


@pytest.mark.parametrize(
    "harm",
    [
        lambda out: (out / "sections" / "twist.json").write_text("{", encoding="utf-8"),
        lambda out: (out / "sections" / "twist.json").write_text('{"format": "zerorev.section/1"}', encoding="utf-8"),
        lambda out: (out / "sections" / "twist.json").write_text("[]", encoding="utf-8"),
        lambda out: (out / "figures" / "rotation_split.png").write_bytes(b"no picture"),
        lambda out: (out / "figures" / "rotation_split.png").unlink(),
        lambda out: (out / "tables" / "chain.csv").unlink(),
    ],
)
def test_a_damaged_section_is_made_again(counted, tmp_path, harm):
    page = reproduce("chapter4", tmp_path / "out", CONTEXT).read_bytes()
    harm(tmp_path / "out")
    counted.made = []
    assert reproduce("chapter4", tmp_path / "out", CONTEXT).read_bytes() == page
    assert counted.made == ["twist"]


def test_a_section_is_not_finished_before_its_figures_are(tmp_path, monkeypatch):
    store = Store(tmp_path / "out", CONTEXT)
    section = Section(("text",), (), (), (Picture("first", "", b"1"), Picture("second", "", b"2")))

    def stops(path, data):
        if path.stem == "second":
            raise KeyboardInterrupt
        write_bytes(path, data)

    store.write("part", section)
    monkeypatch.setattr("zerorev.thesis.reproduce.store.write_bytes", stops)
    with pytest.raises(KeyboardInterrupt):
        store.write("part", section)
    assert store.read("part") is None


def test_a_section_comes_back_as_it_was(tmp_path):
    table = Table("t", "caption", (Column("a", "mm", 2), Column("b")), ((1.25, "x"), (None, 3)))
    section = Section(
        ("one", "two"), (Result("w", "t", "s", "o", "", "r"),), (table,), (Picture("p", "c", b"\x00\xff"),)
    )
    store = Store(tmp_path / "out", CONTEXT)
    store.write("part", section)
    assert store.read("part") == section
    assert (tmp_path / "out" / "tables" / "t.csv").read_text(encoding="utf-8") == "a [mm],b\n1.25,x\n,3\n"


def test_the_page_asks_for_nothing_outside_of_itself(counted, tmp_path):
    page = reproduce("chapter4", tmp_path / "out", CONTEXT).read_text(encoding="utf-8")
    assert not re.search(r"https?:|//[a-z]|@import|url\(|<script|<link|<iframe", re.sub(r"base64,[^\"]*", "", page))
    sources = re.findall(r'(?:src|href)="([^"]{0,40})', page)
    assert sources
    assert all(source.startswith(("data:image/png;base64,", "#")) for source in sources)
    assert set(re.findall(r'href="#([^"]+)', page)) <= set(re.findall(r'id="([^"]+)', page))


def test_text_is_escaped(monkeypatch, tmp_path):
    evil = Section(("<b>&",), (Result("<i>", "t", "s", "o", "e", "r"),))
    monkeypatch.setitem(chapters.CHAPTERS, "chapter4", (Part("x", "X", "s", lambda context: evil),))
    page = reproduce("chapter4", tmp_path / "out", CONTEXT).read_text(encoding="utf-8")
    assert "&lt;b&gt;&amp;" in page
    assert "<i>" not in page


@pytest.mark.parametrize("chapter", ["chapter6", ""])
def test_a_chapter_that_is_not_there_is_refused_with_those_that_are(tmp_path, chapter):
    with pytest.raises(InputError, match=r"chapter4, chapter5, all"):
        reproduce(chapter, tmp_path / "out", CONTEXT)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("bad", [{"seeds": 1}, {"seeds": True}, {"seeds": 2.5}, {"map_size": 0}, {"map_size": 10**6}])
def test_numbers_that_cannot_be_used_are_refused(bad):
    with pytest.raises(InputError, match="whole number"):
        Context(**bad)


def test_the_command(counted, tmp_path, capsys):
    assert main(["reproduce", "chapter4", "-o", str(tmp_path / "out"), "--seeds", "2", "--map-size", "6"]) == cli.FINE
    assert str(tmp_path / "out" / PAGE) in capsys.readouterr().out
    counted.fault = "last"
    assert main(["reproduce", "chapter4", "-o", str(tmp_path / "two"), "--seeds", "2"]) == cli.INTERRUPTED
    assert "resumes" in capsys.readouterr().err
    assert main(["reproduce", "chapter6", "-o", str(tmp_path / "three")]) == cli.BAD_INPUT
    assert main(["reproduce", "all", "-o", str(tmp_path / "no" / "such")]) == cli.BAD_INPUT
    assert main(["reproduce", "all", "-o", str(tmp_path / "four"), "--seeds", "few"]) == cli.BAD_INPUT


@pytest.mark.long
def test_chapter_5(tmp_path):
    """In the virtual cell, few sets: the page names every figure, and stands by itself."""
    page = reproduce("chapter5", tmp_path / "out", Context(seeds=10)).read_text(encoding="utf-8")
    page = re.sub(r"data:image/png;base64,[^\"]*", "", page)
    for figure in (28, 32, 34, 35, 40, 44):
        assert f"{figure}" in page
    assert "position 3" in page
    assert not re.search(r"\bnan\b", page)
    assert len(list((tmp_path / "out" / "figures").glob("*.png"))) == 12


def test_all_is_what_there_is():
    assert chapters.parts_of("all") == tuple(part for parts in CHAPTERS.values() for part in parts)
    keys = [part.key for part in chapters.parts_of("all")]
    assert len(set(keys)) == len(keys)
