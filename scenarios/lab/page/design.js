// The design view: one magnet in one place, everything that follows from it, and what it has to keep.
import { ask, complain, latest, posted, say } from "./ask.js";
import { Controls, withValue } from "./controls.js";
import { by } from "./dom.js";
import { ErrorMap } from "./map.js";
import { become, element, given, Plot, put, shown } from "./plot.js";
import { picture, save, showCommand } from "./save.js";
import { Side, Top } from "./scene.js";

/** Questions that may be underway at a time: the next one need not wait until the last has come back. */
const UNDERWAY = 2;
const AT_PAUSE_MS = 60;
const AT_REST_MS = 180;
/** As the program has it: `_MAP_MOUNTINGS`. */
const MAP_MOUNTINGS = 50;
const TURN = { span: [0, 360], marks: [0, 90, 180, 270, 360], x: "shaft angle / deg" };

export class DesignView {
  constructor(start) {
    this.controls = new Controls(by("controls"), start, (path, value, when) => this.change({ [path]: value }, when));
    const moved = (changes, when) => this.change(changes, when);
    this.side = new Side(by("side"), moved);
    this.top = new Top(by("top"), moved);
    this.map = new ErrorMap(by("map-plot"), (size, gap) => this.change({ ...this.sized(size), "placement.air_gap_mm": gap }));
    this.plots = {
      error: new Plot(by("error-plot"), { ...TURN, y: "error / deg", words: "Angle error over the turn, both directions" }),
      field: new Plot(by("field-plot"), { ...TURN, y: "field in the plane / mT", words: "Field at the sensor over the turn" }),
      orders: new Plot(by("orders-plot"), { span: [-0.7, 12.7], marks: [0, 2, 4, 6, 8, 10, 12], x: "order / cycles a turn", y: "amplitude / deg", words: "Error by order" }),
      signals: new Plot(by("signals-plot"), { ...TURN, y: "signal / nominal amplitude", words: "The two channels over the turn" }),
    };
    this.atOnce = latest((design, when, overtaken) => this.askAtOnce(design, when, overtaken), UNDERWAY);
    this.study = latest((design) => this.askStudy(design));
    this.causes = latest(async (design) => {
      this.alone = (await ask("design/causes", design)).alone_deg;
      this.drawCauses();
    });
    this.askMap = latest(async (design) => {
      const of = by("map-of").value;
      const told = await ask(of === "yield" ? "design/yield-map" : "design/map", design);
      if (of === by("map-of").value) this.map.draw(told, this.design);
    });
    by("map-of").addEventListener("change", () => this.noteMap());
    for (const button of document.querySelectorAll("#design button.picture")) {
      const name = button.dataset.of;
      button.title = "Save this picture as SVG";
      button.setAttribute("aria-label", `Save the picture of ${name} as SVG`);
      button.addEventListener("click", () => save(picture((name === "map" ? this.map : this.plots[name]).svg), `halltwin_${name}.svg`));
    }
    by("save-twin").addEventListener("click", () => this.saved("twin/save", "twin.toml"));
    by("save-sweep").addEventListener("click", () => this.saved("sweep/save", "sweep.csv"));
  }

  /** Begin anew with a twin as the program tells of it. */
  begin(twin) {
    this.twin = twin;
    by("design").classList.toggle("empty", !twin.design);
    put(by("no-design"), twin.no_design ?? "");
    if (!twin.design) return;
    this.design = twin.design;
    this.asked = null;
    this.show();
    this.rest();
    this.atOnce(this.design, undefined);
  }

  sized(size) {
    return this.design.magnet.shape === "block" ? { "magnet.length_mm": size, "magnet.width_mm": size } : { "magnet.diameter_mm": size };
  }

  change(changes, when) {
    for (const [path, value] of Object.entries(changes)) this.design = withValue(this.design, path, value);
    if ("magnet.grade" in changes) {
      const { remanence_T: _, percent_per_K: __, ...magnet } = this.design.magnet;
      this.design = { ...this.design, magnet };
    }
    // The question is on its way while the drawing follows the hand.
    this.atOnce(this.design, when);
    this.show();
    by("figures").classList.add("waiting");
    // The hand comes first: the causes follow where it pauses, the study and the map where it rests.
    clearTimeout(this.pause);
    this.pause = setTimeout(() => this.causes(this.design), AT_PAUSE_MS);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.rest(), AT_REST_MS);
  }

  show() {
    this.controls.show(this.design);
    this.side.draw(this.design);
    this.top.draw(this.design);
    this.map.here(this.design);
  }

  noteMap() {
    const { mountings } = this.design.demand;
    const words = { error: "Largest error over the temperatures asked for, mounted as it is.", yield: `Share of ${Math.min(mountings, MAP_MOUNTINGS)} mountings within the tolerances that keep error and field.` };
    put(by("map-note"), `${words[by("map-of").value]} Hatched: the field leaves the window. Click to go there.`);
    this.askMap(this.design);
  }

  rest() {
    this.study(this.design);
    this.noteMap();
  }

  async askAtOnce(design, when, overtaken) {
    const told = await ask("design/at-once", design);
    if (overtaken()) return;
    this.told = told;
    complain(null);
    this.drawTold(design);
    if (when !== undefined) performance.measure("drag to redraw", { start: when, end: performance.now() });
  }

  drawTold(design) {
    const { told } = this;
    const limit = { value: design.demand.max_error_deg, both: true, name: `asked: ±${given(design.demand.max_error_deg)}°` };
    this.plots.error.draw({
      lines: [{ name: "forward", style: "first", values: told.forward_deg }, { name: "backward", style: "second dashed", values: told.backward_deg }],
      limits: [limit],
    });
    const [low, high] = design.demand.window_mT;
    this.plots.field.draw({
      lines: [
        { name: "magnitude", style: "ink", values: told.field.size_mT },
        { name: "x", style: "first", values: told.field.x_mT },
        { name: "y", style: "second dashed", values: told.field.y_mT },
      ],
      bands: [{ low, high, style: "window", name: `window ${given(low)} to ${given(high)} mT` }],
    });
    const { order, amplitude_deg: amplitude } = told.orders;
    this.plots.orders.draw({ bars: order.map((at, k) => ({ at, value: amplitude[k] })), include: [0] });
    this.plots.signals.draw({ lines: [{ name: "x", style: "first", values: told.signals.x }, { name: "y", style: "second dashed", values: told.signals.y }] });
    this.drawFigures();
    by("command-of-design").hidden = !told.command;
    put(by("command-note"), told.command ? "" : "The options of halltwin design cannot say how this one is mounted.");
    showCommand(by("command"), told.command ?? "");
    showCommand(by("sweep-command"), told.sweep_command);
  }

  async askStudy(design) {
    const study = await ask("design/study", design);
    if (design !== this.design) return;
    this.asked = { design, study };
    this.alone = study.alone_deg;
    by("figures").classList.remove("waiting");
    this.drawFigures();
    this.drawCauses();
    say("");
  }

  drawFigures() {
    const { told, design } = this;
    if (!told) return;
    const { demand } = design;
    const here = told.figures;
    const study = this.asked?.study.figures;
    const from = `from ${demand.temperature_c.map(given).join(" to ")}\u00a0°C`;
    const resting = design.speed_rpm ? ", at rest" : "";
    const cards = [
      { name: `Error at ${given(design.temperature_c)}\u00a0°C${design.speed_rpm ? `, ${given(design.speed_rpm)} rpm` : ""}`, value: here.error_deg, unit: "deg", beside: `largest; ${shown(here.rms_deg)} deg RMS` },
    ];
    if (study) {
      cards.push(
        { name: `Error ${from}${resting}`, value: study.error_deg, unit: "deg", beside: `asked: ≤ ${given(demand.max_error_deg)} deg`, kept: study.error_deg <= demand.max_error_deg },
        { name: `Field ${from}`, text: `${shown(study.field_low_mT)}–${shown(study.field_high_mT)}`, unit: "mT", beside: `window ${demand.window_mT.map(given).join(" to ")} mT`, kept: study.margin_mT >= 0 },
        { name: `Yield of ${given(demand.mountings)} mountings`, text: given(100 * study.yield), unit: "%", beside: `asked: ≥ ${given(100 * demand.min_yield)} %`, kept: study.yield >= demand.min_yield },
      );
    }
    cards.push(
      { name: "By 1 mT of stray field", value: here.stray_error_deg, unit: "deg", beside: `at most, at ${given(design.temperature_c)} °C; field ${shown(here.field_low_mT)} mT` },
      { name: "Noise in the angle", value: here.noise_deg, unit: "deg RMS", beside: here.resolution_bits === null ? "the twin has none" : `at ${given(design.temperature_c)} °C, as a grid of ${shown(here.resolution_bits)} bits` },
    );
    become(by("figures"), cards.map(card));
    if (study) put(by("verdict"), verdict(study, demand));
  }

  drawCauses() {
    const { design } = this;
    const { all_deg: all, without_deg: without = {} } = this.asked?.study ?? {};
    const alone = Object.entries(this.alone ?? {});
    const part = alone.filter(([name, error]) => error > 5e-5 || Math.abs((without[name] ?? all) - all) > 5e-5);
    const largest = Math.max(...part.map(([, error]) => error), 1e-9);
    // The order changes when all rests: nothing jumps about under the pointer.
    if (!this.order || this.asked?.design === design) this.order = part.sort((a, b) => b[1] - a[1]).map(([name]) => name);
    const place = ([name]) => this.order.indexOf(name);
    const rows = part.sort((a, b) => place(a) - place(b)).map(([name, error]) => causeRow(words(name), this.twin.causes[name], error / largest, [shown(error, 2), shown(without[name], 3)]));
    const total = causeRow("all together", "", 0, ["", shown(all, 3)]);
    total.className = "total";
    become(document.querySelector("#causes tbody"), [total, ...rows]);
    const best = part.map(([name]) => name).filter((name) => without[name] < all).sort((a, b) => without[a] - without[b])[0];
    put(by("causes-first"), all === undefined ? "" : best ? `Worth mending first: ${words(best)}. Without it the error would be ${shown(without[best])}° in place of ${shown(all)}°.` : "No cause is worth mending by itself: without any one of them the error would be no smaller.");
    const idle = alone.filter((one) => !part.includes(one)).map(([name]) => words(name));
    put(by("no-part"), idle.length ? `No part in it here: ${idle.join(", ")}.` : "");
    put(by("causes-at"), `${design.demand.temperature_c.map(given).join(" to ")} °C, ${given(design.speed_rpm)} rpm`);
  }

  /** The design as the program makes a file of it. */
  async saved(path, name) {
    try {
      const reply = await posted(path, this.design);
      save(await reply.blob(), name);
      say(`saved ${name}`);
    } catch (error) {
      complain(error.message);
    }
  }
}

const words = (name) => (name === "field" ? "field as mounted" : name.replaceAll("_", " "));

/** A row of the table of causes; `share` is the length of its bar. */
function causeRow(name, title, share, figures) {
  const made = (tag, properties, ...children) => {
    const one = Object.assign(document.createElement(tag), properties);
    one.append(...children);
    return one;
  };
  const bar = element("svg", { viewBox: "0 0 100 8", preserveAspectRatio: "none", "aria-hidden": "true" }, element("rect", { class: "bar-fill", width: 100 * share, height: 8 }));
  const cells = figures.map((figure) => made("td", { className: "number", textContent: figure }));
  return made("tr", {}, made("th", { scope: "row", textContent: name, title: title ?? "" }), made("td", { className: "bar-cell" }, bar), ...cells);
}

/** What it comes to, in one sentence. */
function verdict(study, demand) {
  const kept = `${given(demand.max_error_deg)}° and the field's window`;
  const share = `${given(100 * study.yield)} % of the mountings`;
  if (study.yield >= demand.min_yield) return `Keeps ${kept} in ${share}.`;
  const why = [];
  if (study.error_deg > demand.max_error_deg) why.push(`as mounted here it errs by ${shown(study.error_deg)}°`);
  if (study.field_low_mT < demand.window_mT[0]) why.push(`its field falls to ${shown(study.field_low_mT)} mT`);
  if (study.field_high_mT > demand.window_mT[1]) why.push(`its field rises to ${shown(study.field_high_mT)} mT`);
  if (!why.length) why.push(`one mounting in twenty errs by ${shown(study.error_p95_deg)}° or more`);
  return `Keeps ${kept} in only ${share}: ${why.join(", and ")}.`;
}

function card({ name, value, text: words, unit, beside, kept }) {
  const made = document.createElement("div");
  if (kept !== undefined) made.className = kept ? "kept" : "missed";
  const part = (tag, properties) => Object.assign(document.createElement(tag), properties);
  const figure = part("dd", { className: "value", textContent: `${words ?? shown(value)} ` });
  figure.append(part("small", { textContent: unit }));
  made.append(part("dt", { textContent: name }), figure, part("dd", { className: "beside", textContent: beside }));
  return made;
}
