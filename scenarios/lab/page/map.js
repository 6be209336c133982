// The map of error over magnet size and air gap: classes of the error asked for, hatched where the field is no good.
import { become, element, given, set, text, ticks, watched, wide } from "./plot.js";

const CLASSES = [0.25, 0.5, 0.75, 1, 1.5, 2.5];

/** `go(size, gap)` hears where a person wants to be. */
export class ErrorMap {
  constructor(host, go) {
    Object.assign(this, { host, go, told: null, point: element("g") });
    this.svg = element("svg", { role: "img" });
    host.append(this.svg);
    watched(host, (width) => {
      this.width = width;
      if (this.told) this.draw(this.told, this.design);
    });
    this.svg.addEventListener("click", (event) => this.clicked(event));
  }

  clicked(event) {
    if (!this.place) return;
    const box = this.svg.getBoundingClientRect();
    const { frame, span } = this.place;
    const at = [event.clientX - box.left, event.clientY - box.top].map((one) => (one * this.place.width) / box.width);
    const share = [(at[0] - frame.left) / (frame.right - frame.left), (frame.bottom - at[1]) / (frame.bottom - frame.top)];
    if (share.some((one) => one < 0 || one > 1)) return;
    const [size, gap] = share.map((one, k) => +(span[k][0] + one * (span[k][1] - span[k][0])).toFixed(2));
    this.go(size, gap);
  }

  draw(told, design) {
    Object.assign(this, { told, design });
    const { size_mm: sizes, air_gap_mm: gaps, error_deg: error, field_low_mT: low, field_high_mT: high } = told;
    const limit = design.demand.max_error_deg;
    const window_ = design.demand.window_mT;
    const { width } = this;
    const bottom = Math.min(330, Math.max(210, width * 0.55)) + 24;
    const legend = this.legend(limit, width);
    const frame = { left: 40, right: width - 8, top: legend.height + 22, bottom: bottom + legend.height };
    const half = (values) => (values[1] - values[0]) / 2;
    const span = [sizes, gaps].map((values) => [values[0] - half(values), values[values.length - 1] + half(values)]);
    const px = (value) => frame.left + ((value - span[0][0]) / (span[0][1] - span[0][0])) * (frame.right - frame.left);
    const py = (value) => frame.bottom - ((value - span[1][0]) / (span[1][1] - span[1][0])) * (frame.bottom - frame.top);
    const [w, h] = [px(sizes[1]) - px(sizes[0]), py(gaps[0]) - py(gaps[1])];
    const cells = element("g", { "shape-rendering": "crispEdges" });
    let bad = "";
    gaps.forEach((gap, row) => sizes.forEach((size, column) => {
      const [x, y] = [px(size) - w / 2, py(gap) - h / 2];
      const kind = CLASSES.findIndex((one) => error[row][column] <= one * limit);
      cells.append(element("rect", { class: `m${kind < 0 ? CLASSES.length : kind}`, x, y, width: w + 0.5, height: h + 0.5 }));
      if (low[row][column] < window_[0] || high[row][column] > window_[1]) {
        bad += `M${x.toFixed(1)} ${(y + h).toFixed(1)}L${(x + w).toFixed(1)} ${y.toFixed(1)}`;
      }
    }));
    const axes = [];
    for (const mark of ticks(span[0][0], span[0][1], width < 420 ? 4 : 8).filter((one) => one >= span[0][0] && one <= span[0][1])) {
      axes.push(element("path", { class: "frame", d: `M${px(mark)} ${frame.bottom}v4` }), text(given(mark), { x: px(mark), y: frame.bottom + 16, "text-anchor": "middle" }));
    }
    for (const mark of ticks(span[1][0], span[1][1], 5).filter((one) => one >= span[1][0] && one <= span[1][1])) {
      axes.push(element("path", { class: "frame", d: `M${frame.left} ${py(mark)}h-4` }), text(given(mark), { x: frame.left - 7, y: py(mark) + 4, "text-anchor": "end" }));
    }
    const name = design.magnet.shape === "block" ? "side of the block / mm" : "diameter / mm";
    axes.push(text("air gap / mm", { class: "label", x: 2, y: legend.height + 12 }), text(name, { class: "label", x: (frame.left + frame.right) / 2, y: frame.bottom + 32, "text-anchor": "middle" }));
    this.place = { frame, span, width };
    set(this.svg, { viewBox: `0 0 ${width} ${frame.bottom + 38}`, "aria-label": `Largest error over ${name} and air gap` });
    this.svg.replaceChildren(legend.group, cells, element("path", { class: "hatch", d: bad }), ...axes, this.point);
    this.scale = { px, py };
    this.here(design);
  }

  /** Where the design stands on the map. */
  here(design) {
    this.design = design;
    if (!this.scale) return;
    const { magnet, placement } = design;
    const size = magnet.shape === "block" ? magnet.length_mm : magnet.diameter_mm;
    const at = { cx: this.scale.px(size), cy: this.scale.py(placement.air_gap_mm), r: 7 };
    become(this.point, [element("circle", { class: "here-halo", ...at }), element("circle", { class: "here", ...at })]);
  }

  legend(limit, width) {
    const group = element("g");
    const names = CLASSES.map((one) => `≤ ${given(one * limit)}°`);
    names.push(`> ${given(CLASSES[CLASSES.length - 1] * limit)}°`);
    let [x, y] = [0, 12];
    names.forEach((name, k) => {
      const long = 30 + wide(name);
      if (x + long - 10 > width) [x, y] = [0, y + 17];
      group.append(element("rect", { class: `m${k}`, x, y: y - 10, width: 14, height: 11 }), text(name, { x: x + 18, y }));
      x += long;
    });
    return { group, height: y + 8 };
  }
}
