// What hands do to the cell: pointing, clicking, keys.
import { THREE } from "nicegui-scene";

const PICK = 16; // [px] how near to a hole or a cell a click has to be

// names what is under the pointer; a click without a drag picks it
export function point(cell) {
  let looking = null, down = null;
  cell.canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
  cell.canvas.addEventListener("pointerup", (event) => {
    if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
    const hit = hitAt(cell, event);
    if (hit?.hole !== undefined) cell.on.pickHole?.(cell.holes.ids[hit.hole]);
    if (hit?.cell !== undefined) cell.on.pickCell?.(hit.cell);
  });
  cell.canvas.addEventListener("pointermove", (event) => {
    if (event.buttons || looking) return;
    looking = requestAnimationFrame(() => {
      looking = null;
      const hit = hitAt(cell, event);
      cell.canvas.style.cursor = hit ? "pointer" : "";
      if (hit?.words === cell.hover?.words) return;
      cell.hover = hit;
      cell.invalidate();
    });
  });
  cell.canvas.addEventListener("pointerleave", () => ((cell.hover = null), cell.invalidate()));
}

// keys of the whole player; those of the picture while it is focused
export function listen(cell) {
  cell.root.addEventListener("keydown", (event) => {
    const aimed = event.target === cell.canvas, step = cell.track ? (cell.track.end - cell.track.start) / 100 : 0;
    const turns = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
    const moves = { ArrowLeft: cell.x - step, ArrowRight: cell.x + step, Home: cell.track?.start, End: cell.track?.end };
    if (event.key === " " && !["BUTTON", "SELECT"].includes(event.target.tagName)) cell.play(!cell.playing);
    else if (aimed && event.shiftKey && turns[event.key]) turn(cell, ...turns[event.key]);
    else if (aimed && event.key in moves && cell.track) cell.seek(moves[event.key], true);
    else if (aimed && ["+", "=", "-"].includes(event.key)) zoom(cell, event.key === "-" ? 1.12 : 1 / 1.12);
    else return;
    event.preventDefault();
  });
}

// the hole, or else the cell, nearest to the pointer
function hitAt(cell, event) {
  if (!cell.wide) return null;
  const box = cell.canvas.getBoundingClientRect(), wide = cell.mode === "side" ? cell.wide / 2 : cell.wide;
  const [x, y] = [(event.clientX - box.left) % wide, event.clientY - box.top];
  const place = new THREE.Vector3();
  const nearest = (count, at, within) => {
    let best = null, least = within;
    for (let i = 0; i < count; i++) {
      at(i, place).project(cell.camera);
      const away = Math.hypot(((place.x + 1) / 2) * wide - x, ((1 - place.y) / 2) * cell.high - y);
      if (away < least && place.z < 1) [best, least] = [i, away];
    }
    return best;
  };
  const { holes, slice } = cell;
  const hole = holes ? nearest(holes.ids.length, (i, out) => holes.at(i, holes.depth[i], out), PICK) : null;
  if (hole != null) return { hole, words: holes.words(hole), place: holes.at(hole, holes.depth[hole], new THREE.Vector3()) };
  const number = slice ? nearest(slice.words.length, (i, out) => slice.at(i, out), 2 * PICK) : null;
  if (number == null) return null;
  return { cell: number, words: slice.words[number], place: slice.at(number, new THREE.Vector3()) };
}

function turn(cell, around, over) {
  if (cell.failed) return;
  const arm = cell.camera.position.clone().sub(cell.controls.target), flat = Math.hypot(arm.x, arm.y);
  const up = Math.min(1.55, Math.max(-1.55, Math.atan2(arm.z, flat) - over)), side = Math.atan2(arm.y, arm.x) + around, far = arm.length();
  arm.set(far * Math.cos(up) * Math.cos(side), far * Math.cos(up) * Math.sin(side), far * Math.sin(up));
  cell.camera.position.copy(cell.controls.target).add(arm);
  cell.invalidate();
}

function zoom(cell, factor) {
  if (cell.failed) return;
  cell.camera.position.sub(cell.controls.target).multiplyScalar(factor).add(cell.controls.target);
  cell.invalidate();
}
