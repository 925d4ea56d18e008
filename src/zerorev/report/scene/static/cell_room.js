// What stands around the arm: floor, frames, the part's faces, the holes, and the cells of a map.
import { THREE } from "nicegui-scene";
import { Copies } from "zerorev-cell/cell_copies.js";

export const UNPLANNED = -1, INFEASIBLE = -2;
const HOLE = 4.5, AXES = ["#c8442f", "#2f8f4e", "#2f62c8"], LETTERS = ["x", "y", "z"];
const MANY = 200; // holes, of which each is so small that it need not be as round
const CROWD = 1000; // holes, of which each is a spot: a machine without a graphics card draws them in each frame, too

export function floats(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

export function bytes(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

// materials are let go and not disposed of: the last of its kind would take its shader with it,
// and the next would compile it again
export function free(group) {
  group.traverse((object) => {
    object.geometry?.dispose();
    for (const material of [object.material].flat()) material?.map?.dispose();
  });
  group.clear();
}

// a line every 100 mm, a stronger one every 500 mm, fading into the distance
export function floor(reach, ink, height) {
  const half = Math.ceil((1.5 * reach) / 500) * 500, group = new THREE.Group();
  for (const [step, opacity] of [[100, 0.16], [500, 0.34]]) {
    const points = [];
    for (let x = -half; x <= half; x += step) {
      if (step === 100 && x % 500 === 0) continue;
      points.push(x, -half, 0, x, half, 0, -half, x, 0, half, x, 0);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
    group.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: ink, transparent: true, opacity })));
  }
  const shade = new THREE.Mesh(new THREE.PlaneGeometry(2 * half, 2 * half), new THREE.ShadowMaterial({ opacity: 0.22 }));
  shade.receiveShadow = true;
  shade.position.z = -0.5;
  group.add(shade);
  group.position.z = height - 1;
  return group;
}

// three arrows with their letters; pose: three rows of four
export function frame(pose, length) {
  const group = new THREE.Group();
  group.matrixAutoUpdate = false;
  group.matrix.copy(matrix(pose));
  LETTERS.forEach((letter, i) => {
    const material = new THREE.MeshBasicMaterial({ color: AXES[i] });
    const shaft = new THREE.Mesh(new THREE.CylinderGeometry(length * 0.018, length * 0.018, length, 10), material);
    const head = new THREE.Mesh(new THREE.ConeGeometry(length * 0.05, length * 0.16, 14), material);
    shaft.position.y = length / 2;
    head.position.y = length;
    const arrow = new THREE.Group();
    arrow.add(shaft, head);
    if (i === 0) arrow.rotation.z = -Math.PI / 2;
    if (i === 2) arrow.rotation.x = Math.PI / 2;
    const name = letterSprite(letter, AXES[i]);
    name.scale.setScalar(length * 0.3);
    name.position.set(0, 0, i < 2 ? length * 0.1 : 0).setComponent(i, length * 1.24);
    group.add(arrow, name);
  });
  return group;
}

function letterSprite(letter, colour) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext("2d");
  pen.font = "600 46px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillStyle = colour;
  pen.fillText(letter, 32, 32);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  return new THREE.Sprite(new THREE.SpriteMaterial({ map: texture, transparent: true, depthWrite: false }));
}

export function matrix(rows) {
  return new THREE.Matrix4().set(...rows[0], ...rows[1], ...rows[2], 0, 0, 0, 1);
}

// a hexagon of four triangles; a circle has two more, around its centre
function spot(radius) {
  const circle = new THREE.CircleGeometry(radius, 6).rotateX(Math.PI / 2);
  circle.setIndex([1, 2, 3, 1, 3, 4, 1, 4, 5, 1, 5, 6]);
  return circle;
}

export class Holes {
  // data: what report/cell_data.holes_data makes
  constructor(data, colours, ink) {
    this.ids = data.ids;
    this.target = floats(data.target_mm);
    this.direction = floats(data.direction);
    this.depth = floats(data.depth_mm);
    this.root = new THREE.Group();
    this.colours = colours;
    this._plates(data.plates, ink);
    this.onFaces = data.plates.length > 0 || data.shaped; // of plates, or of the part itself
    this.bodies = this._bodies();
    this.crosses = new THREE.Group();
    this.root.add(...this.bodies, this.crosses);
    this.know(data.reversals);
    this.ring = new THREE.Mesh(
      new THREE.TorusGeometry(3 * HOLE, 0.45 * HOLE, 12, 40), new THREE.MeshBasicMaterial({ color: ink }));
    this.axis = new THREE.Mesh(
      new THREE.CylinderGeometry(0.7, 0.7, 1, 8), new THREE.MeshBasicMaterial({ color: ink, transparent: true, opacity: 0.55 }));
    this.root.add(this.ring, this.axis);
    this.select(null);
  }

  at(i, standoff, out) {
    for (let k = 0; k < 3; k++) out.setComponent(k, this.target[3 * i + k] - standoff * this.direction[3 * i + k]);
    return out;
  }

  way(i, out) {
    return out.fromArray(this.direction, 3 * i);
  }

  words(i) {
    const count = this.reversals[i];
    const state = count === UNPLANNED ? "not planned yet" : count === INFEASIBLE ? "infeasible"
      : `${count} reversal${count === 1 ? "" : "s"}`;
    return `${this.ids[i]}: ${state}, ${+this.depth[i].toFixed(2)} mm deep`;
  }

  // what was found of each: its count, or why there is none
  know(reversals) {
    this.reversals = reversals;
    const colour = new THREE.Color();
    for (const mesh of this.bodies) mesh.paint((i) => colour.set(this.colour(reversals[i])));
    free(this.crosses);
    this._crosses();
  }

  colour(count) {
    return count === UNPLANNED ? "#f4f4f4" : count === INFEASIBLE ? this.colours.cannot
      : this.colours.reversals[Math.min(count, this.colours.reversals.length - 1)];
  }

  select(id) {
    const i = this.ids.indexOf(id);
    this.selected = i;
    this.ring.visible = this.axis.visible = i >= 0;
    if (i < 0) return;
    const way = this.way(i, new THREE.Vector3());
    this.at(i, this.depth[i] + 0.5, this.ring.position);
    this.ring.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), way);
    this.at(i, this.depth[i] / 2 + 15, this.axis.position);
    this.axis.scale.y = this.depth[i] + 90;
    this.axis.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way);
  }

  _plates(plates, ink) {
    for (const { pose, size_mm } of plates) {
      const box = new THREE.BoxGeometry(...size_mm);
      const plate = new THREE.Mesh(box, new THREE.MeshLambertMaterial({
        color: "#9db4c6", transparent: true, opacity: 0.26, depthWrite: false, side: THREE.DoubleSide,
      }));
      const edges = new THREE.LineSegments(
        new THREE.EdgesGeometry(box), new THREE.LineBasicMaterial({ color: ink, transparent: true, opacity: 0.35 }));
      plate.renderOrder = 4;
      const group = new THREE.Group();
      group.matrixAutoUpdate = false;
      group.matrix.copy(matrix(pose));
      group.add(plate, edges);
      this.root.add(group);
    }
  }

  // of each hole, which geometries, whether they reach down to its bottom, and their looks
  _parts(count) {
    if (count > CROWD) return [[spot(1.5 * HOLE), false, { side: THREE.DoubleSide }]];
    const [wall, rim, round] = count > MANY ? [8, 12, 4] : [16, 24, 8];
    const parts = [
      [new THREE.CylinderGeometry(HOLE, HOLE, 1, wall, 1, true).translate(0, -0.5, 0), true, { side: THREE.BackSide }],
      [new THREE.TorusGeometry(1.3 * HOLE, 0.35 * HOLE, round, rim).rotateX(Math.PI / 2), false, {}],
    ];
    if (!this.onFaces) parts.push([
      new THREE.CylinderGeometry(5 * HOLE, 5 * HOLE, 0.6, 28).translate(0, -1, 0), false,
      { transparent: true, opacity: 0.3, depthWrite: false },
    ]);
    return parts;
  }

  // each hole a short cylinder and a rim at its mouth; on a face that is not drawn, a small disc around it
  _bodies() {
    const count = this.ids.length, parts = this._parts(count);
    const [place, turn, size, way] = [new THREE.Vector3(), new THREE.Quaternion(), new THREE.Vector3(), new THREE.Vector3()];
    const from = new THREE.Vector3(0, -1, 0);
    return parts.map(([shape, stretched, look]) => new Copies(shape, new THREE.MeshLambertMaterial(look), count, (i, to) => {
      this.at(i, this.depth[i], place);
      turn.setFromUnitVectors(from, this.way(i, way));
      to.compose(place, turn, size.set(1, stretched ? this.depth[i] : 1, 1));
    }));
  }

  // an infeasible hole has a cross over its mouth
  _crosses() {
    const lost = this.ids.map((_, i) => i).filter((i) => this.reversals[i] === INFEASIBLE);
    if (!lost.length) return;
    const [place, way, size] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3(1, 1, 1)];
    const [from, turn] = [new THREE.Vector3(0, 0, -1), new THREE.Quaternion()];
    const sides = [1, -1].map((side) => new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 0, 1), (side * Math.PI) / 4));
    this.crosses.add(new Copies(
      new THREE.BoxGeometry(4.4 * HOLE, 0.4 * HOLE, 0.4 * HOLE), new THREE.MeshBasicMaterial({ color: "#a32020" }), 2 * lost.length,
      (n, to) => {
        const i = lost[n >> 1];
        turn.setFromUnitVectors(from, this.way(i, way)).multiply(sides[n % 2]);
        to.compose(this.at(i, this.depth[i], place), turn, size);
      }));
  }
}

export class Slice {
  // data: what report/cell_data.slice_data makes
  constructor(data) {
    this.position = floats(data.position_mm);
    this.words = data.words;
    this.title = data.title;
    const rgb = bytes(data.rgb), [u, v] = data.edges_mm.map((edge) => new THREE.Vector3(...edge));
    const across = u.clone().cross(v).normalize(), count = this.words.length;
    const turned = new THREE.Matrix4().makeBasis(u.clone().multiplyScalar(0.9), v.clone().multiplyScalar(0.9), across);
    const mesh = new Copies(
      new THREE.BoxGeometry(1, 1, 2), new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.82, side: THREE.DoubleSide }),
      count, (i, to) => to.copy(turned).setPosition(...this.position.subarray(3 * i, 3 * i + 3)));
    const colour = new THREE.Color();
    mesh.paint((i) => colour.setRGB(rgb[3 * i] / 255, rgb[3 * i + 1] / 255, rgb[3 * i + 2] / 255, THREE.SRGBColorSpace));
    mesh.renderOrder = 1;
    this.root = new THREE.Group().add(mesh);
    this.radius = Math.max(u.length(), v.length()) / 2;
    this.mesh = mesh;
  }

  at(i, out) {
    return out.fromArray(this.position, 3 * i);
  }
}
