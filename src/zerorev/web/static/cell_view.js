// The cell as a part of the page; all of it is in the player that the replay file has, too.
import { Cell } from "zerorev-cell/cell.js";

export default {
  template: "<div></div>",
  mounted() {
    this.cell = new Cell(this.$el, {
      pickHole: (id) => this.$emit("pick_hole", { id }),
      pickCell: (index) => this.$emit("pick_cell", { index }),
      seek: (x) => this.$emit("seek", { x }),
    });
    this.onHand = (event) => this.cell.inHand(event.detail);
    window.addEventListener("zerorev-in-hand", this.onHand); // of the twist map
    this.$emit("ready", {});
  },
  unmounted() {
    window.removeEventListener("zerorev-in-hand", this.onHand);
    this.cell.dispose();
  },
  methods: {
    show_scene(data) {
      this.cell.showScene(data);
    },
    show_motion(data) {
      this.cell.showMotion(data);
      requestAnimationFrame(() => requestAnimationFrame(() => this.$emit("drawn", {})));
    },
    show_slice(data) {
      this.cell.showSlice(data);
    },
    seek(x) {
      this.cell.seek(x);
    },
  },
};
