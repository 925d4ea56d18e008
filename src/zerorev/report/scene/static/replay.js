// The page of a replay file: the player, and beside it the figures of the hole that is played.
import { Cell } from "zerorev-cell/cell.js";
import { element } from "zerorev-cell/cell_bar.js";

const TONES = { error: "bad", warning: "warn", info: "" };

export function show(page) {
  const data = JSON.parse(page.getElementById("data").textContent);
  const list = page.getElementById("hole"), root = page.documentElement, button = page.getElementById("theme");
  const dress = (dark) => {
    root.dataset.theme = dark ? "dark" : "light";
    button.textContent = dark ? "Light" : "Dark";
    page.body.classList.toggle("dark", dark);
  };
  dress(matchMedia("(prefers-color-scheme: dark)").matches);
  button.addEventListener("click", () => dress(root.dataset.theme !== "dark"));

  const place = page.getElementById("cell");
  let at = -1;
  const next = () => at + 1 < data.holes.length && data.holes[at + 1].hole === data.holes[at].hole; // another stroke of it
  const cell = new Cell(place, {
    pickHole: (id) => choose(data.holes.findIndex((hole) => hole.hole === id)),
    ended: () => next() && (choose(at + 1), cell.play(true)),
  });
  list.append(...data.holes.map((hole, i) => element("option", { value: i }, `${hole.id} (${hole.verdict})`)));
  list.addEventListener("change", () => choose(Number(list.value)));
  cell.showScene({ arm: data.arm, solids: data.solids, holes: data.scene });
  choose(data.holes.findIndex((hole) => hole.motion));

  function choose(i) {
    const hole = data.holes[i];
    if (!hole) return;
    at = i;
    list.value = i;
    cell.showScene({ selected: hole.hole });
    cell.showMotion(hole.motion);
    page.getElementById("figures").replaceChildren(...figures(hole, data.note));
  }
}

function figures(hole, note) {
  const row = ([name, planned, constant]) =>
    element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, planned), element("td", {}, constant));
  const [number, of] = hole.stroke;
  const parts = of === 1 ? [] : [element("p", { "data-testid": "replay-stroke" },
    `Stroke ${number} of ${of}. They are played one after the other; the moves between them are not shown.`)];
  parts.push(
    element("p", { class: `verdict ${hole.tone}`, "data-testid": "replay-verdict" }, hole.verdict),
    element("table", {},
      element("thead", {}, element("tr", {}, element("th", {}, ""), element("th", {}, "planned"), element("th", {}, "constant spin"))),
      element("tbody", {}, ...hole.figures.map(row))),
  );
  if (hole.findings.length)
    parts.push(element("ul", {}, ...hole.findings.map(([level, message]) =>
      element("li", {}, element("b", { class: TONES[level] }, level), message))));
  if (note) parts.push(element("p", { class: "note", "data-testid": "replay-note" }, note));
  return parts;
}
