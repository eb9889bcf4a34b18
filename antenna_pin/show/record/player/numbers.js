// Numbers: unpacked, interpolated, and as text.

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

// Size, prefix, and from where on it is taken, as in the tables of a report: 1500 N reads better than 1.5 kN.
const PREFIXES = [[1e6, "M", 1e6], [1e3, "k", 1e4], [1, "", 0.1], [1e-3, "m", 1e-4], [1e-6, "\u00b5", 1e-7], [1e-9, "n", 1e-10]];

// A number of a series with four digits, and its unit, with the prefix that suits a number of such a size; zero far
// below that.
function written(value, unit, like = value) {
  if (!Number.isFinite(value)) return "none";
  const large = /^(N|Hz|Pa|J|W)(?![\w*\u00b2\u00b3])/.test(unit);
  const takes = large || /^(m|s|rad)(?![\w*\u00b2\u00b3])/.test(unit);
  const found = takes && PREFIXES.find(([one, , least]) => Math.abs(like) >= least && (one <= 1 || large));
  const [factor, prefix] = found || [1, ""];
  const number = Math.abs(value) < 1e-6 * Math.abs(like) ? 0 : value / factor, size = Math.abs(number);
  const text = size && (size < 1e-3 || size >= 1e5) ? number.toExponential(2).replace("e+", "e") : Number(number.toPrecision(4));
  return `${text}${unit ? " " + prefix + unit : ""}`.replace("-", "\u2212");
}
