// Asking the program: questions in JSON, dropped files, and the words that tell how it went.
const OWN = { "X-Halltwin-Lab": "1" };
const errorLine = document.getElementById("error");
const statusLine = document.getElementById("status");

/** Say in the status line what goes on. */
export function say(words) {
  if (statusLine.textContent !== words) statusLine.textContent = words;
}

/** Show one line that says what is wrong, or take it away. */
export function complain(words) {
  errorLine.textContent = words ?? "";
  errorLine.hidden = !words;
  // What stands on the page was computed before: it is no answer to what was refused.
  document.body.classList.toggle("refused", Boolean(words));
}

async function answered(request) {
  let reply;
  try {
    reply = await request;
  } catch {
    throw new Error("the program does not answer: it has ended. Start halltwin lab again and open its address");
  }
  if (!reply.ok) {
    const told = await reply.json().catch(() => ({}));
    throw new Error(told.error ?? `the program answered with status ${reply.status}`);
  }
  return reply;
}

/** The answer to a question as plain values. Throws an Error whose message is one line. */
export async function ask(path, content) {
  return (await posted(path, content)).json();
}

/** The same as it came. */
export function posted(path, content) {
  const headers = { ...OWN, "Content-Type": "application/json" };
  return answered(fetch(path, { method: "POST", headers, body: JSON.stringify(content) }));
}

/** What is to be had at a path. */
export async function got(path) {
  return (await answered(fetch(path))).json();
}

/** Hand a file over. */
export async function handOver(path, file) {
  const headers = { ...OWN, "X-File-Name": encodeURIComponent(file.name) };
  return (await answered(fetch(path, { method: "POST", headers, body: file }))).json();
}

/**
 * A function that does one thing at a time, or so many: of what is asked meanwhile only the latest is done. What is
 * overtaken by a later one is told so, and leaves the page to it.
 */
export function latest(work, atATime = 1) {
  let running = 0;
  let begun = 0;
  let ended = 0;
  let waiting = null;
  async function next() {
    running += 1;
    while (waiting) {
      const arguments_ = waiting;
      waiting = null;
      begun += 1;
      const own = begun;
      const overtaken = () => own < ended;
      try {
        await work(...arguments_, overtaken);
      } catch (error) {
        if (!overtaken()) complain(error.message);
      }
      ended = Math.max(ended, own);
    }
    running -= 1;
  }
  return (...arguments_) => {
    waiting = arguments_;
    if (running < atATime) next();
  };
}
