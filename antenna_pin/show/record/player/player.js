// Plays a recording of antenna_pin: poses over time, interpolated between key frames, on a meshcat scene.
//
//   const player = AntennaPin.mount(element, data, {embedded: false});
//   await player.ready;
//
// What others drive it by (times in seconds of the run, lengths in metres of the world, pixels of the page):
//
//   player.duration, player.times     end minus start; the key frames, Float64Array
//   player.start, player.end          first and last key frame
//   player.time                       the time shown
//   player.seek(t)                    go to t exactly; what is drawn depends on t alone
//   player.advance(t, wall = 1 / 30)  go on to t as playing does: force arrows show the largest force since the
//                                     time before and fade over `wall` seconds, so that no impact is missed
//   player.render()                   draw now
//   player.play(), player.pause()     with player.speed, 1 being real time
//   player.setCamera(position, target) a pinhole camera, 32 degrees high, gravity down
//   player.camera                     {position, target} now
//   player.resetCamera(whole)         frames the mechanism as it is now, or its whole motion
//   player.view(name, whole)          the same against an axis, "x", "y", "z", or as at the start, "iso"
//   player.follow(body)               goes along with a body from now on; null: with none
//   player.project(point)             [x, y] in pixels from the canvas' upper left corner
//   player.pose(body)                 {position, quaternion xyzw} of a body now, in the world
//   player.curve                      its series, choose(name), values, timeAt(x), xAt(t)
//   player.film()                     a time line in place of the controls
//   player.canvas, player.viewer      the HTML canvas; meshcat's viewer
//   player.dispose()                  stop and free the graphics context

const LIGHT = [[0.97, 0.98, 0.99], [0.86, 0.89, 0.93]]; // of the background: top, bottom
const DARK = [[0.13, 0.15, 0.18], [0.07, 0.08, 0.10]];

class Player {
  constructor(root, data, options) {
    this.root = root;
    this.data = data;
    this.embedded = Boolean(options && options.embedded);
    this.times = doubles(data.times);
    this.start = this.times[0];
    this.end = this.times[this.times.length - 1];
    this.duration = this.end - this.start;
    this.speed = data.speed;
    this.time = this.start;
    this.playing = false;
    this.whole = false; // whether the whole motion is framed: of a film, whose camera stays
    this.impacts = {times: doubles(data.impacts.times), peaks: floats(data.impacts.peaks)};
    this.bodies = [];
    this.switches = [];
    this.build();
    this.ready = new Promise((resolve) => { this.resolve = resolve; });
    try {
      this.scene();
    } catch (error) {
      this.stage.textContent = "This browser cannot draw 3D pictures (WebGL): " + error.message;
      this.stage.classList.add("ap-failed");
      this.failed = true;
      this.resolve(this);
      return;
    }
    this.overlays();
    this.theme();
    this.seek(this.start);
    this.resize();
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.stage);
    this.tick = this.tick.bind(this);
    this.handle = requestAnimationFrame(this.tick);
  }

  // --- parts of the page ---

  build() {
    const {data, root} = this;
    root.classList.add("ap-recording");
    root.replaceChildren();
    root.tabIndex = 0;
    this.head = element("div", "ap-head", root); // over the stage, or above it where that is narrow
    this.stage = element("div", "ap-stage", root);
    element("div", "ap-title", this.head).textContent = data.title;
    element("div", "ap-case", this.head).textContent = data.subtitle;
    this.facts = element("ul", "ap-facts", this.head);
    for (const fact of data.facts) {
      if (fact.paths) continue;
      const item = element("li", "", this.facts);
      if (fact.colour) element("span", "ap-key", item).style.background = fact.colour;
      item.append(fact.text);
    }
    this.clock = element("div", "ap-clock", this.stage);
    this.clockTime = element("div", "ap-time", this.clock);
    this.clockSpeed = element("div", "ap-rate", this.clock);
    if (data.triad) this.triad = new Triad(this.stage, data.triad);
    if (data.contacts && data.contacts.map) this.legend(data.contacts.map);
    this.foot = element("div", "ap-foot", this.stage);
    if (data.warnings.length) {
      const notes = element("div", "ap-notes", this.foot, {role: "note"});
      for (const text of data.warnings) element("div", "", notes).textContent = text;
      const close = element("button", "ap-close", notes, {type: "button", title: "close", "aria-label": "close this note"});
      close.textContent = "\u00d7";
      close.addEventListener("click", () => notes.remove());
    }
    this.bar = new Bar(root, this);
    this.curve = this.bar.curve;
    // A page of its own takes keys wherever the focus is; one of many on a page only where it has the focus.
    this.keys = this.embedded ? this.root : document;
    this.pressed = (event) => this.key(event);
    this.keys.addEventListener("keydown", this.pressed);
    // It has the focus from the first; in a frame of a notebook that would be taken from who writes there.
    if (!this.embedded && window === window.top) root.focus({preventScroll: true});
    this.setSpeed(this.speed);
  }

  legend(map) {
    const node = element("div", "ap-legend", this.stage);
    element("div", "", node).textContent = map.label;
    const stops = map.colours.map((c) => `rgb(${c.join(",")})`).join(",");
    element("div", "ap-colours", node).style.background = `linear-gradient(to right,${stops})`;
    const ends = element("div", "ap-ends", node);
    const middle = Math.sqrt(map.low * map.high);
    for (const value of [map.low, middle, map.high]) element("span", "", ends).textContent = quantity(value, "N");
  }

  // What lies over the scene, and what can be shown or hidden.
  overlays() {
    const {data, viewer} = this;
    const names = this.bodies.map((body) => ({...body, text: body.name, kind: "body", wanted: () => body.visible}));
    for (const fact of data.facts.filter((one) => one.paths)) {
      const objects = fact.paths.map((path) => node(viewer, path));
      const one = new Switch(fact.text, fact.colour, fact.shown !== false, (on) => {
        for (const object of objects) object.visible = on;
        this.dirty = true;
      });
      one.line(this.facts);
      this.switches.push(one);
      for (const {text, path, at} of fact.labels || []) {
        const centre = new MeshCat.THREE.Vector3(...at);
        names.push({text, kind: "joint", object: node(viewer, path), centre, wanted: () => one.on});
      }
    }
    const seen = (text, thing) => this.switches.push(
      new Switch(text, null, true, (on) => { thing.hidden = !on; this.dirty = true; })
    );
    this.scaleBar = new ScaleBar(this.foot, data.play);
    seen("scale bar", this.scaleBar.node);
    if (this.triad) seen(this.triad.gravity ? `${this.triad.label} and gravity` : this.triad.label, this.triad.node);
    if (names.length) {
      this.labels = new Labels(this.stage, names);
      this.names = new Switch("names", null, false, (on) => { this.labels.on = on; this.dirty = true; });
      this.switches.push(this.names);
    }
    this.panel = new Panel(this.stage, this);
    this.help = {node: help(this.stage, data.thinned, () => this.flip(this.help))};
  }

  flip(part) {
    if (part) part.node.hidden = !part.node.hidden;
  }

  // Dark where the page is: a page of its own always may be, one with others is where its style says so.
  theme() {
    const dark = window.matchMedia("(prefers-color-scheme: dark)");
    const apply = (paper = false) => {
      const scheme = getComputedStyle(document.documentElement).colorScheme;
      const on = !paper && scheme.includes("dark") && (dark.matches || !scheme.includes("light"));
      this.root.classList.toggle("ap-dark", on);
      ["top_color", "bottom_color"].forEach((name, k) => {
        this.viewer.set_property(["Background"], name, (on ? DARK : LIGHT)[k]);
      });
      this.dirty = true;
      if (this.curve) this.curve.draw();
    };
    this.paper = () => apply(true);
    this.screen = () => apply();
    dark.addEventListener("change", this.screen);
    window.addEventListener("ap-theme", this.screen); // of a page that has a switch
    this.untheme = () => {
      dark.removeEventListener("change", this.screen);
      window.removeEventListener("ap-theme", this.screen);
    };
    apply();
  }

  // --- parts of the scene ---

  scene() {
    const THREE = MeshCat.THREE;
    const {data} = this;
    // What is drawn stays in the canvas until the next drawing, so it can be printed and captured at any time.
    const renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
    this.canvas = renderer.domElement;
    this.canvas.className = "ap-canvas";
    this.stage.prepend(this.canvas);
    this.viewer = new MeshCat.Viewer(this.stage, false, renderer);
    const {viewer} = this;
    viewer.gui.domElement.remove();
    viewer.set_3d_pane_size = () => this.resize();
    for (const text of data.commands) viewer.handle_command_bytearray(bytes(text));
    for (const name of ["PointLightNegativeX", "PointLightPositiveX", "FillLight"]) {
      viewer.set_property(["Lights", name], "visible", false);
    }
    // Lights that go with the camera, so that no view is dark and the size of the scene does not matter.
    const camera = viewer.camera;
    camera.fov = FIELD_OF_VIEW;
    viewer.set_camera(camera);
    for (const [x, y, z, strength] of [[-0.6, 1, 0.8, 0.46], [0.9, 0.1, 0.7, 0.28]]) {
      const light = new THREE.DirectionalLight(0xffffff, strength);
      light.position.set(x, y, z);
      camera.add(light, light.target);
    }
    const {controls} = viewer;
    controls.enableZoom = !this.embedded; // so that the wheel scrolls the page it is embedded in
    if (this.embedded) this.stage.style.touchAction = "pan-y";
    controls.addEventListener("start", () => { this.eye.moved = true; });
    controls.addEventListener("change", () => { this.dirty = true; });
    this.bodies = (data.bodies || []).map((body) => new Body(viewer, body));
    this.actors = data.actors.map((actor) => new Actor(viewer, actor));
    const forces = (one) => (one ? new Contacts(viewer, one, this.times) : null);
    this.contacts = forces(data.contacts);
    this.arrows = [this.contacts, forces(data.applied)].filter(Boolean); // those of contacts, and applied ones
    this.trails = data.trails.map((trail) => new Trail(viewer, trail));
    this.eye = new Eye(viewer, data.camera, data.triad ? data.triad.axes : [], this.bodies);
  }

  resize() {
    const w = Math.max(this.stage.clientWidth, 1), h = Math.max(this.stage.clientHeight, 1);
    const {viewer} = this;
    viewer.renderer.setPixelRatio(window.devicePixelRatio);
    viewer.renderer.setSize(w, h);
    viewer.camera.aspect = w / h;
    viewer.camera.updateProjectionMatrix();
    if (!this.eye) return; // meshcat's own first size
    if (!this.eye.moved) this.resetCamera();
    else if (viewer.camera.view && viewer.camera.view.enabled) {
      const {fullHeight, offsetY} = viewer.camera.view;
      viewer.camera.setViewOffset(w, h, 0, offsetY * h / fullHeight, w, h);
    }
    this.bar.resize();
    this.dirty = true;
    if (this.shown) this.render();
  }

  // --- time ---

  clamp(t) {
    return Math.min(Math.max(t, this.start), this.end);
  }

  seek(t) {
    this.time = this.clamp(t);
    if (this.failed) return;
    this.place();
    for (const one of this.arrows) one.seek(this.time);
  }

  advance(t, wall = 1 / 30) {
    const before = this.time;
    this.time = this.clamp(t);
    if (this.failed) return;
    this.place();
    for (const one of this.arrows) {
      if (this.time < before) one.seek(this.time);
      else one.advance(before, this.time, wall);
    }
  }

  place() {
    const t = this.time;
    for (const actor of this.actors) actor.show(t);
    for (const trail of this.trails) trail.show(t);
    this.eye.go();
    this.bar.show(t);
    this.clockTime.textContent = `${t.toFixed(this.digits)} s`;
    this.dirty = true;
  }

  render() {
    if (this.failed) return;
    this.viewer.render();
    if (this.triad) this.triad.show(this.time, (axis) => this.eye.seen(axis));
    if (this.labels) this.labels.draw(this.eye);
    this.scaleBar.draw(this.eye);
    this.dirty = false;
    if (!this.shown) {
      this.shown = true;
      this.resolve(this);
    }
  }

  tick(now) {
    this.handle = requestAnimationFrame(this.tick);
    if (this.playing) {
      const wall = Math.min((now - this.last) / 1000, 0.25);
      this.last = now;
      if (wall > 0) this.advance(this.time + wall * this.speed, wall);
      this.wait = this.time < this.end ? 0 : this.wait + wall;
      if (this.wait > 3 * FADE) this.pause();
    }
    if (this.dirty) this.render();
  }

  play() {
    if (!(this.duration > 0) || this.failed) return;
    if (this.time >= this.end) this.seek(this.start);
    this.playing = true;
    this.wait = 0;
    this.last = performance.now();
    this.label("pause");
  }

  pause() {
    this.playing = false;
    this.label("play");
  }

  toggle() {
    if (this.playing) this.pause(); else this.play();
  }

  label(what) {
    const {play} = this.bar;
    play.innerHTML = icon(ICONS[what]);
    play.title = `${what} (space)`;
    play.setAttribute("aria-label", play.title);
  }

  setSpeed(speed) {
    this.speed = speed;
    this.bar.select.value = speed;
    this.digits = Math.min(Math.max(3 + Math.round(-Math.log10(speed)), 2), 7);
    this.clockSpeed.textContent = speed === 1 ? "real time" : `${speedName(speed)} of real time`;
    if (speed > 1) this.clockSpeed.textContent = `${speedName(speed)} real time`;
    this.clockTime.textContent = `${this.time.toFixed(this.digits)} s`;
  }

  // To the next faster (-1) or slower (1) speed there is.
  faster(by) {
    const {speeds} = this.bar;
    const i = speeds.indexOf(this.speed) + by;
    if (i >= 0 && i < speeds.length) this.setSpeed(speeds[i]);
  }

  // To the peak of the next (1) or previous (-1) impact.
  jump(way) {
    this.pause();
    const {times} = this.impacts;
    const at = this.time;
    const later = way > 0 ? upto(times, at + 1e-12) : upto(times, at - 1e-12) - 1;
    if (later >= 0 && later < times.length) this.seek(times[later]);
    else this.seek(way > 0 ? this.end : this.start);
  }

  // To the next (1) or previous (-1) key frame.
  step(way) {
    this.pause();
    const i = way > 0 ? upto(this.times, this.time) : upto(this.times, this.time - 1e-12) - 1;
    this.seek(this.times[Math.min(Math.max(i, 0), this.times.length - 1)]);
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || this.failed) return;
    // What is chosen by keys itself keeps them, the slider of time excepted.
    const {target} = event;
    if (target.matches && target.matches("select, input") && target !== this.bar.slider) return;
    const jump = event.shiftKey ? (way) => this.jump(way) : (way) => this.step(way);
    const actions = {
      " ": () => this.toggle(), k: () => this.toggle(), ArrowLeft: () => jump(-1), ArrowRight: () => jump(1),
      Home: () => { this.pause(); this.seek(this.start); }, End: () => { this.pause(); this.seek(this.end); },
      "]": () => this.faster(-1), "[": () => this.faster(1),
      "+": () => this.faster(-1), "=": () => this.faster(-1), "-": () => this.faster(1), "−": () => this.faster(1),
      1: () => this.view("x"), 2: () => this.view("y"), 3: () => this.view("z"), 4: () => this.view("iso"),
      r: () => this.resetCamera(), a: () => this.resetCamera(true), f: () => this.followNext(), F: () => this.fullscreen(),
      n: () => this.names && this.names.set(!this.names.on), p: () => this.flip(this.panel),
      "?": () => this.flip(this.help), Escape: () => { this.help.node.hidden = this.panel.node.hidden = true; },
    };
    const action = actions[event.key] || actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action();
  }

  fullscreen() {
    if (document.fullscreenElement) document.exitFullscreen();
    else if (document.fullscreenEnabled) this.root.requestFullscreen();
  }

  // For pictures that are taken one by one: no controls, but a line of time.
  film() {
    this.root.classList.add("ap-filmed");
    this.whole = true;
    this.bar.from.textContent = `${Number(this.start.toPrecision(6))}`;
    this.bar.to.textContent = `${Number(this.end.toPrecision(6))} s`;
  }

  // --- camera ---

  setCamera(position, target) {
    this.follow(null);
    this.eye.set(position, target);
    this.dirty = true;
  }

  get camera() {
    return this.eye.get();
  }

  resetCamera(whole = this.whole) {
    this.follow(null);
    this.view("iso", whole);
  }

  view(name, whole = this.whole) {
    const w = Math.max(this.stage.clientWidth, 1), h = Math.max(this.stage.clientHeight, 1);
    const over = this.head.getBoundingClientRect().bottom - this.stage.getBoundingClientRect().top;
    this.eye.frame(name, w, h, Math.min(Math.max(over, 0), 0.35 * h), whole);
    if (name !== "iso" || whole !== this.whole) this.eye.moved = true;
    this.dirty = true;
  }

  follow(name) {
    const body = name === null ? null : this.bodies.find((one) => one.name === name);
    if (body === undefined) throw new Error(`no body ${name}`);
    this.eye.follow(body);
    if (this.panel && this.panel.follow) this.panel.follow.value = name || "";
    this.dirty = true;
  }

  // Of the bodies that are drawn the next one, after the last of them none.
  followNext() {
    const some = this.bodies.filter((body) => body.radius > 0);
    const next = some[some.indexOf(this.eye.followed) + 1];
    if (next) this.follow(next.name);
    else this.resetCamera();
  }

  project(point) {
    return this.eye.project(point);
  }

  pose(body) {
    for (const {name, object} of this.actors.flatMap((actor) => actor.tracks)) {
      if (name !== body) continue;
      return {position: object.position.toArray(), quaternion: object.quaternion.toArray()};
    }
    throw new Error(`no body ${body}`);
  }

  dispose() {
    this.pause();
    this.keys.removeEventListener("keydown", this.pressed);
    cancelAnimationFrame(this.handle);
    if (this.observer) this.observer.disconnect();
    if (this.untheme) this.untheme();
    if (!this.viewer) return;
    this.viewer.controls.dispose();
    this.viewer.renderer.dispose();
    this.viewer.renderer.forceContextLoss();
  }
}
