// Where the page begins: what the program tells at the start, the twin that is chosen, files that are dropped.
import { ask, complain, got, handOver, say } from "./ask.js";
import { BenchView } from "./bench.js";
import { DesignView } from "./design.js";
import { by } from "./dom.js";
import { ExplainView } from "./explain.js";

async function trying(work) {
  try {
    complain(null);
    await work();
  } catch (error) {
    complain(error.message);
    say("");
  }
}

function showTwin(twin) {
  const select = by("preset");
  const known = [...select.options].some((one) => one.value === twin.name);
  if (!known) select.prepend(Object.assign(document.createElement("option"), { value: twin.name, textContent: twin.name, disabled: true }));
  select.value = twin.name;
}

const VIEWS = ["design", "explain", "bench"];

/** Show one of the views; its name stands behind the address, so that a reload comes back to it. */
function show(name) {
  const chosen = VIEWS.includes(name) ? name : VIEWS[0];
  for (const view of VIEWS) {
    by(view).classList.toggle("away", view !== chosen);
    const tab = by(`tab-${view}`);
    tab.setAttribute("aria-selected", String(view === chosen));
    tab.tabIndex = view === chosen ? 0 : -1;
  }
  say("");
  history.replaceState(null, "", `#${chosen}`);
}

VIEWS.forEach((view, k) => {
  by(`tab-${view}`).addEventListener("click", () => show(view));
  by(`tab-${view}`).addEventListener("keydown", (event) => {
    if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
    const next = VIEWS[(k + (event.key === "ArrowRight" ? 1 : VIEWS.length - 1)) % VIEWS.length];
    show(next);
    by(`tab-${next}`).focus();
  });
});

for (const button of document.querySelectorAll("button.copy")) {
  button.addEventListener("click", async () => {
    await navigator.clipboard.writeText(by(button.dataset.of).textContent);
    say("copied the command line");
  });
}

await trying(async () => {
  const start = await got("start");
  const select = by("preset");
  select.append(...start.presets.map((name) => Object.assign(document.createElement("option"), { value: name, textContent: name })));
  const design = new DesignView(start);
  const take = (twin) => {
    showTwin(twin);
    for (const place of ["held-name", "loop-twin"]) by(place).textContent = twin.name;
    design.begin(twin);
  };
  take(start.twin);
  show(start.sweep ? "explain" : location.hash.slice(1));
  const explain = new ExplainView(start);
  new BenchView();
  select.addEventListener("change", () => trying(async () => take(await ask("twin/preset", { name: select.value }))));
  const open = (file) => (file.name.toLowerCase().endsWith(".toml") ? openTwin(file) : openSweep(file));
  const openSweep = (file) => {
    show("explain");
    return explain.open(file);
  };
  const openTwin = (file) => trying(async () => {
    say(`reading ${file.name}`);
    take(await handOver("twin/open", file));
    say(`opened ${file.name}`);
  });
  by("open-twin").addEventListener("click", () => by("twin-file").click());
  by("twin-file").addEventListener("change", (event) => {
    const [file] = event.target.files;
    event.target.value = "";
    if (file) openTwin(file);
  });
  document.addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("dropping");
  });
  for (const name of ["dragleave", "drop"]) document.addEventListener(name, () => document.body.classList.remove("dropping"));
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    const [file] = event.dataTransfer.files;
    if (file) open(file);
  });
});
document.documentElement.dataset.ready = "yes";
