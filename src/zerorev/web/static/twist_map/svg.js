// Small helpers that all parts of the map share.
const NS = "http://www.w3.org/2000/svg";

/** An SVG element with attributes, put into a parent. */
export function svg(parent, tag, attributes = {}, text = null) {
  const element = document.createElementNS(NS, tag);
  set(element, attributes);
  if (text !== null) element.textContent = text;
  parent?.appendChild(element);
  return element;
}

/** Set attributes; those that are null are taken away, and those that are so already are left alone: they cost a layout. */
export function set(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null) element.removeAttribute(name);
    else if (element.getAttribute(name) !== String(value)) element.setAttribute(name, value);
  }
  return element;
}

/** Write a text, if it is not there already. */
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** A number with so many digits, a real minus, and never -0. */
export function number(value, digits = 1) {
  const rounded = Number(value.toFixed(digits)) + 0;
  return rounded.toFixed(digits).replace("-", "−");
}

/** The same with its sign. */
export function signed(value, digits = 1) {
  const text = number(value, digits);
  return Number(value.toFixed(digits)) > 0 ? `+${text}` : text;
}

/** Places of labels moved apart as little as keeps them `gap` from each other. */
export function spreadOut(places, gap, low, high) {
  const order = places.map((_, n) => n).sort((a, b) => places[a] - places[b]);
  const blocks = [];
  for (const n of order) {
    blocks.push({ centre: places[n], members: [n] });
    while (blocks.length > 1) {
      const [below, above] = blocks.slice(-2);
      const size = below.members.length + above.members.length;
      if (above.centre - below.centre >= (gap * size) / 2) break;
      const centre = (below.centre * below.members.length + above.centre * above.members.length) / size;
      blocks.splice(-2, 2, { centre, members: [...below.members, ...above.members] });
    }
  }
  const out = new Array(places.length);
  for (const { centre, members } of blocks) {
    const half = (gap * (members.length - 1)) / 2;
    const middle = Math.min(Math.max(centre, low + half), high - half);
    members.forEach((n, k) => (out[n] = middle - half + gap * k));
  }
  return out;
}
