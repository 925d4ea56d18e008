// A chart, drawn by ECharts as SVG. What it shows comes by `show` and not as a property: Vue would watch every point of
// a curve, and go through the whole page whenever one moves.
import { echarts } from "nicegui-echart";

const minus = (text) => String(text).replace("-", "\u2212");

// what stands beside the pointer, said as views/chart.py: tip has it
function tip({ across, up, digits, within }) {
  const [low, high] = within ?? [-Infinity, Infinity];
  const said = (value) =>
    value > high ? `beyond ${high}` : value < low ? minus(`beyond ${low}`) : minus(value.toFixed(digits[1]));
  return (points) => {
    const named = points.filter(
      ({ seriesType, seriesName, value }) => seriesType === "line" && value?.[1] != null && !seriesName.includes("\0"),
    );
    if (!named.length) return "";
    const rows = named.map(
      ({ color, seriesName, value }) =>
        `<tr><td><span class="zr-tip-key" style="background:${color}"></span>
        ${echarts.format.encodeHTML(seriesName)}</td><td>${said(value[1])}</td></tr>`,
    );
    const place = minus(named[0].value[0].toFixed(digits[0]));
    return `<table class="zr-tip"><caption>at ${place} ${across}, in ${up}</caption>${rows.join("")}</table>`;
  };
}

export default {
  template: "<div></div>",
  mounted() {
    this.chart = echarts.init(this.$el, null, { renderer: "svg" });
    this.sizes = new ResizeObserver(() => this.chart.resize());
    this.sizes.observe(this.$el);
  },
  unmounted() {
    this.sizes.disconnect();
    this.chart.dispose();
  },
  methods: {
    // options: of ECharts, or those that are others than before; series are distinguished by their ids
    show(options) {
      for (const axis of [options.xAxis ?? [], options.yAxis ?? []].flat()) axis.axisLabel.formatter = minus;
      if (options.tooltip) options.tooltip.formatter = tip(options.tooltip.said);
      this.chart.setOption(options);
    },
  },
};
