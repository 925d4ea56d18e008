// The motion over the plane: its legs with their handles, its reversals, and where it cannot be run.
import { number, set, signed, svg, write } from "./svg.js";

export const NAMES = { start: "start", target: "target", end: "end", inner: "inner point" };
const TOGETHER = 30; // [px]
const LABEL = 90; // [px] that the label of an end or of the target takes beside it
const SHAPES = {
  start: "M7 0A7 7 0 1 1 -7 0A7 7 0 1 1 7 0Z",
  target: "M0 -9.5L9.5 0L0 9.5L-9.5 0Z",
  end: "M-6.5 -6.5H6.5V6.5H-6.5Z",
  inner: "M5.2 0A5.2 5.2 0 1 1 -5.2 0A5.2 5.2 0 1 1 5.2 0Z",
};

export class Legs {
  constructor(plane, root) {
    this.plane = plane;
    this.points = []; // {standoff [mm], psi [deg]} in order of motion
    this.motion = null;
    this.labels = []; // of the handles: {x [px], up: above the leg}
    this.cursor = null;
    this.back = svg(root, "g", { "clip-path": plane.clipped });
    this.baseline = svg(this.back, "path", { class: "zr-tw-baseline" });
    this.baselineText = svg(this.back, "text", { class: "zr-tw-baseline-text", "text-anchor": "end" });
    this.cursorLine = svg(this.back, "path", { class: "zr-tw-cursor" });
    const legs = svg(root, "g", { "clip-path": plane.clipped });
    this.casing = svg(legs, "path", { class: "zr-tw-leg-casing" });
    this.leg = svg(legs, "path", { class: "zr-tw-leg" });
    this.faults = svg(legs, "path", { class: "zr-tw-fault", "data-testid": "fault" });
    this.arrows = svg(legs, "path", { class: "zr-tw-arrow" });
    this.hits = ["plunge", "retract"].map((name) =>
      svg(root, "path", {
        class: "zr-tw-hit", "data-leg": name, "data-testid": `leg-${name}`, tabindex: 0, role: "button",
        "aria-label": `${name} leg: press Insert, or double-click, to add a point`,
      }),
    );
    this.handles = svg(root, "g");
    this.nearest = null; // {x [mm], psi [deg], low}: where the motion comes nearest to what stands around
    this.nearestMark = svg(root, "circle", { class: "zr-tw-nearest", r: 14, "data-testid": "nearest-mark" });
    this.marks = svg(root, "g");
  }

  get corner() {
    let least = 0;
    this.points.forEach((point, n) => {
      if (point.standoff < this.points[least].standoff) least = n;
    });
    return least;
  }

  kind(n) {
    if (n === 0) return "start";
    if (n === this.points.length - 1) return "end";
    return n === this.corner ? "target" : "inner";
  }

  /** Signed path distance from the corner [mm] of a point. */
  distance(n) {
    const corner = this.corner;
    const away = this.points[n].standoff - this.points[corner].standoff;
    return n < corner ? -away : away;
  }

  /** Spin [deg] of the motion at a signed path distance [mm]. */
  psiAt(distance) {
    const xs = this.points.map((_, n) => this.distance(n));
    let n = 0;
    while (n < xs.length - 2 && xs[n + 1] < distance) n++;
    const share = Math.min(Math.max((distance - xs[n]) / (xs[n + 1] - xs[n] || 1), 0), 1);
    return this.points[n].psi + share * (this.points[n + 1].psi - this.points[n].psi);
  }

  /** The path of the motion between two signed distances [mm]. */
  path(from = -Infinity, to = Infinity) {
    const xs = this.points.map((_, n) => this.distance(n));
    const first = Math.max(from, xs[0]);
    const last = Math.min(to, xs[xs.length - 1]);
    const stops = [first, ...xs.filter((x) => x > first && x < last), last];
    return stops.map((x, n) => `${n ? "L" : "M"}${this.plane.x(x).toFixed(1)} ${this.plane.y(this.psiAt(x)).toFixed(1)}`).join("");
  }

  draw() {
    const there = this.points.length > 2;
    for (const each of [this.casing, this.leg, this.arrows, this.baseline, this.baselineText, ...this.hits]) {
      each.style.display = there ? "" : "none";
    }
    if (!there) {
      this.handles.replaceChildren();
      this.marks.replaceChildren();
      this.faults.setAttribute("d", "");
      this.nearestMark.style.display = "none";
      return;
    }
    const d = this.path();
    for (const each of [this.casing, this.leg]) set(each, { d });
    set(this.hits[0], { d: this.path(-Infinity, 0) });
    set(this.hits[1], { d: this.path(0, Infinity) });
    this.drawArrows();
    this.drawBaseline();
    this.drawHandles();
    this.drawMotion();
    this.drawCursor();
  }

  drawArrows() {
    const half = this.plane.reach / 2;
    this.arrows.setAttribute("d", [-half, half].map((at) => {
      const [x, y] = [this.plane.x(at), this.plane.y(this.psiAt(at))];
      const [u, v] = [this.plane.x(at + 0.5) - this.plane.x(at - 0.5), this.plane.y(this.psiAt(at + 0.5)) - this.plane.y(this.psiAt(at - 0.5))];
      const k = 7 / Math.hypot(u, v);
      const [a, b] = [u * k, v * k];
      return `M${x + a} ${y + b}L${x - a - b * 0.7} ${y - b + a * 0.7}L${x - a + b * 0.7} ${y - b - a * 0.7}Z`;
    }).join(""));
  }

  drawBaseline() {
    const y = this.plane.y(this.points[0].psi);
    const { left, right } = this.plane.box;
    set(this.baseline, { d: `M${left} ${y}H${right}` });
    const count = this.motion?.baseline;
    const says = count === undefined ? "" : count === null ? ": cannot be run" : `: ${count} reversal${count === 1 ? "" : "s"}`;
    set(this.baselineText, { x: right - 8, y: y - 6 });
    write(this.baselineText, `constant spin${says}`);
  }

  drawHandles() {
    const kinds = this.points.map((_, n) => this.kind(n));
    const names = kinds.map((kind, n) => (kind === "inner" ? `inner-${n}` : kind));
    const now = [...this.handles.children];
    if (now.length !== names.length || now.some((each, n) => each.dataset.testid !== `handle-${names[n]}`)) {
      this.handles.replaceChildren(...names.map((name, n) => this.makeHandle(name, kinds[n], n)));
    }
    this.labels = [];
    this.points.forEach((point, n) => {
      const [x, y] = [this.plane.x(this.distance(n)), this.plane.y(point.psi)];
      const handle = this.handles.children[n];
      set(handle, {
        transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})`, "aria-valuenow": point.psi.toFixed(2),
        "aria-valuetext": `${number(point.psi, 2)} degrees of spin at ${number(point.standoff, 1)} millimetres of stand-off`,
      });
      const text = handle.lastChild;
      const beside = this.points[n + (n > 0 && n === this.points.length - 1 ? -1 : 1)];
      const up = beside.psi <= point.psi;
      if (kinds[n] !== "inner") this.labels.push({ x, up });
      const edge = n === 0 ? "start" : n === this.points.length - 1 ? "end" : "start";
      set(text, { x: edge === "end" ? -10 : 11, y: up ? -11 : 21, "text-anchor": edge });
      write(text, kinds[n] === "inner" ? `${number(point.psi, 1)}°` : `${kinds[n]} ${signed(point.psi, 1)}°`);
    });
  }

  makeHandle(name, kind, n) {
    const handle = svg(null, "g", {
      class: `zr-tw-handle zr-tw-handle-${kind}`, "data-testid": `handle-${name}`, "data-index": n, tabindex: 0, role: "slider",
      "aria-orientation": "vertical", "aria-valuemin": -720, "aria-valuemax": 720, "aria-label": `${NAMES[kind]}: spin`,
    });
    svg(handle, "circle", { r: 17, class: "zr-tw-grip" });
    svg(handle, "path", { d: SHAPES[kind], class: "zr-tw-knob" });
    svg(handle, "text", { class: "zr-tw-label" });
    return handle;
  }

  drawMotion() {
    const faults = this.motion?.faults ?? [];
    this.faults.setAttribute("d", faults.map(({ start, end }) => {
      const least = 0.004 * this.plane.reach; // so that a point is seen, too
      return this.path(Math.min(start, end - least), Math.max(end, start + least));
    }).join(""));
    this.drawNearest();
    const marks = this.motion?.marks ?? [];
    while (this.marks.children.length > marks.length) this.marks.lastChild.remove();
    while (this.marks.children.length < marks.length) {
      const mark = svg(this.marks, "g", { class: "zr-tw-mark", "data-testid": "reversal-mark", role: "img" });
      svg(mark, "path", { d: "M-5 -5L5 5M-5 5L5 -5", class: "zr-tw-mark-casing" });
      svg(mark, "path", { d: "M-5 -5L5 5M-5 5L5 -5", class: "zr-tw-mark-ink" });
      svg(mark, "text", { class: "zr-tw-label" });
    }
    let last = null; // reversals close together share one line of names
    const lines = [];
    marks.forEach((mark, n) => {
      const element = this.marks.children[n];
      const [x, y] = [this.plane.x(mark.x), this.plane.y(this.psiAt(mark.x))];
      set(element, { transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})`, "aria-label": `${mark.name} reverses here`, "data-joint": mark.joint });
      if (last === null || x - last > TOGETHER) lines.push({ text: element.lastChild, x, leg: mark.leg, names: new Map() });
      else this.name(element.lastChild, new Map());
      last = x;
      lines[lines.length - 1].names.set(mark.name, mark);
    });
    for (const { text, x, leg, names } of lines) {
      // out of the way of a handle's own label
      const beside = this.labels.find((label) => Math.abs(label.x - x) < LABEL && label.up);
      set(text, { x: -8, y: leg === "target" || beside ? 21 : -9, "text-anchor": "end" });
      this.name(text, names);
    }
  }

  drawNearest() {
    const near = this.nearest;
    const there = near && Math.abs(near.x) <= this.plane.reach + 0.01;
    this.nearestMark.style.display = there ? "" : "none";
    if (!there) return;
    set(this.nearestMark, {
      cx: this.plane.x(near.x).toFixed(1), cy: this.plane.y(this.psiAt(near.x)).toFixed(1),
      class: near.low ? "zr-tw-nearest low" : "zr-tw-nearest",
    });
  }

  /** Write names of joints in their colours. */
  name(text, names) {
    const line = [...names.keys()].join(" ");
    if (text.textContent === line) return;
    text.replaceChildren();
    for (const [name, { colour, ink }] of names) {
      const style = `--colour: ${colour}; --ink: ${ink}`;
      svg(text, "tspan", { class: "zr-tw-mark-name", style }, text.firstChild ? ` ${name}` : name);
    }
  }

  drawCursor() {
    const { top, bottom } = this.plane.box;
    const at = this.cursor;
    const there = at !== null && this.points.length > 2;
    this.cursorLine.setAttribute("d", there ? `M${this.plane.x(at)} ${top}V${bottom}` : "");
  }
}
