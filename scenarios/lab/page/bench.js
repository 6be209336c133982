// The bench view: the closed loop on the virtual bus, its readings as they come, before and with the correction.
import { ask, complain, got, say } from "./ask.js";
import { by, node } from "./dom.js";
import { become, given, Plot, put, shown } from "./plot.js";
import { picture, save, showCommand } from "./save.js";

const WATCHED_EVERY_MS = 150;

export class BenchView {
  constructor() {
    const axes = { span: [0, 360], marks: [0, 90, 180, 270, 360], x: "reference angle / deg", height: 240 };
    this.plots = {
      before: new Plot(by("before-plot"), { ...axes, y: "error / deg, its zero taken off", words: "Error of each reading, as the encoder is" }),
      after: new Plot(by("after-plot"), { ...axes, y: "error / deg, as read", words: "Error of each reading, with the correction loaded" }),
    };
    by("loop-begin").addEventListener("click", () => this.trying(() => this.begin()));
    by("loop-stop").addEventListener("click", () => this.trying(async () => this.show(await ask("bench/stop", {}))));
    for (const [name, plot] of Object.entries(this.plots)) {
      const button = document.querySelector(`[data-of=${name}]`);
      button.setAttribute("aria-label", `Save the picture of the error ${name} as SVG`);
      button.addEventListener("click", () => save(picture(plot.svg), `halltwin_${name}.svg`));
    }
  }

  async trying(work) {
    try {
      complain(null);
      await work();
    } catch (error) {
      complain(error.message);
      this.idle();
    }
  }

  async begin() {
    const hide = by("hide").value.split(/\s+/).filter(Boolean);
    const stand = await ask("bench/begin", { hide, points: Number(by("loop-points").value) });
    showCommand(by("loop-command"), stand.command);
    by("loop").hidden = false;
    by("loop-verdict").textContent = "Measuring, explaining, correcting, measuring again";
    by("loop-figures").replaceChildren();
    this.show(stand);
  }

  idle() {
    clearTimeout(this.timer);
    by("loop-begin").disabled = false;
    by("loop-stop").hidden = true;
    by("loop-seconds").textContent = "";
    put(by("loop-progress"), "");
  }

  show(stand) {
    clearTimeout(this.timer);
    for (const [part, plot] of Object.entries(this.plots)) this.draw(plot, stand.curves[part], part);
    become(by("loop-said"), stand.said.map((words) => node("li", { textContent: words })));
    if (stand.state === "working") {
      by("loop-begin").disabled = true;
      by("loop-stop").hidden = false;
      by("loop-seconds").textContent = `${Math.floor(stand.elapsed_s)} s:`;
      put(by("loop-progress"), stand.words);
      this.timer = setTimeout(() => this.trying(async () => this.show(await got("bench"))), WATCHED_EVERY_MS);
      return;
    }
    this.idle();
    if (stand.state === "failed") {
      by("loop-verdict").textContent = "The loop was not closed";
      complain(stand.words);
    }
    if (stand.state === "done") this.take(stand.answer);
  }

  draw(plot, curve, part) {
    const style = part === "after" ? "third" : "first";
    const dots = curve ? [{ name: `${curve.at_deg.length} of ${curve.total} readings`, style, x: curve.at_deg, y: curve.error_deg }] : [];
    // The corrected error is drawn against what it has to reach.
    plot.draw({ dots, include: part === "after" ? [-0.2, 0.2, 0] : [0], limits: part === "after" ? [{ value: 0.2, both: true, name: "aim: ±0.2°", always: true }] : [] });
  }

  take(answer) {
    const names = answer.causes.map((one) => one.name.replaceAll("_", " ")).join(", ");
    const reached = answer.reached ? "The aim is reached" : "The aim is missed";
    by("loop-verdict").textContent = `${reached}: ${shown(answer.after.largest_deg)}° are left over the whole turn`;
    say(reached);
    const cards = [
      ["Before, largest", answer.before.largest_deg, "deg", `${shown(answer.before.rms_deg)} deg RMS, zero taken off`],
      ["Corrected, largest", answer.after.largest_deg, "deg", `asked: < ${given(answer.aim_deg)} deg`, answer.reached],
      ["Corrected", answer.after.rms_deg, "deg RMS", `${answer.orders} orders loaded`],
    ];
    const told = cards.map(([name, value, unit, beside, kept]) => node("div", { className: kept === undefined ? "" : kept ? "kept" : "missed" }, node("dt", { textContent: name }), node("dd", { className: "value" }, `${shown(value)} `, node("small", { textContent: unit })), node("dd", { className: "beside", textContent: beside })));
    told.push(node("div", {}, node("dt", { textContent: "What was wrong" }), node("dd", { className: "value words", textContent: names || "nothing beyond the error model" }), node("dd", { className: "beside", textContent: answer.verdict })));
    become(by("loop-figures"), told);
  }
}
