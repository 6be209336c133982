// Where the page begins: what the program tells at the start, the twin that is chosen, files that are dropped.
import { ask, complain, got, handOver, say } from "./ask.js";
import { DesignView } from "./design.js";

const by = (id) => document.getElementById(id);

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

await trying(async () => {
  const start = await got("start");
  const select = by("preset");
  select.append(...start.presets.map((name) => Object.assign(document.createElement("option"), { value: name, textContent: name })));
  const design = new DesignView(start);
  const take = (twin) => {
    showTwin(twin);
    design.begin(twin);
  };
  take(start.twin);
  select.addEventListener("change", () => trying(async () => take(await ask("twin/preset", { name: select.value }))));
  const open = (file) => trying(async () => {
    say(`reading ${file.name}`);
    take(await handOver("twin/open", file));
    say(`opened ${file.name}`);
  });
  by("open-twin").addEventListener("click", () => by("twin-file").click());
  by("twin-file").addEventListener("change", (event) => {
    const [file] = event.target.files;
    event.target.value = "";
    if (file) open(file);
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
