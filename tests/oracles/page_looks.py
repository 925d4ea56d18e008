"""What a page looks like to a reader, found in the browser from what it computed: expressions in JavaScript."""

from __future__ import annotations

TEXTS = """
const texts = [...document.body.querySelectorAll("*")].map((element) => {
    const own = [...element.childNodes].filter((node) => node.nodeType === Node.TEXT_NODE);
    return { element, text: own.map((node) => node.textContent.trim()).join(" ").trim() };
}).filter(({ element, text }) => text && !element.closest(
        "script, style, template, noscript, .ag-aria-description-container") // the last is for readers of the screen
    && element.checkVisibility({ opacityProperty: true, visibilityProperty: true }));
const named = (element, text) =>
    `${element.closest("[data-testid]")?.dataset.testid ?? ""} ${element.className} "${text}"`;
"""

# Texts whose contrast to what is behind them is below WCAG 2.2, 1.4.3 (AA): 4.5, or 3 for large letters. What is
# switched off is exempt there, and what lies on a picture has no single ground. -> ["ratio, which, colours"]
FAINT = (
    """() => {"""
    + TEXTS
    + """
const dot = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
const rgba = (colour) => {
    dot.clearRect(0, 0, 1, 1); dot.fillStyle = colour; dot.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = dot.getImageData(0, 0, 1, 1).data;
    return [r, g, b, a / 255];
};
const over = (top, ground) => ground.map((value, k) => top[3] * top[k] + (1 - top[3]) * value);
const luminance = (rgb) => {
    const [r, g, b] = rgb.map((value) => (value /= 255) <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const above = (element) => element ? [element, ...above(element.parentElement)] : [];
const ground = (element) => above(element).map((each) => rgba(getComputedStyle(each).backgroundColor))
    .reverse().reduce((under, top) => over(top, under), [255, 255, 255]);
return texts.filter(({ element }) => !element.closest("svg, .disabled, [disabled], [aria-disabled=true]")).flatMap(
    ({ element, text }) => {
        const style = getComputedStyle(element), under = ground(element), ink = rgba(style.color);
        for (const each of above(element)) ink[3] *= Number(getComputedStyle(each).opacity);
        const [light, dark] = [luminance(over(ink, under)), luminance(under)].sort((a, b) => b - a);
        const ratio = (light + 0.05) / (dark + 0.05), size = parseFloat(style.fontSize);
        const large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
        if (ratio >= (large ? 3 : 4.5)) return [];
        return [`${ratio.toFixed(2)} ${named(element, text)} ${style.color} on ${under.map(Math.round)}`];
    });
}"""
)

# Texts that are not in full view where they stand: cut by their own box or by a box around them that cannot be
# scrolled, or shortened by an ellipsis. -> ["which"]
CUT = (
    """() => {"""
    + TEXTS
    + """
const typed = "input:not([type=file], [type=range], .q-select__focus-target), textarea";
const fields = [...document.querySelectorAll(typed)].filter((field) => field.value
    && field.checkVisibility({ visibilityProperty: true }) && field.scrollWidth > field.clientWidth + 1);
const boxes = (element) => {
    const range = document.createRange();
    range.selectNodeContents(element);
    return element.closest("svg") ? [element.getBoundingClientRect()] : [...range.getClientRects()];
};
const beyond = (inner, outer, side) => side === "x"
    ? inner.left < outer.left - 1 || inner.right > outer.right + 1
    : inner.top < outer.top - 1.5 || inner.bottom > outer.bottom + 1.5;
const clips = (value) => value === "hidden" || value === "clip";
const whole = (element) => {
    const own = getComputedStyle(element);
    if (!element.closest("svg") && clips(own.overflowX) && element.scrollWidth > element.clientWidth + 1) return false;
    if (own.webkitLineClamp !== "none" && element.scrollHeight > element.clientHeight + 1) return false;
    let across = true, down = true; // until a box that can be scrolled
    const all = boxes(element).filter((box) => box.width > 0);
    for (let each = element.parentElement; each && (across || down); each = each.parentElement) {
        const style = getComputedStyle(each), frame = each.getBoundingClientRect();
        if (across && clips(style.overflowX) && all.some((box) => beyond(box, frame, "x"))) return false;
        if (down && clips(style.overflowY) && all.some((box) => beyond(box, frame, "y"))) return false;
        across &&= !["auto", "scroll"].includes(style.overflowX);
        down &&= !["auto", "scroll"].includes(style.overflowY);
    }
    return true;
};
return [...texts.filter(({ element }) => !whole(element)).map(({ element, text }) => named(element, text)),
    ...fields.map((field) => named(field, field.value))];
}"""
)
