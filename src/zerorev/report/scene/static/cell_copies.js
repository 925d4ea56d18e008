// Many copies of one small shape, each at its place and in its colour, as a single mesh.
// Not an InstancedMesh: without a graphics card each instance costs as much as a mesh of its own, in every frame.
import { THREE } from "nicegui-scene";

export class Copies extends THREE.Mesh {
  // place(i, out): sets the matrix of the i-th of so many copies
  constructor(shape, material, count, place) {
    const { position, normal } = shape.attributes, each = position.count, { index } = shape;
    const geometry = new THREE.BufferGeometry(), order = new Uint32Array(index.count * count);
    const [at, ways, colours] = [0, 1, 2].map(() => new Float32Array(3 * each * count));
    const to = new THREE.Matrix4(), turn = new THREE.Matrix3(), vector = new THREE.Vector3();
    for (let i = 0; i < count; i++) {
      place(i, to);
      turn.getNormalMatrix(to);
      for (let k = 0; k < each; k++) {
        vector.fromBufferAttribute(position, k).applyMatrix4(to).toArray(at, 3 * (i * each + k));
        vector.fromBufferAttribute(normal, k).applyNormalMatrix(turn).toArray(ways, 3 * (i * each + k));
      }
      for (let k = 0; k < index.count; k++) order[i * index.count + k] = i * each + index.getX(k);
    }
    shape.dispose();
    geometry.setAttribute("position", new THREE.BufferAttribute(at, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(ways, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(colours.fill(1), 3));
    geometry.setIndex(new THREE.BufferAttribute(order, 1));
    material.vertexColors = true;
    super(geometry, material);
    this.each = each;
  }

  // colour(i): of the i-th copy
  paint(colour) {
    const { color } = this.geometry.attributes;
    for (let k = 0; k < color.count; k += this.each) {
      const { r, g, b } = colour(k / this.each);
      for (let n = k; n < k + this.each; n++) color.setXYZ(n, r, g, b);
    }
    color.needsUpdate = true;
  }

  // of the i-th copy
  colour(i) {
    return new THREE.Color().fromBufferAttribute(this.geometry.attributes.color, i * this.each);
  }
}
