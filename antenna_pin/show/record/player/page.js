// Elements of the page.

const ICONS = {
  play: "M5 3.5v13l11-6.5z",
  pause: "M5 3.5h3.6v13H5zM11.4 3.5H15v13h-3.6z",
  previous: "M4 4h2v12H4zM16 4v12L7 10z",
  next: "M14 4h2v12h-2zM4 4v12l9-6z",
  view: "M10 4a6 6 0 1 0 6 6h-2a4 4 0 1 1-4-4v3l4.5-4L10 1z",
  all: "M3 3h5L6.3 4.7 9 7.4 7.4 9 4.7 6.3 3 8zM17 3v5l-1.7-1.7L12.6 9 11 7.4l2.7-2.7L12 3zM3 17v-5l1.7 1.7L7.4 11 9 12.6l-2.7 2.7L8 17zM17 17h-5l1.7-1.7L11 12.6l1.6-1.6 2.7 2.7L17 12z",
  panel: "M3 4h2v2H3zM7 4h10v2H7zM3 9h2v2H3zM7 9h10v2H7zM3 14h2v2H3zM7 14h10v2H7z",
  help: "M10 2a8 8 0 1 0 0 16 8 8 0 0 0 0-16zm-1 11h2v2H9zm3.9-5.3c0 1.9-2 2.2-2 4H9.1c0-2.6 1.9-2.8 1.9-4 0-.6-.4-1-1-1s-1 .4-1 1H7.1c0-1.7 1.2-2.8 2.9-2.8s2.9 1.1 2.9 2.8z",
  full: "M3 3h5v2H5v3H3zM12 3h5v5h-2V5h-3zM3 12h2v3h3v2H3zM15 12h2v5h-5v-2h3z",
};

function element(tag, name, parent, attributes) {
  const made = document.createElement(tag);
  if (name) made.className = name;
  for (const [key, value] of Object.entries(attributes || {})) made.setAttribute(key, value);
  if (parent) parent.appendChild(made);
  return made;
}

function icon(path) {
  return `<svg viewBox="0 0 20 20" aria-hidden="true"><path d="${path}"/></svg>`;
}

function button(parent, name, path, label, action) {
  const node = element("button", `ap-button ap-${name}`, parent, {type: "button", title: label, "aria-label": label});
  node.innerHTML = icon(path);
  node.addEventListener("click", action);
  return node;
}

// The three.js object of a path such as run/base.
const node = (viewer, path) => viewer.scene_tree.find(path.split("/")).object;
