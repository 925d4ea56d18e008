// The plane behind the legs: twist spread, zones, the lines where spin does not move a joint, and the axes.
import { number, set, spreadOut, svg } from "./svg.js";

const MARGIN = { left: 54, right: 40, top: 24, bottom: 42 };
const TURN = 360;
const ZONES = ["open", "near-singular", "over a joint limit", "out of reach"];
const SINGULAR = ["shoulder", "elbow", "wrist"];
const CLASSES = ["", "near", "limited", "unreached"];
const NAME = { width: 52, height: 13 }; // [px]
let made = 0;

const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

/** The point of a curve [distance, spin, ...] that is nearest to a distance. */
function nearest(points, distance) {
  let best = 0;
  for (let n = 0; n < points.length; n += 2) {
    if (Math.abs(points[n] - distance) < Math.abs(points[best] - distance)) best = n;
  }
  return [points[best], points[best + 1]];
}

export class Plane {
  constructor(root, canvas) {
    this.canvas = canvas;
    this.data = null;
    this.low = -180; // spins that are shown [deg]
    this.high = 180;
    this.reach = 50; // path distance on either side [mm]
    this.key = `zr-tw-${++made}`; // patterns are found by an id that is the page's alone
    this.width = this.height = 0;
    const defs = svg(root, "defs");
    const hatch = svg(defs, "pattern", {
      id: `${this.key}-unreached`, width: 9, height: 9, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)",
    });
    svg(hatch, "rect", { width: 9, height: 9, class: "zr-tw-unreached-ground" });
    svg(hatch, "rect", { width: 1.1, height: 9, class: "zr-tw-unreached-ink" });
    const dots = svg(defs, "pattern", { id: `${this.key}-limited`, width: 8, height: 8, patternUnits: "userSpaceOnUse" });
    svg(dots, "rect", { width: 8, height: 8, class: "zr-tw-limited-ground" });
    for (const at of [2, 6]) svg(dots, "circle", { cx: at, cy: at, r: 1.15, class: "zr-tw-limited-ink" });
    const cross = svg(defs, "pattern", {
      id: `${this.key}-near`, width: 7, height: 7, patternUnits: "userSpaceOnUse", patternTransform: "rotate(-45)",
    });
    svg(cross, "rect", { width: 1.6, height: 7, class: "zr-tw-near-ink" });
    svg(cross, "rect", { width: 7, height: 1.6, class: "zr-tw-near-ink" });
    const bars = svg(defs, "pattern", { id: `${this.key}-tight`, width: 6, height: 6, patternUnits: "userSpaceOnUse" });
    svg(bars, "rect", { width: 6, height: 6, class: "zr-tw-tight-ground" });
    svg(bars, "rect", { width: 6, height: 1.4, class: "zr-tw-tight-ink" });
    this.clip = svg(svg(defs, "clipPath", { id: `${this.key}-clip` }), "rect");
    this.inside = svg(root, "g", { "clip-path": `url(#${this.key}-clip)` });
    this.zones = svg(this.inside, "g");
    this.zone = null; // where the clearance is not kept
    this.zoneShapes = svg(this.inside, "g");
    this.tight = true; // whether it is drawn
    this.lines = svg(this.inside, "g");
    this.loads = svg(this.inside, "g");
    this.loaded = false; // whether they are drawn
    this.senses = null; // which ways the joints of the motion turn, by leg; null: there is no motion
    this.clipped = `url(#${this.key}-clip)`;
    this.axes = svg(root, "g", { class: "zr-tw-axes", "aria-hidden": "true" });
  }

  x(distance) {
    return MARGIN.left + ((distance + this.reach) / (2 * this.reach)) * this.innerWidth;
  }

  y(psi) {
    return MARGIN.top + ((this.high - psi) / (this.high - this.low)) * this.innerHeight;
  }

  distanceAt(x) {
    return ((x - MARGIN.left) / this.innerWidth) * 2 * this.reach - this.reach;
  }

  psiAt(y) {
    return this.high - ((y - MARGIN.top) / this.innerHeight) * (this.high - this.low);
  }

  get innerWidth() {
    return Math.max(this.width - MARGIN.left - MARGIN.right, 1);
  }

  get innerHeight() {
    return Math.max(this.height - MARGIN.top - MARGIN.bottom, 1);
  }

  get box() {
    return { left: MARGIN.left, top: MARGIN.top, right: MARGIN.left + this.innerWidth, bottom: MARGIN.top + this.innerHeight };
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
  }

  show(data) {
    this.data = data && {
      ...data, spread: bytes(data.spread), zone: bytes(data.zone), limited: bytes(data.limited),
      singular: bytes(data.singular), best: bytes(data.best),
    };
    this.image = this.zone = null;
  }

  /** Where the clearance is not kept on the map that is shown, or null. */
  showZone(data) {
    this.zone = data && { ...data, near: bytes(data.near) };
    this.drawZone();
  }

  /** Show spins around a middle, so many on either side [deg]. */
  look(middle, half) {
    this.low = middle - half;
    this.high = middle + half;
  }

  draw() {
    if (this.width < 10 || this.height < 10) return;
    const box = this.box;
    set(this.clip, { x: box.left, y: box.top, width: this.innerWidth, height: this.innerHeight });
    this.zones.replaceChildren();
    this.lines.replaceChildren();
    this.axes.replaceChildren();
    this.drawImage();
    if (this.data) {
      this.drawZones();
      this.drawLines();
    }
    this.drawZone();
    this.drawLoads();
    this.drawAxes();
  }

  /** Whole turns by which the map, from -180 to 180 deg, is shifted to fill what is shown. */
  get turns() {
    const first = Math.floor((this.low + TURN / 2) / TURN);
    const last = Math.floor((this.high + TURN / 2) / TURN);
    return Array.from({ length: last - first + 1 }, (_, n) => (first + n) * TURN);
  }

  drawImage() {
    const ratio = window.devicePixelRatio || 1;
    const canvas = this.canvas;
    canvas.width = Math.round(this.width * ratio);
    canvas.height = Math.round(this.height * ratio);
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    const box = this.box;
    const colours = getComputedStyle(canvas);
    const ground = colours.getPropertyValue("--zr-surface").trim() || "#ffffff";
    context.fillStyle = ground;
    context.fillRect(box.left, box.top, this.innerWidth, this.innerHeight);
    if (!this.data) return;
    const ink = colours.getPropertyValue("--zr-tw-field").trim() || "#647690";
    if (!this.image || this.image.key !== ground + ink) this.image = this.makeImage(ground, ink);
    context.save();
    context.beginPath();
    context.rect(box.left, box.top, this.innerWidth, this.innerHeight);
    context.clip();
    for (const turn of this.turns) {
      const top = this.y(turn + TURN / 2);
      context.drawImage(this.image.canvas, box.left, top, this.innerWidth, this.y(turn - TURN / 2) - top);
    }
    context.restore();
  }

  makeImage(ground, ink) {
    const dot = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    const rgb = (colour) => {
      dot.fillStyle = colour;
      dot.fillRect(0, 0, 1, 1);
      return [...dot.getImageData(0, 0, 1, 1).data];
    };
    const [from, to] = [rgb(ground), rgb(ink)];
    const [S, P] = this.data.shape;
    const canvas = document.createElement("canvas");
    canvas.width = 2 * S - 1;
    canvas.height = P;
    const pixels = new ImageData(canvas.width, canvas.height);
    for (let p = 0; p < P; p++) {
      for (let c = 0; c < canvas.width; c++) {
        const level = this.data.spread[Math.abs(c - S + 1) * P + p];
        const share = level === 255 ? 0 : 0.05 + (0.95 * level) / 254;
        const at = 4 * ((P - 1 - p) * canvas.width + c);
        for (let k = 0; k < 3; k++) pixels.data[at + k] = from[k] + share * (to[k] - from[k]);
        pixels.data[at + 3] = 255;
      }
    }
    canvas.getContext("2d").putImageData(pixels, 0, 0);
    return { canvas, key: ground + ink };
  }

  /** The path of curves [distance, spin, ...], on both sides of the target and in every turn that is shown. */
  path(curves, close, sides = [1, -1]) {
    let d = "";
    for (const turn of this.turns) {
      for (const side of sides) {
        for (const points of curves) {
          for (let n = 0; n < points.length; n += 2) {
            const x = this.x(side * points[n]).toFixed(1);
            d += `${n ? "L" : "M"}${x} ${this.y(points[n + 1] + turn).toFixed(1)}`;
          }
          if (close) d += "Z";
        }
      }
    }
    return d;
  }

  drawZones() {
    for (const region of this.data.regions) {
      if (!region.rings.length) continue;
      const name = CLASSES[region.zone];
      svg(this.zones, "path", {
        d: this.path(region.rings, true), fill: `url(#${this.key}-${name})`, "fill-rule": "evenodd",
        "data-zone": ZONES[region.zone],
      });
      svg(this.zones, "path", { d: this.path(region.edges, false), class: `zr-tw-edge zr-tw-${name}-edge` });
    }
  }

  drawZone() {
    this.zoneShapes.replaceChildren();
    if (!this.data || !this.zone || !this.tight) return;
    const { rings, edges } = this.zone;
    svg(this.zoneShapes, "path", {
      d: this.path(rings, true), fill: `url(#${this.key}-tight)`, "fill-rule": "evenodd", "data-testid": "tight",
    });
    svg(this.zoneShapes, "path", { d: this.path(edges, false), class: "zr-tw-edge zr-tw-tight-edge" });
  }

  drawLines() {
    const ends = [];
    for (const line of this.data.lines) {
      const joint = this.data.joints[line.joint - 1];
      const d = this.path([line.points], false);
      svg(this.lines, "path", { d, class: "zr-tw-casing" });
      svg(this.lines, "path", {
        d, class: "zr-tw-line", stroke: joint.colour, "stroke-dasharray": joint.dash.join(" ") || null,
        "data-joint": joint.name,
      });
      const n = line.points.length;
      for (const at of [0, n - 2]) {
        if (this.reach - line.points[at] > 0.02 * this.reach) continue;
        for (const turn of this.turns) ends.push({ psi: line.points[at + 1] + turn, joint });
        break;
      }
    }
    const shown = ends.filter((end) => end.psi >= this.low && end.psi <= this.high);
    const { top, bottom, right } = this.box;
    const places = spreadOut(shown.map((end) => this.y(end.psi)), 13, top + 5, bottom - 3);
    shown.forEach(({ joint }, n) => {
      svg(this.axes, "text", { x: right + 6, y: places[n] + 4, class: "zr-tw-joint", "data-joint": joint.name,
        style: `--colour: ${joint.colour}; --ink: ${joint.ink}` }, joint.name);
    });
  }

  /** The joints of the motion turn otherwise than before: other curves are those of their loads. */
  turning(senses) {
    if (JSON.stringify(senses) === JSON.stringify(this.senses)) return;
    this.senses = senses;
    this.drawLoads();
  }

  /** Where the loads change their sign, on the legs on which the joints turn that way. */
  drawLoads() {
    this.loads.replaceChildren();
    if (!this.data || !this.loaded) return;
    const names = [];
    for (const line of this.data.loads) {
      const legs = line.legs.filter((leg) => !this.senses || this.senses[leg][line.joint - 1].includes(line.sense));
      if (!legs.length) continue;
      const joint = this.data.joints[line.joint - 1];
      const sides = legs.map((leg) => (leg === "plunge" ? -1 : 1));
      const d = this.path([line.points], false, sides);
      svg(this.loads, "path", { d, class: "zr-tw-load-casing" });
      svg(this.loads, "path", { d, class: "zr-tw-load", stroke: joint.colour, "data-joint": joint.name, "data-level": line.level });
      names.push({ line, joint, sides });
    }
    const taken = [];
    names.forEach((each) => this.nameLoad(each, taken));
  }

  /** Joint and share of friction, on the curve, in the first place with room. */
  nameLoad({ line, joint, sides }, taken) {
    const text = `${joint.name} ${line.level}`;
    const room = (other) => (other.text === text ? 0.4 * this.innerWidth : NAME.width); // once along a curve in pieces
    for (const turn of this.turns) {
      for (const side of sides) {
        for (const share of [0.7, 0.4, 0.95, 0.15]) {
          const [distance, psi] = nearest(line.points, share * this.reach);
          const [x, y] = [this.x(side * distance), this.y(psi + turn) + 4];
          const other = taken.find((each) => Math.abs(each.x - x) < room(each) && Math.abs(each.y - y) < NAME.height);
          if (other && other.text !== text) continue;
          if (other) break;
          taken.push({ x, y, text });
          svg(this.loads, "text", { x, y, class: "zr-tw-load-name", "text-anchor": "middle",
            style: `--colour: ${joint.colour}; --ink: ${joint.ink}` }, text);
          break;
        }
      }
    }
  }

  drawAxes() {
    const box = this.box;
    svg(this.axes, "rect", { x: box.left, y: box.top, width: this.innerWidth, height: this.innerHeight, class: "zr-tw-frame" });
    svg(this.axes, "line", { x1: this.x(0), x2: this.x(0), y1: box.top, y2: box.bottom, class: "zr-tw-target" });
    const step = [1, 5, 15, 45, 90, 180].find((each) => (this.high - this.low) / each <= this.innerHeight / 26) ?? 360;
    for (let psi = Math.ceil(this.low / step) * step; psi <= this.high + 1e-9; psi += step) {
      const y = this.y(psi);
      svg(this.axes, "line", { x1: box.left - 4, x2: box.left, y1: y, y2: y });
      svg(this.axes, "text", { x: box.left - 8, y: y + 4, "text-anchor": "end" }, number(psi, 0));
    }
    for (const distance of this.distances()) {
      const x = this.x(distance);
      svg(this.axes, "line", { x1: x, x2: x, y1: box.bottom, y2: box.bottom + 4 });
      svg(this.axes, "text", { x, y: box.bottom + 17, "text-anchor": "middle" }, String(distance).replace("-", "−"));
    }
    const middle = (box.left + box.right) / 2;
    svg(this.axes, "text", { x: middle, y: box.bottom + 35, "text-anchor": "middle", class: "zr-tw-title" }, "path from the target [mm]");
    svg(this.axes, "text", {
      x: 0, y: 0, "text-anchor": "middle", class: "zr-tw-title",
      transform: `translate(13 ${(box.top + box.bottom) / 2}) rotate(-90)`,
    }, "spin ψ [deg]");
    for (const [share, text] of [[0.25, "plunge →"], [0.5, "target"], [0.75, "retract →"]]) {
      svg(this.axes, "text", { x: box.left + share * this.innerWidth, y: box.top - 8, "text-anchor": "middle", class: "zr-tw-title" }, text);
    }
  }

  distances() {
    const most = Math.max(2, Math.floor(this.innerWidth / 130));
    const raw = this.reach / most;
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 2.5, 5, 10].map((each) => each * power).find((each) => each >= raw * 0.999);
    const out = [0];
    for (let n = 1; n * step <= this.reach + 1e-9; n++) {
      const distance = Number((n * step).toPrecision(6));
      out.unshift(-distance);
      out.push(distance);
    }
    return out;
  }

  /** What the map says of a place, in words, or null where there is none. */
  say(distance, psi) {
    if (!this.data || Math.abs(distance) > this.reach || psi < this.low || psi > this.high) return null;
    const [S, P] = this.data.shape;
    const s = Math.round((Math.abs(distance) / this.reach) * (S - 1));
    const wrapped = (((psi + TURN / 2) % TURN) + TURN) % TURN;
    const at = s * P + Math.round((wrapped / TURN) * (P - 1));
    const zone = this.data.zone[at];
    const bits = (mask, names) => names.filter((_, n) => mask & (1 << n)).join(", ");
    const where = { 1: bits(this.data.singular[at], SINGULAR), 2: bits(this.data.limited[at], this.data.joints.map((joint) => joint.name)) };
    const level = this.data.spread[at];
    const [floor, cap] = this.data.spread_range;
    const spread = floor * (cap / floor) ** (level / 254);
    const parts = [
      `stand-off ${number(Math.abs(distance) + this.data.corner, 1)} mm, spin ${number(psi, 1)}°`,
      ZONES[zone] + (where[zone] ? ` (${where[zone]})` : ""),
    ];
    if (this.zone?.near[at] && zone < 3) parts.push("too near");
    if (level < 254 && zone < 3) parts.push(`twist spread ${spread.toFixed(2)} deg/mm`);
    if (level === 254 && zone < 3) parts.push(`twist spread over ${cap} deg/mm`);
    if (this.data.branch === null && zone < 3) parts.push(`branch ${this.data.best[at]}`);
    return parts.join(" · ");
  }
}
