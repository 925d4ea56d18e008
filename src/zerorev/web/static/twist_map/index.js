// What the twist map is drawn with: the plane behind (its zones, lines and axes) and the legs before it.
export { Plane } from "./plane.js";
export { Legs, NAMES } from "./legs.js";
export { inserted, moved, removed, turned } from "./edit.js";
export { number } from "./svg.js";
