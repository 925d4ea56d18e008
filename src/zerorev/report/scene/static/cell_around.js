// What stands around the arm, the bodies that are held apart from it, and the line between the two nearest points.
import { THREE } from "nicegui-scene";
import { bytes, floats, free, matrix } from "zerorev-cell/cell_room.js";

const UP = new THREE.Vector3(0, 1, 0);
const LOOKS = { part: ["#9db4c6", 0.3], fixture: ["#b08d57", 0.62], body: ["#56b4e9", 0.3] }; // colour and opacity
const EDGED = 25; // [deg] an edge between two triangles is drawn from this angle on

export class Around {
  // data: what report/solids_data makes; arm: whose links carry the bodies
  constructor(data, arm, ink) {
    this.root = new THREE.Group();
    for (const solid of data.obstacles) this.root.add(drawn(solid, LOOKS[solid.kind], ink));
    this.bodies = data.bodies.map((solid) => {
      const body = drawn(solid, LOOKS.body, ink);
      (solid.link ? arm.frames[solid.link - 1] : arm.root).add(body);
      return body;
    });
  }

  setBodies(shown) {
    for (const body of this.bodies) body.visible = shown;
  }

  dispose() {
    for (const group of [this.root, ...this.bodies]) free(group), group.removeFromParent();
  }
}

export class NearestLine {
  constructor() {
    this.root = new THREE.Group();
    this.root.visible = false;
    this.paint = new THREE.MeshBasicMaterial({ depthTest: false, transparent: true });
    this.rod = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 8), this.paint);
    this.ends = [0, 1].map(() => new THREE.Mesh(new THREE.SphereGeometry(3, 16, 12), this.paint));
    this.root.add(this.rod, ...this.ends);
    for (const mesh of this.root.children) mesh.renderOrder = 10;
  }

  // near: what Track.nearestAt makes, or null
  show(near, colour) {
    this.near = near;
    this.root.visible = Boolean(near);
    if (!near) return;
    this.paint.color.set(colour);
    const [one, other] = [0, 3].map((from) => new THREE.Vector3().fromArray(near.points, from)), way = other.clone().sub(one);
    [one, other].forEach((place, n) => this.ends[n].position.copy(place));
    this.place = one.clone().add(other).multiplyScalar(0.5);
    this.rod.position.copy(this.place);
    this.rod.scale.y = Math.max(way.length(), 1e-3);
    if (way.length() > 1e-6) this.rod.quaternion.setFromUnitVectors(UP, way.normalize());
  }

  get words() {
    const { apart, names, low } = this.near;
    return `${names.join(" – ")}: ${apart > 0.005 ? `${apart.toFixed(1)} mm${low ? ", too near" : ""}` : "they touch"}`;
  }
}

function drawn(solid, [colour, opacity], ink) {
  const group = new THREE.Group(), geometry = shape(solid);
  const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({
    color: colour, transparent: true, opacity, depthWrite: false, side: THREE.DoubleSide, flatShading: solid.shape === "mesh",
  }));
  mesh.renderOrder = 4;
  group.matrixAutoUpdate = false;
  group.matrix.copy(matrix(solid.pose));
  group.name = solid.id;
  group.add(mesh);
  if (solid.shape !== "capsule") group.add(new THREE.LineSegments(
    new THREE.EdgesGeometry(geometry, EDGED), new THREE.LineBasicMaterial({ color: ink, transparent: true, opacity: 0.4 })));
  return group;
}

function shape(solid) {
  if (solid.shape === "box") return new THREE.BoxGeometry(...solid.size);
  if (solid.shape === "mesh") {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(floats(solid.vertices_mm), 3));
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes(solid.faces).buffer), 1));
    geometry.computeVertexNormals();
    return geometry;
  }
  const [one, other] = solid.ends.map((end) => new THREE.Vector3(...end)), way = other.clone().sub(one), length = way.length();
  const geometry = new THREE.CapsuleGeometry(solid.radius, length, 8, 24);
  if (length > 1e-6) geometry.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(UP, way.normalize()));
  return geometry.translate(...one.add(other).multiplyScalar(0.5).toArray());
}
