// The arm as three.js objects: solids of each link, merged into one mesh a link, on a chain of turning frames.
import { THREE } from "nicegui-scene";
import { bytes, floats } from "zerorev-cell/cell_room.js";

const PAINT = { body: "#e6e3dc", joint: "#aab0b5", dark: "#3d434a", steel: "#c3c9cf" };
const BEHIND = { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 }; // where two arms coincide
const UP = new THREE.Vector3(0, 1, 0);

export class Arm {
  // data: what report/cell_data.arm_data makes; like: another arm of the same data, whose shapes are this one's, too
  constructor(data, like = null) {
    this.data = data;
    this.shapes = like?.shapes ?? [...data.links, data.tool_solids].map((solids) => this._shape(solids));
    this.root = new THREE.Group();
    this.paint = new THREE.MeshLambertMaterial({ vertexColors: true });
    this.veil = new THREE.MeshLambertMaterial({
      color: data.colours.baseline, transparent: true, opacity: 0.34, depthWrite: false, ...BEHIND,
    });
    this.hidden = new THREE.MeshBasicMaterial({ colorWrite: false, ...BEHIND });
    this.meshes = [];
    this.frames = [];
    let parent = this.root;
    this._addShape(parent, this.shapes[0]);
    data.chain.forEach((joint, i) => {
      const frame = new THREE.Group();
      frame.position.set(...joint.place);
      parent.add(frame);
      this._addShape(frame, this.shapes[i + 1]);
      this.frames.push(frame);
      parent = frame;
    });
    this._addShape(parent, this.shapes.at(-1));
    this.tip = new THREE.Object3D();
    this.tip.position.set(...data.tip);
    parent.add(this.tip);
    this.halos = data.rings.map((ring, i) => this._halo(ring, i));
    this.setJoints(data.home_deg);
    this.setGhost(false);
  }

  // the six controller angles [deg]
  setJoints(angles) {
    this.data.chain.forEach((joint, i) => {
      const q = (joint.sign * angles[i] * Math.PI) / 180 - joint.offset;
      this.frames[i].rotation[joint.axis === 2 ? "z" : "y"] = q;
    });
  }

  setGhost(ghost) {
    for (const { mesh, before } of this.meshes) {
      mesh.material = ghost ? this.veil : this.paint;
      mesh.castShadow = mesh.receiveShadow = !ghost;
      mesh.renderOrder = ghost ? 3 : 0;
      before.visible = ghost; // only the nearest surface of a ghost is seen
    }
  }

  // rings around the joints (1 to 6) that reverse here
  setHalos(joints) {
    this.halos.forEach((halo, i) => (halo.visible = joints.includes(i + 1)));
  }

  haloPlace(joint, target) {
    return this.halos[joint - 1].getWorldPosition(target);
  }

  _shape(solids) {
    return solids.length ? merged(solids.map((solid) => [solidGeometry(solid), this._colour(solid.paint)])) : null;
  }

  _addShape(frame, geometry) {
    if (!geometry) return;
    const mesh = new THREE.Mesh(geometry, this.paint);
    const before = new THREE.Mesh(geometry, this.hidden);
    before.renderOrder = 2;
    frame.add(mesh, before);
    this.meshes.push({ mesh, before });
  }

  _colour(paint) {
    return new THREE.Color(PAINT[paint] ?? (paint.startsWith("#") ? paint : null) ?? this.data.colours.joints[Number(paint.slice(1)) - 1]);
  }

  _halo(ring, i) {
    const halo = new THREE.Mesh(
      new THREE.TorusGeometry(ring.radius, ring.radius * 0.07, 12, 48),
      new THREE.MeshBasicMaterial({ color: this.data.colours.joints[i], transparent: true, opacity: 0.95, depthTest: false }),
    );
    halo.renderOrder = 9;
    halo.visible = false;
    halo.position.set(...ring.place);
    if (this.data.chain[i].axis === 1) halo.rotation.x = Math.PI / 2;
    this.frames[i].add(halo);
    return halo;
  }
}

function solidGeometry(solid) {
  if (solid.kind === "mesh") return mesh(solid);
  const start = new THREE.Vector3(...solid.start), end = new THREE.Vector3(...solid.end);
  if (solid.kind === "plate") return plate(solid);
  const along = end.clone().sub(start);
  const geometry = (solid.kind === "rod" ? rod : beam)(solid.radii, along.length());
  return geometry
    .applyQuaternion(new THREE.Quaternion().setFromUnitVectors(UP, along.normalize()))
    .translate(...solid.start);
}

// the maker's own shape
function mesh({ vertices_mm, faces }) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(floats(vertices_mm), 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes(faces).buffer), 1));
  return creased(geometry);
}

// round, from y = 0 to y = length, its edges broken
function rod([low, high], length) {
  const edge = Math.min(3, 0.1 * Math.max(low, high), 0.2 * length), e = 0.02;
  const a = Math.min(edge, 0.5 * low), b = Math.min(edge, 0.5 * high);
  const points = [
    [0, 0], [low - a - e, 0], [low - a, 0], [low, a], [low + ((high - low) * e) / length, a + e],
    [high + ((low - high) * e) / length, length - b - e], [high, length - b], [high - b, length], [high - b - e, length], [0, length],
  ];
  return new THREE.LatheGeometry(points.map(([r, y]) => new THREE.Vector2(Math.max(r, 0), y)), 40);
}

// a bar of square section from y = 0 to y = length
function beam([half], length) {
  const round = 0.22 * half, bevel = Math.min(3, 0.1 * half, 0.2 * length);
  const shape = new THREE.Shape();
  [[1, -1, -Math.PI / 2], [1, 1, 0], [-1, 1, Math.PI / 2], [-1, -1, Math.PI]].forEach(([x, y, turn]) =>
    shape.absarc(x * (half - round), y * (half - round), round, turn, turn + Math.PI / 2, false));
  return extruded(shape, length, bevel).rotateX(-Math.PI / 2);
}

// the hull of two discs that stand across y
function plate({ start, end, radii: [r0, r1], thickness }) {
  const [u, v] = [end[0] - start[0], end[2] - start[2]], apart = Math.hypot(u, v);
  const shape = new THREE.Shape();
  if (apart <= Math.abs(r0 - r1) + 1e-6) {
    const [x, z, r] = r0 >= r1 ? [start[0], start[2], r0] : [end[0], end[2], r1];
    shape.absarc(x, z, r, 0, 2 * Math.PI, false);
  } else {
    const way = Math.atan2(v, u), open = Math.acos((r0 - r1) / apart);
    shape.absarc(start[0], start[2], r0, way + open, way + 2 * Math.PI - open, false);
    shape.absarc(end[0], end[2], r1, way - open, way + open, false);
  }
  const bevel = Math.min(4, 0.08 * Math.min(r0, r1), 0.2 * thickness);
  return extruded(shape, thickness, bevel).translate(0, 0, -thickness / 2).rotateX(Math.PI / 2).translate(0, start[1], 0);
}

function extruded(shape, length, bevel) {
  const geometry = new THREE.ExtrudeGeometry(shape, {
    depth: length - 2 * bevel, bevelEnabled: true, bevelThickness: bevel, bevelSize: bevel, bevelOffset: -bevel,
    bevelSegments: 2, curveSegments: 28,
  });
  return creased(geometry.translate(0, 0, bevel));
}

// normals that are smooth round a curve and sharp at an edge
function creased(geometry, angle = 0.6) {
  const flat = geometry.index ? geometry.toNonIndexed() : geometry;
  const at = flat.attributes.position.array, count = at.length / 3, sharp = Math.cos(angle);
  const normals = new Float32Array(count), units = new Float32Array(count); // of the faces, three numbers each
  const named = new Map(), places = new Array(count); // of each corner, the faces that meet there
  const [a, b, c] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
  for (let i = 0; i < count; i++) {
    const name = `${Math.round(at[3 * i] * 50)},${Math.round(at[3 * i + 1] * 50)},${Math.round(at[3 * i + 2] * 50)}`;
    let faces = named.get(name);
    if (!faces) named.set(name, (faces = []));
    faces.push(i - (i % 3));
    places[i] = faces;
  }
  for (let i = 0; i < count; i += 3) {
    a.fromArray(at, 3 * i), b.fromArray(at, 3 * i + 3), c.fromArray(at, 3 * i + 6);
    const normal = c.sub(b).cross(a.sub(b)); // as long as the face is large
    normal.toArray(normals, i);
    normal.normalize().toArray(units, i);
  }
  const out = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) {
    const own = i - (i % 3);
    a.set(0, 0, 0);
    for (const face of places[i]) {
      const along = units[own] * units[face] + units[own + 1] * units[face + 1] + units[own + 2] * units[face + 2];
      if (along > sharp) a.add(b.fromArray(normals, face));
    }
    a.normalize().toArray(out, 3 * i);
  }
  flat.setAttribute("normal", new THREE.BufferAttribute(out, 3));
  return flat;
}

// one geometry of many, each in its colour
function merged(parts) {
  const flat = parts.map(([geometry, colour]) => [geometry.index ? geometry.toNonIndexed() : geometry, colour]);
  const count = flat.reduce((sum, [geometry]) => sum + geometry.attributes.position.count, 0);
  const [position, normal, colours] = [0, 0, 0].map(() => new Float32Array(3 * count));
  let at = 0;
  for (const [geometry, colour] of flat) {
    position.set(geometry.attributes.position.array, at);
    normal.set(geometry.attributes.normal.array, at);
    const end = at + geometry.attributes.position.array.length;
    for (; at < end; at += 3) colour.toArray(colours, at);
    geometry.dispose();
  }
  const whole = new THREE.BufferGeometry();
  for (const [name, values] of Object.entries({ position, normal, color: colours }))
    whole.setAttribute(name, new THREE.BufferAttribute(values, 3));
  return whole;
}
