// Figures: unpacked, one of a section's at a time, enlarged, saved.

const files = new Map(); // blobs by figure

function download(content, type, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], {type}));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const nameOf = (figure) => figure.id.replace(/^figure-/, "");

function savers(figure) {
  const made = (text, title, action) => {
    const node = document.createElement("button");
    node.type = "button";
    node.className = "save";
    node.textContent = text;
    node.title = title;
    node.setAttribute("aria-label", `${title}: ${nameOf(figure)}`);
    node.addEventListener("click", action);
    return node;
  };
  const name = nameOf(figure);
  const all = [made("SVG", "save the figure", () => download(files.get(figure), "image/svg+xml", `${name}.svg`))];
  if (hasNumbers(name)) {
    const save = async () => download(await csvOf(name), "text/csv", `${name}.csv`);
    all.push(made("CSV", "save its numbers", save));
  }
  return all;
}

async function unpackPictures() {
  const zoom = new Zoom();
  for (const figure of document.querySelectorAll("figure.picture")) {
    const image = figure.querySelector("img"), packed = figure.querySelector("script.packed");
    const content = packed ? await inflated(packed.textContent) : bytesOf(image.src.split(",")[1]);
    const file = new Blob([content], {type: "image/svg+xml"});
    files.set(figure, file);
    if (packed) image.src = URL.createObjectURL(file);
    const caption = figure.querySelector("figcaption");
    const saves = document.createElement("span");
    saves.className = "saves";
    saves.append(...savers(figure));
    caption.append(" ", saves);
    const size = [image.width, image.height].map(Number);
    const drawn = [Number(image.getAttribute("width")), Number(image.getAttribute("height"))];
    figure.querySelector(".enlarge").addEventListener("click", () => zoom.show(image.src, image.alt, drawn[0] ? drawn : size, savers(figure)));
  }
}

// Of the figures of a section one is seen at a time; on paper all are.
function tabs(group, number) {
  const figures = Array.from(group.querySelectorAll("figure.picture"));
  if (figures.length < 2) return;
  const list = document.createElement("div");
  list.className = "tabs";
  list.setAttribute("role", "tablist");
  list.setAttribute("aria-label", "figures");
  group.prepend(list);
  const choose = (k, focus) => {
    figures.forEach((figure, i) => {
      const on = i === k;
      figure.classList.toggle("other", !on);
      list.children[i].setAttribute("aria-selected", on);
      list.children[i].tabIndex = on ? 0 : -1;
    });
    if (focus) list.children[k].focus();
  };
  figures.forEach((figure, k) => {
    const tab = document.createElement("button");
    tab.type = "button";
    tab.id = `tab-${number}-${k}`;
    tab.textContent = figure.dataset.name;
    tab.setAttribute("role", "tab");
    tab.setAttribute("aria-controls", figure.id);
    figure.setAttribute("role", "tabpanel");
    figure.setAttribute("aria-labelledby", tab.id);
    tab.addEventListener("click", () => choose(k));
    list.append(tab);
  });
  list.addEventListener("keydown", (event) => {
    const now = Array.from(list.children).indexOf(document.activeElement);
    const to = {ArrowRight: now + 1, ArrowLeft: now - 1, Home: 0, End: figures.length - 1}[event.key];
    if (to === undefined) return;
    event.preventDefault();
    choose((to + figures.length) % figures.length, true);
  });
  choose(0);
}
