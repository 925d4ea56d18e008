// The twist map: the plane of path distance and spin, over which the legs of a motion are steered by hand.
import { Legs, NAMES, Plane, inserted, moved, number, removed, turned } from "zerorev-twist-map";

const LATE = 1000; // [ms] after which an answer is waited for no longer
const STEPS = { plain: 1, shift: 10, fine: 0.1 }; // [deg] of an arrow key
const ALONG = { plain: 1, shift: 5, fine: 0.1 }; // [mm]
const SETTLED = 300; // [ms] after the last key the motion counts as let go
const LOST = "predicted deviation of the tip across the drill axis that the gears cause, half a stroke about the turn; friction, stiffness and gap are guesses";
const LOADS = "where a leg crosses such a curve, the gear crosses its lost motion without a reversal; drawn for the way each joint turns in this motion, and for the share of the nominal friction that is guessed to lie behind the gear";
const NEAR = "where two bodies of the arm, or the arm and what stands around it, come nearer than asked for; of one branch";
const LEAST_HALF = 10; // [deg] shown on either side of the middle, at the closest

export default {
  template: `
    <section class="zr-tw" data-testid="twist-map" aria-label="Twist map">
      <div class="zr-tw-tools">
        <button type="button" :class="{ away: !edited }" :disabled="!edited" @click="$emit('let_go')" data-testid="let-go" title="give up the motion by hand">back to the plan</button>
        <button type="button" v-if="loaded" :aria-pressed="String(loads)" @click="showLoads" data-testid="loads" :title="LOADS">loads</button>
        <button type="button" v-if="zoned" :aria-pressed="String(near)" @click="showNear" data-testid="clearance-zone" :title="NEAR">clearance</button>
        <label>branch <select aria-label="branch" data-testid="branch" :value="choice" :disabled="!branches.length" @change="choose">
          <option v-for="each in branches" :key="each.value" :value="each.value">{{ each.label }}</option></select></label>
        <span class="zr-tw-zoom" role="group" aria-label="spins that are shown">
          <button type="button" aria-label="show fewer spins" data-testid="zoom-in" @click="zoom(0.5)">+</button>
          <button type="button" aria-label="show more spins" data-testid="zoom-out" @click="zoom(2)">−</button>
          <button type="button" aria-label="show a whole turn around the motion" data-testid="zoom-fit" @click="fit()">fit</button>
        </span>
      </div>
      <div class="zr-tw-strip">
        <div class="zr-tw-total" :class="grade"><b data-testid="reversals">{{ count }}</b> <span>{{ count === "1" ? "reversal" : "reversals" }}</span></div>
        <div class="zr-tw-joints" v-if="joints.length">
          <span v-for="joint in joints" :key="joint.name" class="zr-tw-chip" :class="{ some: joint.count > 0 }" data-testid="joint-reversals"
            :title="joint.title"><svg width="13" height="4" aria-hidden="true"><line x1="0" x2="13" y1="2" y2="2" :stroke="joint.colour" stroke-width="3" :stroke-dasharray="joint.dash"/></svg>{{ joint.name }} <b>{{ joint.count }}</b></span>
        </div>
        <div class="zr-tw-numbers" :class="{ away: !runs || count === '–' }">
          <div class="zr-tw-number" title="sum over the joints of the angle moved">travel <b data-testid="travel">{{ travel || "–" }}</b> deg</div>
          <div class="zr-tw-number" :class="{ mild: why }" title="least rate of the joints that do not reverse">slowest <b data-testid="margin">{{ margin || "–" }}</b> deg/mm</div>
          <div class="zr-tw-number" title="least distance of a joint to a limit">to a limit <b data-testid="limit">{{ limit || "–" }}</b> deg</div>
          <div class="zr-tw-number" v-if="lost" :title="LOST">lost motion <b data-testid="lost">{{ lost[0] }}</b> mm, legs swapped <b data-testid="lost-twin">{{ lost[1] }}</b> mm</div>
        </div>
      </div>
      <div class="zr-tw-least" v-if="around" :class="{ low: nearest && nearest.low, away: !runs }" data-testid="nearest">
        <span>least clearance <b data-testid="clearance">{{ nearest ? nearest.least : "–" }}</b> mm</span>
        <span v-if="nearest" data-testid="clearance-between">{{ nearest.between }}</span>
        <button type="button" v-if="nearest" data-testid="clearance-where" title="show the robot there" @click="$emit('seek', { x: nearest.x })">{{ nearest.where }}</button>
      </div>
      <div class="zr-tw-plot" ref="plot">
        <canvas ref="canvas" aria-hidden="true"></canvas>
        <svg ref="back" aria-hidden="true"></svg>
        <svg ref="svg" role="group" aria-label="spin over the path; the points of the motion can be moved"></svg>
        <p class="zr-tw-why" :class="{ bad: !runs, hit: runs && nearest?.low, mild: runs && !nearest?.low }" data-testid="why" role="status">{{ why }}</p>
        <div class="zr-tw-cover" v-if="cover" data-testid="map-cover" role="status"><span class="zr-tw-spinner" v-if="loading"></span>{{ cover }}</div>
      </div>
      <div class="zr-tw-foot">
        <div class="zr-tw-readout" data-testid="readout">{{ readout }}</div>
        <ul class="zr-tw-legend" :class="{ away: readout }" aria-label="legend">
          <li v-for="zone in zones" :key="zone.name"><i class="zr-tw-swatch" :class="'zr-tw-' + zone.name + '-swatch'"></i>{{ zone.text }}</li>
          <li v-if="near && zoned" :title="NEAR"><i class="zr-tw-swatch zr-tw-tight-swatch"></i>{{ zoned }}</li>
          <li v-if="lined"><svg width="22" height="6" aria-hidden="true"><line x1="0" x2="22" y1="3" y2="3" stroke="currentColor" stroke-width="2" stroke-dasharray="6 2"/></svg>spin does not move a joint</li>
          <li v-if="loads && loaded" :title="LOADS"><svg width="22" height="6" aria-hidden="true"><line x1="0" x2="22" y1="3" y2="3" stroke="currentColor" class="zr-tw-load"/></svg>a joint’s load changes its sign (share of its friction)</li>
          <li v-if="stuck.length">spin never moves {{ stuck.join(", ") }}</li>
          <li v-if="scale"><i class="zr-tw-scale"></i>twist spread {{ scale }} deg/mm</li>
        </ul>
      </div>
    </section>`,

  emits: ["ready", "grab", "drag", "drop", "restore", "let_go", "choose", "seek"],

  data() {
    return {
      count: "–", joints: [], travel: "", margin: "", limit: "", why: "", runs: true, edited: false, grade: "",
      choice: "", branches: [], readout: "", zones: [], lined: false, stuck: [], scale: "", loading: true,
      lost: null, loads: false, loaded: false, LOST, LOADS,
      around: false, nearest: null, near: true, zoned: "", NEAR,
      cover: "the map is being drawn …",
    };
  },

  mounted() {
    this.seq = 0;
    this.last = 0; // [ms] the last update took
    this.waiting = null; // {seq, asked}: sent, and not yet answered
    this.next = null; // {asked}: to be sent when that is answered
    this.held = null; // the drag under way
    this.plane = new Plane(this.$refs.back, this.$refs.canvas);
    this.legs = new Legs(this.plane, this.$refs.svg);
    const svg = this.$refs.svg;
    svg.addEventListener("pointerdown", this.press);
    svg.addEventListener("pointermove", this.move);
    svg.addEventListener("pointerup", this.release);
    svg.addEventListener("pointercancel", this.cancel);
    svg.addEventListener("pointerleave", () => this.held || this.tell(null));
    svg.addEventListener("dblclick", this.add);
    svg.addEventListener("keydown", this.key);
    this.onKey = (event) => {
      if (event.key === "Escape" && this.held?.start) this.cancel(event);
      if (event.ctrlKey || event.metaKey) this.settle(); // of an undo, which takes back what counts as let go
    };
    window.addEventListener("keydown", this.onKey, true);
    this.$refs.plot.addEventListener("wheel", this.wheel, { passive: false });
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(this.$refs.plot);
    this.themes = new MutationObserver(() => this.plane.draw());
    this.themes.observe(document.body, { attributes: true, attributeFilter: ["class"] });
    this.resize();
    this.$emit("ready");
  },

  unmounted() {
    this.sizes.disconnect();
    this.themes.disconnect();
    window.removeEventListener("keydown", this.onKey, true);
    clearTimeout(this.settling);
    this.letGo();
  },

  methods: {
    // ---- what the server shows

    show_map(data) {
      this.plane.show(data);
      this.zoned = "";
      if (data) {
        this.plane.reach = data.reach;
        const zones = { 1: "near", 2: "limited", 3: "unreached" };
        this.zones = data.legend.map(({ zone, text }) => ({ name: zones[zone], text }));
        this.lined = data.lines.length > 0;
        this.stuck = data.stuck;
        this.loaded = data.loads.length > 0;
        this.scale = data.spread_range.join("–");
        this.choice = data.branch === null ? "all" : String(data.branch);
      }
      this.loading = false;
      this.cover = data ? "" : "choose a hole to see its twist map";
      this.draw();
    },

    show_zone(data) {
      this.plane.showZone(data);
      this.zoned = data?.text ?? "";
    },

    show_loading() {
      this.loading = true;
      this.cover = "the map is being drawn …";
    },

    show_branches(branches) {
      this.branches = branches;
    },

    show_cursor(distance) {
      this.legs.cursor = distance;
      this.legs.drawCursor();
    },

    show_motion(data) {
      const answer = this.waiting && data.seq === this.waiting.seq ? this.waiting : null;
      if (data.seq !== null && !answer) return; // late: a newer one is under way
      this.legs.motion = data;
      if (!this.held && !this.next) this.legs.points = data.points.map(([standoff, psi]) => ({ standoff, psi }));
      if (data.fit) this.fit(false);
      this.fill(data);
      this.legs.draw();
      if (!answer) return;
      this.waiting = null;
      this.$nextTick(() => requestAnimationFrame(() => this.drawn(answer)));
      this.send();
    },

    fill(data) {
      this.runs = data.runs;
      this.count = data.reversals === null ? "–" : String(data.reversals);
      this.grade = data.reversals === null ? (data.runs ? "idle" : "none") : data.reversals ? "some" : "zero";
      this.joints = data.joints ?? [];
      this.travel = data.travel;
      this.margin = data.margin;
      this.limit = data.limit;
      this.around = data.around;
      this.nearest = this.legs.nearest = data.nearest;
      this.why = data.why || (data.nearest?.why ?? "");
      this.edited = data.edited;
      this.lost = data.lost;
      this.plane.turning(data.senses ?? null);
    },

    showLoads() {
      this.loads = this.plane.loaded = !this.loads;
      this.plane.drawLoads();
    },

    showNear() {
      this.near = this.plane.tight = !this.near;
      this.plane.drawZone();
    },

    drawn({ seq, asked }) {
      this.last = performance.now() - asked;
      window.dispatchEvent(new CustomEvent("zerorev-drawn", { detail: { seq, ms: this.last } }));
    },

    // ---- what is drawn

    resize() {
      const { width, height } = this.$refs.plot.getBoundingClientRect();
      this.plane.resize(width, height);
      for (const svg of [this.$refs.back, this.$refs.svg]) svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
      this.draw();
    },

    draw() {
      this.plane.draw();
      this.legs.draw();
    },

    /** Show a whole turn around the motion, or more where it spans more. */
    fit(draw = true) {
      const spins = this.legs.points.map((point) => point.psi);
      const [low, high] = spins.length ? [Math.min(...spins), Math.max(...spins)] : [0, 0];
      const far = Math.max(Math.abs(low), Math.abs(high)) > 150;
      this.plane.look(far ? Math.round((low + high) / 30) * 15 : 0, Math.max(180, (high - low) / 2 + 30));
      if (draw) this.draw();
      else this.plane.draw();
    },

    zoom(by, about = null) {
      const { low, high } = this.plane;
      const spins = this.legs.points.map((point) => point.psi);
      const centre = about ?? (spins.length ? (Math.min(...spins) + Math.max(...spins)) / 2 : 0);
      const half = Math.min(Math.max(((high - low) / 2) * by, LEAST_HALF), 360);
      // the spin under the pointer stays there; a button brings the motion to the middle
      const share = about === null ? 0.5 : (high - about) / (high - low);
      this.plane.look(centre + (2 * share - 1) * half, half);
      this.draw();
    },

    wheel(event) {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      this.zoom(event.deltaY > 0 ? 1.15 : 1 / 1.15, this.plane.psiAt(this.at(event).y));
    },

    tell(event) {
      const place = event && this.at(event);
      this.readout = (place && this.plane.say(this.plane.distanceAt(place.x), this.plane.psiAt(place.y))) ?? "";
    },

    at(event) {
      const box = this.held?.box ?? this.$refs.svg.getBoundingClientRect(); // measured once a drag: it costs a layout
      return { x: event.clientX - box.left, y: event.clientY - box.top };
    },

    // ---- steering by hand

    press(event) {
      if (event.button !== 0) return;
      const handle = event.target.closest(".zr-tw-handle");
      const { x, y } = this.at(event);
      if (event.target.closest(".zr-tw-hit")) return; // of a double click
      this.$refs.svg.setPointerCapture(event.pointerId);
      if (!handle) {
        this.held = { y, low: this.plane.low, high: this.plane.high };
        return;
      }
      event.preventDefault();
      handle.focus();
      this.held = { n: Number(handle.dataset.index), x, y, start: this.legs.points, moved: false, box: this.$refs.svg.getBoundingClientRect() };
      handle.classList.add("held");
    },

    move(event) {
      this.tell(event);
      if (!this.held) return;
      const { x, y } = this.at(event);
      const { start, n, low, high } = this.held;
      const by = ((this.plane.high - this.plane.low) * (this.held.y - y)) / this.plane.innerHeight;
      if (!start) {
        this.plane.look((low + high) / 2 - by, (high - low) / 2);
        this.draw();
        return;
      }
      if (!this.held.moved) {
        if (Math.hypot(x - this.held.x, y - this.held.y) < 2) return; // a click, not a drag
        this.held.moved = true;
        this.take();
      }
      const along = ((x - this.held.x) / this.plane.innerWidth) * 2 * this.plane.reach;
      const outwards = n < this.legs.corner ? -1 : 1;
      const inner = this.legs.kind(n) === "inner";
      this.steer(
        event.shiftKey ? turned(start, by) : moved(start, n, start[n].psi + by, inner ? start[n].standoff + outwards * along : null),
        event.timeStamp,
      );
    },

    /** The motion is edited from now on: other views may want to know. */
    take() {
      window.dispatchEvent(new CustomEvent("zerorev-in-hand", { detail: true }));
      this.$emit("grab");
    },

    letGo() {
      window.dispatchEvent(new CustomEvent("zerorev-in-hand", { detail: false }));
    },

    release() {
      const held = this.held;
      this.held = null;
      this.letHandleGo();
      if (held?.moved) this.drop();
    },

    /** Escape, or the pointer is taken away: all is as before the drag. */
    cancel(event) {
      event.preventDefault?.();
      const held = this.held;
      this.held = null;
      this.letHandleGo();
      if (!held?.start) return;
      this.legs.points = held.start;
      this.legs.draw();
      this.waiting = this.next = null;
      if (!held.moved) return;
      this.letGo();
      this.$emit("restore");
    },

    letHandleGo() {
      this.$refs.svg.querySelectorAll(".held").forEach((each) => each.classList.remove("held"));
    },

    add(event) {
      if (!event.target.closest(".zr-tw-hit")) return;
      this.insert(this.plane.distanceAt(this.at(event).x), event.timeStamp);
    },

    insert(distance, asked) {
      const { points, corner } = this.legs;
      let n = 0;
      while (n < points.length - 2 && this.legs.distance(n + 1) < distance) n++;
      const room = Math.min(distance - this.legs.distance(n), this.legs.distance(n + 1) - distance);
      if (room < 0.2) return;
      this.change(inserted(points, n, Math.abs(distance) + points[corner].standoff, this.legs.psiAt(distance)), asked);
      this.$refs.svg.querySelector(`[data-testid="handle-inner-${n + 1}"]`)?.focus();
    },

    key(event) {
      const pace = event.shiftKey ? "shift" : event.ctrlKey || event.altKey ? "fine" : "plain";
      const leg = event.target.closest(".zr-tw-hit");
      const handle = event.target.closest(".zr-tw-handle");
      const n = handle ? Number(handle.dataset.index) : null;
      const change = leg ? this.legKey(event, leg) : handle && this.handleKey(event, n, pace);
      if (!change) return;
      event.preventDefault();
      change();
    },

    legKey(event, leg) {
      const half = (leg.dataset.leg === "plunge" ? -0.5 : 0.5) * this.plane.reach;
      return event.key === "Insert" ? () => this.insert(half, event.timeStamp) : null;
    },

    handleKey(event, n, pace) {
      const { points } = this.legs;
      const { psi, standoff } = points[n];
      const inner = this.legs.kind(n) === "inner";
      const right = n < this.legs.corner ? -1 : 1;
      const to = (list) => () => this.change(list, event.timeStamp);
      const here = this.legs.distance(n);
      const after = n < points.length - 1 ? this.legs.distance(n + 1) : this.legs.distance(n - 1);
      return {
        ArrowUp: to(moved(points, n, psi + STEPS[pace])),
        ArrowDown: to(moved(points, n, psi - STEPS[pace])),
        ArrowLeft: inner && to(moved(points, n, psi, standoff - right * ALONG[pace])),
        ArrowRight: inner && to(moved(points, n, psi, standoff + right * ALONG[pace])),
        PageUp: to(turned(points, STEPS[pace])),
        PageDown: to(turned(points, -STEPS[pace])),
        Insert: () => this.insert((here + after) / 2, event.timeStamp),
        Delete: inner && to(removed(points, n)),
      }[event.key];
    },

    /** A change by key: it counts as let go when no other follows. */
    change(points, asked) {
      if (!this.settling) this.take();
      clearTimeout(this.settling);
      this.settling = setTimeout(() => this.settle(), SETTLED);
      this.steer(points, asked);
    },

    settle() {
      if (!this.settling) return;
      clearTimeout(this.settling);
      this.settling = null;
      this.drop();
    },

    steer(points, asked) {
      this.legs.points = points;
      this.legs.draw();
      this.next = { asked };
      this.send();
    },

    /** The newest points go to the server, one message at a time. */
    send() {
      if (!this.next || (this.waiting && performance.now() - this.waiting.sent < LATE)) return;
      this.waiting = { seq: ++this.seq, asked: this.next.asked, sent: performance.now() };
      this.next = null;
      this.$emit("drag", { points: this.list(), seq: this.seq, ms: this.last });
    },

    list() {
      return this.legs.points.map(({ standoff, psi }, n) => [n, psi, standoff]);
    },

    drop() {
      this.letGo();
      this.next = this.waiting = null;
      this.$emit("drop", { points: this.list() });
    },

    choose(event) {
      this.choice = event.target.value;
      this.$emit("choose", { branch: this.choice });
    },
  },
};
