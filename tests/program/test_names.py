"""Names of programs and of their parts, in languages whose names are short."""

import pytest

from zerorev.program.letters import Comments
from zerorev.program.names import Names

SHORT = Names(8, capitals=True)


@pytest.mark.parametrize("name", ["PANEL", "PANELS", "PANEL_UP", "P", "A_B_C_D_"])
@pytest.mark.parametrize("number", [1, 9, 12, 345])
def test_the_name_of_a_part_fits(name, number):
    called = SHORT.part(name, number)
    assert SHORT.fits(called)
    assert called.endswith(f"_{number}")


def test_parts_of_two_programs_have_two_names():
    names = [f"PANEL_{letter}{other}" for letter in "ABCDEFGH" for other in "ABCDEFGH"]
    assert len({SHORT.part(name, 1) for name in names}) == len(names)


def test_a_narrow_comment_has_no_columns():
    narrow = Comments("!", 33, narrow=True)
    assert narrow.lines("a wing with a long name that is wrapped", first="Plan      ") == [
        "! Plan a wing with a long name",
        "!  that is wrapped",
    ]
    assert narrow.lines("one two", first="") == ["! one two"]
