"""The script of a batch's page: two figures of every device against each other, and how one of them is distributed."""

from __future__ import annotations

STYLE = """
.pick { display: flex; flex-wrap: wrap; gap: .5rem 1.2rem; align-items: baseline; margin: .6rem 0; }
.pick select, .pick input { font: inherit; color: inherit; background: var(--card); border: 1px solid var(--rule);
  border-radius: .3rem; padding: .15rem .4rem; max-width: 16rem; }
.canvas { display: grid; grid-template-columns: 4fr 1fr; gap: .5rem; }
canvas { width: 100%; height: 26rem; display: block; }
"""

SCRIPT = """
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const count = data.names.length, id = name => document.getElementById(name);
const order = {name: "number in the order of production", values: data.names.map((_, k) => k + 1)};
const choices = [order, ...data.figures];
for (const [name, first] of [["down", 1], ["across", 0]]) {
  choices.forEach((one, k) => id(name).add(new Option(one.name, k, false, k === first)));
}
const colour = name => getComputedStyle(document.documentElement).getPropertyValue(name);
const known = values => values.filter(value => value !== null);
const limits = values => {
  let low = Infinity, high = -Infinity;
  for (const value of values) if (value !== null) { low = Math.min(low, value); high = Math.max(high, value); }
  if (!(high > low)) { low -= 1; high += 1; }
  const edge = 0.04 * (high - low);
  return [low - edge, high + edge];
};
const ticks = ([low, high]) => {
  const rough = (high - low) / 5, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find(one => one * power >= rough), found = [];
  for (let at = Math.ceil(low / step) * step; at <= high; at += step) found.push(Number(at.toPrecision(6)));
  return found;
};
const begun = canvas => {
  const scale = window.devicePixelRatio || 1, pen = canvas.getContext("2d");
  canvas.width = canvas.clientWidth * scale; canvas.height = canvas.clientHeight * scale;
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.font = "12px system-ui, sans-serif";
  return [pen, canvas.clientWidth, canvas.clientHeight];
};
const edge = {left: 62, right: 8, top: 8, bottom: 34};
let shown = [], nearest = -1;
function draw() {
  const across = choices[id("across").value], down = choices[id("down").value], wanted = id("find").value;
  const [pen, width, height] = begun(id("points"));
  const [x0, x1] = limits(across.values), [y0, y1] = limits(down.values);
  const x = value => edge.left + (value - x0) / (x1 - x0) * (width - edge.left - edge.right);
  const y = value => height - edge.bottom - (value - y0) / (y1 - y0) * (height - edge.top - edge.bottom);
  pen.strokeStyle = colour("--grid"); pen.fillStyle = colour("--soft");
  pen.textAlign = "center";
  for (const at of ticks([x0, x1])) {
    pen.beginPath(); pen.moveTo(x(at), edge.top); pen.lineTo(x(at), height - edge.bottom); pen.stroke();
    pen.fillText(at, x(at), height - 18);
  }
  pen.fillText(across.name, (edge.left + width - edge.right) / 2, height - 3);
  pen.textAlign = "right";
  for (const at of ticks([y0, y1])) {
    pen.beginPath(); pen.moveTo(edge.left, y(at)); pen.lineTo(width - edge.right, y(at)); pen.stroke();
    pen.fillText(at, edge.left - 6, y(at) + 4);
  }
  shown = [];
  const usual = colour("--after"), apart = colour("--before"), ink = colour("--ink");
  for (const odd of [false, true]) {
    pen.fillStyle = odd ? apart : usual; pen.globalAlpha = odd ? 1 : count > 2000 ? 0.35 : 0.7;
    for (let k = 0; k < count; k += 1) {
      if ((k in data.apart) !== odd || across.values[k] === null || down.values[k] === null) continue;
      const at = [x(across.values[k]), y(down.values[k]), k], size = odd ? 4 : count > 2000 ? 1.6 : 2.5;
      pen.beginPath(); pen.arc(at[0], at[1], size, 0, 7); pen.fill();
      shown.push(at);
    }
  }
  pen.globalAlpha = 1; pen.strokeStyle = ink; pen.lineWidth = 1.5;
  let hits = 0;
  for (const [left, top, k] of shown) {
    const hit = wanted && data.names[k].includes(wanted);
    hits += hit;
    if (hit || k === nearest) { pen.beginPath(); pen.arc(left, top, 7, 0, 7); pen.stroke(); }
  }
  const told = k => `${data.names[k]} (number ${k + 1}): ${across.values[k]}, ${down.values[k]}`
    + (k in data.apart ? `; apart in ${data.apart[k]}` : "");
  id("said").textContent = nearest >= 0 ? told(nearest) : wanted ? `${hits} found` : `${shown.length} devices`;
  spread(down);
}
function spread(one) {
  const [pen, width, height] = begun(id("spread")), [low, high] = limits(one.values), bins = 40;
  const counts = new Array(bins).fill(0);
  for (const value of known(one.values)) {
    counts[Math.min(bins - 1, Math.floor((value - low) / (high - low) * bins))] += 1;
  }
  const most = Math.max(...counts), tall = (height - edge.top - edge.bottom) / bins;
  pen.fillStyle = colour("--after");
  counts.forEach((each, k) => {
    pen.fillRect(0, height - edge.bottom - (k + 1) * tall, each / most * (width - 4), tall - 1);
  });
  pen.fillStyle = colour("--soft"); pen.fillText(`most in a bin: ${most}`, 0, height - 18);
}
id("points").addEventListener("mousemove", event => {
  let best = 144; nearest = -1;
  for (const [left, top, k] of shown) {
    const far = (left - event.offsetX) ** 2 + (top - event.offsetY) ** 2;
    if (far < best) { best = far; nearest = k; }
  }
  draw();
});
id("points").addEventListener("mouseleave", () => { nearest = -1; draw(); });
for (const name of ["down", "across", "find"]) id(name).addEventListener("input", draw);
window.addEventListener("resize", draw);
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
draw();
"""
