// Pictures of curves and bars in SVG: axes with units, a legend a stranger can read, text that keeps its size.
const NS = "http://www.w3.org/2000/svg";

/** An element of SVG. */
export function element(name, attributes = {}, ...children) {
  const made = document.createElementNS(NS, name);
  set(made, attributes);
  made.append(...children);
  return made;
}

/** Set attributes. */
export function set(node, attributes) {
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

/** Make the children of a node those that are given, by changing as little as may be: what has the focus keeps it. */
export function become(host, children) {
  const old = [...host.childNodes];
  children.forEach((child, k) => {
    if (k >= old.length) host.append(child);
    else if (alike(old[k], child)) adopt(old[k], child);
    else old[k].replaceWith(child);
  });
  old.slice(children.length).forEach((one) => one.remove());
}

function alike(one, other) {
  return one.nodeName === other.nodeName && one.dataset?.part === other.dataset?.part;
}

function adopt(old, fresh) {
  if (old.nodeType !== Node.ELEMENT_NODE) {
    if (old.data !== fresh.data) old.data = fresh.data;
    return;
  }
  for (const { name, value } of [...fresh.attributes]) if (old.getAttribute(name) !== value) old.setAttribute(name, value);
  for (const { name } of [...old.attributes]) if (!fresh.hasAttribute(name)) old.removeAttribute(name);
  become(old, [...fresh.childNodes]);
}

/** Other words in an element, where they are others: what a screen reader has read it does not read again. */
export function put(host, told) {
  if (host.textContent !== told) host.textContent = told;
}

/** A number with so many significant digits, and a minus sign that is one. */
export function shown(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e6)) return minus(value.toExponential(digits - 1));
  const behind = size === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return minus(value.toFixed(Math.min(behind, 6)));
}

const minus = (text) => text.replace("-", "−");

/** A number that a person has set, as it was set. */
export function given(value) {
  return minus(String(+value.toFixed(6)));
}

/** Round numbers from below low to above high, about so many. */
export function ticks(low, high, about = 5) {
  const span = high - low || Math.abs(high) || 1;
  const raw = span / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].find((one) => one * power >= raw * 0.999) * power;
  const first = Math.floor(low / step + 1e-9);
  const last = Math.ceil(high / step - 1e-9);
  return Array.from({ length: last - first + 1 }, (_, k) => (first + k) * step);
}

/** A tick's number with as many decimals as the step between ticks has. */
function tick(value, step) {
  let decimals = 0;
  while (decimals < 8 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6) decimals += 1;
  return minus(value.toFixed(decimals));
}

/** Have `seen` hear of an element's width, at once and whenever it changes: to ask each time would lay the page out. */
export function watched(host, seen) {
  seen(host.clientWidth || 400);
  new ResizeObserver(([{ contentRect }]) => contentRect.width && seen(contentRect.width)).observe(host);
}

/** A picture with axes; it draws itself anew where its place changes its width. */
export class Plot {
  /** `x` and `y` name the axes with their units; `span` is that of x, `marks` its ticks. */
  constructor(host, { x, y, span, marks, height = 190, words }) {
    Object.assign(this, { host, x, y, span, marks, height, words });
    this.svg = element("svg", { role: "img", "aria-label": words });
    host.append(this.svg);
    this.data = null;
    this.seen = true;
    watched(host, (width) => {
      this.width = width;
      if (this.data) this.draw(this.data);
    });
    // What is not on the screen is drawn when it comes there: the hand waits for nothing that nobody sees.
    new IntersectionObserver((entries) => {
      this.seen = entries[entries.length - 1].isIntersecting;
      if (this.seen && this.stale) this.draw(this.data);
    }, { rootMargin: "200px" }).observe(host);
  }

  /**
   * Draw lines ({name, style, values, x?}: without x they are spread evenly over the turn), dots, columns (lowest and
   * highest), bars, bands (low, high, name) and limits (value, name) of y.
   */
  draw(data) {
    this.data = data;
    const values = valuesOf(data);
    this.describe(data, values);
    this.stale = !this.seen;
    if (this.stale && this.drawn) return;
    this.drawn = true;
    const { width } = this;
    const largest = Math.max(0, ...(data.limits ? (data.lines ?? []).flatMap((line) => line.values.map(Math.abs)) : []));
    // A limit far beyond the curves would press them flat: it is left out, and its name with it.
    const limits = (data.limits ?? []).filter((limit) => limit.always || limit.value <= 2.5 * largest);
    const entries = [...(data.dots ?? []).filter((one) => one.name), ...(data.columns ?? []).filter((one) => one.name), ...(data.lines ?? []).filter((one) => one.name), ...(data.bands ?? []), ...limits];
    const legend = legendOf(entries, width);
    const top = legend.height + 22;
    const frame = { left: 46, right: width - 8, top, bottom: top + this.height };
    const span = data.span ?? this.span;
    const reach = [...values, ...(data.include ?? []), ...limits.flatMap((limit) => (limit.both ? [limit.value, -limit.value] : [limit.value]))];
    let [low, high] = [Infinity, -Infinity];
    for (const value of reach) [low, high] = [Math.min(low, value), Math.max(high, value)];
    if (!(high > low)) [low, high] = [low - 1e-3, high + 1e-3];
    const marks = ticks(low, high, 5);
    [low, high] = [marks[0], marks[marks.length - 1]];
    const px = (value) => frame.left + ((value - span[0]) / (span[1] - span[0])) * (frame.right - frame.left);
    const py = (value) => frame.bottom - ((value - low) / (high - low)) * (frame.bottom - frame.top);
    const parts = [legend.group];
    for (const band of data.bands ?? []) {
      const [a, b] = [Math.max(band.low, low), Math.min(band.high, high)];
      if (b > a) parts.push(element("rect", { class: band.style, x: frame.left, y: py(b), width: frame.right - frame.left, height: py(a) - py(b) }));
    }
    const step = marks[1] - marks[0];
    for (const mark of marks) {
      const y = py(mark);
      parts.push(element("path", { class: Math.abs(mark) < step * 1e-6 ? "zero" : "grid", d: `M${frame.left} ${y}H${frame.right}` }));
      parts.push(text(tick(mark, step), { x: frame.left - 6, y: y + 4, "text-anchor": "end" }));
    }
    const across = data.marks ?? this.marks ?? ticks(span[0], span[1], width < 420 ? 4 : 7).filter((m) => m >= span[0] - 1e-9 && m <= span[1] + 1e-9);
    for (const mark of across) {
      parts.push(element("path", { class: "grid", d: `M${px(mark)} ${frame.bottom}v4` }));
      parts.push(text(minus(String(+mark.toFixed(6))), { x: px(mark), y: frame.bottom + 16, "text-anchor": "middle" }));
    }
    parts.push(element("path", { class: "frame", d: `M${frame.left} ${frame.bottom}H${frame.right}` }));
    parts.push(text(data.y ?? this.y, { class: "label", x: 2, y: legend.height + 11 }));
    parts.push(text(data.x ?? this.x, { class: "label", x: (frame.left + frame.right) / 2, y: frame.bottom + 32, "text-anchor": "middle" }));
    for (const limit of limits) {
      for (const value of limit.both ? [limit.value, -limit.value] : [limit.value]) {
        if (value >= low && value <= high) parts.push(element("path", { class: "limit", d: `M${frame.left} ${py(value)}H${frame.right}` }));
      }
    }
    for (const bar of data.bars ?? []) {
      const x = px(bar.at) - 7;
      const drawn = element("rect", { class: "bar-fill", x, y: py(bar.value), width: 14, height: Math.max(py(Math.max(low, 0)) - py(bar.value), 0) });
      drawn.append(element("title", {}, `order ${bar.at}: ${shown(bar.value)} deg`));
      parts.push(drawn);
    }
    for (const { style, x, y } of data.dots ?? []) {
      let path = "";
      for (let k = 0; k < x.length; k += 1) path += `M${px(x[k]).toFixed(1)} ${py(y[k]).toFixed(1)}h0`;
      parts.push(element("path", { class: `dots ${style}${x.length < 150 ? " few" : ""}`, d: path }));
    }
    for (const { style, x, low: bottom, high: top_ } of data.columns ?? []) {
      let path = "";
      for (let k = 0; k < x.length; k += 1) path += `M${(px(x[k]) - 0.5).toFixed(1)} ${(py(top_[k]) - 0.5).toFixed(1)}h1V${(py(bottom[k]) + 0.5).toFixed(1)}h-1z`;
      parts.push(element("path", { class: `band-${style}`, d: path }));
    }
    for (const line of data.lines ?? []) {
      const count = line.values.length;
      const at = line.x ? (k) => line.x[k] : ((k) => span[0] + ((span[1] - span[0]) * k) / count);
      let path = "";
      for (let k = 0; k < count; k += 1) path += `${k ? "L" : "M"}${px(at(k)).toFixed(1)} ${py(line.values[k]).toFixed(1)}`;
      parts.push(element("path", { class: `line ${line.style}`, d: path }));
    }
    set(this.svg, { viewBox: `0 0 ${width} ${frame.bottom + 38}` });
    become(this.svg, parts);
    this.scale = { px, py, frame };
  }

  /** Say in words what is drawn, also where that is not on the screen. */
  describe(data, values) {
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) [low, high] = [Math.min(low, value), Math.max(high, value)];
    const span = high >= low ? `; ${data.y ?? this.y}: from ${shown(low)} to ${shown(high)}` : "";
    set(this.svg, { "aria-label": `${this.words}${span}` });
  }
}

/** All values that a picture draws. */
function valuesOf(data) {
  const values = [...(data.lines ?? []).flatMap((line) => line.values), ...(data.bars ?? []).map((bar) => bar.value)];
  for (const { y, low, high } of [...(data.dots ?? []), ...(data.columns ?? [])]) {
    for (const part of [y, low, high]) if (part) for (const value of part) values.push(value);
  }
  return values;
}

/** Words in a picture. */
export function text(words, attributes) {
  return element("text", attributes, words);
}

const ruler = document.createElement("canvas").getContext("2d");
const widths = new Map();

/** How wide words are in a picture [px]. */
export function wide(words) {
  if (!widths.has(words)) {
    ruler.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    widths.set(words, ruler.measureText(words).width);
  }
  return widths.get(words);
}

/** The legend in as many lines as the width needs. */
function legendOf(entries, width) {
  const group = element("g");
  let [x, y] = [0, 12];
  for (const entry of entries) {
    const long = 41 + wide(entry.name);
    if (x && x + long - 14 > width) [x, y] = [0, y + 17];
    const sample = entry.y ? element("path", { class: `dots few ${entry.style}`, d: `M${x + 4} ${y - 4}h0m7 0h0m7 0h0` })
      : entry.high && entry.x ? element("rect", { class: `band-${entry.style}`, x, y: y - 10, width: 22, height: 11 })
      : entry.values ? element("path", { class: `line ${entry.style}`, d: `M${x} ${y - 4}h22` })
      : "low" in entry ? element("rect", { class: entry.style, x, y: y - 10, width: 22, height: 11 })
      : element("path", { class: "limit", d: `M${x} ${y - 4}h22` });
    group.append(sample, text(entry.name, { x: x + 27, y }));
    x += long;
  }
  return { group, height: entries.length ? y + 8 : 4 };
}
