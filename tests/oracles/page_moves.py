"""A drag of the twist map as the hand of a user makes it, and how soon it is answered; in JavaScript."""

from __future__ import annotations

# a mouse says where it is 60 times a second, however busy the page is; the driver's own would wait for each to be drawn
MOVES = """async ([x, y, reach, moves]) => {
    const map = document.querySelector('[data-testid="twist-map"] svg[role="group"]');
    for (let n = 1; n <= moves; n++) {
        const clientY = y + reach * Math.sin(n / moves * 7.5 * Math.PI);
        map.dispatchEvent(new PointerEvent("pointermove", { clientX: x, clientY, pointerId: 1, bubbles: true }));
        await new Promise((after) => setTimeout(after, 16));
    }
}"""
DRAWN = """window.drawn = []; window.addEventListener("zerorev-drawn", (event) => window.drawn.push(event.detail))"""
