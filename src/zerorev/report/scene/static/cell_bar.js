// What is written and pressed around the picture: the player's bar, the readout, the legend, labels.

const ICONS = {
  play: "M7 4.5v15l12-7.5z",
  pause: "M6 4.5h4.2v15H6zM13.8 4.5H18v15h-4.2z",
};
const SPEEDS = [0.25, 0.5, 1, 2, 4];
export const BASELINES = { off: "Off", ghost: "Ghost", side: "Side by side" };
export const CAMERAS = { iso: "Iso", front: "Front", side: "Side", top: "Top", close: "Close-up", drill: "Along drill", fit: "Fit" };

export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value !== false && value != null) made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children);
  return made;
}

function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

function choice(title, options, chosen, test, on) {
  const group = element("div", { class: "zrc-group", role: "group", "aria-label": title }, element("span", { class: "zrc-name" }, title));
  const buttons = Object.entries(options).map(([key, words]) => element("button", {
    type: "button", "data-testid": `${test}-${key}`, "aria-pressed": chosen == null ? null : String(key === chosen), onclick: () => on(key),
  }, words));
  group.append(element("span", { class: "zrc-segments" }, ...buttons));
  return { group, press: (key) => buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(Object.keys(options)[i] === key))) };
}

export function signed(value, digits) {
  const text = Math.abs(value).toFixed(digits);
  return (value < 0 && Number(text) !== 0 ? "−" : "") + text;
}

export class Bar {
  // on: play(), seek(x), speed(factor), baseline(kind), bodies(shown), camera(preset)
  constructor(on) {
    this.play = element("button", { type: "button", class: "zrc-play", "data-testid": "cell-play", onclick: on.play }, icon("play"));
    this.slider = element("input", {
      type: "range", step: "any", "data-testid": "cell-scrub", "aria-label": "Place along the path",
      oninput: () => on.seek(Number(this.slider.value)),
    });
    this.marks = element("div", { class: "zrc-marks", "aria-hidden": "true" });
    this.time = element("output", { class: "zrc-time", "data-testid": "cell-time" });
    this.speed = element("select", { "aria-label": "Speed of playing", "data-testid": "cell-speed", onchange: () => on.speed(Number(this.speed.value)) },
      ...SPEEDS.map((factor) => element("option", { value: factor, selected: factor === 1 }, `×${factor}`)));
    this.baseline = choice("Constant spin", BASELINES, "off", "cell-baseline", on.baseline);
    this.bodies = element("button", {
      type: "button", class: "zrc-switch", "data-testid": "cell-bodies", "aria-pressed": "false", hidden: true,
      title: "the bodies of arm and tool that are held apart from what stands around",
      onclick: () => on.bodies(this.bodies.getAttribute("aria-pressed") !== "true"),
    }, "Bodies");
    const cameras = choice("View", CAMERAS, null, "cell-camera", on.camera);
    this.root = element("div", { class: "zrc-bar" },
      element("div", { class: "zrc-row" }, this.play,
        element("div", { class: "zrc-track" }, this.marks, this.slider,
          element("div", { class: "zrc-ends", "aria-hidden": "true" }, element("span", {}, "plunge"), element("span", {}, "retract"))),
        this.time, element("label", { class: "zrc-group" }, element("span", { class: "zrc-name" }, "Speed"), this.speed), this.bodies),
      element("div", { class: "zrc-row zrc-choices" }, this.baseline.group, cameras.group));
    this.setTrack(null);
    this.setPlaying(false);
  }

  setPlaying(playing) {
    this.play.replaceChildren(icon(playing ? "pause" : "play"));
    this.play.setAttribute("aria-label", playing ? "Pause" : "Play");
    this.play.title = playing ? "Pause (space)" : "Play (space)";
  }

  setTrack(track, held, colours) {
    this.track = track;
    for (const control of [this.play, this.slider]) control.disabled = !track;
    this.marks.replaceChildren();
    if (!track) {
      this.time.textContent = "no motion";
      return;
    }
    [this.slider.min, this.slider.max] = [track.start, track.end];
    const left = (x) => `left:${(100 * (x - track.start)) / (track.end - track.start)}%`;
    this.marks.append(element("i", { class: "zrc-corner", style: left(0), title: "the target" }));
    for (const [from, to] of track.faults)
      this.marks.append(element("i", { class: "zrc-fault", title: track.why,
        style: `${left(from)};width:${Math.max(1, (100 * (to - from)) / (track.end - track.start))}%` }));
    for (const mark of track.marks)
      this.marks.append(element("i", { class: "zrc-mark", "data-testid": "cell-mark", title: `${mark.name} reverses at ${signed(mark.x_mm, 1)} mm`,
        style: `${left(mark.x_mm)};background:${colours.joints[mark.joint - 1]}` }));
  }

  setPlace(x, pose) {
    const where = Math.abs(x) < 0.05 ? "at the target" : x < 0 ? "plunge" : "retract";
    this.slider.value = x;
    const seconds = (value) => `${value.toFixed(1)} s`;
    this.time.textContent = `${seconds(this.track.secondsAt(x))} of ${seconds(this.track.duration)}`;
    this.slider.setAttribute("aria-valuetext",
      `${where}, ${pose.standoff.toFixed(1)} mm behind the target, spin ${signed(pose.psi, 1)} degrees`);
  }
}

export class Readout {
  constructor() {
    this.root = element("div", { class: "zrc-readout zrc-card", "data-testid": "cell-readout" });
  }

  show(track, pose, x, other, otherPose, arm) {
    this.root.hidden = !track;
    if (!track) return;
    const now = track.near(x), otherNow = other ? other.near(x) : [];
    const line = (name, text, unit) => element("div", { class: "zrc-figure" }, element("span", {}, name), element("b", {}, text), element("span", {}, unit));
    const rows = arm.names.map((name, i) => {
      const cells = [element("th", { scope: "row" }, element("i", { class: "zrc-dot", style: `background:${arm.colours.joints[i]}` }), name),
        ...angle(pose, now, i, arm)];
      if (otherPose) cells.push(...angle(otherPose, otherNow, i, arm, "zrc-muted"));
      return element("tr", {}, ...cells);
    });
    const head = element("tr", {}, element("th"), element("th", { colspan: 2 }, otherPose ? "planned" : "[deg]"));
    if (otherPose) head.append(element("th", { colspan: 2 }, "constant"));
    this.root.replaceChildren(line("stand-off", pose.standoff.toFixed(1), "mm"), line("spin", signed(pose.psi, 1), "deg"),
      element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows)));
    if (arm.shown_note) this.root.append(element("p", { class: "zrc-muted", "data-testid": "cell-shown-note" }, `${arm.shown_note}.`));
    if (track.lost(x)) this.root.append(element("p", { class: "zrc-bad" }, track.why));
  }
}

// the angle of a joint as the controller shows it, and which way the joint turns
function angle(pose, now, i, arm, more = "") {
  const shown = arm.j3_less_j2 && i === 2 ? pose.joints[2] - pose.joints[1] : pose.joints[i];
  const turns = now.some((mark) => mark.joint === i + 1);
  const way = turns ? ["⇄", "reverses"] : [["−", "turns −"], ["·", "stands still"], ["+", "turns +"]][pose.ways[i] + 1];
  return [element("td", { class: more }, signed(shown, 1)),
    element("td", { class: `zrc-way ${turns ? "zrc-bad" : more}`, title: way[1], "aria-label": way[1] }, way[0])];
}

export function legend(holes) {
  const counts = new Map();
  for (const count of holes.reversals) {
    const kind = Math.min(count, 6);
    counts.set(kind, (counts.get(kind) ?? 0) + 1);
  }
  const words = (kind) => (kind === -2 ? "infeasible" : kind === -1 ? "not planned yet" : `${kind}${kind === 6 ? " or more" : ""} reversal${kind === 1 ? "" : "s"}`);
  const order = [...counts.keys()].sort((a, b) => (a < 0 ? 9 - a : a) - (b < 0 ? 9 - b : b));
  return element("div", { class: "zrc-legend", "data-testid": "cell-legend" },
    ...order.map((kind) => element("div", {},
      element("i", { class: `zrc-dot ${kind === -2 ? "zrc-cross" : ""}`, style: `background:${holes.colour(kind)}` }),
      `${words(kind)}: ${counts.get(kind)} hole${counts.get(kind) === 1 ? "" : "s"}`)));
}
