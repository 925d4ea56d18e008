// Pure changes of a motion's points, {standoff [mm], psi [deg]} in order of motion: each makes another list.

/** A point moved: start, target and end along the spin alone, an inner point between its neighbours, too. */
export function moved(points, n, psi, standoff = null) {
  const inner = n > 0 && n < points.length - 1 && standoff !== null;
  const to = inner ? between(points, n, standoff) : points[n].standoff;
  return points.map((point, k) => (k === n ? { standoff: to, psi } : point));
}

/** All points turned by the same angle. */
export function turned(points, by) {
  return points.map(({ standoff, psi }) => ({ standoff, psi: psi + by }));
}

/** A point more, on the segment after point n. */
export function inserted(points, n, standoff, psi) {
  return [...points.slice(0, n + 1), { standoff, psi }, ...points.slice(n + 1)];
}

/** A point less. */
export function removed(points, n) {
  return points.filter((_, k) => k !== n);
}

function between(points, n, standoff) {
  const [a, b] = [points[n - 1].standoff, points[n + 1].standoff].sort((p, q) => p - q);
  const room = Math.min(0.2, (b - a) / 4); // mm kept from a neighbour
  return Math.min(Math.max(standoff, a + room), b - room);
}
