// The page's elements: one by its id, and new ones.

export const by = (id) => document.getElementById(id);

/** A new element with properties and children. */
export function node(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}
