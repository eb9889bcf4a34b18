// What is written over the scene: names of bodies and joints, and how long a length is.

const LINE = 15; // [px] height of a name
const BAR = 150; // [px] most that the scale bar takes

class Labels {
  // Each with a text, an object that it goes with and a place in its frame, and whether it is wanted.
  constructor(stage, items) {
    this.node = element("div", "ap-labels", stage, {"aria-hidden": "true"});
    this.items = items.map((item) => ({...item, node: element("span", `ap-label ap-label-${item.kind}`, this.node)}));
    for (const item of this.items) item.node.textContent = item.text;
    this.on = false;
  }

  draw(eye) {
    this.node.hidden = !this.on;
    if (!this.on) return;
    const seen = [];
    for (const {node, object, centre, wanted} of this.items) {
      const at = wanted() ? eye.pixels(object.localToWorld(centre.clone())) : null;
      node.hidden = !at;
      if (at) seen.push({node, at, wide: 7 * node.textContent.length});
    }
    const taken = []; // from above down, so that one that would lie over another goes below it
    for (const {node, at: [x, height], wide} of seen.sort((one, other) => one.at[1] - other.at[1])) {
      let y = height;
      while (taken.some(([a, b, w]) => Math.abs(a - x) < 0.5 * (w + wide) && Math.abs(b - y) < LINE)) y += LINE;
      taken.push([x, y, wide]);
      node.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
    }
  }
}

// The largest 1, 2 or 5 times a power of ten that is not above a length.
function round(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return [5, 2, 1].find((step) => step * power <= length) * power;
}

class ScaleBar {
  // `play` tells how many times as wide gaps are drawn as they are; null where all is as it is.
  constructor(foot, play) {
    this.play = play;
    this.node = element("div", "ap-scale", foot);
    this.text = element("span", "", this.node);
    this.bar = element("span", "ap-rule", this.node);
  }

  draw(eye) {
    if (this.node.hidden) return;
    const metres = eye.scale();
    if (!(metres > 0 && metres < Infinity)) return;
    const length = round(BAR * metres);
    this.bar.style.width = `${(length / metres).toFixed(1)}px`;
    const text = quantity(length, "m") + (this.play ? `, of play ${quantity(length / this.play, "m")}` : "");
    if (text !== this.text.textContent) this.text.textContent = text;
  }
}
