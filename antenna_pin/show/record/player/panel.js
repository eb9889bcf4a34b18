// What can be shown or hidden, from where it is looked at, and the bodies: a panel over the scene.

// One thing that is on or off; its heading's line and its line in the panel are two views of it.
class Switch {
  constructor(text, colour, on, apply) {
    Object.assign(this, {text, colour, on, apply, told: []});
    apply(on);
  }

  set(on) {
    this.on = on;
    this.apply(on);
    for (const tell of this.told) tell(on);
  }

  // A line of the heading, struck through while it is off; what begins hidden has one while it is shown only.
  line(list) {
    const item = element("li", "", list);
    const line = element("button", "ap-fact", item, {type: "button", title: "show or hide"});
    if (this.colour) element("span", "ap-key", line).style.background = this.colour;
    line.append(this.text);
    line.addEventListener("click", () => this.set(!this.on));
    const begun = this.on;
    this.tell((on) => {
      line.setAttribute("aria-pressed", on);
      item.hidden = !begun && !on;
    });
  }

  row(list) {
    const row = element("label", "ap-row", list);
    const box = element("input", "", row, {type: "checkbox"});
    if (this.colour) element("span", "ap-key", row).style.background = this.colour;
    row.append(this.text);
    box.addEventListener("change", () => this.set(box.checked));
    this.tell((on) => { box.checked = on; });
  }

  tell(how) {
    this.told.push(how);
    how(this.on);
  }
}

// A body's shapes: shown, or not, or translucent.
class Body {
  constructor(viewer, {name, path, parent, shapes}) {
    Object.assign(this, {name, parent, object: node(viewer, path), shapes: shapes.map((one) => node(viewer, one))});
    this.visible = true;
    this.paints = [];
    for (const shape of this.shapes) {
      shape.traverse(({material}) => {
        if (material) this.paints.push({material, opacity: material.opacity, depthWrite: material.depthWrite, clear: material.transparent});
      });
    }
    // Where its middle is and how far it reaches, before anything has moved.
    this.object.updateWorldMatrix(true, true);
    const box = new MeshCat.THREE.Box3();
    for (const shape of this.shapes) box.expandByObject(shape);
    const empty = box.isEmpty();
    this.radius = empty ? 0 : 0.5 * box.getSize(new MeshCat.THREE.Vector3()).length();
    this.centre = empty ? new MeshCat.THREE.Vector3() : this.object.worldToLocal(box.getCenter(new MeshCat.THREE.Vector3()));
  }

  show(on) {
    this.visible = on;
    for (const shape of this.shapes) shape.visible = on;
  }

  // Times as opaque as it was, 0 to 1.
  fade(share) {
    for (const {material, opacity, depthWrite, clear} of this.paints) {
      material.transparent = clear || share < 1;
      material.opacity = share * opacity;
      material.depthWrite = depthWrite && share === 1;
      material.needsUpdate = true;
    }
  }
}

class Panel {
  constructor(stage, player) {
    this.node = element("div", "ap-panel", stage, {role: "group", "aria-label": "views, marks and bodies"});
    this.node.hidden = true;
    const views = this.part("View");
    const buttons = element("div", "ap-views", views);
    for (const [key, view] of Object.entries({1: "x", 2: "y", 3: "z", 4: "iso"})) {
      const one = element("button", "ap-button", buttons, {type: "button", title: `view ${view} (${key})`});
      one.textContent = view;
      one.addEventListener("click", () => player.view(view));
    }
    for (const [text, title, whole] of [["fit", "fit the mechanism (r)", false], ["all", "fit the whole motion (a)", true]]) {
      const fit = element("button", "ap-button", buttons, {type: "button", title});
      fit.textContent = text;
      fit.addEventListener("click", () => player.resetCamera(whole));
    }
    if (player.bodies.length) {
      const row = element("label", "ap-row", views);
      row.append("follow ");
      this.follow = element("select", "ap-speed", row, {title: "body that the camera goes along with (f)"});
      for (const name of ["", ...player.bodies.map((body) => body.name)]) {
        element("option", "", this.follow, {value: name}).textContent = name || "none";
      }
      this.follow.addEventListener("change", () => player.follow(this.follow.value || null));
    }
    const marks = this.part("Show");
    for (const one of player.switches) one.row(marks);
    if (player.bodies.length) this.tree(this.part("Bodies"), player);
  }

  part(title) {
    const part = element("section", "", this.node);
    element("h3", "", part).textContent = title;
    return part;
  }

  // The bodies, each below and right of the one it hangs on.
  tree(list, player) {
    const known = new Set(player.bodies.map((body) => body.name));
    const under = (parent, deep) => {
      for (const body of player.bodies) {
        if ((known.has(body.parent) ? body.parent : null) !== parent) continue;
        const row = element("div", "ap-row ap-body", list);
        row.style.paddingLeft = `${Math.min(deep, 8) * 10}px`;
        const name = element("label", "", row, {title: body.name});
        const box = element("input", "", name, {type: "checkbox"});
        name.append(body.name);
        box.checked = true;
        box.addEventListener("change", () => { body.show(box.checked); player.dirty = true; });
        if (body.paints.length) {
          const clear = element("input", "ap-clear", row, {
            type: "range", min: 0.1, max: 1, step: 0.05, value: 1, title: "opacity", "aria-label": `opacity of ${body.name}`,
          });
          clear.addEventListener("input", () => { body.fade(Number(clear.value)); player.dirty = true; });
        }
        under(body.name, deep + 1);
      }
    };
    under(null, 0);
  }
}

// What the keys do.
const KEYS = [
  ["space, k", "play, pause"],
  ["\u2190 \u2192", "key frame by key frame; with shift, impact by impact"],
  ["home, end", "start, end"],
  ["[ ]", "slower, faster"],
  ["1 2 3 4", "view against x, y, z; as at the start"],
  ["r", "fit the mechanism as it is now"],
  ["a", "fit the whole motion"],
  ["f", "follow the next body, or none"],
  ["n", "names of bodies and joints"],
  ["p", "panel of views, marks and bodies"],
  ["shift f", "full screen"],
  ["?", "this list"],
];

function help(stage, remarks, close) {
  const node = element("div", "ap-help", stage, {role: "dialog", "aria-label": "keys"});
  const list = element("dl", "", node);
  for (const [key, what] of KEYS) {
    element("dt", "", list).textContent = key;
    element("dd", "", list).textContent = what;
  }
  element("p", "", node).textContent = "Drag, wheel, two fingers: turn, zoom, move. Click or drag the curve: go to that time.";
  for (const text of remarks) element("p", "", node).textContent = text;
  node.addEventListener("click", close);
  node.hidden = true;
  return node;
}
