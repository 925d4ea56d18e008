"""Pages of HTML with figures: one file that needs no network."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

__all__ = ["embedded", "html_page", "picture"]

PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<style>body {{ font-family: sans-serif; margin: 1.5em auto; max-width: 1180px; color: #1a1a1a }} p {{ color: #5c5c5c }}
img {{ max-width: 100% }} table {{ border-collapse: collapse }} th {{ text-align: left; font-weight: normal }}
td, th {{ padding: 0.25em 1em; border-bottom: 1px solid #e4e4e4 }} td, thead th {{ text-align: right }}
</style>
{script}</head><body>
<h1>{title}</h1><p>{subtitle}</p>
{sections}
</body></html>
"""


def html_page(title: str, subtitle: str, sections: Sequence[tuple[str, str, str]], *, moving: bool = True) -> str:
    """A page that needs no network.

    Args:
        title: of the page.
        subtitle: a line below it.
        sections: heading, what to do, and contents as HTML, of each.
        moving: whether it has figures of plotly.
    """
    script = ""
    if moving:
        from plotly.offline import get_plotlyjs

        script = f"<script>{get_plotlyjs()}</script>"
    parts = (f"<h2>{html.escape(head)}</h2><p>{html.escape(hint)}</p>\n{contents}" for head, hint, contents in sections)
    return PAGE.format(
        title=html.escape(title), subtitle=html.escape(subtitle), script=script, sections="\n".join(parts)
    )


def picture(png: bytes, words: str) -> str:
    """A picture as part of a page.

    Args:
        png: its bytes.
        words: what it shows, for those who do not see it.
    """
    data = base64.b64encode(png).decode("ascii")
    return f'<img alt="{html.escape(words)}" src="data:image/png;base64,{data}">'


def embedded(figure: Figure) -> str:
    """A figure as part of a page."""
    from plotly.io import to_html

    text = to_html(figure, include_plotlyjs=False, full_html=False, auto_play=False)
    # slashes are escaped so that no tag can end early; none can where < is escaped, and cells of -1 are all slashes
    return str(text).replace("\\u002f", "/")
