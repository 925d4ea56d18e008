// A motion to be played: its samples, and the ribbon along the drill axis that shows the spin.
import { THREE } from "nicegui-scene";
import { floats } from "zerorev-cell/cell_room.js";

export class Track {
  // data: what report/cell_data.track_data makes
  constructor(data) {
    this.x = floats(data.x_mm);
    this.seconds = floats(data.seconds);
    this.standoff = floats(data.standoff_mm);
    this.psi = floats(data.psi_deg);
    this.joints = floats(data.joints_deg);
    this.edge = floats(data.ribbon_mm);
    this.marks = data.marks;
    this.faults = data.faults_mm;
    this.reversals = data.reversals;
    this.runs = data.runs;
    this.why = data.why;
    const nearest = data.nearest;
    this.nearest = nearest && {
      names: nearest.pairs, pair: floats(nearest.pair), apart: floats(nearest.apart_mm), points: floats(nearest.points_mm),
      asked: nearest.asked_mm,
    };
  }

  get start() { return this.x[0]; }
  get end() { return this.x[this.x.length - 1]; }
  get duration() { return this.seconds[this.seconds.length - 1]; }

  // where on the path [mm] the motion is after so many seconds, and the other way round
  xAfter(seconds) { return this._between(this.seconds, this.x, seconds); }
  secondsAt(x) { return this._between(this.x, this.seconds, x); }

  // stand-off [mm], spin and joints [deg], and which way each joint is turning (-1, 0, 1)
  at(x) {
    const [n, share] = this._find(this.x, x);
    const mix = (values, size, k) => values[size * n + k] * (1 - share) + values[size * (n + 1) + k] * share;
    const joints = [], ways = [];
    for (let k = 0; k < 6; k++) {
      joints.push(mix(this.joints, 6, k));
      const step = this.joints[6 * (n + 1) + k] - this.joints[6 * n + k];
      ways.push(Math.abs(step) < 1e-6 ? 0 : Math.sign(step));
    }
    return { standoff: mix(this.standoff, 1, 0), psi: mix(this.psi, 1, 0), joints, ways };
  }

  lost(x) {
    return this.faults.some(([from, to]) => x >= from - 1e-6 && x <= to + 1e-6);
  }

  // the reversals that lie near enough to be shown at x
  near(x) {
    const close = Math.max(0.6, 0.03 * (this.end - this.start));
    return this.marks.filter((mark) => Math.abs(mark.x_mm - x) <= close);
  }

  // what of the arm is nearest to what stands around: how far [mm], and where; null where nothing is known
  nearestAt(x) {
    if (!this.nearest) return null;
    const { names, pair, apart, points, asked } = this.nearest, [n, share] = this._find(this.x, x);
    const k = share < 0.5 ? n : n + 1, part = pair[n] === pair[n + 1] ? share : k - n; // of two pairs the one nearby
    if (pair[k] < 0) return null;
    const mix = (values, size, i) => values[size * n + i] * (1 - part) + values[size * (n + 1) + i] * part;
    const far = part === k - n ? apart[k] : mix(apart, 1, 0);
    const at = Array.from({ length: 6 }, (_, i) => (part === k - n ? points[6 * k + i] : mix(points, 6, i)));
    return { apart: far, points: at, names: names[pair[k]], low: far < asked - 0.02 };
  }

  tipAt(x, out) { return this._ribbonAt(x, 0, out); }
  edgeAt(x, out) { return this._ribbonAt(x, 3, out); }

  _ribbonAt(x, from, out) {
    const [n, share] = this._find(this.x, x);
    for (let k = from; k < from + 3; k++)
      out.setComponent(k - from, this.edge[6 * n + k] * (1 - share) + this.edge[6 * (n + 1) + k] * share);
    return out;
  }

  _find(grid, value) {
    let low = 0, high = grid.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (grid[middle] <= value) low = middle; else high = middle;
    }
    const wide = grid[high] - grid[low];
    return [low, wide > 0 ? Math.min(1, Math.max(0, (value - grid[low]) / wide)) : 0];
  }

  _between(grid, values, at) {
    const [n, share] = this._find(grid, at);
    return values[n] * (1 - share) + values[n + 1] * share;
  }
}

// from the tip outwards, towards the wrist: plunge and retract in two shades; a mark where a joint reverses
export function ribbon(track, colours, joints, { pale = false } = {}) {
  const group = new THREE.Group(), count = track.x.length;
  const corner = track.x.reduce((best, x, i) => (Math.abs(x) < Math.abs(track.x[best]) ? i : best), 0);
  for (const [from, to, colour] of [[0, corner, colours[0]], [corner, count - 1, colours[1]]]) {
    const points = [], faces = [], rim = [];
    for (let i = from; i <= to; i++) {
      points.push(...track.edge.subarray(6 * i, 6 * i + 6));
      rim.push(new THREE.Vector3().fromArray(track.edge, 6 * i + 3));
      const n = 2 * (i - from);
      if (i < to) faces.push(n, n + 1, n + 2, n + 1, n + 3, n + 2);
    }
    const sheet = new THREE.BufferGeometry();
    sheet.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
    sheet.setIndex(faces);
    const face = new THREE.Mesh(sheet, new THREE.MeshBasicMaterial({
      color: colour, transparent: true, opacity: pale ? 0.18 : 0.38, side: THREE.DoubleSide, depthWrite: false,
    }));
    face.renderOrder = 5;
    const tube = new THREE.Mesh(
      new THREE.TubeGeometry(new THREE.CatmullRomCurve3(rim), Math.max(8, 2 * rim.length), pale ? 0.7 : 1.1, 6),
      new THREE.MeshBasicMaterial({ color: colour, transparent: true, opacity: pale ? 0.6 : 1 }));
    tube.renderOrder = 6;
    group.add(face, tube);
  }
  const beside = new Map(), tip = new THREE.Vector3();
  for (const mark of track.marks) {
    const gem = new THREE.Mesh(
      new THREE.OctahedronGeometry(pale ? 4 : 5), new THREE.MeshBasicMaterial({ color: joints[mark.joint - 1], depthTest: false }));
    const nth = beside.get(mark.x_mm.toFixed(2)) ?? 0; // marks of one place stand in a row
    beside.set(mark.x_mm.toFixed(2), nth + 1);
    track.edgeAt(mark.x_mm, gem.position);
    gem.position.addScaledVector(gem.position.clone().sub(track.tipAt(mark.x_mm, tip)).normalize(), 11 * nth);
    gem.renderOrder = 8;
    group.add(gem);
  }
  return group;
}
