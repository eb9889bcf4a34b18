// Many recordings in one page.

// Browsers allow a page about 16 graphics contexts and blank the oldest beyond: this many are kept.
const LIVE = 8;
const slots = [];
let printing = false;

// The text of a script element: as it stands, or deflated and in base64.
async function unpacked(node) {
  if (node.type !== "application/zlib") return node.textContent;
  const deflated = new Blob([bytes(node.textContent)]).stream();
  return new Response(deflated.pipeThrough(new DecompressionStream("deflate"))).text();
}

// Meshcat's own script, where the page has it deflated.
async function loadViewer() {
  const packed = document.querySelector("script.ap-viewer");
  if (!packed || window.MeshCat) return;
  const running = document.createElement("script");
  running.textContent = await unpacked(packed);
  document.head.append(running);
}

// One place for a recording: it has a player while it is in view, and for some time after.
class Slot {
  constructor(id, viewer) {
    this.root = document.getElementById(id);
    this.text = null;
    this.player = null;
    this.inView = false;
    this.time = null;
    new IntersectionObserver((entries) => {
      this.inView = entries[entries.length - 1].isIntersecting;
      if (this.inView && !printing) this.start();
    }, {rootMargin: "100px"}).observe(this.root);
    this.ready = Promise.all([unpacked(document.getElementById(id + "-data")), viewer]).then(([text]) => {
      this.text = text;
      if (this.inView && !printing) this.start();
    });
  }

  start(room = true) {
    if (this.player || this.text === null) return;
    const idle = slots.filter((slot) => slot.player && !slot.inView && !slot.player.playing);
    const live = slots.filter((slot) => slot.player).length;
    if (room) idle.slice(0, Math.max(live + 1 - LIVE, 0)).forEach((slot) => slot.stop());
    this.player = window.AntennaPin.mount(this.root, JSON.parse(this.text), {embedded: true});
    if (this.time !== null) this.player.seek(this.time);
  }

  stop() {
    this.time = this.player.time;
    this.drop();
    this.root.replaceChildren();
  }

  drop() {
    this.player.dispose();
    window.AntennaPin.players = window.AntennaPin.players.filter((player) => player !== this.player);
    this.player = null;
  }

  // For paper: a still picture in place of the scene. It does not stay at the start, where nothing has happened.
  freeze() {
    const before = this.player;
    this.start(false);
    const {player} = this;
    if (!player || player.failed) return;
    if (player.time === player.start) {
      player.seek(player.data.poster);
      if (!player.eye.moved) player.resetCamera();
    }
    player.paper();
    player.render();
    const {canvas} = player;
    this.still = element("canvas", "ap-canvas ap-still");
    this.still.width = canvas.width;
    this.still.height = canvas.height;
    this.still.style.cssText = canvas.style.cssText;
    this.still.getContext("2d").drawImage(canvas, 0, 0);
    canvas.after(this.still);
    canvas.hidden = true;
    if (!before) this.drop();
  }

  thaw() {
    if (!this.still) return;
    this.still.remove();
    this.still = null;
    if (this.player) {
      this.player.canvas.hidden = false;
      this.player.screen();
    } else this.root.replaceChildren();
    if (this.inView) this.start();
  }
}

window.addEventListener("beforeprint", () => {
  if (!printing) slots.forEach((slot) => slot.freeze());
  printing = true;
});
window.addEventListener("afterprint", () => {
  printing = false;
  slots.forEach((slot) => slot.thaw());
});

window.AntennaPin = {
  players: [],
  // A player of `data` in an element.
  mount(root, data, options) {
    const player = new Player(root, data, options);
    this.players.push(player);
    return player;
  },
};

// A page that is one recording plays it at once; of many, each once it comes into view.
document.addEventListener("DOMContentLoaded", () => {
  document.querySelectorAll(".ap-whole").forEach((root) => {
    const data = JSON.parse(document.getElementById(root.id + "-data").textContent);
    window.recording = window.AntennaPin.mount(root, data);
  });
  const frames = document.querySelectorAll(".ap-frame");
  const viewer = frames.length ? loadViewer() : null;
  frames.forEach((root) => slots.push(new Slot(root.id, viewer)));
  window.AntennaPin.ready = Promise.all(slots.map((slot) => slot.ready));
});
