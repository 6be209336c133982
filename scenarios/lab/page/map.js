// The map of error or yield over magnet size and air gap: classes of what is asked for, hatched one way where the field
// is too weak and the other way where it is too strong.
import { become, element, given, set, shown, text, ticks, watched, wide } from "./plot.js";

const SHARES = [0.25, 0.5, 0.75, 1, 1.5, 2.5];
const YIELDS = [0.9, 0.75, 0.5];

/** The classes of a map: colour, words and whether a value belongs to it, the first that does. */
function classesOf(told, demand) {
  if (told.yield) {
    const least = [demand.min_yield, ...YIELDS.filter((one) => one < demand.min_yield)];
    const found = least.map((one, k) => ({ colour: ["m1", "m3", "m4", "m5"][k], words: `≥ ${given(100 * one)} %`, has: (value) => value >= one }));
    return [...found, { colour: "m6", words: `< ${given(100 * least[least.length - 1])} %`, has: () => true }];
  }
  const limit = demand.max_error_deg;
  const found = SHARES.map((one, k) => ({ colour: `m${k}`, words: `≤ ${given(one * limit)}°`, has: (value) => value <= one * limit }));
  return [...found, { colour: "m6", words: `> ${given(SHARES[SHARES.length - 1] * limit)}°`, has: () => true }];
}

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
    const { size_mm: sizes, air_gap_mm: gaps, field_low_mT: low, field_high_mT: high } = told;
    const values = told.yield ?? told.error_deg;
    const classes = classesOf(told, design.demand);
    const window_ = design.demand.window_mT;
    const { width } = this;
    const bottom = Math.min(330, Math.max(210, width * 0.55)) + 24;
    const legend = this.legend(classes, width);
    const frame = { left: 40, right: width - 8, top: legend.height + 22, bottom: bottom + legend.height };
    const half = (values) => (values[1] - values[0]) / 2;
    const span = [sizes, gaps].map((values) => [values[0] - half(values), values[values.length - 1] + half(values)]);
    const px = (value) => frame.left + ((value - span[0][0]) / (span[0][1] - span[0][0])) * (frame.right - frame.left);
    const py = (value) => frame.bottom - ((value - span[1][0]) / (span[1][1] - span[1][0])) * (frame.bottom - frame.top);
    const [w, h] = [px(sizes[1]) - px(sizes[0]), py(gaps[0]) - py(gaps[1])];
    // One path a class: hundreds of squares of their own would be laid out and painted with every move of the hand.
    const cells = new Map(classes.map(({ colour }) => [colour, ""]));
    let [weak, strong] = ["", ""];
    gaps.forEach((gap, row) => sizes.forEach((size, column) => {
      const [x, y] = [px(size) - w / 2, py(gap) - h / 2];
      const { colour } = classes.find((one) => one.has(values[row][column]));
      cells.set(colour, `${cells.get(colour)}M${x.toFixed(1)} ${y.toFixed(1)}h${(w + 0.5).toFixed(1)}v${(h + 0.5).toFixed(1)}h${(-w - 0.5).toFixed(1)}z`);
      if (low[row][column] < window_[0]) weak += `M${x.toFixed(1)} ${(y + h).toFixed(1)}L${(x + w).toFixed(1)} ${y.toFixed(1)}`;
      if (high[row][column] > window_[1]) strong += `M${x.toFixed(1)} ${y.toFixed(1)}L${(x + w).toFixed(1)} ${(y + h).toFixed(1)}`;
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
    set(this.svg, { viewBox: `0 0 ${width} ${frame.bottom + 38}` });
    const areas = [...cells].map(([colour, d]) => element("path", { class: colour, d }));
    this.svg.replaceChildren(legend.group, element("g", { "shape-rendering": "crispEdges" }, ...areas), element("path", { class: "hatch weak", d: weak }), element("path", { class: "hatch strong", d: strong }), ...axes, this.point);
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
    set(this.svg, { "aria-label": this.words(size, placement.air_gap_mm) });
    become(this.point, [element("circle", { class: "here-halo", ...at }), element("circle", { class: "here", ...at })]);
  }

  /** The map in words: what it is of, and what it has where the design stands. */
  words(size, gap) {
    const { told } = this;
    const nearest = (values, value) => values.reduce((best, one, k) => (Math.abs(one - value) < Math.abs(values[best] - value) ? k : best), 0);
    const [row, column] = [nearest(told.air_gap_mm, gap), nearest(told.size_mm, size)];
    const window_ = this.design.demand.window_mT;
    const at = told.yield ? `${given(100 * told.yield[row][column])} %` : `${shown(told.error_deg[row][column])} deg`;
    const field = told.field_low_mT[row][column] < window_[0] ? ", field too weak" : told.field_high_mT[row][column] > window_[1] ? ", field too strong" : "";
    const of = told.yield ? "Yield" : "Largest error";
    return `${of} over the magnet's size and the air gap; near ${given(size)} mm and ${given(gap)} mm ${at}${field}`;
  }

  legend(classes, width) {
    const group = element("g");
    let [x, y] = [0, 12];
    const add = (name, ...sample) => {
      const long = 30 + wide(name);
      if (x + long - 10 > width) [x, y] = [0, y + 17];
      group.append(...sample.map(([kind, attributes]) => element(kind, attributes(x, y))), text(name, { x: x + 18, y }));
      x += long;
    };
    const box = (colour) => ["rect", (left, base) => ({ class: colour, x: left, y: base - 10, width: 14, height: 11 })];
    for (const one of classes) add(one.words, box(one.colour));
    const rising = (left, base) => ({ class: "hatch", d: `M${left} ${base - 4}l6 -6M${left} ${base + 1}l11 -11M${left + 4} ${base + 1}l10 -10M${left + 9} ${base + 1}l5 -5` });
    const falling = (left, base) => ({ class: "hatch", d: `M${left} ${base - 5}l6 6M${left} ${base - 10}l11 11M${left + 4} ${base - 10}l10 10M${left + 9} ${base - 10}l5 5` });
    add("field too weak", ["path", rising]);
    add("too strong", ["path", falling]);
    return { group, height: y + 8 };
  }
}
