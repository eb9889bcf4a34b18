// A series of the run under the slider: what was computed, over the same time.

const INSET = 8; // [px] half of the slider's thumb: time begins and ends there, as on the slider
const ROOM = 7; // [px] above and below the curve

class Curve {
  // `place` has row, canvas, range (its two ends), select, value and other (the ideal run's), elements of the page;
  // `data` a list of series.
  constructor(place, data, start, end, seek) {
    Object.assign(this, place);
    this.series = data.series;
    this.start = start;
    this.end = end;
    this.time = start;
    this.hover = null; // the sample below the pointer
    this.read = new Map();
    const groups = new Map();
    this.series.forEach((one, k) => {
      if (!groups.has(one.group)) {
        groups.set(one.group, element("optgroup", "", this.select, {label: one.group}));
      }
      element("option", "", groups.get(one.group), {value: k}).textContent = one.text;
    });
    this.select.title = "what the curve shows";
    this.select.addEventListener("change", () => this.choose(Number(this.select.value)));
    const at = (event) => this.timeAt(event.clientX - this.canvas.getBoundingClientRect().left);
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      this.dragged = true;
      seek(at(event));
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (this.dragged) seek(at(event));
      this.point(at(event));
    });
    for (const kind of ["pointerup", "pointercancel"]) {
      this.canvas.addEventListener(kind, () => { this.dragged = false; });
    }
    this.canvas.addEventListener("pointerleave", () => this.point(null));
    this.choose(data.first);
  }

  // By its place in the list, or by name.
  choose(which) {
    const k = typeof which === "string" ? this.series.findIndex((one) => one.name === which) : which;
    if (!this.series[k]) throw new Error(`no series ${which}`);
    this.select.value = k;
    this.shown = this.series[k];
    if (!this.read.has(k)) {
      const {ideal} = this.shown;
      const unpacked = ({times, values}) => ({times: doubles(times), values: doubles(values)});
      this.read.set(k, {...unpacked(this.shown), ideal: ideal ? unpacked(ideal) : null});
    }
    Object.assign(this, this.read.get(k));
    const known = [this.values, this.ideal ? this.ideal.values : []].map((one) => one.filter(Number.isFinite));
    let low = Infinity, high = -Infinity;
    for (const one of known) for (const value of one) { low = Math.min(low, value); high = Math.max(high, value); }
    if (!(low <= high)) [low, high] = [0, 0];
    this.ends = [low, high];
    if (low > 0 && low < 0.5 * high) low = 0;
    if (high < 0 && high > 0.5 * low) high = 0;
    const flat = low === high ? Math.abs(low) || 1 : 0;
    this.span = [low - flat, high + flat];
    const {unit} = this.shown;
    this.size = Math.max(...this.span.map(Math.abs)); // all that is said has the prefix of this
    this.range.children[0].textContent = written(this.span[1], unit, this.size);
    this.range.children[1].textContent = written(this.span[0], unit, this.size);
    this.few = this.times.length < this.shown.samples;
    this.row.title = this.few
      ? `${this.times.length} of ${this.shown.samples} samples; no other is off the line by more than ${written(this.shown.off, unit)}`
      : "";
    this.hover = null;
    this.draw();
  }

  width() {
    return Math.max(this.canvas.clientWidth - 2 * INSET, 1);
  }

  timeAt(x) {
    const share = Math.min(Math.max((x - INSET) / this.width(), 0), 1);
    return this.start + share * (this.end - this.start);
  }

  xAt(t) {
    return INSET + this.width() * (t - this.start) / (this.end - this.start);
  }

  yAt(value, height) {
    const [low, high] = this.span;
    return height - ROOM - (height - 2 * ROOM) * (value - low) / (high - low);
  }

  // The sample that is drawn nearest to a time; none where the pointer has left.
  point(t) {
    this.hover = null;
    if (t !== null && this.times.length) {
      const k = Math.min(upto(this.times, t), this.times.length - 1);
      this.hover = k > 0 && t - this.times[k - 1] < this.times[k] - t ? k - 1 : k;
    }
    this.draw();
  }

  // The value at a time, between the samples that are drawn linearly.
  at(t, {times, values} = this) {
    const [i, u] = locate(times, t);
    return times.length < 2 ? values[0] : (1 - u) * values[i] + u * values[i + 1];
  }

  show(t) {
    this.time = t;
    this.draw();
  }

  draw() {
    const {canvas, times, values, ideal} = this;
    const scale = window.devicePixelRatio || 1;
    const w = canvas.clientWidth, h = canvas.clientHeight;
    if (!w || !h) return;
    if (canvas.width !== Math.round(w * scale)) canvas.width = Math.round(w * scale);
    if (canvas.height !== Math.round(h * scale)) canvas.height = Math.round(h * scale);
    const pen = canvas.getContext("2d");
    const style = getComputedStyle(canvas);
    const colour = (name) => style.getPropertyValue(`--ap-${name}`);
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, w, h);
    pen.lineWidth = 1;
    const [low, high] = this.span;
    if (low <= 0 && high >= 0) {
      pen.strokeStyle = colour("line");
      const y = Math.round(this.yAt(0, h)) + 0.5;
      pen.strokeRect(INSET, y, this.width(), 0);
    }
    pen.lineJoin = "round";
    if (ideal) this.line(pen, colour("ghost"), 2.5, ideal, h); // wider and below, so that it is seen where both are one
    this.line(pen, colour("curve"), 1.25, this, h);
    this.mark(pen, colour("accent"), this.time, this.at(this.time), h);
    if (this.hover !== null) this.mark(pen, colour("force"), times[this.hover], values[this.hover], h);
    this.say();
  }

  line(pen, colour, wide, {times, values}, h) {
    pen.strokeStyle = colour;
    pen.lineWidth = wide;
    pen.beginPath();
    let broken = true; // by numbers that are none
    for (let i = 0; i < times.length; i++) {
      if (!Number.isFinite(values[i])) { broken = true; continue; }
      const x = this.xAt(times[i]), y = this.yAt(values[i], h);
      if (broken) pen.moveTo(x, y); else pen.lineTo(x, y);
      broken = false;
    }
    pen.stroke();
  }

  mark(pen, colour, t, value, h) {
    pen.strokeStyle = pen.fillStyle = colour;
    pen.lineWidth = 1;
    const x = Math.round(this.xAt(t)) + 0.5;
    pen.beginPath();
    pen.moveTo(x, 0);
    pen.lineTo(x, h);
    pen.stroke();
    if (!Number.isFinite(value)) return;
    pen.beginPath();
    pen.arc(this.xAt(t), this.yAt(value, h), 3.5, 0, 2 * Math.PI);
    pen.fill();
  }

  // Below the pointer the sample as it was computed, to the last digit; else what is drawn at the time shown. Of the
  // ideal run what its line says at that time.
  say() {
    const {value, other, hover, ideal} = this;
    const unit = this.shown.unit ? ` ${this.shown.unit}` : "";
    value.classList.toggle("ap-exact", hover !== null);
    const text = hover === null
      ? `${this.few ? "\u2248 " : ""}${written(this.at(this.time), this.shown.unit, this.size)}`
      : `${this.values[hover]}${unit} at ${Number(this.times[hover].toPrecision(9))} s`;
    if (text !== value.textContent) value.textContent = text;
    const at = hover === null ? this.time : this.times[hover];
    const beside = ideal ? `ideal \u2248 ${written(this.at(at, ideal), this.shown.unit, this.size)}` : "";
    if (beside !== other.textContent) other.textContent = beside;
  }
}
