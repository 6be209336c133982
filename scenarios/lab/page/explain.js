// The explain view: a sweep goes in, the search is watched and stopped, and the answer is taken apart layer by layer.
import { ask, complain, got, handOver, latest, say } from "./ask.js";
import { by, node } from "./dom.js";
import { layerName, Layers, Numbers } from "./layers.js";
import { become, Plot, put, shown } from "./plot.js";
import { picture, save, showCommand } from "./save.js";

const WATCHED_EVERY_MS = 250;
const AT_REST_MS = 160;
const COLOURS = { forward: "first", backward: "second" };

export class ExplainView {
  constructor(start) {
    this.sweep = start.sweep;
    by("held").checked = start.held;
    this.residual = new Plot(by("residual-plot"), { span: [0, 360], x: "", y: "error left / deg", height: 260, words: "What is left of each reading's error" });
    this.spectrum = new Plot(by("spectrum-plot"), { span: [0, 1], x: "order / cycles a turn", y: "amplitude / deg", height: 170, words: "Spectrum of what is left" });
    this.look = latest((asked) => this.askLook(asked));
    by("open-sweep").addEventListener("click", () => by("sweep-file").click());
    by("sweep-file").addEventListener("change", (event) => {
      const [file] = event.target.files;
      event.target.value = "";
      if (file) this.open(file);
    });
    by("example").addEventListener("click", () => this.taken(() => ask("sweep/example", {})));
    by("begin").addEventListener("click", () => this.begin());
    by("stop").addEventListener("click", () => this.trying(async () => this.show(await ask("explain/stop", {}))));
    by("over").addEventListener("change", (event) => this.changed(event.timeStamp));
    by("all-on").addEventListener("click", (event) => {
      this.layers.allOn();
      this.numbers.fitted();
      this.changed(event.timeStamp);
    });
    for (const name of ["residual", "spectrum"]) {
      const button = document.querySelector(`[data-of=${name}]`);
      button.setAttribute("aria-label", `Save the picture of ${name} as SVG`);
      button.addEventListener("click", () => save(picture(this[name].svg), `halltwin_${name}.svg`));
    }
    this.ready();
    if (start.sweep) this.begin();
  }

  async trying(work) {
    try {
      complain(null);
      await work();
    } catch (error) {
      complain(error.message);
      this.waited(null);
    }
  }

  ready() {
    by("sweep-name").textContent = this.sweep ?? "";
    by("begin").disabled = !this.sweep;
    by("example").hidden = Boolean(this.sweep);
  }

  open(file) {
    put(by("progress"), `reading ${file.name}`);
    return this.taken(() => handOver("sweep/open", file));
  }

  /** Explain the sweep that the program has been handed or told to take. */
  taken(given) {
    return this.trying(async () => {
      this.sweep = (await given()).name;
      this.ready();
      await this.begin();
    });
  }

  begin() {
    return this.trying(async () => {
      by("answer").hidden = true;
      this.show(await ask("explain/begin", { held: by("held").checked }));
    });
  }

  /** Show where the search stands, and look again while it works. */
  show(stand) {
    clearTimeout(this.timer);
    const working = stand.state === "working";
    by("begin").hidden = working;
    by("stop").hidden = !working;
    by("open-sweep").disabled = working;
    if (working) {
      by("answer-verdict").textContent = `${this.sweep} is searched`;
      by("answer-words").textContent = `How long it takes depends on what is in the sweep: a bench sweep takes seconds, a log with channels, temperatures and many causes minutes. After ${stand.budget_s} s of computing the search ends by itself, and finishes the answer with what it has; Stop does so now.`;
      this.waited(stand);
      this.timer = setTimeout(() => this.trying(async () => this.show(await got("explain"))), WATCHED_EVERY_MS);
      return;
    }
    this.waited(null);
    if (stand.state === "failed") {
      by("answer-verdict").textContent = `${this.sweep} was not explained`;
      by("answer-words").replaceChildren(...whatNow(stand.words, this.sweep));
      complain(stand.words);
    }
    if (stand.state === "done") this.take(stand.answer);
  }

  /** Where the search stands: the stage is told when it changes, the seconds are for the eye alone. */
  waited(stand) {
    by("elapsed").hidden = !stand;
    by("seconds").textContent = stand ? `${Math.floor(stand.elapsed_s)} s:` : "";
    // Of the computing, which a busy machine keeps waiting, and not of the clock: the bar tells when the search ends.
    const spent = stand && stand.computed_s >= stand.budget_s ? `the ${stand.budget_s} s of computing are spent, the answer is being finished: ` : "";
    put(by("progress"), stand ? spent + stand.words : "");
    if (stand) Object.assign(by("elapsed"), { max: stand.budget_s, value: Math.min(stand.computed_s, stand.budget_s), title: `${Math.round(stand.computed_s)} of ${stand.budget_s} s of computing` });
  }

  take(answer) {
    this.answer = answer;
    const names = answer.causes.filter((one) => one.name !== "unnamed").map((one) => one.name.replaceAll("_", " "));
    by("answer-verdict").textContent = `${answer.verdict[0].toUpperCase()}${answer.verdict.slice(1)}${names.length ? `: ${names.join(", ")}` : ""}`;
    by("answer-words").textContent = `${signed(answer.verdict_words)} ${answer.name}: ${answer.sweep_words}.${answer.read_words}`;
    become(by("answer-figures"), figures(answer));
    this.layers = new Layers(by("layers"), answer, (when) => this.changed(when));
    this.numbers = new Numbers(by("factors"), answer, (when) => this.changed(when));
    const names_ = { angle: "shaft angle", clock: answer.across.clock.split(" / ")[0], temperature: "temperature", speed: "speed" };
    by("over").replaceChildren(...Object.keys(answer.across).map((key) => node("option", { value: key, textContent: names_[key] })));
    document.querySelector("#answer .found").classList.toggle("many", answer.causes.length > 3);
    by("cause-list").replaceChildren(...causes(answer));
    by("factor-table").replaceChildren(factors(answer));
    by("next").replaceChildren(...(answer.next.length ? answer.next : [{ do: "nothing: all that can be searched for was", why: "" }]).map((one) => node("li", {}, capital(one.do), node("small", { textContent: one.why.replaceAll("_", " ") }))));
    showCommand(by("explain-command"), answer.command);
    by("answer").hidden = false;
    by("spectrum-note").textContent = `${answer.two_ways ? "Order 0: half of the step between the directions. " : ""}Dashed: what noise alone passes at one order in twenty.`;
    this.look({ whole: true });
    say(by("answer-verdict").textContent);
  }

  /** Something was switched or moved at a time: what is left follows at once, its spectrum when all rests. */
  changed(when) {
    this.look({ whole: false, when });
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.look({ whole: true }), AT_REST_MS);
  }

  async askLook({ whole, when }) {
    const width = Math.round(Math.max(this.residual.host.clientWidth - 54, 50));
    const told = await ask("explain/look", { off: [...this.layers.off], values: this.numbers.values, over: by("over").value, width, spectrum: whole });
    complain(null);
    this.layers.show(told.rms_deg);
    this.drawResidual(told);
    if (told.spectrum) this.drawSpectrum(told.spectrum);
    if (when !== undefined) performance.measure("switch to redraw", { start: when, end: performance.now() });
  }

  drawResidual(told) {
    const off = [...this.layers.off].map((name) => layerName(name, this.answer));
    by("residual-title").textContent = off.length ? `What is left without ${off.join(", ")}` : "What is left";
    const [dots, columns, lines] = [[], [], []];
    for (const [way, part] of Object.entries(told.ways)) {
      const name = Object.keys(told.ways).length > 1 ? way : "readings";
      (part.y ? dots : columns).push({ name, style: COLOURS[way], ...part });
      if (part.mean) lines.push({ name: "", style: COLOURS[way], values: part.mean.y, x: part.mean.x });
    }
    if (told.touched?.y) dots.push({ name: "touched by it", style: "fourth large", ...told.touched });
    const marks = told.x.startsWith("shaft angle") ? [0, 90, 180, 270, 360] : undefined;
    this.residual.draw({ dots, columns, lines, x: told.x, span: told.span, marks, include: [0] });
    const few = columns.length ? "Of the readings in each column of the picture the lowest and the highest. " : "";
    by("residual-note").textContent = `${few}${lines.length ? "Lines: their mean." : ""}`;
  }

  drawSpectrum({ order, amplitude_deg: amplitude, noise_deg: noise }) {
    const span = [Math.min(0, order[0]), order[order.length - 1]];
    this.spectrum.draw({ span, include: [0], lines: [{ name: "left", style: "first", values: amplitude, x: order }, { name: "noise alone, at most", style: "ink dashed", values: noise, x: order }] });
  }
}

/** Words with arrows and minus signs that are such. */
const signed = (words) => words.replaceAll("->", "→").replace(/(^|[^\w])-(?=\d)/g, "$1−");
const capital = (words) => words.charAt(0).toUpperCase() + words.slice(1);

/** What to do about a sweep that was not explained; what is wrong with it stands above. */
function whatNow(words, sweep) {
  if (!words.startsWith(`${sweep}: `)) return [`${capital(words)}.`];
  const link = (page, textContent) => node("a", { href: `guide/${page}.html`, target: "_blank", rel: "noopener", textContent });
  const ways = ["What is wrong with it stands above. Of a log under names of its own ", node("code", { textContent: "halltwin import" }), " makes a sweep: "];
  return [...ways, link("logs", "logs of any kind"), ". What a sweep has to hold: ", link("explain_sweep", "explain a sweep"), "."];
}

function figures(answer) {
  const one = answer.figures;
  const model = answer.held_against === "given twin" ? "the twin" : "the error model";
  const cards = [
    ["Error as measured", one.measured_deg, "deg RMS", "its zero taken off"],
    [`Left by ${model}`, one.baseline_held_out_deg, "deg RMS", "on readings it never saw"],
    ["Left by the extended twin", one.extended_held_out_deg, "deg RMS", "on readings it never saw"],
    ["Closer by", one.gain, "times", `the extended twin than ${model}`],
    ["Noise floor", one.noise_floor_deg, "deg RMS", one.noise_floor_deg === null ? "no angle was read several times in a row" : "from repeated readings"],
  ];
  const figure = (value, unit) => (value === null ? node("dd", { className: "value words", textContent: "not known" }) : node("dd", { className: "value" }, `${shown(value)} `, node("small", { textContent: unit })));
  return cards.map(([name, value, unit, beside]) => node("div", {}, node("dt", { textContent: name }), figure(value, unit), node("dd", { className: "beside", textContent: beside })));
}

function causes(answer) {
  const parts = answer.setup.map((words) => node("p", { className: "error", textContent: words }));
  for (const words of answer.changed) parts.push(node("p", { textContent: capital(signed(words)) }));
  for (const cause of answer.causes) {
    const said = [...cause.parameters, `held-out RMS ${cause.held_out} deg, false alarm ${cause.false_alarm}`, ...cause.said];
    const head = node("h4", {}, inCatalogue(cause.name), ` (${cause.stage})`);
    parts.push(node("div", { className: "cause" }, head, ...said.map((words) => node("p", { textContent: signed(words) }))));
  }
  if (!answer.causes.length) parts.push(node("p", { textContent: "No cause stands out of the noise." }));
  return parts;
}

/** A cause's name, as a link to what the guide says of it. */
function inCatalogue(name) {
  const words = name.replaceAll("_", " ");
  if (name === "unnamed") return node("a", { href: "guide/own_effects.html", target: "_blank", rel: "noopener", textContent: words });
  return node("a", { href: `guide/catalogue.html#${name}`, target: "_blank", rel: "noopener", textContent: words });
}

/** The paper's factors before and with the causes. */
function factors(answer) {
  const moved = answer.factors.some((row) => row.after);
  const heads = ["Factor", "before", ...(moved ? ["with the causes"] : []), ""];
  const cell = (words, k) => {
    const made = node("td", { className: "number", textContent: signed(words) });
    if (moved) made.dataset.head = `${heads[k + 1]}:`;
    return made;
  };
  const cells = (row) => [row.before, ...(moved ? [row.after] : [])].map(cell);
  const rows = answer.factors.map((row) => node("tr", {}, node("th", { scope: "row", textContent: row.label }), ...cells(row), node("td", { textContent: row.flag })));
  const head = node("tr", {}, ...heads.map((words, k) => (words ? node("th", { scope: "col", textContent: words, className: k ? "number" : "" }) : node("td"))));
  const caption = node("caption", { className: "unseen", textContent: "Factors of the error model, with their intervals" });
  return node("table", {}, caption, node("thead", {}, head), node("tbody", {}, ...rows));
}
