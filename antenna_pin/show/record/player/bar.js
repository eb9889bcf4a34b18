// The bar below the scene: what plays, the slider with its impacts, the curve under it.

const SPEEDS = [1, 0.5, 0.1, 0.01, 1e-3, 1e-4];

class Bar {
  constructor(root, player) {
    this.player = player;
    const bar = this.node = element("div", "ap-bar", root);
    const left = element("div", "ap-left", bar);
    button(left, "previous", ICONS.previous, "previous impact (Shift + \u2190)", () => player.jump(-1));
    this.play = button(left, "play", ICONS.play, "play (space)", () => player.toggle());
    button(left, "next", ICONS.next, "next impact (Shift + \u2192)", () => player.jump(1));
    this.from = element("span", "ap-span", bar); // of a film, which has no buttons
    const track = element("div", "ap-track", bar);
    this.marks = element("canvas", "ap-marks", track, {"aria-hidden": "true"});
    this.slider = element("input", "ap-slider", track, {
      type: "range", min: player.start, max: player.end, step: "any", "aria-label": "time in seconds",
    });
    this.slider.addEventListener("input", () => { player.pause(); player.seek(Number(this.slider.value)); });
    this.to = element("span", "ap-span", bar);
    const right = element("div", "ap-right", bar);
    this.select = element("select", "ap-speed", right, {title: "speed ([ and ])", "aria-label": "speed"});
    this.speeds = Array.from(new Set([...SPEEDS, player.speed])).sort((a, b) => b - a);
    for (const speed of this.speeds) {
      element("option", "", this.select, {value: speed}).textContent = speedName(speed);
    }
    this.select.addEventListener("change", () => player.setSpeed(Number(this.select.value)));
    button(right, "view", ICONS.view, "fit the mechanism (r)", () => player.resetCamera());
    button(right, "all", ICONS.all, "fit the whole motion (a)", () => player.resetCamera(true));
    button(right, "sides", ICONS.panel, "views, marks and bodies (p)", () => player.flip(player.panel));
    button(right, "ask", ICONS.help, "keys (?)", () => player.flip(player.help));
    if (document.fullscreenEnabled) {
      button(right, "full", ICONS.full, "full screen (Shift + f)", () => player.fullscreen());
    }
    if (!(player.duration > 0)) {
      for (const one of bar.querySelectorAll("input, select, .ap-play, .ap-previous, .ap-next")) one.disabled = true;
    } else if (player.data.curves && player.data.curves.series.length) this.addCurve(player);
  }

  addCurve(player) {
    const range = element("div", "ap-range", this.node);
    const row = element("div", "ap-curve", this.node);
    const side = element("div", "ap-pick", this.node);
    element("span", "", range);
    element("span", "", range);
    const canvas = element("canvas", "", row, {role: "img", "aria-label": "curve over time"});
    const select = element("select", "ap-speed", side);
    const values = element("div", "ap-values", side);
    const value = element("output", "ap-value", values);
    const other = element("output", "ap-value ap-other", values); // of the ideal run
    const seek = (t) => { player.pause(); player.seek(t); };
    this.curve = new Curve({row, canvas, range, select, value, other}, player.data.curves, player.start, player.end, seek);
  }

  show(t) {
    this.slider.value = t;
    const {start, duration} = this.player;
    this.slider.style.setProperty("--ap-done", `${duration > 0 ? 100 * (t - start) / duration : 0}%`);
    if (this.curve) this.curve.show(t);
  }

  resize() {
    this.drawImpacts();
    if (this.curve) this.curve.draw();
  }

  drawImpacts() {
    const {marks} = this, {start, duration, impacts} = this.player;
    const scale = window.devicePixelRatio || 1;
    const w = marks.clientWidth, h = marks.clientHeight;
    marks.width = w * scale;
    marks.height = h * scale;
    const pen = marks.getContext("2d");
    pen.scale(scale, scale);
    pen.clearRect(0, 0, w, h);
    if (!(duration > 0)) return;
    const largest = impacts.peaks.reduce((a, b) => Math.max(a, b), 0);
    pen.fillStyle = "rgba(213, 94, 0, 0.55)";
    impacts.times.forEach((t, i) => {
      const x = INSET + (w - 2 * INSET) * (t - start) / duration;
      const size = 2 + (h - 2) * Math.sqrt(largest > 0 ? impacts.peaks[i] / largest : 0);
      pen.fillRect(x - 0.5, h - size, 1, size);
    });
  }
}
