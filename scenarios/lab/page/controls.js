// The design in numbers: for each a slider and a field, with its name and unit. They are the way for the keyboard.

import { given } from "./plot.js";

const MAGNET = [
  ["magnet.diameter_mm", "Diameter", "mm", 2, 16, 0.05],
  ["magnet.length_mm", "Length, magnetised", "mm", 2, 16, 0.05],
  ["magnet.width_mm", "Width", "mm", 2, 16, 0.05],
  ["magnet.height_mm", "Height", "mm", 0.5, 8, 0.05],
  ["magnet.bore_mm", "Bore", "mm", 0, 8, 0.05],
];
const SENSOR = [
  ["placement.air_gap_mm", "Air gap", "mm", 0.2, 6, 0.01],
  ["placement.sensor_x_mm", "Sensor off axis, x", "mm", -2, 2, 0.01],
  ["placement.sensor_y_mm", "Sensor off axis, y", "mm", -2, 2, 0.01],
  ["placement.sensor_tilt_y_deg", "Sensor tilt, about y", "deg", -15, 15, 0.1],
];
const CONDITIONS = [
  ["temperature_c", "Temperature", "°C", -40, 150, 1],
  ["speed_rpm", "Speed", "rpm", 0, 10000, 10],
];
const MORE = [
  ["placement.magnet_x_mm", "Magnet off axis, x", "mm", -2, 2, 0.01],
  ["placement.magnet_y_mm", "Magnet off axis, y", "mm", -2, 2, 0.01],
  ["placement.magnet_tilt_y_deg", "Magnet tilt, about y", "deg", -15, 15, 0.1],
  ["placement.magnet_tilt_x_deg", "Magnet tilt, about x", "deg", -15, 15, 0.1],
  ["placement.sensor_tilt_x_deg", "Sensor tilt, about x", "deg", -15, 15, 0.1],
  ["placement.stray_x_mT", "Stray field, x", "mT", -5, 5, 0.05],
  ["placement.stray_y_mT", "Stray field, y", "mT", -5, 5, 0.05],
  ["placement.stray_z_mT", "Stray field, z", "mT", -5, 5, 0.05],
];
const TOLERANCE_NAMES = {
  off_axis: "Sensor off axis", tilt: "Sensor tilt", magnet_off_axis: "Magnet off axis", magnet_tilt: "Magnet tilt",
  air_gap: "Air gap", stray: "Stray field",
};

/** The value at a dotted path. */
export function at(design, path) {
  return path.split(".").reduce((part, name) => part[name], design);
}

/** The design with the value at a dotted path. */
export function withValue(design, path, value) {
  const [name, ...rest] = path.split(".");
  const inner = rest.length ? withValue(design[name], rest.join("."), value) : value;
  if (Array.isArray(design)) return design.map((one, k) => (String(k) === name ? inner : one));
  return { ...design, [name]: inner };
}

function node(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

/** The form; `changed(path, value)` hears of each change. */
export class Controls {
  constructor(form, start, changed) {
    Object.assign(this, { form, changed, rows: new Map() });
    form.addEventListener("submit", (event) => event.preventDefault());
    const choices = [this.choice("magnet.shape", "Shape", start.shapes), this.choice("magnet.grade", "Grade", Object.keys(start.grades))];
    this.remanence = node("p", { className: "note" });
    this.grades = start.grades;
    form.append(
      this.group("Magnet", [...choices, this.remanence, ...MAGNET.map((one) => this.slider(...one))]),
      this.group("Sensor", SENSOR.map((one) => this.slider(...one))),
      this.group("Conditions", CONDITIONS.map((one) => this.slider(...one))),
      this.folded("More of the mounting", MORE.map((one) => this.slider(...one))),
      this.folded("What it has to keep", this.demand(start.tolerances)),
    );
  }

  group(name, rows) {
    return node("fieldset", {}, node("legend", { textContent: name }), ...rows);
  }

  folded(name, rows) {
    const inside = node("fieldset", { ariaLabel: name }, ...rows);
    return node("details", {}, node("summary", { textContent: name }), inside);
  }

  demand(tolerances) {
    const rows = [
      this.field("demand.max_error_deg", "Largest error", "deg"),
      this.pair("demand.window_mT", "Field, low and high", "mT"),
      this.pair("demand.temperature_c", "Temperature, low and high", "°C"),
      this.field("demand.min_yield", "Share of mountings, 0 to 1", ""),
      this.field("demand.mountings", "Mountings drawn", ""),
      node("p", { className: "note", textContent: "Mounting tolerances, each to either side:" }),
    ];
    return [...rows, ...Object.entries(tolerances).map(([name, unit]) => this.field(`demand.tolerance.${name}`, TOLERANCE_NAMES[name], unit))];
  }

  choice(path, name, options) {
    const id = path.replaceAll(".", "-");
    const select = node("select", { id }, ...options.map((one) => node("option", { value: one, textContent: one })));
    select.addEventListener("change", () => this.changed(path, select.value));
    const row = node("div", { className: "row" }, node("label", { htmlFor: id, textContent: name }), select);
    this.rows.set(path, { row, show: (value) => { select.value = value; } });
    return row;
  }

  number(path, properties) {
    const input = node("input", { type: "number", step: "any", required: true, ...properties });
    input.addEventListener("change", () => {
      if (input.value !== "" && Number.isFinite(input.valueAsNumber)) this.changed(path, input.valueAsNumber);
    });
    return input;
  }

  field(path, name, unit) {
    const id = path.replaceAll(".", "-");
    const input = this.number(path, { id });
    const row = node("div", { className: "row" }, node("label", { htmlFor: id, textContent: name }), input, node("span", { className: "unit", textContent: unit }));
    this.rows.set(path, { row, show: (value) => put(input, value) });
    return row;
  }

  pair(path, name, unit) {
    const id = path.replaceAll(".", "-");
    const inputs = [0, 1].map((k) => this.number(`${path}.${k}`, { id: `${id}-${k}`, ariaLabel: `${name}: ${k ? "high" : "low"}` }));
    const row = node("div", { className: "row pair" }, node("span", { textContent: name, className: "name" }), ...inputs, node("span", { className: "unit", textContent: unit }));
    this.rows.set(path, { row, show: (value) => inputs.forEach((input, k) => put(input, value[k])) });
    return row;
  }

  slider(path, name, unit, low, high, step) {
    const id = path.replaceAll(".", "-");
    const range = node("input", { type: "range", id, min: low, max: high, step });
    const input = this.number(path, { ariaLabel: `${name} in ${unit}` });
    range.addEventListener("input", (event) => this.changed(path, range.valueAsNumber, event.timeStamp));
    const row = node("div", { className: "row" }, node("label", { htmlFor: id, textContent: name }), input, node("span", { className: "unit", textContent: unit }), range);
    const show = (value) => {
      put(input, value);
      range.value = value;
      range.setAttribute("aria-valuetext", `${value} ${unit}`);
    };
    this.rows.set(path, { row, show });
    return row;
  }

  /** Show a design in all fields, and those fields alone that its shape has. */
  show(design) {
    for (const [path, row] of this.rows) {
      const value = at(design, path);
      if (row.shown === value) continue;
      row.show(value);
      row.shown = value;
    }
    if (this.magnet === design.magnet) return;
    this.magnet = design.magnet;
    const { shape, grade, remanence_T: own } = design.magnet;
    const used = { diameter_mm: shape !== "block", bore_mm: shape === "ring", length_mm: shape === "block", width_mm: shape === "block" };
    for (const [name, shownHere] of Object.entries(used)) this.rows.get(`magnet.${name}`).row.hidden = !shownHere;
    const stated = this.grades[grade];
    this.remanence.textContent = own
      ? `${own} T at 20 °C, as the twin states it; grade ${grade}: ${given(stated.percent_per_K)} %/K`
      : `${stated.remanence_T} T at 20 °C, ${given(stated.percent_per_K)} %/K`;
    this.remanence.title = stated.source;
  }
}

function put(input, value) {
  const told = String(+Number(value).toFixed(6));
  if (document.activeElement !== input && input.value !== told) input.value = told;
}
