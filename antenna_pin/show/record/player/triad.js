// Which way is which: the axes that numbers are in, and gravity, in the corner.

const TRIAD = 30; // [px] length of an axis in the corner

// The axes that numbers are in, and gravity, drawn in the corner as the camera sees them.
class Triad {
  constructor(stage, data) {
    this.node = element("div", "ap-triad", stage);
    this.label = data.label;
    this.axes = data.axes;
    this.times = doubles(data.times);
    this.gravity = data.gravity ? floats(data.gravity) : null;
    const size = 2 * (TRIAD + 14);
    this.node.innerHTML = `<svg viewBox="0 0 ${size} ${size}" width="${size}" height="${size}" role="img"></svg>`;
    this.svg = this.node.firstChild;
    this.svg.setAttribute("aria-label", data.label + (data.gravity ? " and gravity, g" : ""));
    element("div", "", this.node).textContent = data.label;
  }

  // Draws it for a time; `seen` turns directions of the scene to [right, up, towards who looks].
  show(t, seen) {
    const arrows = this.axes.map((axis, k) => ["xyz"[k], axis]);
    if (this.gravity) {
      const [i, u] = locate(this.times, t);
      const p = 3 * i, q = this.times.length < 2 ? p : p + 3;
      const pull = [0, 1, 2].map((k) => (1 - u) * this.gravity[p + k] + u * this.gravity[q + k]);
      const norm = Math.hypot(...pull) || 1;
      arrows.push(["g", pull.map((x) => x / norm)]);
    }
    const middle = TRIAD + 14;
    const taken = []; // where names stand, none over another
    const lines = arrows.map(([name, axis]) => {
      const [x, y, near] = seen(axis);
      const [right, down] = [TRIAD * x, -TRIAD * y];
      const long = Math.hypot(right, down);
      const [a, b] = long > 0 ? [right / long, down / long] : [0, 0];
      const place = (along, across) =>
        `${(middle + a * along - b * across).toFixed(1)} ${(middle + b * along + a * across).toFixed(1)}`;
      const head = Math.min(6, long);
      // The label of gravity stands beside it: it points along an axis as often as not.
      const free = (at) => taken.every(([x, y]) => Math.hypot(x - at[0], y - at[1]) > 10);
      const spots = name === "g" ? [[long - 8, 10]] : [[long + 8, 0], [long + 4, 9], [long + 4, -9]];
      const tried = spots.map((spot) => place(...spot).split(" ").map(Number));
      const words = tried.find(free) || tried[0];
      taken.push(words);
      return [near, `<g class="ap-axis-${name}"><path d="M${middle} ${middle}L${place(long, 0)}` +
        `M${place(long - head, 0.45 * head)}L${place(long, 0)}L${place(long - head, -0.45 * head)}"/>` +
        `<text x="${words[0]}" y="${words[1]}">${name}</text></g>`];
    });
    const drawn = lines.sort((one, other) => one[0] - other[0]).map((line) => line[1]).join("");
    if (drawn !== this.drawn) this.svg.innerHTML = this.drawn = drawn;
  }
}
