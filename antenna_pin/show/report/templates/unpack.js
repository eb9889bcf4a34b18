"use strict";
// What the page holds in little room, as it was: deflated texts, and columns of numbers.

function bytesOf(text) {
  const raw = atob(text.trim());
  const out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
  return out;
}

async function inflated(text) {
  const packed = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(packed).arrayBuffer();
}

// A column of numbers, of which the first bytes of all come first, then the second ones, and so on.
async function column([count, width, text]) {
  const apart = new Uint8Array(await inflated(text));
  const together = new Uint8Array(apart.length);
  for (let byte = 0; byte < width; byte++) {
    for (let i = 0; i < count; i++) together[i * width + byte] = apart[byte * count + i];
  }
  return width === 8 ? new Float64Array(together.buffer) : new Float32Array(together.buffer);
}

// The numbers of a figure as a file: two columns or more for each line, as long as the line.
async function csvOf(figure) {
  const {columns, figures} = JSON.parse(document.getElementById("numbers").textContent);
  const drawn = figures[figure];
  const head = [], body = [];
  for (const one of drawn) {
    const about = [one.panel, one.label].filter(Boolean).join(", ");
    for (const [k, name] of one.names.entries()) {
      const values = await column(columns[one.columns[k]]);
      const fewer = values.length < one.of ? ` (${values.length} of ${one.of})` : "";
      head.push(`${about ? about + ": " : ""}${name}${k === 0 ? fewer : ""}`);
      body.push(values);
    }
  }
  // An apostrophe makes text of what a spreadsheet would evaluate as a formula, as in tables.write_csv.
  const inert = (text) => (/^[=+\-@\t\r\n]/.test(text) ? `'${text}` : text);
  const quoted = (text) => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const written = (values, i) => {
    if (i >= values.length || Number.isNaN(values[i])) return "";
    // Nine digits give a number of 32 bits back.
    return String(values instanceof Float32Array ? Number(values[i].toPrecision(9)) : values[i]);
  };
  const lines = [head.map(inert).map(quoted).join(",")];
  const longest = Math.max(...body.map((values) => values.length));
  for (let i = 0; i < longest; i++) lines.push(body.map((values) => written(values, i)).join(","));
  return lines.join("\n") + "\n";
}

const hasNumbers = (figure) => figure in JSON.parse(document.getElementById("numbers").textContent).figures;
