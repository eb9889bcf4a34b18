// The camera of a recording. Of the turned world z is up, of three.js y.

const FIELD_OF_VIEW = 32; // [deg], vertical
const MARGIN = 1.06; // of what is framed
const VERTICES = 500; // of a shape, that are looked at to frame it
const NEAR_BY = 2.5; // a body that is followed is framed so many times as large as it is

const minus = (a, b) => a.map((x, k) => x - b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => { const size = Math.hypot(...a); return a.map((x) => x / size); };

// The middle of the box around points.
const centred = (points) => [0, 1, 2].map((k) => {
  let low = Infinity, high = -Infinity;
  for (let i = k; i < points.length; i += 3) { low = Math.min(low, points[i]); high = Math.max(high, points[i]); }
  return 0.5 * (low + high);
});

class Eye {
  // `axes` are those of the triad, in the scene; `bodies` have an object, a centre and a radius.
  constructor(viewer, data, axes, bodies) {
    const THREE = MeshCat.THREE;
    this.viewer = viewer;
    this.camera = viewer.camera;
    this.direction = data.direction;
    this.target = data.target;
    this.axes = axes;
    this.bodies = bodies;
    this.moved = false; // whether someone turned the view
    this.followed = null;
    // Which way is up: the world is drawn turned where gravity does not point along its -z.
    const [a, b, c] = this.upright = data.upright;
    const turn = new THREE.Matrix4().set(...a, 0, ...b, 0, ...c, 0, 0, 0, 0, 1);
    viewer.scene.quaternion.multiply(new THREE.Quaternion().setFromRotationMatrix(turn));
    // The camera is in the scene and does not turn with it.
    node(viewer, "Cameras/default/rotated").quaternion.copy(viewer.scene.quaternion).invert();
    this.points = floats(data.points);
    for (let i = 0; i < this.points.length; i += 3) this.points.set(this.turned(this.points.subarray(i, i + 3)), i);
  }

  turned(point) {
    return this.upright.map((row) => dot(row, point));
  }

  // The other way round: from three.js' world to the recording's.
  world({x, y, z}) {
    return [0, 1, 2].map((k) => dot(this.upright.map((row) => row[k]), [x, -z, y]));
  }

  // A direction of the scene as the camera sees it: right, up, towards who looks.
  seen(direction) {
    const [x, y, z] = this.turned(direction);
    this.camera.updateMatrixWorld();
    return new MeshCat.THREE.Vector3(x, z, -y).transformDirection(this.camera.matrixWorldInverse).toArray();
  }

  // A pinhole camera in the middle of the canvas, FIELD_OF_VIEW high.
  set(position, target) {
    this.moved = true;
    this.camera.clearViewOffset();
    this.aim(this.turned(position), this.turned(target));
  }

  get() {
    return {position: this.world(this.camera.position), target: this.world(this.viewer.controls.target)};
  }

  aim(position, target) {
    const {camera} = this, {controls} = this.viewer;
    const swap = ([x, y, z]) => [x, z, -y];
    camera.position.set(...swap(position));
    controls.target.set(...swap(target));
    const far = Math.hypot(...minus(position, target));
    camera.near = 0.02 * far;
    camera.far = 50 * far;
    camera.updateProjectionMatrix();
    controls.update();
  }

  // From where a view looks: against an axis of the triad, or as the recording begins.
  from(view) {
    const axis = this.axes["xyz".indexOf(view)];
    if (!axis) return this.direction;
    const [x, y, z] = this.turned(axis);
    return Math.hypot(x, y) > 1e-3 ? [x, y, z] : [0, -1e-3, z]; // straight from above, what is up would be open
  }

  // Points on the bodies that are shown, where they are now; those of the whole motion where no body is drawn.
  present() {
    const found = [];
    for (const body of this.bodies.filter((one) => one.visible)) {
      body.object.updateWorldMatrix(true, true); // else it is that of the last picture
      for (const shape of body.shapes) {
        shape.traverse(({geometry, matrixWorld}) => {
          if (!geometry || !geometry.attributes.position) return;
          const {position} = geometry.attributes;
          const vertex = new MeshCat.THREE.Vector3();
          for (let i = 0; i < position.count; i += Math.ceil(position.count / VERTICES)) {
            const {x, y, z} = vertex.fromBufferAttribute(position, i).applyMatrix4(matrixWorld);
            found.push(x, -z, y);
          }
        });
      }
    }
    return found.length ? Float32Array.from(found) : this.points;
  }

  // In the middle of the mechanism as it is now, or of its whole motion, and so near that it just fits into the stage,
  // of which the uppermost `top` pixels are taken.
  frame(view, w, h, top, whole) {
    const points = whole ? this.points : this.present();
    const {camera} = this;
    camera.setViewOffset(w, h, 0, -0.5 * top, w, h);
    const back = unit(this.from(view));
    const right = unit(cross([0, 0, 1], back));
    const up = cross(back, right);
    const half = Math.tan(0.5 * camera.fov * Math.PI / 180) / MARGIN;
    const vertical = half * (h - top) / h;
    const horizontal = half * w / h;
    const middle = whole ? this.turned(this.target) : centred(points);
    let distance = 0;
    for (let pass = 0; pass < 4; pass++) {
      const seen = [];
      distance = 0;
      for (let i = 0; i < points.length; i += 3) {
        const point = minus(points.subarray(i, i + 3), middle);
        const [x, y, depth] = [dot(point, right), dot(point, up), dot(point, back)];
        seen.push([x, y, depth]);
        distance = Math.max(distance, depth + Math.abs(x) / horizontal, depth + Math.abs(y) / vertical);
      }
      if (!(distance > 0)) distance = 1;
      for (const [k, axis] of [[0, right], [1, up]]) {
        const place = seen.map((point) => point[k] / (distance - point[2]));
        const [low, high] = place.reduce(([a, b], x) => [Math.min(a, x), Math.max(b, x)], [Infinity, -Infinity]);
        const off = 0.5 * distance * (low + high);
        if (pass < 3) axis.forEach((value, i) => { middle[i] += off * value; });
      }
    }
    this.aim(middle.map((x, k) => x + distance * back[k]), middle);
    this.moved = false;
    if (this.followed) this.at = this.place(this.followed);
  }

  // Where a body's middle is in three.js' world.
  place(body) {
    body.object.updateWorldMatrix(true, false); // else it is that of the last picture
    return body.object.localToWorld(body.centre.clone());
  }

  // Goes along with a body from now on, and comes near it; with none of them the camera stays where it is.
  follow(body) {
    this.followed = body;
    if (!body) return;
    const {camera} = this, {target} = this.viewer.controls;
    this.moved = true;
    this.at = this.place(body);
    const back = camera.position.clone().sub(target);
    const near = NEAR_BY * body.radius / Math.tan(0.5 * camera.fov * Math.PI / 180);
    if (near > 0) back.setLength(Math.min(back.length(), near));
    this.aim(this.turned(this.world(this.at.clone().add(back))), this.turned(this.world(this.at)));
  }

  // After the bodies were moved: the one that is followed stays where it is in the picture.
  go() {
    if (!this.followed) return;
    const now = this.place(this.followed);
    const moved = now.clone().sub(this.at);
    this.at = now;
    this.camera.position.add(moved);
    this.viewer.controls.target.add(moved);
    this.viewer.controls.update();
  }

  // Pixels of a place of three.js' world, from the canvas' upper left corner; null behind the camera.
  pixels(place) {
    const {camera} = this, canvas = this.viewer.renderer.domElement;
    camera.updateMatrixWorld();
    const at = place.clone().project(camera);
    if (at.z > 1) return null;
    return [0.5 * (at.x + 1) * canvas.clientWidth, 0.5 * (1 - at.y) * canvas.clientHeight];
  }

  project(point) {
    const [x, y, z] = this.turned(point);
    return this.pixels(new MeshCat.THREE.Vector3(x, z, -y));
  }

  // Metres of a pixel where the camera looks at.
  scale() {
    const far = this.camera.position.distanceTo(this.viewer.controls.target);
    return 2 * far * Math.tan(0.5 * this.camera.fov * Math.PI / 180) / this.viewer.renderer.domElement.clientHeight;
  }
}
