// The magnet above the sensor, to scale, from the side and along the shaft; what can be moved is moved here too.
import { become, element, given, set, text, watched } from "./plot.js";

const SCALES = [3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50];
const PACKAGE = { width: 5, depth: 4.4, above: 0.25, below: 0.75 };
const STEP = 0.01;

const rounded = (value, step = STEP) => +(Math.round(value / step) * step).toFixed(6);
const within = (value, low, high) => Math.min(Math.max(value, low), high);

/** Width and depth of a magnet [mm]. */
function extent(magnet) {
  return magnet.shape === "block" ? [magnet.length_mm, magnet.width_mm] : [magnet.diameter_mm, magnet.diameter_mm];
}

/** One view of the bench; `move(changes, when)` hears of what is dragged, as paths and values. */
class View {
  constructor(host, words, move) {
    Object.assign(this, { host, move, held: null });
    this.svg = element("svg", { role: "group", "aria-label": words });
    host.append(this.svg);
    watched(host, (width) => {
      this.width = width;
      if (this.design) this.draw(this.design);
    });
    this.svg.addEventListener("pointerdown", (event) => this.take(event));
    this.svg.addEventListener("pointermove", (event) => this.held && this.drag(event));
    for (const name of ["pointerup", "pointercancel"]) {
      this.svg.addEventListener(name, () => {
        this.held = null;
        if (this.design) this.draw(this.design);
      });
    }
    this.svg.addEventListener("keydown", (event) => this.key(event));
  }

  take(event) {
    const part = event.target.closest("[data-part]");
    if (!part) return;
    this.svg.setPointerCapture(event.pointerId);
    this.svg.querySelector(`[data-part="${part.dataset.part}"]`).focus({ focusVisible: false });
    this.held = { part: part.dataset.part, from: [event.clientX, event.clientY], design: this.design };
    event.preventDefault();
  }

  drag(event) {
    const by = [(event.clientX - this.held.from[0]) / this.scale, (event.clientY - this.held.from[1]) / this.scale];
    this.move(this.moved(this.held.part, by, this.held.design), event.timeStamp);
  }

  key(event) {
    const part = event.target.dataset?.part;
    const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (!part || !ways[event.key]) return;
    event.preventDefault();
    const step = event.shiftKey ? 0.01 : 0.1;
    this.move(this.moved(part, ways[event.key].map((one) => one * step), this.design), event.timeStamp);
  }

  /** Pixels a millimetre so that this many millimetres fit; it stays while something is held. */
  fitted(wide, tall, width, height) {
    if (this.held && this.scale) return this.scale;
    return SCALES.filter((one) => one * wide <= width && one * tall <= height).pop() ?? SCALES[0];
  }

  show(parts, width, height) {
    set(this.svg, { viewBox: `0 0 ${width} ${height}` });
    become(this.svg, parts);
  }
}

/** A part that can be moved. */
function movable(part, words, told, ...children) {
  const attributes = { class: "movable", tabindex: 0, role: "slider", "data-part": part, "aria-label": words, "aria-valuenow": told.value, "aria-valuetext": told.words };
  return element("g", attributes, ...children);
}

function scaleBar(scale, x, y) {
  const long = [0.5, 1, 2, 5, 10].find((one) => one * scale >= 30) ?? 10;
  const path = `M${x} ${y - 4}v8M${x} ${y}h${long * scale}M${x + long * scale} ${y - 4}v8`;
  return [element("path", { class: "dimension", d: path }), text(`${long} mm`, { x: x + long * scale + 6, y: y + 4 })];
}

/** A length between two points on one line, with heads and a number beside it. */
function dimension(from, to, words, { upright = false, at }) {
  const [a, b] = [Math.min(from, to), Math.max(from, to)];
  const head = Math.min(5, (b - a) / 2.2);
  const tip = (x, way) => (upright ? `M${at - 3} ${x + way * head}L${at} ${x}L${at + 3} ${x + way * head}z` : `M${x + way * head} ${at - 3}L${x} ${at}L${x + way * head} ${at + 3}z`);
  const line = upright ? `M${at} ${a}V${b}` : `M${a} ${at}H${b}`;
  const words_at = upright ? { x: at + 7, y: (a + b) / 2 + 4 } : { x: (a + b) / 2, y: at - 6, "text-anchor": "middle" };
  return [element("path", { class: "dimension", d: line }), element("path", { class: "dimension-head", d: tip(a, 1) + tip(b, -1) }), text(words, { class: "label", ...words_at })];
}

/** Down the shaft: the magnet above, the sensor below it. */
export class Side extends View {
  constructor(host, move) {
    super(host, "The magnet above the sensor, from the side", move);
  }

  moved(part, [right, down], { magnet, placement }) {
    const gap = (value) => rounded(within(value, 0.05, 20));
    if (part === "magnet") {
      return { "placement.air_gap_mm": gap(placement.air_gap_mm - down), "placement.magnet_x_mm": rounded(within(placement.magnet_x_mm + right, -5, 5)) };
    }
    if (part === "sensor") {
      return { "placement.air_gap_mm": gap(placement.air_gap_mm + down), "placement.sensor_x_mm": rounded(within(placement.sensor_x_mm + right, -5, 5)) };
    }
    const size = (value) => rounded(within(value, 0.5, 30), 0.05);
    const wide = magnet.shape === "block" ? "length_mm" : "diameter_mm";
    return { [`magnet.${wide}`]: size(magnet[wide] + 2 * right), "magnet.height_mm": size(magnet.height_mm - down) };
  }

  draw(design) {
    this.design = design;
    const { magnet, placement } = design;
    const { width } = this;
    const height = Math.min(320, Math.max(230, width * 0.7));
    const [wide] = extent(magnet);
    const reach = Math.max(wide + 2 * Math.abs(placement.magnet_x_mm), PACKAGE.width + 2 * Math.abs(placement.sensor_x_mm));
    const s = this.fitted(reach + 1, magnet.height_mm + placement.air_gap_mm + PACKAGE.below, width - 110, height - 74);
    this.scale = s;
    const axis = width / 2 - 14;
    const plane = height - 34 - PACKAGE.below * s;
    const face = plane - placement.air_gap_mm * s;
    const tall = magnet.height_mm * s;
    const [mx, sx] = [axis + placement.magnet_x_mm * s, axis + placement.sensor_x_mm * s];
    const centre = face - tall / 2;
    const half = (wide * s) / 2;
    const words = `${magnet.shape} ${given(wide)} mm wide, ${given(magnet.height_mm)} mm high`;
    const bodies = [
      element("rect", { class: "north", x: mx - half, y: face - tall, width: half, height: tall }),
      element("rect", { class: "south", x: mx, y: face - tall, width: half, height: tall }),
    ];
    if (magnet.shape === "ring") {
      const bore = (magnet.bore_mm * s) / 2;
      bodies.push(element("rect", { class: "package", x: mx - bore, y: face - tall, width: 2 * bore, height: tall }));
    }
    const poles = tall >= 14 && half >= 16 ? [text("N", { class: "pole", x: mx - half / 2 - (magnet.shape === "ring" ? (magnet.bore_mm * s) / 4 : 0), y: centre }), text("S", { class: "pole", x: mx + half / 2 + (magnet.shape === "ring" ? (magnet.bore_mm * s) / 4 : 0), y: centre })] : [];
    const body = movable("magnet", "Magnet: up and down for the air gap, left and right off the axis", { value: placement.air_gap_mm, words: `${words}; air gap ${placement.air_gap_mm} mm` },
      ...bodies, element("rect", { class: "outline", x: mx - half, y: face - tall, width: 2 * half, height: tall }), ...poles);
    set(body, { transform: `rotate(${-placement.magnet_tilt_y_deg} ${mx} ${centre})` });
    const chip = (PACKAGE.width * s) / 2;
    const sensor = movable("sensor", "Sensor: left and right off the axis, up and down for the air gap", { value: placement.sensor_x_mm, words: `${placement.sensor_x_mm} mm off the axis` },
      element("rect", { class: "package", x: sx - chip, y: plane - PACKAGE.above * s, width: 2 * chip, height: (PACKAGE.above + PACKAGE.below) * s, rx: 2 }),
      element("path", { class: "plane", d: `M${sx - chip * 0.4} ${plane}h${chip * 0.8}` }),
      element("circle", { class: "die", cx: sx, cy: plane, r: 3 }),
      element("rect", { class: "hit", x: sx - chip, y: plane - 10, width: 2 * chip, height: PACKAGE.below * s + 16 }));
    set(sensor, { transform: `rotate(${-placement.sensor_tilt_y_deg} ${sx} ${plane})` });
    const right = Math.max(axis + (reach / 2) * s, mx + half, sx + chip) + 14;
    const rule = element("path", { class: "dimension", "stroke-dasharray": "2 3", d: `M${mx + half + 3} ${face}H${right + 4}M${sx + chip + 3} ${plane}H${right + 4}` });
    const parts = [
      element("path", { class: "axis", d: `M${axis} 6V${height - 24}` }),
      sensor, body, rule,
      ...dimension(face, plane, `${given(placement.air_gap_mm)} mm`, { upright: true, at: right }),
      ...dimension(mx - half, mx + half, `${given(wide)} mm`, { at: face - tall - 8 }),
      ...dimension(face - tall, face, `${given(magnet.height_mm)} mm`, { upright: true, at: right }),
      this.corner(mx + half, face - tall),
      ...scaleBar(s, 8, height - 10),
      text("x →", { x: width - 4, y: height - 6, "text-anchor": "end" }),
    ];
    this.show(parts, width, height);
  }

  corner(x, y) {
    const words = { value: extent(this.design.magnet)[0], words: `${extent(this.design.magnet)[0]} by ${this.design.magnet.height_mm} mm` };
    const handle = movable("size", "Size of the magnet: left and right for its width, up and down for its height", words,
      element("rect", { class: "hit", x: x - 13, y: y - 13, width: 26, height: 26 }), element("rect", { class: "handle", x: x - 4.5, y: y - 4.5, width: 9, height: 9, rx: 2 }));
    return handle;
  }
}

/** Along the shaft, from the magnet: x to the right, y down. */
export class Top extends View {
  constructor(host, move) {
    super(host, "Magnet and sensor along the shaft", move);
  }

  moved(part, [right, down], { placement }) {
    const place = (name, by) => rounded(within(placement[name] + by, -5, 5));
    const whose = part === "magnet" ? "magnet" : "sensor";
    return { [`placement.${whose}_x_mm`]: place(`${whose}_x_mm`, right), [`placement.${whose}_y_mm`]: place(`${whose}_y_mm`, down) };
  }

  draw(design) {
    this.design = design;
    const { magnet, placement, demand } = design;
    // Of the gap, the temperature and the rest nothing is seen along the shaft.
    const { air_gap_mm: _, ...place } = placement;
    const seen = JSON.stringify([magnet, place, demand.tolerance.off_axis, this.width, Boolean(this.held)]);
    if (seen === this.seen) return;
    this.seen = seen;
    const { width } = this;
    const height = Math.min(270, Math.max(200, width * 0.6));
    const [wide, deep] = extent(magnet);
    const far = 2 * Math.max(Math.abs(placement.magnet_y_mm), Math.abs(placement.magnet_x_mm));
    const s = this.fitted(Math.max(wide, PACKAGE.width) + far + 1, Math.max(deep, PACKAGE.depth) + far + 0.6, width - 90, height - 26);
    this.scale = s;
    const [cx, cy] = [width / 2 - 14, height / 2];
    const [mx, my] = [cx + placement.magnet_x_mm * s, cy + placement.magnet_y_mm * s];
    const [sx, sy] = [cx + placement.sensor_x_mm * s, cy + placement.sensor_y_mm * s];
    const [a, b] = [(wide * s) / 2, (deep * s) / 2];
    const bore = magnet.shape === "ring" ? (magnet.bore_mm * s) / 2 : 0;
    const round = (sweep) => `M${mx} ${my - b}A${a} ${b} 0 0 ${sweep} ${mx} ${my + b}${bore ? `V${my + bore}A${bore} ${bore} 0 0 ${1 - sweep} ${mx} ${my - bore}` : ""}z`;
    const square = (way) => `M${mx} ${my - b}h${way * a}v${2 * b}h${-way * a}z`;
    const shape = magnet.shape === "block" ? [square(-1), square(1)] : [round(0), round(1)];
    const body = movable("magnet", "Magnet along the shaft: arrow keys move it off the axis", { value: placement.magnet_x_mm, words: `${placement.magnet_x_mm} and ${placement.magnet_y_mm} mm off the axis` },
      element("path", { class: "north", d: shape[0], "fill-opacity": 0.9 }), element("path", { class: "south", d: shape[1], "fill-opacity": 0.9 }),
      element("path", { class: "outline", d: shape.join("") }),
      text("N", { class: "pole", x: mx - (a + bore) / 2, y: my }), text("S", { class: "pole", x: mx + (a + bore) / 2, y: my }));
    const [pw, pd] = [PACKAGE.width * s, PACKAGE.depth * s];
    const outline = element("rect", { class: "outline", x: sx - pw / 2, y: sy - pd / 2, width: pw, height: pd, rx: 3, "stroke-dasharray": "4 3" });
    const radius = demand.tolerance.off_axis * s;
    const sensor = movable("sensor", "Sensor along the shaft: arrow keys move it off the axis", { value: placement.sensor_x_mm, words: `${placement.sensor_x_mm} and ${placement.sensor_y_mm} mm off the axis` },
      element("circle", { class: "hit", cx: sx, cy: sy, r: 15 }), element("circle", { class: "package", cx: sx, cy: sy, r: 5.5 }), element("circle", { class: "die", cx: sx, cy: sy, r: 2.5 }));
    const parts = [body, outline, element("path", { class: "axis", d: `M${cx - 9} ${cy}h18M${cx} ${cy - 9}v18` })];
    if (radius > 5.5) parts.push(element("circle", { class: "tolerance", cx: sx, cy: sy, r: radius }));
    parts.push(sensor, ...this.stray(placement, cx, cy, s), ...scaleBar(s, 8, height - 10), text("x →", { x: width - 4, y: height - 6, "text-anchor": "end" }), text("y ↓", { x: width - 4, y: height - 22, "text-anchor": "end" }));
    this.show(parts, width, height);
  }

  stray({ stray_x_mT: x, stray_y_mT: y }, cx, cy, s) {
    const size = Math.hypot(x, y);
    if (!size) return [];
    const [dx, dy] = [(x / size) * 34, (y / size) * 34];
    const from = [36, 36];
    const tip = [from[0] + dx / 2, from[1] + dy / 2];
    const head = `M${tip[0]} ${tip[1]}l${(-dx * 8 - dy * 4) / 34} ${(-dy * 8 + dx * 4) / 34}l${(dy * 8) / 34} ${(-dx * 8) / 34}z`;
    return [element("path", { class: "stray", d: `M${from[0] - dx / 2} ${from[1] - dy / 2}L${tip}` }), element("path", { class: "stray-head", d: head }), text(`stray ${given(size)} mT`, { x: 10, y: 14 })];
  }
}
