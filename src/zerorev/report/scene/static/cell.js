// The cell, in the page and in the replay file: the arm with its motion, played; the holes, to be picked.
import { THREE, OrbitControls } from "nicegui-scene";
import { Arm } from "zerorev-cell/cell_arm.js";
import { Around, NearestLine } from "zerorev-cell/cell_around.js";
import { Bar, Readout, element, legend } from "zerorev-cell/cell_bar.js";
import { listen, point } from "zerorev-cell/cell_hands.js";
import { Holes, Slice, floor, frame, free } from "zerorev-cell/cell_room.js";
import { Track, ribbon } from "zerorev-cell/cell_trace.js";

const VIEWS = { iso: [1, -1.35, 0.75], front: [1, 0, 0.12], side: [0, -1, 0.12], top: [0, -0.001, 1] };
const SEEKS = 66; // [ms] between two that are reported
const LETTER = 7.2; // [px] of a label, about: to measure one would cost a layout in every frame
const SELDOM = 2000; // [ms] between two drawings of answers that come one after the other, where drawing is slow
const REST = 300; // [ms] that an edited motion has to rest before it is drawn where drawing is slow

export class Cell {
  // root: an empty element; on: pickHole(id), pickCell(number), seek(x), ended(); fine: as it is with graphics hardware
  constructor(root, on = {}, { fine = root.hasAttribute("data-fine") } = {}) {
    this.on = on;
    this.fine = fine;
    this.root = root;
    this.x = 0;
    this.speed = 1;
    this.mode = "off";
    this.playing = false;
    this.labels = [];
    root.classList.add("zrc");
    root.cell = this;
    this.bar = new Bar({
      play: () => this.play(!this.playing), seek: (x) => this.seek(x, true), speed: (factor) => (this.speed = factor),
      baseline: (kind) => this.setBaseline(kind), bodies: (shown) => this.setBodies(shown), camera: (preset) => this.look(preset),
    });
    this.readout = new Readout();
    this.canvas = element("canvas", {
      tabindex: 0, role: "application", "data-testid": "cell-canvas",
      "aria-label": "The robot in its cell. Space plays, arrows move along the path, shift and arrows turn the view, plus and minus zoom.",
    });
    this.overlay = element("div", { class: "zrc-labels", "aria-hidden": "true" });
    this.legend = element("div", { class: "zrc-legend" });
    this.note = element("div", { class: "zrc-note zrc-card", hidden: true, "data-testid": "cell-note" });
    this.stage = element("div", { class: "zrc-stage" }, this.canvas, this.overlay, this.readout.root, this.note);
    root.replaceChildren(this.stage, this.legend, this.bar.root); // the legend beside the picture: it would hide the drill
    this.readout.root.hidden = true;
    listen(this);
    try {
      this._begin();
    } catch (error) {
      this._fail(error);
    }
  }

  // data: any of what report/cell_data makes: arm, holes, or their reversals alone (and which is selected); and of solids
  showScene({ arm, solids, holes, reversals, selected }) {
    if (arm) this._showArm(arm);
    if (solids !== undefined) this._showSolids(solids);
    if (holes) this._showHoles(holes);
    if (reversals) this._showReversals(reversals);
    if (selected !== undefined) this._select(selected);
    if (arm || (holes && !this.fitted)) this.look("iso");
    this.fitted = true;
    if (this.slow && reversals && !holes) this.seldom ??= setTimeout(() => ((this.seldom = null), this.invalidate()), SELDOM);
    else this.invalidate();
  }

  // data: {planned, held} as report/cell_data.motion_data makes them, either of them left out where it is as before
  showMotion(data) {
    if (!data || data.planned !== undefined) this.track = data?.planned ? new Track(data.planned) : null;
    if (!data || data.held !== undefined) this.held = data?.held ? new Track(data.held) : null;
    this.hole = data?.hole ?? null;
    if (!this.track) this.play(false);
    this.bar.setTrack(this.track, this.held, this.data?.colours);
    this._captions();
    this._showRibbons();
    this.note.hidden = !this.track?.why;
    this.note.textContent = this.track?.why ?? "";
    const again = Boolean(data) && this.seen === data.hole;
    if (this.slow && again) this.restsAt = performance.now() + REST;
    this.seek(again ? this.x : (this.track?.start ?? 0));
    this.seen = data?.hole;
  }

  // data: what report/cell_data.slice_data makes, or null
  showSlice(data) {
    if (this.failed) return;
    if (this.slice) free(this.slice.root), this.scene.remove(this.slice.root);
    this.slice = data ? new Slice(data) : null;
    if (this.slice) this.scene.add(this.slice.root);
    this.invalidate();
  }

  // to a signed path distance from the corner [mm]
  seek(x, report = false) {
    const track = this.track;
    this.x = track ? Math.min(track.end, Math.max(track.start, x)) : 0;
    const pose = track?.at(this.x), beside = this.mode === "off" ? null : this.held, other = beside?.at(this.x);
    if (track) this.bar.setPlace(this.x, pose);
    if (this.data) this.readout.show(track, pose, this.x, beside, other, this.data);
    if (this.failed || !this.arm) return;
    this.arm.setJoints(pose?.joints ?? this.data.home_deg);
    this.arm.setHalos(track ? track.near(this.x).map((mark) => mark.joint) : []);
    const near = track?.nearestAt(this.x);
    this.line.show(near ?? null, near?.low ? this.bad : this.good);
    if (other) this.twin.setJoints(other.joints);
    this.twin.setHalos(other ? beside.near(this.x).map((mark) => mark.joint) : []);
    if (report) this._tell();
    this.invalidate(true);
  }

  play(on) {
    this.playing = Boolean(on && this.track);
    if (this.playing && this.x >= this.track.end - 1e-6) this.seek(this.track.start, true);
    this.before = null;
    this.bar.setPlaying(this.playing);
    this.invalidate();
  }

  setBaseline(kind) {
    const was = this.mode;
    this.mode = kind;
    this.bar.baseline.press(kind);
    if (this.arm) this.twin.setGhost(kind === "ghost");
    this._captions();
    this._showRibbons();
    this.seek(this.x);
    if (was !== kind && [was, kind].includes("side")) this.refit = true;
  }

  // whether the bodies of arm and tool are shown
  setBodies(shown) {
    this.bodied = shown;
    this.bar.bodies.setAttribute("aria-pressed", String(shown));
    this.around?.setBodies(shown);
    this.invalidate();
  }

  // a preset: iso, front, side, top, close (the hole), drill (along it), fit (as it is, but all in sight)
  look(preset) {
    if (this.failed || !this.arm) return;
    const way = new THREE.Vector3(), centre = new THREE.Vector3(), i = this.holes?.selected ?? -1;
    this.camera.up.set(0, 0, 1);
    if ((preset === "drill" || preset === "close") && i >= 0) {
      this.holes.at(i, preset === "drill" ? 0 : this.holes.depth[i], centre);
      if (preset === "close") return this._place(way.set(...VIEWS.iso), centre, 0.24 * this.data.reach_mm);
      this.holes.way(i, way); // from within the part, where nothing hides the tool
      if (Math.abs(way.z) > 0.99) way.x -= 0.01;
      return this._place(way, centre, 0.3 * this.data.reach_mm);
    }
    if (VIEWS[preset]) way.set(...VIEWS[preset]);
    else way.copy(this.camera.position).sub(this.controls.target);
    const sphere = this._bounds().getBoundingSphere(new THREE.Sphere());
    this._place(way, sphere.center, 0.93 * sphere.radius);
  }

  theme() {
    const style = getComputedStyle(this.root);
    this.ink = new THREE.Color(style.getPropertyValue("--zr-ink").trim() || "#1a1a1a");
    this.accent = style.getPropertyValue("--zr-accent").trim() || "#005a8f";
    this.muted = style.getPropertyValue("--zr-muted").trim() || "#5c5c5c";
    this.good = style.getPropertyValue("--zr-good").trim() || "#0072b2";
    this.bad = style.getPropertyValue("--zr-bad").trim() || "#a3123a";
    if (this.failed || !this.data) return;
    this._showFloor();
    if (this.solids) this._showSolids(this.solids);
    this.seek(this.x);
    if (this.holesData) this._showHoles(this.holesData);
    this._showRibbons();
  }

  // whether a motion is in somebody's hand: where drawing is slow, it would hold up the hand, so it waits for the end
  inHand(held) {
    this.handed = held;
    if (held) return;
    if (this.slow) this.restsAt = performance.now() + REST; // its last step is on the way
    this.invalidate();
  }

  invalidate(moved = false) {
    if (this.failed) return;
    if (moved) this.renderer.shadowMap.needsUpdate = true;
    if (this.slow && this.handed) return;
    clearTimeout(this.resting);
    const rest = (this.restsAt ?? 0) - performance.now();
    if (rest > 0 && !this.playing) this.resting = setTimeout(() => this.invalidate(), rest);
    else this.waiting ??= requestAnimationFrame((now) => this._frame(now));
  }

  dispose() {
    cancelAnimationFrame(this.waiting);
    clearTimeout(this.resting);
    clearTimeout(this.seldom);
    this.watchers?.forEach((stop) => stop());
    if (this.failed) return;
    this.controls.dispose();
    free(this.scene);
    this.renderer.dispose();
    this.failed = true;
  }

  _begin() {
    this.slow = !this.fine && drawnBySoftware(); // then fewer pixels, no shadows, and not while a motion is edited
    const context = this.canvas.getContext("webgl2", { antialias: !this.slow, alpha: true });
    if (!context) throw new Error("no WebGL 2");
    const renderer = new THREE.WebGLRenderer({ canvas: this.canvas, context });
    renderer.setPixelRatio(this.slow ? 1 : Math.min(window.devicePixelRatio, 2));
    renderer.shadowMap.enabled = !this.slow;
    renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    renderer.shadowMap.autoUpdate = false;
    renderer.toneMapping = THREE.NoToneMapping;
    this.renderer = renderer;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 10, 60000);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(2000, -2700, 1500);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => this.invalidate());
    this.sun = new THREE.DirectionalLight("#ffffff", 2.0);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.normalBias = 3;
    this.room = new THREE.Group();
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#8d949c", 1.7), this.sun, this.sun.target, this.room);
    this.ribbons = [new THREE.Group(), new THREE.Group()];
    this.line = new NearestLine();
    this.scene.add(...this.ribbons, this.line.root);
    const size = new ResizeObserver(() => this._resize());
    size.observe(this.stage);
    const dress = new MutationObserver(() => this.theme());
    dress.observe(document.body, { attributes: true, attributeFilter: ["class", "data-theme"] });
    const night = matchMedia("(prefers-color-scheme: dark)"), redress = () => this.theme();
    night.addEventListener("change", redress);
    this.watchers = [() => size.disconnect(), () => dress.disconnect(), () => night.removeEventListener("change", redress)];
    this.canvas.addEventListener("webglcontextlost", (event) => (event.preventDefault(), this._fail()));
    point(this);
    this.theme();
    this._resize();
  }

  _fail(error) {
    if (error) console.info(`no three-dimensional view: ${error.message ?? error}`);
    this.failed = true;
    this.stage.append(element("div", { class: "zrc-fail", role: "status", "data-testid": "cell-fail" },
      element("b", {}, "The three-dimensional view cannot be shown"),
      element("span", {}, "This browser offers no WebGL, or has lost it. Switch on hardware acceleration, or reload; everything else works.")));
  }

  _showArm(data) {
    this.data = data;
    this._showSolids(null); // they are on the arm's links
    for (const old of [this.arm, this.twin]) if (old) this.scene.remove(old.root), free(old.root);
    if (this.failed) return;
    this.arm = new Arm(data);
    this.twin = new Arm(data, this.arm);
    this.twin.setGhost(this.mode === "ghost");
    this.scene.add(this.arm.root, this.twin.root);
    this._showFloor();
  }

  _showFloor() {
    free(this.room);
    const reach = this.data.reach_mm;
    this.room.add(floor(reach, this.ink, this.solids?.floor_mm ?? 0), frame([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], 0.5 * reach));
    this.sun.position.set(1.2 * reach, -2.2 * reach, 4 * reach);
    Object.assign(this.sun.shadow.camera, { left: -2 * reach, right: 2 * reach, top: 2 * reach, bottom: -2 * reach, far: 10 * reach });
    this.sun.shadow.camera.updateProjectionMatrix();
    this.invalidate(true);
  }

  // data: what report/solids_data makes, or null
  _showSolids(data) {
    this.solids = data;
    this.bar.bodies.hidden = !data;
    if (this.failed) return;
    this.around?.dispose();
    this.around = data && new Around(data, this.arm, this.ink);
    if (data) this.scene.add(this.around.root), this.setBodies(this.bodied ?? false);
    this._showFloor();
  }

  _showHoles(data) {
    this.holesData = data;
    if (this.failed) return;
    if (this.holes) free(this.holes.root), this.scene.remove(this.holes.root);
    this.holes = new Holes(data, this.data.colours, this.ink);
    this.part = frame(data.part, 0.18 * this.data.reach_mm);
    this.partPlace = new THREE.Vector3(data.part[0][3], data.part[1][3], data.part[2][3]);
    this.part.visible = this.partPlace.length() > 1 || data.part[0][0] < 0.999;
    this.holes.root.add(this.part);
    this.holes.select(this.selected);
    this.scene.add(this.holes.root);
    this._showLegend();
  }

  _showReversals(reversals) {
    this.holesData.reversals = reversals;
    if (this.failed) return;
    this.holes.know(reversals);
    this._showLegend();
  }

  _showLegend() {
    const next = legend(this.holes);
    this.legend.replaceWith(next);
    this.legend = next;
  }

  _select(id) {
    this.selected = id;
    this.holes?.select(id);
    this.invalidate();
  }

  _showRibbons() {
    if (this.failed || !this.data) return;
    this.ribbons.forEach(free);
    const { joints, baseline } = this.data.colours;
    if (this.track) this.ribbons[0].add(ribbon(this.track, [this.accent, "#56b4e9"], joints));
    if (this.held && this.mode !== "off") this.ribbons[1].add(ribbon(this.held, [baseline, baseline], joints, { pale: true }));
    this.invalidate();
  }

  _captions() {
    this.captions?.forEach((old) => old.remove());
    this.root.classList.toggle("zrc-side", this.mode === "side");
    const said = (track) => (!track ? "no motion" : track.reversals == null ? "cannot run" : `${track.reversals} reversal${track.reversals === 1 ? "" : "s"}`);
    const made = (left, text) => element("div", { class: "zrc-caption", style: `left:${left}` }, text);
    this.captions = this.mode !== "side" ? [] : [element("div", { class: "zrc-divide" }),
      made("25%", `planned: ${said(this.track)}`), made("75%", `constant spin: ${said(this.held)}`)];
    this.stage.append(...this.captions);
  }

  _bounds() {
    const box = new THREE.Box3().setFromObject(this.arm.root);
    const place = new THREE.Vector3();
    for (let i = 0; i < (this.holes?.ids.length ?? 0); i++) box.expandByPoint(this.holes.at(i, 0, place));
    return box;
  }

  _place(way, centre, radius) {
    const aspect = Math.min(1, this.camera.aspect), half = (this.camera.fov * Math.PI) / 360;
    const far = radius / Math.sin(Math.atan(Math.tan(half) * aspect));
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(way.clone().normalize(), far);
    this.controls.update();
    this.invalidate();
  }

  _resize() {
    const { clientWidth: wide, clientHeight: high } = this.stage;
    if (this.failed || !wide || !high) return;
    this.renderer.setSize(wide, high, false);
    [this.wide, this.high] = [wide, high];
    this.invalidate();
  }

  _frame(now) {
    this.waiting = null;
    if (this.playing) this._advance(now);
    if (this.failed || !this.arm || !this.wide) return;
    const side = this.mode === "side", count = side ? 2 : 1, wide = this.wide / count;
    const aspect = wide / this.high;
    if (Math.abs(this.camera.aspect - aspect) > 1e-6) {
      this.camera.aspect = aspect;
      this.camera.updateProjectionMatrix();
    }
    if (this.refit) (this.refit = false), this.look("fit");
    this.controls.update();
    this.renderer.setScissorTest(true);
    for (let n = 0; n < count; n++) {
      this.arm.root.visible = this.ribbons[0].visible = n === 0;
      this.line.root.visible = n === 0 && Boolean(this.line.near);
      this.twin.root.visible = this.ribbons[1].visible = Boolean(this.held) && (side ? n === 1 : this.mode === "ghost");
      if (n === 1) this.renderer.shadowMap.needsUpdate = true;
      this.renderer.setViewport(n * wide, 0, wide, this.high);
      this.renderer.setScissor(n * wide, 0, wide, this.high);
      this.renderer.render(this.scene, this.camera);
    }
    this._label(wide, count);
    if (this.playing) this.invalidate();
  }

  _advance(now) {
    const passed = this.before == null ? 0 : Math.min(0.25, (now - this.before) / 1000);
    this.before = now;
    const seconds = this.track.secondsAt(this.x) + passed * this.speed;
    if (seconds >= this.track.duration) {
      this.seek(this.track.end, true);
      this.play(false);
      return void this.on.ended?.();
    }
    this.seek(this.track.xAfter(seconds), true);
  }

  _tell() {
    const now = performance.now();
    clearTimeout(this.later);
    if (now - (this.reported ?? -SEEKS) >= SEEKS) (this.reported = now), this.on.seek?.(this.x);
    else this.later = setTimeout(() => ((this.reported = performance.now()), this.on.seek?.(this.x)), SEEKS);
  }

  // names beside the halos, the frames, and the hole under the pointer
  _label(wide, count) {
    const wanted = [], place = new THREE.Vector3();
    const add = (text, at, kind, half = 0, colour = null) => {
      const seen = at.project(this.camera);
      if (seen.z < 1 && Math.abs(seen.x) <= 1 && Math.abs(seen.y) <= 1)
        wanted.push([text, half * wide + ((seen.x + 1) / 2) * wide, ((1 - seen.y) / 2) * this.high, kind, colour, (half + 1) * wide]);
    };
    const halos = (arm, track, half, when = "") => {
      for (const mark of track?.near(this.x) ?? [])
        add(`${mark.name} reverses${when}`, arm.haloPlace(mark.joint, place), "zrc-reverses", half, this.data.colours.joints[mark.joint - 1]);
    };
    halos(this.arm, this.track, 0);
    if (this.mode !== "off") halos(this.twin, this.held, count - 1, count === 1 ? " at constant spin" : "");
    if (this.line.near) add(this.line.words, place.copy(this.line.place), "zrc-nearest", 0, this.line.near.low ? this.bad : this.good);
    if (this.part?.visible) add("part", place.copy(this.partPlace), "zrc-frame");
    if (this.hover) add(this.hover.words, place.copy(this.hover.place), "");
    while (this.labels.length < wanted.length) this.labels.push(this.overlay.appendChild(element("span")));
    const taken = [];
    this.labels.forEach((label, i) => {
      label.hidden = i >= wanted.length;
      if (label.hidden) return;
      let [text, x, y, kind, colour, end] = wanted[i];
      const left = Math.max(2, Math.min(x + 14, end - 4 - LETTER * text.length - 18));
      const free = (at) => at >= 2 && at <= this.high - 24 && !taken.some(([a, b]) => Math.abs(a - left) < 110 && Math.abs(b - at) < 22);
      const first = Math.max(2, Math.min(y - 10, this.high - 24)); // the nearest free place below it or above
      y = [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7].map((n) => first + 22 * n).find(free) ?? first;
      taken.push([left, y]);
      label.textContent = text;
      label.className = `zrc-label ${kind}`;
      label.style.borderColor = colour ?? "";
      label.style.transform = `translate(${left}px, ${y}px)`;
    });
  }
}

function drawnBySoftware() {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) return false;
  const named = context.getExtension("WEBGL_debug_renderer_info");
  const name = named ? context.getParameter(named.UNMASKED_RENDERER_WEBGL) : "";
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}
