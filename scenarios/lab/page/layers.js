// The layers of an explained sweep and its numbers: switched on and off, moved, and put back.
import { given, shown } from "./plot.js";

function node(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

/** What a layer is called; of several lines of one cause with their orders. */
export function layerName(name, answer) {
  if (name === "error model") return answer.held_against === "given twin" ? "factors of the twin" : "paper's error model";
  return answer.layers.find((one) => one.name === name)?.title ?? name.replaceAll("_", " ");
}

/** The list of layers; `changed(when)` hears of each switch. */
export class Layers {
  constructor(host, answer, changed) {
    this.off = new Set();
    this.total = node("span", {});
    const rows = answer.layers.map((layer) => this.row(layer, answer, changed));
    const first = node("li", {}, node("span", { className: "left", textContent: `Error as measured: ${shown(answer.measured_deg)} deg RMS. Each layer takes its part out:` }));
    const last = node("li", { className: "total" }, node("span", { textContent: "left, RMS" }), this.total);
    host.replaceChildren(first, ...rows, last);
    this.boxes = [...host.querySelectorAll("input")];
  }

  row({ name, without_deg: without, fixed }, answer, changed) {
    const box = node("input", { type: "checkbox", checked: true, disabled: Boolean(fixed) });
    box.addEventListener("change", (event) => {
      if (box.checked) this.off.delete(name);
      else this.off.add(name);
      changed(event.timeStamp);
    });
    const cause = answer.causes.find((one) => one.name === name);
    const gain = fixed ? `always on: ${fixed}` : `without it ${shown(without)} deg are left, with it ${shown(answer.all_deg)}`;
    const held = cause ? `; on readings it never saw ${cause.held_out.replace("->", "→")} deg, false alarm ${cause.false_alarm}` : "";
    return node("li", {}, node("label", {}, box, node("b", { textContent: layerName(name, answer) }), node("span", {}), node("span", { className: "left", textContent: gain + held })));
  }

  show(rms) {
    this.total.textContent = `${shown(rms)} deg`;
  }

  allOn() {
    this.off.clear();
    for (const box of this.boxes) box.checked = true;
  }
}

/** Sliders on every fitted number; `changed(when)` hears of each move. */
export class Numbers {
  constructor(form, answer, changed) {
    this.values = {};
    this.rows = [];
    const groups = new Map();
    for (const slider of answer.sliders) groups.set(slider.of, [...(groups.get(slider.of) ?? []), slider]);
    form.onsubmit = () => false;
    form.replaceChildren(...[...groups].map(([of, sliders]) => node("fieldset", {}, node("legend", { textContent: layerName(of, answer) }), ...sliders.map((one) => this.row(one, changed)))));
  }

  row({ name, label, unit, value, low, high, half_width: half }, changed) {
    const id = `number-${name.replaceAll(/[.#]/g, "-")}`;
    const digits = Math.max(2, Math.ceil(-Math.log10(Math.max(high - low, 1e-9))) + 4);
    const range = node("input", { type: "range", id, min: low, max: high, step: "any" });
    range.value = value;
    const field = node("output", { htmlFor: id });
    const reset = node("button", { type: "button", className: "reset", textContent: "fitted", hidden: true, ariaLabel: `${label}: back to the fitted value` });
    const tell = (told) => {
      field.textContent = given(+told.toFixed(digits));
      range.setAttribute("aria-valuetext", `${given(+told.toFixed(digits))} ${unit}`);
      reset.hidden = !(name in this.values);
    };
    range.addEventListener("input", (event) => {
      this.values[name] = range.valueAsNumber;
      tell(range.valueAsNumber);
      changed(event.timeStamp);
    });
    const back = () => {
      delete this.values[name];
      range.value = value;
      tell(value);
    };
    reset.addEventListener("click", (event) => {
      back();
      changed(event.timeStamp);
    });
    this.rows.push(back);
    tell(value);
    const words = node("label", { htmlFor: id, textContent: `${label} ` }, reset);
    words.title = half ? `fitted: ${given(+value.toFixed(digits))} ± ${given(+half.toPrecision(2))} ${unit} (95 %)` : "";
    words.append(reset);
    return node("div", { className: "row number" }, words, field, node("span", { className: "unit", textContent: unit }), range);
  }

  fitted() {
    for (const back of this.rows) back();
  }
}
