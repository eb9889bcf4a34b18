// A figure as large as the window: the wheel, two fingers or + and - enlarge it, dragging moves it, Escape closes.

const MOST = 24; // times the size at which it fits

class Zoom {
  constructor() {
    this.dialog = document.createElement("dialog");
    this.dialog.className = "zoom";
    this.dialog.innerHTML = `
      <div class="tools"><span class="said"></span><span class="saves"></span>
      <button type="button" data-do="-" aria-label="smaller (-)" title="smaller (-)">\u2212</button>
      <button type="button" data-do="+" aria-label="larger (+)" title="larger (+)">+</button>
      <button type="button" data-do="0" aria-label="whole figure (0)" title="whole figure (0)">whole</button>
      <button type="button" data-do="close" aria-label="close (Escape)" title="close (Escape)">\u2715</button></div>
      <div class="view"><img alt="" draggable="false"></div>`;
    document.body.append(this.dialog);
    this.view = this.dialog.querySelector(".view");
    this.image = this.dialog.querySelector("img");
    this.fingers = new Map();
    this.dialog.querySelectorAll("[data-do]").forEach((one) => one.addEventListener("click", () => this.act(one.dataset.do)));
    this.dialog.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const moves = {ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60]};
      if (moves[event.key]) this.move(...moves[event.key]);
      else if (["+", "=", "-", "0"].includes(event.key)) this.act(event.key === "=" ? "+" : event.key);
      else return;
      event.preventDefault();
    });
    this.view.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.enlarge(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.002)), event.clientX, event.clientY);
    }, {passive: false});
    this.view.addEventListener("dblclick", (event) => this.enlarge(this.scale < 1.5 ? 3 : 1 / MOST, event.clientX, event.clientY));
    this.view.addEventListener("pointerdown", (event) => {
      this.view.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    this.view.addEventListener("pointermove", (event) => this.dragged(event));
    for (const end of ["pointerup", "pointercancel"]) {
      this.view.addEventListener(end, (event) => this.fingers.delete(event.pointerId));
    }
    window.addEventListener("resize", () => { if (this.dialog.open) this.fit(); });
  }

  show(source, caption, size, saves) {
    this.size = size;
    this.image.src = source;
    this.image.alt = caption;
    this.dialog.setAttribute("aria-label", caption);
    this.dialog.querySelector(".said").textContent = caption;
    this.dialog.querySelector(".saves").replaceChildren(...saves);
    this.fingers.clear();
    this.dialog.showModal();
    this.fit();
  }

  act(what) {
    const box = this.view.getBoundingClientRect();
    if (what === "close") this.dialog.close();
    else if (what === "0") this.fit();
    else this.enlarge(what === "+" ? 1.5 : 1 / 1.5, box.left + box.width / 2, box.top + box.height / 2);
  }

  fit() {
    const w = this.view.clientWidth, h = this.view.clientHeight;
    this.least = Math.min(w / this.size[0], h / this.size[1]);
    this.scale = 1;
    this.place(0.5 * (w - this.size[0] * this.least), 0.5 * (h - this.size[1] * this.least));
  }

  // About a point of the window, which stays where it is.
  enlarge(by, x, y) {
    const box = this.view.getBoundingClientRect();
    const scale = Math.min(Math.max(this.scale * by, 1), MOST);
    const share = scale / this.scale;
    const [px, py] = [x - box.left, y - box.top];
    this.scale = scale;
    if (scale === 1) this.fit();
    else this.place(px - (px - this.x) * share, py - (py - this.y) * share);
  }

  move(dx, dy) {
    if (this.scale > 1) this.place(this.x + dx, this.y + dy);
  }

  place(x, y) {
    const w = this.size[0] * this.least * this.scale, h = this.size[1] * this.least * this.scale;
    // A part of it stays in view.
    this.x = Math.min(Math.max(x, 60 - w), this.view.clientWidth - 60);
    this.y = Math.min(Math.max(y, 60 - h), this.view.clientHeight - 60);
    Object.assign(this.image.style, {width: `${w}px`, height: `${h}px`, left: `${this.x}px`, top: `${this.y}px`});
  }

  dragged(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const other = [...this.fingers].filter(([id]) => id !== event.pointerId).map(([, place]) => place)[0];
    this.fingers.set(event.pointerId, now);
    if (!other) {
      this.move(now[0] - before[0], now[1] - before[1]);
      return;
    }
    const apart = (place) => Math.max(Math.hypot(place[0] - other[0], place[1] - other[1]), 1);
    this.enlarge(apart(now) / apart(before), 0.5 * (now[0] + other[0]), 0.5 * (now[1] + other[1]));
  }
}
