// From the page to files: what the program made, and pictures as they are drawn.

/** Have the browser save a content under a name. */
export function save(content, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const STYLES = ["fill", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "stroke-linejoin", "font-size", "font-family", "font-weight", "text-anchor", "opacity", "dominant-baseline"];

/** A picture as a file of its own: every style stands at its element, and the ground is that of the page. */
export function picture(svg) {
  const copy = svg.cloneNode(true);
  const [from, to] = [[svg, ...svg.querySelectorAll("*")], [copy, ...copy.querySelectorAll("*")]];
  from.forEach((one, k) => {
    const computed = getComputedStyle(one);
    for (const name of STYLES) to[k].setAttribute(name, computed.getPropertyValue(name));
    to[k].removeAttribute("class");
  });
  const [, , width, height] = svg.getAttribute("viewBox").split(" ");
  const ground = document.createElementNS(svg.namespaceURI, "rect");
  const colour = getComputedStyle(svg.closest(".card")).backgroundColor;
  for (const [name, value] of Object.entries({ width, height, fill: colour })) ground.setAttribute(name, value);
  copy.prepend(ground);
  copy.setAttribute("width", width);
  copy.setAttribute("height", height);
  copy.setAttribute("xmlns", svg.namespaceURI);
  return new Blob([new XMLSerializer().serializeToString(copy)], { type: "image/svg+xml" });
}

/** A command line of which no word is broken. */
export function showCommand(host, command) {
  if (host.textContent === command) return;
  const words = command.match(/'[^']*'|\S+/g) ?? [];
  host.replaceChildren(...words.flatMap((word, k) => [k ? " " : "", Object.assign(document.createElement("span"), { textContent: word })]));
}
