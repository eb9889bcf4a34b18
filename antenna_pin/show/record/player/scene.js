// What moves by key frames: bodies, contact forces, and lines that grow with time.

const FADE = 0.15; // [s] of wall time in which a force arrow falls to 1/e

class Actor {
  constructor(viewer, data) {
    this.times = doubles(data.times);
    this.tracks = data.tracks.map((track) => ({
      kind: track.kind,
      name: track.name,
      path: track.path,
      data: track.kind === "shown" ? doubles(track.data) : floats(track.data),
      object: node(viewer, track.path),
    }));
  }

  show(t) {
    const [i, u] = locate(this.times, t);
    const single = this.times.length < 2;
    for (const {kind, data, object} of this.tracks) {
      if (kind === "shown") { // from the first of these times on until the second, and so forth
        object.visible = upto(data, t) % 2 === 1;
        continue;
      }
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

class Contacts {
  constructor(viewer, data, times) {
    const THREE = MeshCat.THREE;
    this.THREE = THREE;
    this.times = times;
    this.map = data.map;
    this.size = data.size; // [m] half thickness of an arrow
    this.reference = data.reference; // [N, m]: this force is drawn with this length
    this.power = data.power;
    // Forces and points are given of the key frames at which the contact bears load.
    const spread = (item, text) => {
      const some = floats(text), all = new Float32Array(3 * times.length);
      new Uint32Array(bytes(item.frames).buffer).forEach((i, k) => all.set(some.subarray(3 * k, 3 * k + 3), 3 * i));
      return all;
    };
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
        name: item.name, force: spread(item, item.force), point: spread(item, item.point),
        group, shaft, head, ball, material,
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
