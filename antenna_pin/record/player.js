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
//   player.resetCamera()              frames the whole motion again
//   player.project(point)             [x, y] in pixels from the canvas' upper left corner
//   player.pose(body)                 {position, quaternion xyzw} of a body now, in the world
//   player.canvas, player.viewer      the HTML canvas; meshcat's viewer
//   player.dispose()                  stop and free the graphics context
(function () {
  "use strict";

  const FADE = 0.15; // [s] of wall time in which a force arrow falls to 1/e
  const FIELD_OF_VIEW = 32; // [deg], vertical
  const MARGIN = 1.06; // of the framed motion
  const TRIAD = 30; // [px] length of an axis in the corner
  const SPEEDS = [1, 0.5, 0.1, 0.01, 1e-3, 1e-4];
  const ICONS = {
    play: "M5 3.5v13l11-6.5z",
    pause: "M5 3.5h3.6v13H5zM11.4 3.5H15v13h-3.6z",
    previous: "M4 4h2v12H4zM16 4v12L7 10z",
    next: "M14 4h2v12h-2zM4 4v12l9-6z",
    view: "M10 4a6 6 0 1 0 6 6h-2a4 4 0 1 1-4-4v3l4.5-4L10 1z",
    full: "M3 3h5v2H5v3H3zM12 3h5v5h-2V5h-3zM3 12h2v3h3v2H3zM15 12h2v5h-5v-2h3z",
  };

  // --- numbers ---

  function bytes(text) {
    const raw = atob(text);
    const out = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
    return out;
  }
  const floats = (text) => new Float32Array(bytes(text).buffer);
  const doubles = (text) => new Float64Array(bytes(text).buffer);

  // Number of entries that are <= t.
  function upto(times, t) {
    let low = 0, high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle + 1; else high = middle;
    }
    return low;
  }

  // The interval and the share of it at which t lies; times outside are those of the ends.
  function locate(times, t) {
    const last = times.length - 1;
    if (last < 1 || t <= times[0]) return [0, 0];
    if (t >= times[last]) return [last - 1, 1];
    const i = upto(times, t) - 1;
    return [i, (t - times[i]) / (times[i + 1] - times[i])];
  }

  // The rotation at the share u of the way from one quaternion to another, at constant rate. Where they are close
  // the arc is as good as its chord; the sine of the angle would be lost in the rounding of 32-bit numbers.
  function turned(from, to, u) {
    const cosine = from.reduce((sum, value, k) => sum + value * to[k], 0);
    let [a, b] = [1 - u, u];
    if (Math.abs(cosine) < 0.9999) {
      const angle = Math.acos(Math.abs(cosine));
      [a, b] = [Math.sin(a * angle), Math.sin(b * angle)];
    }
    if (cosine < 0) b = -b;
    const mixed = [0, 1, 2, 3].map((k) => a * from[k] + b * to[k]);
    const norm = Math.hypot(...mixed);
    return mixed.map((value) => value / norm);
  }

  function quantity(value, unit) {
    const size = Math.abs(value);
    for (const [limit, prefix] of [[1e3, "k"], [1, ""], [1e-3, "m"]]) {
      if (size >= limit * 0.9995) return `${Number((value / limit).toPrecision(3))} ${prefix}${unit}`;
    }
    return `${Number((value * 1e6).toPrecision(3))} µ${unit}`;
  }

  function speedName(speed) {
    if (speed === 1) return "real time";
    return speed > 1 ? `${Number(speed.toPrecision(3))} ×` : `1/${Number((1 / speed).toPrecision(3))}`;
  }

  function colourAt(stops, share) {
    const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
    const i = Math.min(Math.floor(place), stops.length - 2);
    return stops[i].map((v, k) => (v + (place - i) * (stops[i + 1][k] - v)) / 255);
  }

  // --- page ---

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

  // --- actors: what moves by key frames ---

  class Actor {
    constructor(viewer, data) {
      this.times = doubles(data.times);
      this.tracks = data.tracks.map((track) => ({
        kind: track.kind,
        name: track.name,
        data: floats(track.data),
        object: node(viewer, track.path),
      }));
    }

    show(t) {
      const [i, u] = locate(this.times, t);
      const single = this.times.length < 2;
      for (const {kind, data, object} of this.tracks) {
        const n = kind === "pose" ? 7 : 12;
        const p = i * n, q = single ? p : p + n;
        const mix = (k) => (1 - u) * data[p + k] + u * data[q + k];
        if (kind === "pose") {
          object.position.set(mix(0), mix(1), mix(2));
          object.quaternion.set(...turned(data.subarray(p + 3, p + 7), data.subarray(q + 3, q + 7), u));
        } else {
          object.matrixAutoUpdate = false;
          object.matrix.set(
            mix(0), mix(1), mix(2), mix(3), mix(4), mix(5), mix(6), mix(7),
            mix(8), mix(9), mix(10), mix(11), 0, 0, 0, 1
          );
          object.matrixWorldNeedsUpdate = true;
        }
      }
    }
  }

  // --- contact forces ---

  class Contacts {
    constructor(viewer, data, times) {
      const THREE = MeshCat.THREE;
      this.THREE = THREE;
      this.times = times;
      this.map = data.map;
      this.size = data.size; // [m] half thickness of an arrow
      this.reference = data.reference; // [N, m]: this force is drawn with this length
      this.power = data.power;
      this.items = data.items.map((item) => {
        const group = new THREE.Group();
        const material = new THREE.MeshPhongMaterial({color: data.colour, depthTest: !data.above, transparent: data.above});
        const shaft = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 20).translate(0, 0.5, 0), material);
        const head = new THREE.Mesh(new THREE.ConeGeometry(1, 1, 24).translate(0, 0.5, 0), material);
        group.add(shaft, head);
        let ball = null;
        if (data.map) {
          ball = new THREE.Mesh(new THREE.SphereGeometry(1, 24, 16), material);
          group.add(ball);
        }
        if (data.above) group.renderOrder = 10;
        for (const child of group.children) child.renderOrder = group.renderOrder;
        node(viewer, item.path).add(group);
        return {
          name: item.name, force: floats(item.force), point: floats(item.point), group, shaft, head, ball, material,
          shown: {size: 0, force: [0, 0, 0], point: [0, 0, 0]},
        };
      });
      this.up = new THREE.Vector3(0, 1, 0);
      this.direction = new THREE.Vector3();
    }

    // The force and point of a contact at t, between key frames linearly; a contact that does not touch at one
    // end of the interval keeps the point of the other.
    at(item, t) {
      const [i, u] = locate(this.times, t);
      const p = 3 * i, q = this.times.length < 2 ? p : p + 3;
      const mix = (data, v) => [0, 1, 2].map((k) => (1 - v) * data[p + k] + v * data[q + k]);
      const size = (j) => Math.hypot(item.force[j], item.force[j + 1], item.force[j + 2]);
      const force = mix(item.force, u);
      const point = mix(item.point, size(p) === 0 ? 1 : size(q) === 0 ? 0 : u);
      return {size: Math.hypot(...force), force, point};
    }

    seek(t) {
      for (const item of this.items) this.draw(item, this.at(item, t));
    }

    // As seek, but shows the largest force since `before`, fading over `wall` seconds.
    advance(before, t, wall) {
      for (const item of this.items) {
        let best = this.at(item, t);
        for (let i = upto(this.times, before); i < this.times.length && this.times[i] <= t; i++) {
          const p = 3 * i;
          const size = Math.hypot(item.force[p], item.force[p + 1], item.force[p + 2]);
          if (size > best.size) {
            best = {size, force: Array.from(item.force.subarray(p, p + 3)), point: Array.from(item.point.subarray(p, p + 3))};
          }
        }
        const fade = Math.exp(-wall / FADE);
        const held = item.shown.size * fade;
        if (held > best.size) best = {size: held, force: item.shown.force.map((f) => f * fade), point: item.shown.point};
        this.draw(item, best);
      }
    }

    length(force) {
      return this.reference[1] * Math.pow(force / this.reference[0], this.power);
    }

    draw(item, state) {
      item.shown = state;
      item.group.visible = state.size > 1e-9 * this.reference[0];
      if (!item.group.visible) return;
      const length = this.length(state.size);
      const head = Math.min(5 * this.size, 0.6 * length);
      const thick = Math.min(this.size, 0.2 * length);
      item.group.position.set(...state.point);
      this.direction.set(...state.force).normalize();
      item.group.quaternion.setFromUnitVectors(this.up, this.direction);
      item.shaft.scale.set(thick, length - head, thick);
      item.head.scale.set(0.5 * head, head, 0.5 * head);
      item.head.position.y = length - head;
      if (this.map) {
        const {low, high, colours} = this.map;
        item.material.color.setRGB(...colourAt(colours, Math.log(state.size / low) / Math.log(high / low)));
        item.ball.scale.setScalar(this.map.ball);
      }
    }
  }

  // --- lines that grow with time ---

  class Trail {
    constructor(viewer, data) {
      const THREE = MeshCat.THREE;
      const sides = 6;
      this.times = doubles(data.times);
      this.tail = data.tail; // [s]; null: from the start
      this.per = 6 * sides;
      const points = floats(data.points);
      const n = this.times.length;
      const at = (i) => new THREE.Vector3(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
      const positions = new Float32Array(3 * n * sides), normals = new Float32Array(3 * n * sides);
      let across = new THREE.Vector3(0, 0, 1), tangent = new THREE.Vector3(1, 0, 0);
      for (let i = 0; i < n; i++) {
        const along = at(Math.min(i + 1, n - 1)).sub(at(Math.max(i - 1, 0)));
        if (along.lengthSq() > 0) tangent = along.normalize();
        if (Math.abs(across.dot(tangent)) > 0.99) across = new THREE.Vector3(tangent.y, tangent.z, tangent.x);
        across = across.sub(tangent.clone().multiplyScalar(across.dot(tangent))).normalize();
        const third = tangent.clone().cross(across);
        for (let k = 0; k < sides; k++) {
          const phi = 2 * Math.PI * k / sides;
          const normal = across.clone().multiplyScalar(Math.cos(phi)).add(third.clone().multiplyScalar(Math.sin(phi)));
          normal.toArray(normals, 3 * (i * sides + k));
          at(i).add(normal.multiplyScalar(data.radius)).toArray(positions, 3 * (i * sides + k));
        }
      }
      const index = new Uint32Array(Math.max(n - 1, 0) * this.per);
      let at0 = 0;
      for (let i = 0; i + 1 < n; i++) {
        for (let k = 0; k < sides; k++) {
          const a = i * sides + k, b = i * sides + (k + 1) % sides;
          index.set([a, b, a + sides, b, b + sides, a + sides], at0);
          at0 += 6;
        }
      }
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
      geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
      geometry.setIndex(new THREE.BufferAttribute(index, 1));
      const above = Boolean(data.above); // drawn over what hides it
      const material = new THREE.MeshBasicMaterial({color: data.colour, depthTest: !above, transparent: above});
      this.mesh = new THREE.Mesh(geometry, material);
      this.mesh.frustumCulled = false;
      this.mesh.renderOrder = above ? 5 : 0;
      node(viewer, data.path).add(this.mesh);
    }

    show(t) {
      const end = Math.max(upto(this.times, t) - 1, 0);
      const start = this.tail === null ? 0 : Math.min(Math.max(upto(this.times, t - this.tail) - 1, 0), end);
      this.mesh.geometry.setDrawRange(start * this.per, (end - start) * this.per);
    }
  }

  // --- which way is which ---

  // The axes that numbers are in, and gravity, drawn in the corner as the camera sees them.
  class Triad {
    constructor(stage, data) {
      this.node = element("div", "ap-triad", stage);
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
      const lines = arrows.map(([name, axis]) => {
        const [x, y, near] = seen(axis);
        const [right, down] = [TRIAD * x, -TRIAD * y];
        const long = Math.hypot(right, down);
        const [a, b] = long > 0 ? [right / long, down / long] : [0, 0];
        const place = (along, across) =>
          `${(middle + a * along - b * across).toFixed(1)} ${(middle + b * along + a * across).toFixed(1)}`;
        const head = Math.min(6, long);
        // The label of gravity stands beside it: it points along an axis as often as not.
        const words = (name === "g" ? place(long - 8, 10) : place(long + 8, 0)).split(" ");
        return [near, `<g class="ap-axis-${name}"><path d="M${middle} ${middle}L${place(long, 0)}` +
          `M${place(long - head, 0.45 * head)}L${place(long, 0)}L${place(long - head, -0.45 * head)}"/>` +
          `<text x="${words[0]}" y="${words[1]}">${name}</text></g>`];
      });
      const drawn = lines.sort((one, other) => one[0] - other[0]).map((line) => line[1]).join("");
      if (drawn !== this.drawn) this.svg.innerHTML = this.drawn = drawn;
    }
  }

  // --- the player ---

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
      this.moved = false; // whether someone turned the view
      this.impacts = {times: doubles(data.impacts.times), peaks: floats(data.impacts.peaks)};
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
      this.seek(this.start);
      this.tick = this.tick.bind(this);
      this.handle = requestAnimationFrame(this.tick);
    }

    // --- parts of the page ---

    build() {
      const {data, root} = this;
      root.classList.add("ap-recording");
      root.replaceChildren();
      root.tabIndex = 0;
      const head = this.head = element("div", "ap-head", root); // over the stage, or above it where that is narrow
      this.stage = element("div", "ap-stage", root);
      element("div", "ap-title", head).textContent = data.title;
      element("div", "ap-case", head).textContent = data.subtitle;
      const facts = element("ul", "ap-facts", head);
      for (const fact of data.facts) {
        const item = element("li", "", facts);
        const line = fact.paths ? element("button", "ap-fact", item, {type: "button", "aria-pressed": "true"}) : item;
        if (fact.colour) element("span", "ap-key", line).style.background = fact.colour;
        line.append(fact.text);
        if (!fact.paths) continue;
        line.title = "show or hide";
        line.addEventListener("click", () => this.show(line, fact.paths));
      }
      this.clock = element("div", "ap-clock", this.stage);
      this.clockTime = element("div", "ap-time", this.clock);
      this.clockSpeed = element("div", "ap-rate", this.clock);
      if (data.triad) this.triad = new Triad(this.stage, data.triad);
      if (data.contacts && data.contacts.map) this.legend(data.contacts.map);
      if (data.warnings.length) {
        const notes = element("div", "ap-notes", this.stage, {role: "note"});
        for (const text of data.warnings) element("div", "", notes).textContent = text;
      }
      const bar = element("div", "ap-bar", root);
      button(bar, "previous", ICONS.previous, "previous impact (Shift + ←)", () => this.jump(-1));
      this.playButton = button(bar, "play", ICONS.play, "play (space)", () => this.toggle());
      button(bar, "next", ICONS.next, "next impact (Shift + →)", () => this.jump(1));
      const track = element("div", "ap-track", bar);
      this.marks = element("canvas", "ap-marks", track, {"aria-hidden": "true"});
      this.slider = element("input", "ap-slider", track, {
        type: "range", min: this.start, max: this.end, step: "any", "aria-label": "time in seconds",
      });
      this.slider.addEventListener("input", () => { this.pause(); this.seek(Number(this.slider.value)); });
      this.select = element("select", "ap-speed", bar, {title: "speed (+ and −)", "aria-label": "speed"});
      this.speeds = Array.from(new Set([...SPEEDS, this.speed])).sort((a, b) => b - a);
      for (const speed of this.speeds) {
        element("option", "", this.select, {value: speed}).textContent = speedName(speed);
      }
      this.select.addEventListener("change", () => this.setSpeed(Number(this.select.value)));
      button(bar, "view", ICONS.view, "view of the whole motion (R)", () => this.resetCamera());
      if (document.fullscreenEnabled) button(bar, "full", ICONS.full, "full screen (F)", () => this.fullscreen());
      if (!(this.duration > 0)) {
        for (const node of bar.querySelectorAll("input, select, .ap-play, .ap-previous, .ap-next")) node.disabled = true;
      }
      // A page of its own takes keys wherever the focus is; one of many on a page only where it has the focus.
      this.keys = this.embedded ? this.root : document;
      this.pressed = (event) => this.key(event);
      this.keys.addEventListener("keydown", this.pressed);
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
      controls.addEventListener("start", () => { this.moved = true; });
      controls.addEventListener("change", () => { this.dirty = true; });
      this.actors = data.actors.map((actor) => new Actor(viewer, actor));
      const forces = (one) => (one ? new Contacts(viewer, one, this.times) : null);
      this.contacts = forces(data.contacts);
      this.arrows = [this.contacts, forces(data.applied)].filter(Boolean);
      this.trails = data.trails.map((trail) => new Trail(viewer, trail));
      // Which way is up: the world is drawn turned where gravity does not point along its -z.
      const [a, b, c] = this.upright = data.camera.upright;
      const turn = new THREE.Matrix4().set(...a, 0, ...b, 0, ...c, 0, 0, 0, 0, 1);
      viewer.scene.quaternion.multiply(new THREE.Quaternion().setFromRotationMatrix(turn));
      // The camera is in the scene and does not turn with it.
      node(viewer, "Cameras/default/rotated").quaternion.copy(viewer.scene.quaternion).invert();
      this.frame = floats(data.camera.points);
      for (let i = 0; i < this.frame.length; i += 3) this.frame.set(this.turned(this.frame.subarray(i, i + 3)), i);
      this.resize();
      this.observer = new ResizeObserver(() => this.resize());
      this.observer.observe(this.stage);
    }

    resize() {
      const w = Math.max(this.stage.clientWidth, 1), h = Math.max(this.stage.clientHeight, 1);
      const {viewer} = this;
      viewer.renderer.setPixelRatio(window.devicePixelRatio);
      viewer.renderer.setSize(w, h);
      viewer.camera.aspect = w / h;
      viewer.camera.updateProjectionMatrix();
      if (this.frame && !this.moved) this.resetCamera();
      else if (viewer.camera.view && viewer.camera.view.enabled) {
        const {fullHeight, offsetY} = viewer.camera.view;
        viewer.camera.setViewOffset(w, h, 0, offsetY * h / fullHeight, w, h);
      }
      this.drawMarks();
      this.dirty = true;
      if (this.shown) this.render();
    }

    drawMarks() {
      const {marks} = this;
      const scale = window.devicePixelRatio || 1;
      const w = marks.clientWidth, h = marks.clientHeight;
      marks.width = w * scale;
      marks.height = h * scale;
      const pen = marks.getContext("2d");
      pen.scale(scale, scale);
      pen.clearRect(0, 0, w, h);
      if (!(this.duration > 0)) return;
      const largest = this.impacts.peaks.reduce((a, b) => Math.max(a, b), 0);
      const inset = 8; // half the slider's thumb
      pen.fillStyle = "rgba(213, 94, 0, 0.55)";
      this.impacts.times.forEach((t, i) => {
        const x = inset + (w - 2 * inset) * (t - this.start) / this.duration;
        const size = 2 + (h - 2) * Math.sqrt(largest > 0 ? this.impacts.peaks[i] / largest : 0);
        pen.fillRect(x - 0.5, h - size, 1, size);
      });
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
      this.slider.value = t;
      this.clockTime.textContent = `${t.toFixed(this.digits)} s`;
      this.dirty = true;
    }

    render() {
      if (this.failed) return;
      this.viewer.render();
      if (this.triad) this.triad.show(this.time, (axis) => this.seen(axis));
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
      this.playButton.innerHTML = icon(ICONS[what]);
      this.playButton.title = `${what} (space)`;
      this.playButton.setAttribute("aria-label", this.playButton.title);
    }

    setSpeed(speed) {
      this.speed = speed;
      this.select.value = speed;
      this.digits = Math.min(Math.max(3 + Math.round(-Math.log10(speed)), 2), 7);
      this.clockSpeed.textContent = speed === 1 ? "real time" : `${speedName(speed)} of real time`;
      if (speed > 1) this.clockSpeed.textContent = `${speedName(speed)} real time`;
      this.clockTime.textContent = `${this.time.toFixed(this.digits)} s`;
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
      if (event.ctrlKey || event.altKey || event.metaKey || event.target === this.select) return;
      const faster = (by) => {
        const i = this.speeds.indexOf(this.speed) + by;
        if (i >= 0 && i < this.speeds.length) this.setSpeed(this.speeds[i]);
      };
      const jump = event.shiftKey ? (way) => this.jump(way) : (way) => this.step(way);
      const actions = {
        " ": () => this.toggle(), k: () => this.toggle(), ArrowLeft: () => jump(-1), ArrowRight: () => jump(1),
        Home: () => { this.pause(); this.seek(this.start); }, End: () => { this.pause(); this.seek(this.end); },
        "+": () => faster(-1), "=": () => faster(-1), "-": () => faster(1), "−": () => faster(1),
        r: () => this.resetCamera(), f: () => this.fullscreen(),
      };
      const action = actions[event.key] || actions[event.key.toLowerCase()];
      if (!action) return;
      event.preventDefault();
      action();
    }

    // Shows or hides what a line of the heading names.
    show(line, paths) {
      const visible = line.getAttribute("aria-pressed") !== "true";
      line.setAttribute("aria-pressed", visible);
      for (const path of paths) node(this.viewer, path).visible = visible;
      this.dirty = true;
    }

    fullscreen() {
      if (document.fullscreenElement) document.exitFullscreen();
      else if (document.fullscreenEnabled) this.root.requestFullscreen();
    }

    // --- camera: the turned world's z is up, three.js' is y ---

    turned(point) {
      return this.upright.map((row) => row[0] * point[0] + row[1] * point[1] + row[2] * point[2]);
    }

    // A direction of the scene as the camera sees it: right, up, towards who looks.
    seen(direction) {
      const {camera} = this.viewer;
      const [x, y, z] = this.turned(direction);
      camera.updateMatrixWorld();
      return new MeshCat.THREE.Vector3(x, z, -y).transformDirection(camera.matrixWorldInverse).toArray();
    }

    // A pinhole camera in the middle of the canvas, FIELD_OF_VIEW high.
    setCamera(position, target) {
      this.moved = true;
      this.viewer.camera.clearViewOffset();
      this.aim(this.turned(position), this.turned(target));
    }

    aim(position, target) {
      const {camera, controls} = this.viewer;
      const swap = ([x, y, z]) => [x, z, -y];
      camera.position.set(...swap(position));
      controls.target.set(...swap(target));
      const far = Math.hypot(...position.map((p, k) => p - target[k]));
      camera.near = 0.02 * far;
      camera.far = 50 * far;
      camera.updateProjectionMatrix();
      controls.update();
      this.dirty = true;
    }

    // In the middle of all points of the motion and so near that they just fit below the heading, whatever the shape
    // of the stage.
    resetCamera() {
      const {direction, target} = this.data.camera;
      const {camera} = this.viewer;
      const w = Math.max(this.stage.clientWidth, 1), h = Math.max(this.stage.clientHeight, 1);
      const over = this.head.getBoundingClientRect().bottom - this.stage.getBoundingClientRect().top;
      const top = Math.min(Math.max(over, 0), 0.35 * h);
      camera.setViewOffset(w, h, 0, -0.5 * top, w, h);
      const norm = (v) => { const s = Math.hypot(...v); return v.map((x) => x / s); };
      const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
      const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
      const back = norm(direction);
      const right = norm(cross([0, 0, 1], back));
      const up = cross(back, right);
      const half = Math.tan(0.5 * camera.fov * Math.PI / 180) / MARGIN;
      const vertical = half * (h - top) / h;
      const horizontal = half * w / h;
      const middle = this.turned(target);
      let distance = 0;
      for (let pass = 0; pass < 4; pass++) {
        const seen = [];
        distance = 0;
        for (let i = 0; i < this.frame.length; i += 3) {
          const point = [0, 1, 2].map((k) => this.frame[i + k] - middle[k]);
          const [x, y, depth] = [dot(point, right), dot(point, up), dot(point, back)];
          seen.push([x, y, depth]);
          distance = Math.max(distance, depth + Math.abs(x) / horizontal, depth + Math.abs(y) / vertical);
        }
        if (!(distance > 0)) distance = 1;
        for (const [k, axis] of [[0, right], [1, up]]) {
          const place = seen.map((point) => point[k] / (distance - point[2]));
          const off = 0.5 * distance * (Math.min(...place) + Math.max(...place));
          if (pass < 3) axis.forEach((value, i) => { middle[i] += off * value; });
        }
      }
      this.aim(middle.map((x, k) => x + distance * back[k]), middle);
      this.moved = false;
    }

    project(point) {
      const {camera, renderer} = this.viewer;
      const [x, y, z] = this.turned(point);
      camera.updateMatrixWorld();
      const at = new MeshCat.THREE.Vector3(x, z, -y).project(camera);
      const w = this.canvas.clientWidth, h = this.canvas.clientHeight;
      return [0.5 * (at.x + 1) * w, 0.5 * (1 - at.y) * h];
    }

    pose(body) {
      const THREE = MeshCat.THREE;
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
      if (!this.viewer) return;
      this.viewer.controls.dispose();
      this.viewer.renderer.dispose();
      this.viewer.renderer.forceContextLoss();
    }
  }

  // --- many recordings in one page ---

  // Browsers allow a page about 16 graphics contexts and blank the oldest beyond: this many are kept.
  const LIVE = 8;
  const slots = [];
  let printing = false;

  // One place for a recording: it has a player while it is in view, and for some time after.
  class Slot {
    constructor(id) {
      this.root = document.getElementById(id);
      this.source = document.getElementById(id + "-data");
      this.player = null;
      this.inView = false;
      this.time = null;
      new IntersectionObserver((entries) => {
        this.inView = entries[entries.length - 1].isIntersecting;
        if (this.inView && !printing) this.start();
      }, {rootMargin: "100px"}).observe(this.root);
    }

    start(room = true) {
      if (this.player) return;
      const idle = slots.filter((slot) => slot.player && !slot.inView && !slot.player.playing);
      const live = slots.filter((slot) => slot.player).length;
      if (room) idle.slice(0, Math.max(live + 1 - LIVE, 0)).forEach((slot) => slot.stop());
      this.player = window.AntennaPin.mount(this.root, JSON.parse(this.source.textContent), {embedded: true});
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
      if (player.failed) return;
      if (player.time === player.start) player.seek(player.data.poster);
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
      if (this.player) this.player.canvas.hidden = false;
      else this.root.replaceChildren();
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
    document.querySelectorAll(".ap-frame").forEach((root) => slots.push(new Slot(root.id)));
  });
})();
