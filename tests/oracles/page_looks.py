"""What a page looks like to a reader, found in the browser from what it computed: expressions in JavaScript."""

from __future__ import annotations

TEXTS = """
const texts = [...document.body.querySelectorAll("*")].map((element) => {
    const own = [...element.childNodes].filter((node) => node.nodeType === Node.TEXT_NODE);
    return { element, text: own.map((node) => node.textContent.trim()).join(" ").trim() };
}).filter(({ element, text }) => text && !element.closest("script, style, template, noscript")
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
