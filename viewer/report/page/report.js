"use strict";
// The page of `palpate report`. This script builds the sentences, tables and drawings from the JSON
// in the page. docs/commands.md describes the JSON; `drawings` are arrays for this page only.

// A missing number is null in JSON. Make it NaN, so that a sum does not treat it as zero.
const report = JSON.parse(document.getElementById("report").textContent,
    (key, value) => value === null ? NaN : value);
const drawings = report.drawings;

// ---- Markup. html`...` escapes inserted values, except markup that html itself made.

class Markup {
  constructor(text) { this.text = text; }
}
const escaped = (text) => String(text).replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);
function markupOf(value) {
  if (value instanceof Markup) return value.text;
  return Array.isArray(value) ? value.map(markupOf).join("") : escaped(value);
}
const html = (parts, ...values) => new Markup(String.raw({ raw: parts }, ...values.map(markupOf)));

// ---- Numbers as text.

const isNumber = Number.isFinite;
/// Returns a number with at most `digits` significant digits.
const brief = (value, digits) => String(Number(value.toPrecision(digits)));
const counted = (count, noun, plural = noun + "s") => `${count} ${count === 1 ? noun : plural}`;

/// Returns "0.0012", "1.2e-06", "34", or "-" for a missing number.
function number(value, digits = 2) {
  if (!isNumber(value)) return "-";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6))
    return value.toExponential(digits - 1).replace(/([+-])(?=\d$)/, "$10");
  return value.toFixed(size === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(size))));
}

/// Returns "99.5 %". Never rounds up to 100 %, which would claim that there is no exception.
function share(value) {
  if (!isNumber(value)) return "-";
  return value < 1 && value > 0.9995 ? ">99.9 %" : (100 * value).toFixed(1) + " %";
}

/// A mean over active nodes is rarely a whole number.
const count = (value) =>
  value.toFixed(Math.abs(value - Math.round(value)) < 1e-6 || value >= 100 ? 0 : 1);

function bytes(value) {
  if (value < 1000) return value.toFixed(0) + " B";
  const units = ["kB", "MB", "GB", "TB"];
  let unit = -1;
  while ((value >= 999.5 || unit < 0) && unit < 3) value /= 1000, ++unit;
  return `${brief(value, 3)} ${units[unit]}`;
}

const millimetres = (metres) => 1e3 * metres;
const rangeOf = (values) => values.reduce(([low, high], value) =>
  [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
const norm = (v) => Math.hypot(...v);

// ---- Ticks of axes.

/// Returns the smallest number that is at least `value` and is 1, 2 or 5 times a power of ten.
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return ([1, 2, 5].find((factor) => value <= factor * power * (1 + 1e-9)) ?? 10) * power;
}

function linearTicks(lowest, highest, wanted = 5) {
  const step = roundUp((highest - lowest) / wanted);
  const ticks = [];
  for (let n = Math.ceil(lowest / step - 1e-9); n * step <= highest + 1e-9 * step; ++n)
    ticks.push(n * step + 0);
  return ticks;
}

/// Returns powers of ten. If there would be fewer than three, adds 2 and 5 times these powers, or
/// all digits.
function logarithmicTicks(lowest, highest) {
  const first = Math.floor(Math.log10(lowest)), last = Math.ceil(Math.log10(highest));
  const every = Math.max(1, Math.floor((last - first + 7) / 8));  // labels must not touch
  for (const digits of [[1], [1, 2, 5], [1, 2, 3, 4, 5, 6, 7, 8, 9]]) {
    const ticks = [];
    for (let decade = first; decade <= last; ++decade)
      for (const digit of digits) {
        const value = digit * 10 ** decade;
        if (decade % every === 0 && value >= lowest * (1 - 1e-9) && value <= highest * (1 + 1e-9))
          ticks.push(value);
      }
    if (ticks.length >= 3 || (digits.length === 9 && ticks.length === 2)) return ticks;
  }
  return linearTicks(lowest, highest);
}

/// Returns the label of a tick: "0.02", "300", "2·10⁻⁵".
function tickLabel(value) {
  const size = Math.abs(value);
  if (size === 0 || (size >= 9.99e-4 && size < 99999)) return brief(value, 6);
  const exponent = Math.floor(Math.log10(size) + 1e-9), leading = value / 10 ** exponent;
  const raised = String(exponent).replace(/./g, (c) => c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]);
  return (Math.abs(leading - 1) < 1e-6 ? "10" : brief(leading, 3) + "·10") + raised;
}

// ---- Drawings: SVG.

/// Returns an SVG element. Numbers are coordinates; they are rounded to a tenth of a unit.
function shape(tag, attributes, content = "") {
  const written = Object.entries(attributes).map(([name, value]) =>
    ` ${name}="${escaped(typeof value === "number" ? Math.round(10 * value) / 10 : value)}"`);
  return new Markup(`<${tag}${written.join("")}>${markupOf(content)}</${tag}>`);
}
const path = (attributes, content) => shape("path", attributes, content);
const circle = (cx, cy, r, attributes, content) =>
  shape("circle", { cx, cy, r, ...attributes }, content);
const words = (x, y, text, anchor = "start", style = "tick") =>
  shape("text", { class: style, x, y, "text-anchor": anchor }, text);
const titled = (text) => text ? shape("title", {}, text) : "";
/// Returns the coordinates of a point of a path: "12.3 4.5".
const at = (x, y) => `${x.toFixed(1)} ${y.toFixed(1)}`;

// ---- Plots. A series has a label, points [x, y, note] and a look, and is drawn as a line, as
// marks, or as both.

/// Returns the look of series n. Colour-blind readers can distinguish the colours (Okabe and Ito).
function look(n) {
  const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000",
    "#7a5195", "#8c6d31", "#7f7f7f"];
  n %= colours.length;
  const dash = n < 5 ? "none" : n === 7 || n === 8 ? "2 3" : "6 3";
  return { colour: colours[n], dash, mark: n % 6, width: n === 0 ? 2.6 : 1.7 };
}
const looks = {
  solved: { colour: "#1b1f24", mark: 0, width: 2 },
  unseen: { colour: "#b00020", mark: 3, width: 2 },
  difference: { colour: "#3d454d", mark: 2, width: 2 },
  sides: [{ colour: "#0072b2", mark: 0, width: 2.6 },
    { colour: "#d55e00", dash: "7 3", mark: 1, width: 2.2 }],
};
const series = (label, style, points = []) => ({ label, style, points, line: true, marks: true });
const marksOnly = (label, style, points) => ({ ...series(label, style, points), line: false });
const lineOnly = (label, style, points) => ({ ...series(label, style, points), marks: false });
/// Returns a series for each method. points(name, number) returns the points of a method.
const methodSeries = (points) =>
  report.methods.map((name, n) => series(name, look(n), points(name, n)));

/// Draws the mark of a series: a disc, square, triangle, diamond, ring, or triangle that points
/// down.
function markAt(x, y, { mark, colour }, note) {
  if (mark === 0) return circle(x, y, 4.2, { fill: colour }, titled(note));
  if (mark === 4)
    return circle(x, y, 3.6, { fill: "#fff", stroke: colour, "stroke-width": 2 }, titled(note));
  const [right, down, steps] = {
    1: [-3.8, -3.8, "h7.6v7.6h-7.6"], 2: [0, -5, "l4.6 8.4h-9.2"],
    3: [0, -5.5, "l5.5 5.5l-5.5 5.5l-5.5 -5.5"], 5: [0, 5, "l4.6 -8.4h-9.2"],
  }[mark];
  return path({ d: `M${at(x + right, y + down)}${steps}z`, fill: colour }, titled(note));
}

const stroke = ({ colour, width, dash = "none" }) =>
  ({ fill: "none", stroke: colour, "stroke-width": width, "stroke-dasharray": dash });

/// Returns the line and mark of a series for a legend.
const seriesKey = ({ label, style, line, marks }) => ({
  text: label, width: 34, height: 12,
  svg: [line ? path({ d: "M1 6H33", ...stroke(style) }) : "", marks ? markAt(17, 6, style) : ""],
});

const frame = { left: 62, right: 14, top: 30, bottom: 46 };

/// Returns the scale that maps values to coordinates between `from` and `to`, with a margin at both
/// ends.
function axisScale({ logarithmic }, values, from, to) {
  const shows = (value) => isNumber(value) && (!logarithmic || value > 0);
  const inner = logarithmic ? Math.log10 : (value) => value;
  const shown = values.filter(shows).map(inner);
  // Give an empty plot axes too.
  let [lowest, highest] = rangeOf(shown.length ? shown : [inner(1), inner(10)]);
  const pad = highest > lowest ? 0.04 * (highest - lowest)
    : logarithmic ? 0.5 : Math.max(0.5 * Math.abs(highest), 0.5);
  lowest -= pad, highest += pad;
  const place = (value) => from + (to - from) * (inner(value) - lowest) / (highest - lowest);
  const wanted = Math.max(5, Math.floor(Math.abs(to - from) / 60));
  const ticks = logarithmic ? logarithmicTicks(10 ** lowest, 10 ** highest)
    : linearTicks(lowest, highest, wanted);
  return { place, shows, ticks };
}

function lineOf({ points, style }, x, y) {
  let d = "", broken = true;
  for (const [px, py] of points) {
    const shown = x.shows(px) && y.shows(py);
    if (shown) d += (broken ? "M" : "L") + at(x.place(px), y.place(py));
    broken = !shown;
  }
  return d && path({ class: "curve", d, ...stroke(style) });
}

function axesOf({ title, x: { label: across }, y: { label: up }, width, height }, x, y) {
  const { left, top } = frame, base = height - frame.bottom, end = width - frame.right;
  const middle = (top + base) / 2;
  return [
    x.ticks.map((tick) => [path({ class: "grid", d: `M${at(x.place(tick), top)}V${base}` }),
      words(x.place(tick), base + 16, tickLabel(tick), "middle")]),
    y.ticks.map((tick) => [path({ class: "grid", d: `M${at(left, y.place(tick))}H${end}` }),
      words(left - 6, y.place(tick) + 4, tickLabel(tick), "end")]),
    path({ class: "axis", d: `M${left} ${top}V${base}H${end}` }),
    words(left, 18, title, "start", "title"),
    words((left + end) / 2, height - 8, across, "middle", "label"),
    shape("text", { class: "label", transform: `translate(15 ${middle}) rotate(-90)`,
      "text-anchor": "middle" }, up)];
}

const linear = (label) => ({ label, logarithmic: false });
const logarithmic = (label) => ({ label, logarithmic: true });

/// Returns a panel with several series on common axes. The first series is drawn on top.
function plot(given) {
  const wanted = { width: 480, height: 340, caption: "", ...given };
  const { title, width, height, caption, series: all } = wanted;
  const valuesOf = (n) => all.flatMap(({ points }) => points.map((point) => point[n]));
  const x = axisScale(wanted.x, valuesOf(0), frame.left, width - frame.right);
  const y = axisScale(wanted.y, valuesOf(1), height - frame.bottom, frame.top);
  const marksOf = ({ points, style }) => points
    .filter(([px, py]) => x.shows(px) && y.shows(py))
    .map(([px, py, note]) => markAt(x.place(px), y.place(py), style, note));
  const curves = [...all].reverse().map((one) =>
    [one.line ? lineOf(one, x, y) : "", one.marks ? marksOf(one) : ""]);
  const rows = () => [["series", wanted.x.label, wanted.y.label],
    ...all.flatMap(({ label, points }) => points.map(([px, py]) => [label, px, py]))];
  return {
    title, width, height, caption, svg: [axesOf(wanted, x, y), curves],
    key: all.map(seriesKey), files: [["CSV", ".csv", rows]],
  };
}

// ---- Colours of logarithmic scales: viridis, whose lightness increases in even steps.

const levels = 25;
function colourOfLevel(level) {
  const stops = [0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70,
    0x7ad151, 0xbddf26, 0xfde725];
  const place = 10 * level / (levels - 1), below = Math.min(Math.floor(place), 9);
  const channel = (shift) => {
    const [from, to] = [stops[below] >> shift & 255, stops[below + 1] >> shift & 255];
    return Math.round(from + (to - from) * (place - below));
  };
  return `rgb(${channel(16)},${channel(8)},${channel(0)})`;
}

function percentile(sorted, part) {
  const place = part * (sorted.length - 1), below = Math.floor(place);
  const above = sorted[below + 1] ?? sorted[below];
  return sorted[below] + (place - below) * (above - sorted[below]);
}

/// Returns a colour scale whose limits are powers of ten. They enclose the values from the 2nd to
/// the 98th percentile, but at most five decades. disc: meaning of a coloured disc, for the legend.
function colourScale(values, unit, disc = "") {
  const sorted = values.filter((value) => isNumber(value) && value > 0).sort((a, b) => a - b);
  let base = -3, top = 0;
  if (sorted.length) {
    top = Math.ceil(Math.log10(percentile(sorted, 0.98)) - 1e-9);
    base = Math.floor(Math.log10(percentile(sorted, 0.02)) + 1e-9);
    base = Math.min(Math.max(base, top - 5), top - 1);
  }
  const levelOf = (value) => {
    const level = Math.floor(levels * (Math.log10(value) - base) / (top - base));
    return value > 0 ? Math.min(Math.max(level, 0), levels - 1) : 0;
  };
  const text = unit === "share" ? share : (value) => number(value) + " N";
  const colourOf = (value) => colourOfLevel(levelOf(value));
  return { base, top, unit, disc, levelOf, text, colourOf };
}

/// Returns the colours with their numbers, for a legend.
function colourBar({ base, top, unit }) {
  const width = 350, margin = 24, box = (width - 2 * margin) / levels;
  const svg = [];
  for (let level = 0; level < levels; ++level)
    svg.push(shape("rect", { x: margin + level * box, y: 2, width: box + 0.3, height: 14,
      fill: colourOfLevel(level) }));
  for (let decade = base; decade <= top; ++decade) {
    const value = 10 ** decade, x = margin + levels * box * (decade - base) / (top - base);
    const label = unit === "share" ? brief(100 * value, 4) + " %" : tickLabel(value) + " N";
    svg.push(words(x, 31, label, "middle"));
  }
  return { text: "", width, height: 40, svg };
}

// ---- Figures. They are numbered, and each drawing has buttons that save it.

const saved = [];  // panels, with their file names
let figures = 0;

const keyHtml = (key) => html`<p class="legend">${key.map(({ svg, text, width, height }) =>
  html`<span>${shape("svg", { viewBox: `0 0 ${width} ${height}`, width, height,
    "aria-hidden": "true" }, svg)} ${text}</span> `)}</p>`;

function panelHtml(panel, letter) {
  const name = `${fileStem()}-figure-${figures}${letter}`;
  const buttons = [["SVG", ".svg"], ...panel.files].map(([label, ending], n) =>
    html`<button type="button" data-panel="${saved.length}" data-file="${n - 1}"
 title="Save ${name}${ending}">${label}</button> `);
  saved.push({ ...panel, name });
  const drawing = shape("svg", { viewBox: `0 0 ${panel.width} ${panel.height}`, role: "img",
    "aria-label": panel.title }, panel.svg);
  return html`<div class="panel">${drawing}<p>${letter && html`<b>${letter}</b> `}
${panel.caption && html`<span>${panel.caption}</span> `}${buttons}</p></div>`;
}

/// Returns panels under one number and caption; several panels get letters. They are arranged about
/// three in a row, or by the CSS class `layout`.
function figure({ caption, panels, layout = "", key = panels[0].key }) {
  ++figures;
  const shown = panels.map((panel, n) =>
    panelHtml(panel, panels.length > 1 ? String.fromCharCode(97 + n) : ""));
  return html`<figure id="figure-${figures}">${keyHtml(key)}
<div class="figures ${layout}">${shown}</div>
<figcaption><b>Figure ${figures}.</b> ${caption}</figcaption></figure>`;
}

/// Returns the beginning of the names of saved files, which is valid on every system.
const fileStem = () => (report.compared ? drawings.names.join("-and-") : report.scene)
  .replace(/[^A-Za-z0-9_-]+/g, "-").replace(/^-+|-+$/g, "") || "palpate";

/// Returns a drawing as a separate file with its styles and its legend, on white.
function svgFile({ width, height, svg, key }) {
  let x = 8, y = height;
  const entries = key.map((entry) => {
    const wide = entry.width + 22 + 6.8 * entry.text.length;
    if (x + wide > width && x > 8) x = 8, y += 20;
    const placed = shape("g", { transform: `translate(${x} ${y})` },
      [entry.svg, words(entry.width + 8, 10, entry.text)]);
    x += wide;
    if (entry.height > 20) x = 8, y += entry.height;
    return placed;
  });
  const whole = Math.ceil(y + 22), style = document.getElementById("drawing-style").textContent;
  return shape("svg", { xmlns: "http://www.w3.org/2000/svg", viewBox: `0 0 ${width} ${whole}`,
    width, height: whole }, [shape("style", {}, "svg{font-family:sans-serif}" + style),
    shape("rect", { width, height: whole, fill: "#fff" }), svg, entries]).text;
}

/// Returns rows as the text of a CSV file (RFC 4180). The cell of a missing number is empty.
const csvFile = (rows) => rows.map((cells) => cells.map((cell) => {
  if (typeof cell === "number") return isNumber(cell) ? brief(cell, 8) : "";
  return /[,"\n\r]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell;
}).join(",") + "\n").join("");

document.addEventListener("click", (event) => {
  const { panel, file } = event.target.dataset ?? {};
  if (panel === undefined) return;
  const drawing = saved[panel], data = drawing.files[file];
  const blob = data ? new Blob([csvFile(data[2]())], { type: "text/csv" })
    : new Blob([svgFile(drawing)], { type: "image/svg+xml" });
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = drawing.name + (data ? data[1] : ".svg");
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
});

// ---- Tables and other parts.

const row = (cells, end = "") => html`<tr>${cells.map((one) => html`<td>${one}</td>`)}${end}</tr>`;
const table = (titles, rows) => html`<div class="scroll"><table>
<thead><tr>${titles.map((title) => html`<th>${title}</th>`)}</tr></thead>
<tbody>${rows}</tbody></table></div>`;
const note = (text) => text && html`<p class="note">${text}</p>`;
function barCell(value, largest) {
  const width = (160 * value / largest).toFixed(0) + "px";
  const bar = html`<span class="bar" style="width:${width}"></span>`;
  return html`<td class="text">${largest > 0 ? bar : ""}</td>`;
}
const cards = (title, all) => html`<p class="how">${title}</p><div class="cards">
${all.map(([value, meaning]) =>
  html`<div class="card"><b>${value}</b><span>${meaning}</span></div>`)}</div>`;
/// Return some of the statistics of a spread, as numbers or as percentages.
const numbersOf = (spread, ...which) => which.map((one) => number(spread?.[one]));
const sharesOf = (spread, ...which) => which.map((one) => share(spread[one]));

// ---- Drawings of a body with values on its surface.

const cross = (a, b) => [0, 1, 2].map((n) =>
  a[(n + 1) % 3] * b[(n + 2) % 3] - a[(n + 2) % 3] * b[(n + 1) % 3]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => a.map((c, n) => c - b[n]);

/// Returns three views of the body. A view is given by its axes: to the right, up, and toward the
/// eye.
function bodyViews(eye) {
  const axes = (towards, hint) => {
    const across = cross(hint, towards), right = across.map((c) => c / norm(across));
    return [right, cross(towards, right), towards];
  };
  const behind = eye.map((c) => -c), hint = Math.abs(eye[2]) < 0.9 ? [0, 0, 1] : [0, 1, 0];
  const front = axes(eye, hint);
  return [["from the front", front], ["from behind", axes(behind, hint)],
    ["from above", axes(front[1], behind)]];
}

/// Returns an orthographic view of the body: the projected nodes, and the triangles that face the
/// eye.
function lookAt(axes) {
  const { nodes, triangles } = drawings.body, width = 420, margin = 12;
  const seenFrom = (p) => axes.map((axis) => dot(axis, p)), seen = [];
  for (let n = 0; n < nodes.length; n += 3) seen.push(seenFrom(nodes.slice(n, n + 3)));
  const [[left, right], [bottom, top]] = [0, 1].map((axis) => rangeOf(seen.map((p) => p[axis])));
  const scaled = (width - 2 * margin) / (right - left);
  const cornersOf = (t) => [0, 1, 2].map((n) => seen[triangles[3 * t + n]]);
  const facing = [], depth = [];
  for (let t = 0; t < triangles.length / 3; ++t) {
    const [p, q, r] = cornersOf(t), normal = cross(minus(q, p), minus(r, p));
    facing.push(normal[2] / norm(normal));
    depth.push(p[2] + q[2] + r[2]);
  }
  return {
    width, margin, scaled, seen, seenFrom, cornersOf, facing, span: right - left,
    height: Math.round(scaled * (top - bottom) + 2 * margin + 30),
    x: (p) => margin + scaled * (p[0] - left), y: (p) => margin + scaled * (top - p[1]),
    /// The visible triangles, beginning with the farthest.
    order: [...facing.keys()].filter((t) => facing[t] > 0).sort((a, b) => depth[a] - depth[b]),
  };
}

function bodyTriangles({ order, facing, cornersOf, x, y }, values, scale) {
  return order.map((t) => {
    const grey = Math.round(176 + 58 * facing[t]), known = isNumber(values[t]);
    const fill = known ? scale.colourOf(values[t]) : `rgb(${grey},${grey + 3},${grey + 3})`;
    const d = `M${cornersOf(t).map((p) => at(x(p), y(p))).join("L")}z`;
    // If very many triangles have titles, browsers cannot print the page.
    return path({ d, fill, stroke: fill },
      titled(known && facing.length <= 4000 ? scale.text(values[t]) : ""));
  });
}

function fixedNodes({ order, seen, x, y }) {
  const { fixed, triangles } = drawings.body;
  const shown = new Set(order.flatMap((t) => triangles.slice(3 * t, 3 * t + 3)));
  return path({ class: "fixed", d: fixed.filter((node) => shown.has(node))
    .map((node) => `M${at(x(seen[node]) - 2, y(seen[node]) - 2)}l4 4m0 -4l-4 4`).join("") });
}

/// Draw a disc in each view that shows one of its triangles.
function bodyMarks({ facing, seenFrom, x, y }, marks, scale) {
  const shown = marks.filter(({ at: { triangles } }) => triangles.some((t) => facing[t] > 0));
  return shown.map(({ at: { place }, value, note: text }) => {
    const seen = seenFrom(place), fill = isNumber(value) ? scale.colourOf(value) : "#fff";
    return circle(x(seen), y(seen), marks.length > 1 ? 4 : 7,
      { fill, stroke: "#fff", "stroke-width": 1.2 }, titled(text));
  });
}

function lengthBar({ span, scaled, margin, height }) {
  const bar = roundUp(span / 10), wide = scaled * bar;
  return [path({ class: "bar", d: `M${margin} ${height - 18}v6h${wide.toFixed(1)}v-6` }),
    words(margin + wide + 8, height - 9, brief(millimetres(bar), 3) + " mm")];
}

/// Returns panels that show the body from three sides. values: one per triangle; a triangle without
/// a value is grey. marks: [{at: {place, triangles}, value, note}]. meaning: describes the values
/// in the saved file.
function bodyPanels({ values = [], marks = [], scale, meaning }) {
  const panels = bodyViews(drawings.body.front).map(([caption, axes]) => {
    const seen = lookAt(axes);
    return {
      title: "the body " + caption, caption, width: seen.width, height: seen.height, files: [],
      key: bodyKey(scale, marks.length > 0),
      svg: [shape("g", { "stroke-width": 0.6, "stroke-linejoin": "round" },
        bodyTriangles(seen, values, scale)), fixedNodes(seen), bodyMarks(seen, marks, scale),
      lengthBar(seen)],
    };
  });
  // One file is enough, because all views show the same numbers.
  panels[0].files = [["CSV", ".csv", () => bodyRows(values, marks, meaning)]];
  return panels;
}

function bodyRows(values, marks, meaning) {
  const { nodes, triangles } = drawings.body;
  const middle = (t) => [0, 1, 2].map((axis) =>
    [0, 1, 2].reduce((sum, n) => sum + nodes[3 * triangles[3 * t + n] + axis] / 3, 0));
  const place = (p) => p.map((c) => Number(brief(millimetres(c), 5)));
  return [["place", "x (mm)", "y (mm)", "z (mm)", meaning],
    ...values.map((value, t) => ["triangle", ...place(middle(t)), value]),
    ...marks.map((mark) => ["mark", ...place(mark.at.place), mark.value])];
}

function bodyKey(scale, hasMarks) {
  const entry = (svg, text) => ({ svg, text, width: 14, height: 14 });
  const key = [colourBar(scale),
    entry(shape("rect", { width: 14, height: 14, fill: "#d6d9d9" }), "no value"),
    entry(path({ class: "fixed", d: "M5 5l4 4m0 -4l-4 4" }), "fixed node")];
  const disc = circle(7, 7, 5, { fill: "#21918c", stroke: "#fff" });
  return hasMarks ? [...key, entry(disc, scale.disc)] : key;
}

// ---- Curves of force against displacement.

const axisNames = ["x", "y", "z"];
const onMillimetres = ([ways, forces]) => ways.map((way, n) => [millimetres(way), forces[n]]);
const exactMarks = {
  unseen: (points) => marksOnly("exact, held out", looks.unseen, points),
  solved: (points) => marksOnly("exact, solved", looks.solved, points),
};

function forcePlot(way, names, title, along) {
  const curves = names.map((name, n) => lineOnly(name, look(n), onMillimetres(way.sampled[n])));
  const [unseen, solved] = [way.held_out, way.solved].map(onMillimetres);
  const direction = way.direction.map((c) => Math.round(100 * c) / 100 + 0).join(", ");
  return plot({
    title, x: linear(`displacement ${along}, mm`), y: linear(`force ${along}, N`),
    width: 380, height: 290, caption: along === "along the path" ? `direction (${direction})` : "",
    series: [...(unseen.length ? [exactMarks.unseen(unseen)] : []),
      ...(solved.length || !unseen.length ? [exactMarks.solved(solved)] : []),
      // Draw the default method first, with the widest line, so that the other lines are on top of
      // it.
      ...curves.reverse()],
  });
}

/// Returns the legend of the curves. marks: some of "unseen" and "solved".
const wayKey = (names, marks) => [...marks.map((mark) => exactMarks[mark]()),
  ...names.map((name, n) => lineOnly(name, look(n)))].map(seriesKey);

// ---- Sections of a report.

const relativeFloor = report.relative_error_floor;
const [method] = report.methods ?? [];
const asItIs = report.lattices?.find(({ dataset, factor }) => dataset === 0 && factor === 0);
const shownLattice = report.lattices?.[report.measured_lattice] ?? asItIs;
const baseName = (file) => file.slice(file.lastIndexOf("/") + 1);
const onThisMachine = "per query, on the machine that made this page";

function areaCards(area) {
  const { area: atProbes } = area.probes;
  const errors = [[share(atProbes.within_target), withinTarget()],
    [share(atProbes.relative.median), "median error, as a share of the force"]];
  return cards(`A finger anywhere on ${area.name}:`, [...(atProbes.count ? errors : []),
    [share(area.relative_bound.median), "median error bound, as a share of the force"],
    [share(area.relative_bound.percentile_95), "95th percentile of the error bound"],
    [area.sites, "sites on the surface"],
    [number(area.seconds_to_prepare) + " s", "to prepare the energy"],
    [number(1e-3 * area.nanoseconds_per_query) + " us", onThisMachine]]);
}

const withinTarget = () => "of exact solutions within " + drawings.words.target;

function methodCards() {
  const measures = asItIs.methods[method], { whole_ball: all } = measures;
  const errors = [[number(all.error.mean) + " N", "mean error over the whole ball"],
    [share(all.relative_to_mean_force), "mean error, as a share of the mean force"],
    [share(all.within_target), withinTarget()],
    [share(all.covered), "of exact solutions in cells with 8 solved corners"]];
  // Without probes the errors may cover only a part of the dataset. They say little about the
  // whole.
  return cards(`The method ${method} on ${asItIs.label}:`, [...(all.count ? errors : []),
    [number(measures.nanoseconds_per_query, 3) + " ns", onThisMachine],
    [count(asItIs.configurations_per_node), "configurations per active node"]]);
}

function probesFigure(area, probes) {
  const one = area.probes.area, nearest = area.probes.nearest_site;
  const errors = (title, label, of) => plot({
    title, x: linear("displacement, mm"), y: logarithmic(label),
    series: [["one energy over the area", "newtons"], ["nearest site alone", "newtons_of_nearest"]]
      .map(([name, which], n) => marksOnly(name, look(n),
        probes.map((probe) => [millimetres(probe.displacement), of(probe) * probe[which]]))),
  });
  const newtons = ({ error }) => numbersOf(error, "mean", "maximum").join(" and ");
  const shares = ({ relative }) => sharesOf(relative, "mean", "maximum").join(" and ");
  return figure({
    layout: "two",
    panels: [errors("Absolute error", "error, N", () => 1),
      errors("Relative error", "error, %", ({ force }) => 100 / Math.max(force, relativeFloor))],
    caption: `Errors against displacement, logarithmic. Each mark is one probe: an exact solution
that no interpolation uses. (a) |interpolated − exact force| in newtons, mean and maximum:
${newtons(one)} with one energy, ${newtons(nearest)} with the nearest site. (b) The same divided by
|exact force|, or by ${relativeFloor} N if the force is smaller, in percent: ${shares(one)} with one
energy, ${shares(nearest)} with the nearest site. Eqs. 13 and 14 of Peterlik et al. 2010 take the
three components one by one and divide by the component, which may be zero.`,
  });
}

function depthFigure(area, probes) {
  const bounds = (which) => area.depths.map((depth) =>
    [millimetres(depth.depth), depth.relative_bound[which]]);
  const errors = probes.length ? [marksOnly("error at probes", look(2),
    probes.map((probe) => [millimetres(probe.displacement), probe.error]))] : [];
  return figure({
    layout: "single",
    panels: [plot({
      title: "Error bound against displacement", width: 640,
      x: linear("displacement, mm"), y: logarithmic("share of the force"),
      series: [series("bound, median", look(0), bounds("median")),
        series("bound, 95 %", look(1), bounds("percentile_95")), ...errors],
    })],
    caption: `Error bound as a share of the force (1 is all of it), logarithmic, against the length
of the displacement in mm: median and 95th percentile over the centroids of all triangles and five
directions within 45 degrees of the inward normal. Triangles are errors at the probes, if the
dataset has probes.`,
  });
}

function areaMaps({ probes, median, largest }) {
  const least = 1e-3;  // smaller errors have the same colour
  const errors = probes.map(({ error }) => Math.max(error, least));
  const scale = colourScale([...median, ...largest, ...errors], "share",
    "probe, coloured by its error");
  const marks = probes.map((probe) => ({ at: probe.at, value: probe.error,
    note: `${share(probe.error)} at ${brief(millimetres(probe.displacement), 3)} mm` }));
  const deepest = brief(millimetres(report.datasets[0].radius), 3);
  const held = probes.length ? "Discs show errors at probes, which are exact solutions."
    : "This dataset has no probes to compare the bound with.";
  return [["median", median], ["largest", largest]].map(([which, values]) => figure({
    panels: bodyPanels({ values, marks, scale, meaning: "share of the force (1 is all)" }),
    caption: `Error on the organ, ${which}: the ${which} error bound at the centroid of each
triangle, as a share of the force. It is taken over five depths up to ${deepest} mm and five
directions within 45 degrees of the inward normal, for forces up to
${brief(drawings.max_force, 3)} N. Colours are logarithmic, views orthographic.
${held}`,
  }));
}

function areaContent(area, drawn) {
  const { probes } = drawn;
  return [html`<h3>${area.name}</h3>`, table(["sites", "collocation points", "preparation, s",
    "query, ns", "probes", "error, median", "95 %", "bound, median", "95 %"],
  row([area.sites, area.collocation_points, number(area.seconds_to_prepare),
    number(area.nanoseconds_per_query, 3), probes.length,
    ...sharesOf(area.probes.relative_error, "median", "percentile_95"),
    ...sharesOf(area.relative_bound, "median", "percentile_95")])),
  html`<p>${drawn.words}</p>`, areaMaps(drawn), depthFigure(area, probes),
  probes.length ? probesFigure(area, probes) : ""];
}

const areasSection = () => ({
  id: "areas", heading: "Accuracy over the surface",
  how: `Error bound of the energy over the finger's whole area, as a share of the force, or of
force_floor / force_error if the force is smaller. Displacements are within 45 degrees of the inward
normal, forces at most max_force of the scene. Discs show errors at probes: exact solutions that are
used for this measurement only.`,
  content: report.areas.map((area, n) => areaContent(area, drawings.areas[n])),
});

function frontierPanel([name, of], overTime) {
  const pointOf = (one, lattice) => {
    const measures = lattice.methods[one], configurations = lattice.configurations_per_node;
    const error = of(measures), time = measures.nanoseconds_per_query;
    return [overTime ? time : configurations, error, `${one}, ${count(configurations)}`
      + ` configurations: ${number(error)} N, ${number(time, 3)} ns`];
  };
  return plot({
    title: `${name}: error against ${overTime ? "time" : "configurations"}`,
    x: logarithmic(overTime ? "ns per query" : "configurations per active node"),
    y: logarithmic("error of the force, N"),
    // A lattice that contains the held-out points has no measured errors.
    series: methodSeries((one) => report.lattices.map((lattice) => pointOf(one, lattice))
      .filter(([, error]) => isNumber(error))),
  });
}

const frontierFigure = () => figure({
  layout: "two",
  panels: [["Whole ball, mean", ({ whole_ball: all }) => all.error.mean],
    ["Whole ball, median", ({ whole_ball: all }) => all.error.median],
    ["Covered points, mean", ({ covered_points: covered }) => covered.error.mean],
  ].flatMap((error) => [frontierPanel(error, false), frontierPanel(error, true)]),
  caption: `Error of each method against its cost. Vertical: |interpolated − exact force| in
newtons, mean or median over the exact solutions of
${counted(report.compared_nodes, "active node")}. Horizontal: solved configurations per active node
(a, c, e), or the time of one query in nanoseconds on the machine that made this page (b, d, f).
Each mark is one lattice density. Covered: the eight surrounding corners are solved.
${drawings.words.held_out}`,
});

function frontierRow(name, lattice) {
  const measures = lattice.methods[name], { whole_ball: all, covered_points: covered } = measures;
  const cells = [lattice === report.lattices[0] ? name : "",
    count(lattice.configurations_per_node)];
  if (measures.problem && all.count === 0)
    return row(cells, html`<td class="reason" colspan="12">${measures.problem}</td>`);
  return row([...cells, ...numbersOf(all.error, "mean", "median", "percentile_95", "maximum"),
    ...numbersOf(covered.error, "mean", "maximum"), share(all.relative.mean),
    share(all.within_target), share(all.covered), number(measures.loop_work),
    number(measures.nanoseconds_per_query, 3), number(1e3 * measures.seconds_to_prepare)]);
}

function frontierSection() {
  // The rows of each method form a group that a line separates from the next.
  const rows = report.methods.map((name, n) => [n > 0 ? html`</tbody><tbody>` : "",
    report.lattices.map((lattice) => frontierRow(name, lattice))]);
  const lattices = report.lattices.map((lattice) => row([lattice.label,
    brief(millimetres(lattice.spacing), 4), count(lattice.configurations_per_node),
    count(lattice.factorizations_per_node)]));
  return {
    id: "frontier", heading: "Speed against error",
    how: `Lower is more accurate; further left is cheaper. A lower curve needs fewer configurations
for the same accuracy. Each mark is one lattice density.`,
    content: [
      // Without exact solutions the plots would be empty, but the table still shows the timings.
      report.references.kind === "none" ? "" : frontierFigure(), html`<h3>In numbers</h3>`,
      table(["method", "configu\u00adrations", "mean", "median", "95 %", "max", "mean, covered",
        "max, covered", "relative", "in target", "covered", "loop work", "ns per query",
        "ms to prepare"], rows),
      table(["lattice", "spacing, mm", "configurations", "factorizations"], lattices),
      drawings.words.gaps.map(note), html`<p class="how">Errors are |interpolated − exact force|
in newtons. Relative: divided by the force, or by ${relativeFloor} N if the force is smaller. In
target: at most ${drawings.words.target}. Covered: the eight surrounding corners are solved; these
points are the same for every method.</p>`],
  };
}

function wayPanel([title, unit, of]) {
  const pointOf = (name, { from, to, methods }) => {
    const error = of(methods[name]) * (unit === "%" ? 100 : 1);
    const [least, most] = [from, to].map((way) => brief(millimetres(way), 3));
    return [millimetres(from + to) / 2, error, `${name}, ${least} to ${most} mm,`
      + ` ${methods[name].count} exact solutions: ${number(error)} ${unit}`];
  };
  return plot({
    title, x: linear("distance from rest, mm"), y: logarithmic("error, " + unit),
    // The curves skip shells without exact solutions.
    series: methodSeries((name) => report.ways.filter(({ methods }) => methods[name].count > 0)
      .map((shell) => pointOf(name, shell))),
  });
}

const waysFigure = (caption, errors) => figure({
  layout: "two", panels: errors.map(wayPanel),
  caption: html`${caption} Errors are logarithmic, against the length of the displacement in mm, in
${report.ways.length} shells of equal thickness around rest. Marks are at the middles of the shells;
the tooltip of a mark shows its number of exact solutions. Measured on ${shownLattice.label} with
${shownLattice.methods[method].whole_ball.count} exact solutions of
${counted(report.compared_nodes, "active node")} (${report.references.kind}).`,
});

const vectorErrors = () => waysFigure(`Error of the force vector: (a, b) |interpolated − exact
force| in newtons, (c, d) the same divided by |exact force|, or by ${relativeFloor} N if the force
is smaller, in percent. Eqs. 13 and 14 instead take the three components one by one and divide by
the component, which is zero on symmetric paths.`, [
  ["Mean absolute error", "N", ({ error }) => error.mean],
  ["Maximum absolute error", "N", ({ error }) => error.maximum],
  ["Mean relative error", "%", ({ relative }) => relative.mean],
  ["Maximum relative error", "%", ({ relative }) => relative.maximum]]);

const componentErrors = () => waysFigure(html`Errors by the paper's equations, over points and
the components i = x, y, z: (a, b) |interpolated<sub>i</sub> − exact<sub>i</sub>| in newtons, (c,
d) divided by |exact<sub>i</sub>| in percent. Unlike in the paper, a component below
${relativeFloor} N counts as ${relativeFloor} N.`, [
  ["Eq. 13, mean", "N", (measures) => measures.mean_component],
  ["Eq. 13, maximum", "N", (measures) => measures.max_component],
  ["Eq. 14, mean", "%", (measures) => measures.mean_relative_component],
  ["Eq. 14, maximum", "%", (measures) => measures.max_relative_component]]);

/// Returns table rows for the methods whose measures on the shown lattice fulfil `wanted`.
const methodRows = (wanted, cellsOf) => report.methods
  .map((name) => [name, shownLattice.methods[name].whole_ball])
  .filter(([, all]) => wanted(all)).map(([name, all]) => row([name, ...cellsOf(all)]));

function waysTable() {
  const rows = methodRows((all) => all.count > 0, (all) => [all.count,
    ...numbersOf(all.error, "mean", "maximum"), ...sharesOf(all.relative, "mean", "maximum"),
    ...numbersOf(all, "mean_component", "max_component"),
    ...sharesOf(all, "mean_relative_component", "max_relative_component")]);
  return table(["method", "exact solutions", "mean, N", "max, N", "relative, mean", "relative, max",
    "Eq. 13 mean, N", "Eq. 13 max, N", "Eq. 14 mean", "Eq. 14 max"], rows);
}

const waysSection = () => ({
  id: "ways", heading: "Error by distance from rest",
  how: `Eqs. 13 and 14 of Peterlik et al. 2010: mean and maximum of the absolute and the relative
error of the interpolated force at exact solutions, by distance from rest.`,
  content: report.ways.length ? [vectorErrors(), componentErrors(),
    html`<h3>In numbers, all distances together</h3>`, waysTable()]
    : html`<p>${drawings.words.held_out}</p>`,
});

function loopsSection() {
  const least = 1e-10;  // smaller values come from the rounding of the sum
  const pointOf = (name, { methods, configurations_per_node: configurations }) => {
    const { loop_work: work } = methods[name];
    return [configurations, Math.max(work, least),
      `${name}, ${count(configurations)} configurations: ${number(work)}`];
  };
  return {
    id: "loops", heading: "Closed loops",
    how: `Work that a hand gains or loses around circles of a quarter of the workspace radius,
divided by force times path length; the largest value found. Elastic tissue returns all
work; a method that does not can make a device vibrate. 10⁻¹⁰ is only the rounding error of the sum.
At jumps between branches, methods that fall back to tri-linear interpolation gain or lose work.`,
    content: figure({
      layout: "single",
      panels: [plot({
        title: "Work around closed loops", width: 640,
        x: logarithmic("configurations per active node"), y: logarithmic("relative work"),
        series: methodSeries((name) => report.lattices.map((one) => pointOf(name, one))),
      })],
      caption: `Work around closed loops, |sum of F·dp| / sum of |F||dp| (dimensionless), against
solved configurations per active node; one mark per lattice density. Largest value of 64 circles
with random centres and planes, each with 4096 samples of the interpolated force.`,
    }),
  };
}

function boundsSection() {
  const rows = methodRows((all) => all.bounds > 0, (all) =>
    [all.bounds, share(all.bound_holds), number(all.bound_over_error)]);
  return {
    id: "bounds", heading: "Error bounds",
    how: `Some methods give a bound of their own error. A good bound holds almost always and is not
many times the error.`,
    content: rows.length ? table(["method", "bounds given", "error within bound",
      "bound / error, median"], rows) : html`<p>No method gave error bounds.</p>`,
  };
}

/// Returns the indices of the active nodes, beginning with the largest mean error of the default
/// method.
function worstFirst() {
  const error = (node) => report.nodes[node].methods[method]?.error.mean ?? -1;
  return [...report.nodes.keys()].sort((a, b) => error(b) - error(a));
}
const isCompared = (node) => isNumber(drawings.nodes[node].compared);

function nodePanel(node) {
  const { compared } = drawings.nodes[node];
  const measured = drawings.lattices.filter(({ node_errors: errors }) => errors.length);
  return plot({
    title: report.nodes[node].name, width: 380, height: 290,
    x: logarithmic("configurations"), y: logarithmic("mean error, N"),
    series: methodSeries((name, m) => measured.map((lattice) =>
      [lattice.node_configurations[compared], lattice.node_errors[compared][m]])),
  });
}

const nodesFigure = (nodes) => figure({
  panels: nodes.filter(isCompared).slice(0, 12).map(nodePanel),
  caption: `Mean error of each method over the exact solutions of an active node, in newtons,
against the node's solved configurations; one mark per lattice density. The node with the largest
error of the default method comes first.`,
});

function nodeRow(n) {
  const node = report.nodes[n], { points } = node;
  const { error, within_target: within, bound_holds: holds } = node.methods[method] ?? {};
  return row([node.name, points.expandable, points.terminating, points.failed,
    node.inconsistent_edges, number(node.largest_force, 3), node.references,
    ...numbersOf(error, "mean", "median", "percentile_95", "maximum"),
    ...[within, holds].map(share)]);
}

function nodesSection() {
  const all = worstFirst(), listed = all.slice(0, 36);
  const cut = listed.length < all.length ? `: ${listed.length} of ${all.length} active nodes` : "";
  const others = report.compared_nodes < all.length ? " The other methods were compared on"
    + ` ${counted(report.compared_nodes, "node")}, evenly chosen.` : "";
  const methodRow = (n) => row([report.nodes[n].name,
    ...report.methods.map((name) => number(report.nodes[n].methods[name]?.error.mean))]);
  return {
    id: "nodes", heading: "Active nodes",
    how: `Errors of ${method} in newtons on ${shownLattice.label}, the worst first${cut}. Jumps:
lattice edges between different branches of solutions; no interpolation is smooth across
them.${others}`,
    content: [table(["active node", "expandable", "terminating", "failed", "jumps",
      "largest force, N", "exact solutions", "mean", "median", "95 %", "max", "in target",
      "within bound"], listed.map(nodeRow)),
    // With a single method, the table above has the same numbers. With a single node, its plot
    // would repeat the plot of all nodes.
    report.methods.length > 1 ? table(["mean error, N", ...report.methods],
      all.filter(isCompared).map(methodRow)) : "",
    isNumber(report.measured_lattice) && all.length > 1 ? nodesFigure(all) : ""],
  };
}

function organFigure(which, word, scale) {
  const { triangles } = drawings.body;
  const atNode = new Map(drawings.nodes.map((node) => [node.node, node[which]]));
  // A triangle whose three corners are active gets the mean of their values.
  const values = Array.from({ length: triangles.length / 3 }, (_, t) =>
    [0, 1, 2].reduce((sum, n) => sum + (atNode.get(triangles[3 * t + n]) ?? NaN) / 3, 0));
  const marks = drawings.nodes.map((node, n) => ({ at: node.at, value: node[which],
    note: `${report.nodes[n].name}: ${number(node[which])} N` })).filter((mark) => mark.at);
  return figure({
    panels: bodyPanels({ values, marks, scale, meaning: "error bound (N)" }),
    caption: `Error on the organ, ${word}: each active node is coloured by the ${word} error
bound of ${method} over its workspace ball, in newtons, on ${shownLattice.label}. A triangle between
three active nodes has their mean. Colours are logarithmic, views orthographic.`,
  });
}

function organSection() {
  const bounds = drawings.nodes.flatMap((node) => [node.mean_bound, node.largest_bound]);
  // Both maps use one scale, so that they can be compared.
  const scale = colourScale(bounds, "newtons", "active node, coloured by its bound");
  return {
    id: "organ", heading: "Error on the organ",
    how: `The surface of ${drawings.mesh} at rest, from three sides.`,
    content: bounds.some(isNumber)
      ? [organFigure("mean_bound", "mean", scale), organFigure("largest_bound", "largest", scale)]
      : html`<p>${method} gives no error bound here. The default method, potential, does.</p>`,
  };
}

// ---- Slices of the ball. The left margin has room for "-123.4".

const slice = { edge: 270, left: 56, right: 24, top: 12, bottom: 28, base: 12 + 270 };

function latticeMark(x, y, tag) {
  if (tag === "expandable") return circle(x, y, 1.7, { class: "solved" });
  if (tag === "terminating")
    return path({ class: "terminating", d: `M${at(x, y - 4)}l4 4l-4 4l-4 -4z` });
  return path({ class: "failed", d: `M${at(x - 3.5, y - 3.5)}l7 7m0 -7l-7 7` });
}

/// Returns one path per colour. A path consists of runs of samples along the rows, so that there
/// are no seams between neighbours.
function sliceColours({ side, bound }, scale) {
  const { left, base } = slice, step = slice.edge / side, paths = Array(levels).fill("");
  const levelAt = (n) => isNumber(bound[n]) ? scale.levelOf(bound[n]) : -1;
  for (let r = 0; r < side; ++r)
    for (let begin = 0, end = 0; begin < side; begin = end) {
      const level = levelAt(r * side + begin);
      while (end < side && levelAt(r * side + end) === level) ++end;
      const place = `M${left + begin * step} ${base - (r + 1) * step}`, wide = (end - begin) * step;
      if (level >= 0) paths[level] += `${place}h${wide}v${step}h-${wide}z`;
    }
  return shape("g", { "shape-rendering": "crispEdges" },
    paths.map((d, level) => d && path({ d, fill: colourOfLevel(level) })));
}

/// Returns the edges between covered and uncovered samples.
function coverEdge({ side, covered }) {
  const { left, base } = slice, step = slice.edge / side;
  let d = "";
  for (let r = 1; r < side; ++r)
    for (let c = 1; c < side; ++c) {
      const here = covered[r * side + c], place = `M${left + c * step} ${base - r * step}`;
      if (here !== covered[(r - 1) * side + c]) d += `${place}h${step}`;
      if (here !== covered[r * side + c - 1]) d += `${place}v-${step}`;
    }
  return path({ class: "cover", d });
}

/// Returns the outline of the ball, and two axes. Each axis is labelled with -radius, its name, and
/// radius.
function sliceFrame({ across, up, radius }) {
  const { edge, left, top, base } = slice, axisX = left - 4, axisY = base + 4;
  const rounded = Math.round(1e4 * radius) / 10;
  const label = (n, axis) => n === 0 ? axisNames[axis] : brief(n * rounded, 6);
  return [circle(left + edge / 2, top + edge / 2, edge / 2, { class: "rim" }),
    path({ class: "axis", d: `M${left} ${axisY}h${edge}M${axisX} ${top}v${edge}` }),
    [-1, 0, 1].map((n) => {
      const x = left + edge * (n + 1) / 2, y = base - edge * (n + 1) / 2;
      return [path({ class: "axis", d: `M${x} ${axisY}v4M${axisX} ${y}h-4` }),
        words(x, axisY + 16, label(n, across), "middle"),
        words(axisX - 6, y + 4, label(n, up), "end")];
    })];
}

function sliceKey(scale) {
  const behind = shape("rect", { width: 14, height: 14, fill: "#b9c0c7" });
  const entry = (svg, text) => ({ text, width: 14, height: 14, svg: [behind, svg] });
  return [colourBar(scale), entry(latticeMark(7, 7, "expandable"), "lattice point"),
    entry(latticeMark(7, 7, "terminating"), "terminating (force limit)"),
    entry(latticeMark(7, 7, "failed"), "failed"),
    entry(circle(7, 7, 4, { class: "probe", fill: colourOfLevel(12) }),
      "exact solution near the plane, coloured by its error"),
    entry(path({ class: "cover", d: "M0 7h14" }), "inside: eight solved corners on one branch"),
    entry(path({ class: "jump", d: "M1 7h12" }), "jump between branches")];
}

function slicePanel(map, scale) {
  const { edge, left, right, base, bottom } = slice;
  const x = ([across]) => left + 0.5 * edge * (1 + across / map.radius);
  const y = ([, up]) => base - 0.5 * edge * (1 + up / map.radius);
  return {
    title: "error in a slice", caption: `${axisNames[map.across]} and ${axisNames[map.up]}`,
    width: left + edge + right, height: base + bottom, key: sliceKey(scale),
    svg: [sliceColours(map, scale), coverEdge(map), sliceFrame(map),
      map.jumps.map(([a, b]) => path({ class: "jump", d: `M${at(x(a), y(a))}L${at(x(b), y(b))}` })),
      map.marks.map((mark) => latticeMark(x(mark.at), y(mark.at), mark.tag)),
      map.errors.map((mark) => circle(x(mark.at), y(mark.at), 4,
        { class: "probe", fill: scale.colourOf(mark.error) }, titled(number(mark.error) + " N")))],
    files: [["CSV", ".csv", () => boundRows(map)],
      ["CSV of marks", "-marks.csv", () => markRows(map)]],
  };
}

/// Returns the samples as rows for a file, from the lowest row to the highest. The first row and
/// the first column hold coordinates.
function boundRows({ side, radius, across, up, bound }) {
  const place = (n) => Number(brief(millimetres(radius * (2 * (n + 0.5) / side - 1)), 5));
  const samples = [...Array(side).keys()];
  const title = `${axisNames[up]} (mm) down / ${axisNames[across]} (mm) across: error bound (N)`;
  return [[title, ...samples.map(place)],
    ...samples.map((r) => [place(r), ...bound.slice(r * side, (r + 1) * side)])];
}

const markRows = ({ across, up, marks, errors }) => [
  ["mark", `${axisNames[across]} (mm)`, `${axisNames[up]} (mm)`, "error (N)"],
  ...marks.map((mark) => [mark.tag, ...mark.at.map(millimetres), NaN]),
  ...errors.map((mark) => ["exact solution", ...mark.at.map(millimetres), mark.error])];

/// Returns a sentence that says which active nodes have pictures; empty if all have one.
const pictured = () => drawings.pictures.length === report.nodes.length ? ""
  : ` Shown: ${counted(drawings.pictures.length, "active node")} with the largest errors.`;

function mapsOf({ node, slices }, scale) {
  const { name } = report.nodes[node], { side } = slices[0];
  return [html`<h3>${name}</h3>`, figure({
    panels: slices.map((map) => slicePanel(map, scale)),
    caption: `Error bound of ${method} at ${name}, in newtons (logarithmic colours), in three planes
of displacements through rest; axes in mm, up to the rim of the workspace ball; ${side} x ${side}
samples on ${shownLattice.label}. Discs: |interpolated − exact force| at exact solutions whose
distance from the plane is at most a twentieth of the radius.`,
  })];
}

function mapsSection() {
  const values = drawings.pictures.flatMap(({ slices }) => slices)
    .flatMap(({ bound, errors }) => [...bound, ...errors.map(({ error }) => error)]);
  const scale = colourScale(values, "newtons");
  return {
    id: "maps", heading: "Error in the workspace ball",
    how: `Colour: the error bound of ${method} at each displacement in three planes through the rest
position (axes in mm, lattice of ${shownLattice.label}). A disc lighter than its surroundings marks
an error above the bound. White: no bound.${pictured()}`,
    content: drawings.pictures.filter(({ slices }) => slices.length)
      .map((picture) => mapsOf(picture, scale)),
  };
}

function areaCurves(area, ways) {
  const names = ["one energy over the area", "nearest site alone"];
  const [toProbes, toSites] = [true, false].map((exact) =>
    ways.filter((way) => way.held_out[0].length > 0 === exact));
  const shown = (list, mark, title, caption) => list.length ? figure({
    key: wayKey(names, [mark]), caption,
    panels: list.map((way) => forcePlot(way, names, title + way.name, "along the path")),
  }) : "";
  return [html`<h3>${area.name}</h3>`, shown(toSites, "solved", "", `Force at three sites of the
finger on paths into the body, along the lattice axis nearest to the inward normal, in newtons,
against the displacement in mm. Marks are exact: equilibria that were solved at the site. Beyond the
force limit of the scene, curves may miss the marks. A curve ends where the area gives no answer.`),
  shown(toProbes, "unseen", "To the probe with the ", `Force on paths from rest to probes, which are
exact solutions that no interpolation uses: those with the largest, the 95th-percentile and the
median relative error. In newtons, against the distance from rest in mm. The gap between curve and
mark is the error along the path.`)];
}

function nodeCurves({ node, axes, ways }) {
  const { name } = report.nodes[node], { methods } = report;
  const file = baseName(report.datasets[0].file);
  const alongAxes = figure({
    key: wayKey(methods, ["solved"]),
    panels: axes.map((way) => forcePlot(way, methods, "Along " + way.name, "along " + way.name)),
    caption: `Force at ${name} along the axes through rest: the force of the tissue on the tool
along the direction of motion, in newtons, against the displacement in mm. Each curve is one method
on all points of ${file}. Marks are exact: solved equilibria that the methods interpolate.`,
  });
  if (!ways.length) return [html`<h3>${name}</h3>`, alongAxes];
  return [html`<h3>${name}</h3>`, alongAxes, figure({
    key: wayKey(methods, ["unseen", "solved"]),
    panels: ways.map((way) =>
      forcePlot(way, methods, "To the solution with the " + way.name, "along the path")),
    caption: `Force at ${name} on paths from rest to exact solutions that no method uses
(${report.references.kind}), by each method on ${shownLattice.label}: those with the largest, the
95th-percentile and the median error of the default method. In newtons, against the distance from
rest in mm. The gap between curve and mark is the error along the path.`,
  })];
}

const curvesSection = () => ({
  id: "curves", heading: "Force against displacement",
  how: `The force of the tissue on the tool along the direction of motion. Marks are exact
solutions. Where curves differ between marks, methods
disagree.${drawings.areas_alone ? "" : pictured()}`,
  content: [report.areas.map((area, n) => areaCurves(area, drawings.areas[n].ways)),
    drawings.pictures.map(nodeCurves)],
});

function failuresSection() {
  const causes = Object.entries(report.failures);
  const sum = ({ points, attempts, probes }) => points + attempts + probes;
  const most = Math.max(...causes.map(([, failed]) => sum(failed)));
  const rows = causes.map(([cause, failed]) =>
    row([cause, failed.points, failed.attempts, failed.probes], barCell(sum(failed), most)));
  return {
    id: "failures", heading: "Failures",
    how: `Points: lattice points without a solution. Attempts: transitions that failed; another one
may have reached the point. palpate explain shows the history of a single point.`,
    content: causes.length ? table(["cause", "points", "attempts", "probes", ""], rows)
      : html`<p>Nothing failed.</p>`,
  };
}

function sizesTable({ arrays, bytes: whole, configurations }) {
  const all = Object.entries(arrays), most = Math.max(...all.map(([, { stored }]) => stored));
  // Combine small arrays: thirty of them would hide the three large ones.
  const isSmall = ([, { stored }]) => stored < 0.01 * whole, small = all.filter(isSmall);
  const rest = small.reduce((sum, [, { stored }]) => sum + stored, 0);
  const each = (stored) => configurations ? bytes(stored / configurations) : "-";
  const rows = all.filter((one) => !isSmall(one)).map(([name, { stored, unpacked }]) =>
    row([name, bytes(stored), bytes(unpacked), each(stored)], barCell(stored, most)));
  if (small.length)
    rows.push(row([`${small.length} smaller arrays`, bytes(rest), "", ""], barCell(rest, most)));
  return table(["array", "in the file", "unpacked", "per configuration", ""], rows);
}

const sizesSection = () => ({
  id: "sizes", heading: "Sizes",
  how: "Sizes of the arrays in the file, for all active nodes together.",
  content: report.datasets.map((dataset) => [html`<h3>${baseName(dataset.file)}:
${bytes(dataset.bytes)} for ${counted(dataset.configurations, "configuration")}</h3>`,
  sizesTable(dataset)]),
});

const provenance = ({ facts, scene }) => html`<dl>
${facts.map(([term, text]) => html`<dt>${term}</dt><dd>${text}</dd>`)}</dl>
<details><summary>Scene with all defaults</summary><pre>${scene}</pre></details>`;

const provenanceSection = () => ({
  id: "provenance", heading: "Scene and provenance",
  how: `What was computed, and by which programs. Palpate ${drawings.version} made this page.`,
  content: drawings.provenance.map(provenance),
});

function reportPage() {
  const { areas_alone: areasAlone, words: { held_out: heldOut, hint } } = drawings;
  const ofNodes = [frontierSection, waysSection, loopsSection, boundsSection, nodesSection,
    organSection, mapsSection];
  const sections = [...(report.areas.length ? [areasSection] : []), ...(areasAlone ? [] : ofNodes),
    curvesSection, failuresSection, sizesSection, provenanceSection];
  return {
    lead: [html`<p class="lead">${counted(report.nodes.length, "active node")}, ${drawings.mesh}.
${areasAlone ? "" : heldOut}</p>`, note(hint),
    report.areas.length ? areaCards(report.areas[0]) : methodCards()],
    sections: sections.map((section) => section()),
  };
}

// ---- Sections of a comparison of two datasets.

const sideName = (side) => `${"AB"[side]}, ${drawings.files[side]}`;

function comparedAxis(ways, axis) {
  const name = axisNames[axis];
  return plot({
    title: "Along " + name, width: 380, height: 290,
    x: linear(`displacement along ${name}, mm`), y: linear(`force along ${name}, N`),
    series: [...ways.map(({ solved }, side) =>
      marksOnly(`${"AB"[side]}: exact, solved`, looks.sides[side], onMillimetres(solved))),
    ...ways.map(({ sampled: [curve] }, side) =>
      lineOnly(sideName(side), looks.sides[side], onMillimetres(curve)))],
  });
}

const comparedAxes = ({ name }, { axes }) => figure({
  panels: axes.map(comparedAxis),
  caption: `Force at ${name} along the same displacements in both datasets: the force of the tissue
on the tool along the direction of motion, in newtons, against the displacement in mm, through rest.
Curves are by ${report.method}; marks are exact: solved equilibria. A curve ends where its dataset
gives no answer.`,
});

function comparedDistances({ name }, { distances }) {
  const forces = (n) => distances.map((one) => [millimetres(one[0]), one[1 + n]]);
  // At rest the force is zero, so there is no relative difference.
  const relative = (n) => distances.filter(([way, first]) => way > 0 && first > 0)
    .map((one) => [millimetres(one[0]), 100 * one[1 + n] / one[1]]);
  return figure({
    layout: "two",
    panels: [plot({
      title: "Forces", x: linear("distance from rest, mm"), y: linear("mean |force|, N"),
      series: [lineOnly(sideName(0), looks.sides[0], forces(0)),
        lineOnly(sideName(1), looks.sides[1], forces(1)),
        lineOnly("|B − A|", looks.difference, forces(2))],
    }), plot({
      title: "B relative to A", x: linear("distance from rest, mm"),
      y: linear("share of mean |force of A|, %"),
      series: [lineOnly("|B| / |A|", looks.sides[1], relative(1)),
        lineOnly("|B − A| / |A|", looks.difference, relative(2))],
    })],
    caption: `Forces at ${name} against the distance from rest in mm: (a) mean magnitude of both
forces and of the difference of the force vectors, in newtons, (b) the same in percent of the force
of A. Means over 26 directions, by ${report.method}.`,
  });
}

function differenceMap() {
  const { everywhere } = drawings;
  const scale = colourScale(everywhere.map(({ relative }) => relative), "share",
    "active node, coloured by the difference");
  const marks = everywhere.map((one) => ({ at: one.at, value: one.relative,
    note: `${one.name}: ${share(one.relative)}` }));
  return figure({
    panels: bodyPanels({ scale, marks, meaning: "|B - A|, share of the force of A (1 is all)" }),
    caption: `Difference of the forces, on the surface of A from three sides: mean magnitude of the
difference of the force vectors, as a share of the mean force of A, over a grid of displacements in
the workspace ball. Shown at ${everywhere.length} of ${report.common_nodes} active nodes that both
datasets have, by ${report.method}. Colours are logarithmic, views orthographic.`,
  });
}

const propertyRow = ([name, [a, b]]) => html`<tr class="${a === b ? "" : "differs"}">
<td>${name}</td><td>${a}</td><td>${b}</td></tr>`;

const propertiesSection = () => ({
  id: "properties", heading: "Side by side", how: "Differences are in bold.",
  content: html`<div class="scroll"><table class="words">
<thead><tr><th></th><th>${sideName(0)}</th><th>${sideName(1)}</th></tr></thead>
<tbody>${Object.entries(report.properties).map(propertyRow)}</tbody></table></div>`,
});

function forcesSection() {
  const cut = report.nodes.length === report.common_nodes ? ""
    : `, at ${report.nodes.length} of ${report.common_nodes} active nodes, evenly chosen`;
  return {
    id: "forces", heading: "Force against displacement",
    how: `Both datasets on the same axes, along the same displacements${cut}.`,
    content: report.nodes.map((node, n) =>
      [html`<h3>${node.name}</h3>`, comparedAxes(node, drawings.places[n])]),
  };
}

const differenceRow = ({ name, apart, displacements, first, second, difference }) => row([name,
  number(millimetres(apart), 3), displacements, number(first.stiffness, 3),
  number(second.stiffness, 3), number(first.mean_force, 3), number(second.mean_force, 3),
  ...numbersOf(difference, "mean", "maximum"), share(difference.relative),
  number(first.mean_error_bound), number(second.mean_error_bound)]);

const differencesSection = () => ({
  id: "differences", heading: "Differences in numbers",
  how: `Over a grid of displacements in the smaller workspace ball, where both datasets give an
answer and both forces are within the limits of their scenes. Stiffness: at rest, mean over
directions. Differences below the bounds may be errors of the interpolation.`,
  content: [table(["active node", "distance, mm", "displace\u00adments", "stiffness A, N/m",
    "stiffness B, N/m", "mean |force| A, N", "mean |force| B, N", "|B − A| mean, N",
    "|B − A| max, N", "share of A", "bound A, N", "bound B, N"], report.nodes.map(differenceRow)),
  // For a single place no map is needed.
  drawings.everywhere.length > 1 ? differenceMap() : "",
  report.nodes.map((node, n) => comparedDistances(node, drawings.places[n]))],
});

const comparisonPage = () => ({
  lead: [html`<p class="lead">Forces of two datasets along the same displacements. The scenes
differ in ${report.differences.join(", ")}.</p>`, report.limits.map(note)],
  sections: [propertiesSection(), forcesSection(), differencesSection(), {
    ...provenanceSection(),
    content: drawings.provenance.map((one, side) =>
      [html`<h3>${sideName(side)}</h3>`, provenance(one)]),
  }],
});

// ---- Sections of a recorded run.

/// Returns the ticks as points: number x of [time, speed, error, bound] against number y.
const tickPoints = (x, y, scale) =>
  drawings.ticks.map((tick) => [scale * tick[x], 100 * tick[y]]);

function runPanel(title, label, x, scale, intervals) {
  const middle = ({ from, to }) => scale * (from + (isNumber(to) ? to : from)) / 2;
  const line = (which) => intervals.filter(({ errors }) => errors.count >= 5)
    .map((one) => [middle(one), 100 * one.errors.relative[which]]);
  return plot({
    title, x: linear(label), y: logarithmic("share of the force, %"),
    series: [lineOnly("error, median", look(1), line("median")),
      lineOnly("error, 95 %", look(2), line("percentile_95")),
      marksOnly("error of a tick", look(0), tickPoints(x, 2, scale)),
      marksOnly("its bound", look(5), tickPoints(x, 3, scale))],
  });
}

const intervalRows = (name, scale, intervals) => intervals.map(({ from, to, errors }) => row([
  `${name} ${brief(scale * from, 3)} ` + (isNumber(to) ? `to ${brief(scale * to, 3)}` : "and more"),
  errors.count,
  ...["median", "percentile_95", "maximum"].map((which) => number(100 * errors.relative[which])),
  share(errors.within_target), share(errors.bound_holds), number(errors.bound_over_error)]));

function runPage() {
  const { all, times, in_contact: inContact, speeds, target, touching, held, unsolved } = report;
  const none = unsolved ? `, and ${unsolved} more have no exact solution` : "";
  const leftOut = held ? ` ${count(held)} are left out, because a second finger held the body.` : "";
  return {
    lead: [html`<p class="lead">${report.recording}: ${count(report.ticks)} ticks,
${count(touching)} of them touch. Of these, ${all.count} are compared with exact solutions on the
path from rest${none}.${leftOut}</p>`, cards("Recorded forces, before the guard", [
      [number(100 * all.relative.median) + " %", "median error"],
      [share(all.within_target), `of ticks within max(${share(target.force_error)} of the force,
${number(target.force_floor)} N)`],
      [share(all.bound_holds), "of error bounds hold"],
      [number(all.bound_over_error), "bound / error, median"]])],
    sections: [{
      id: "errors", heading: "Error against time and speed",
      how: `Relative to the exact force, or to ${report.relative_error_floor} N if that is larger.`,
      content: [figure({
        layout: "two",
        panels: [runPanel("Time", "time in the run, s", 0, 1, times),
          runPanel("Speed", "speed of the tool, cm/s", 1, 100, speeds)],
        caption: `Errors and bounds of the recorded forces in percent, logarithmic, against (a) the
time in the run and (b) the speed of the tool.`,
      }), table(["", "ticks", "error, median, %", "95 %", "largest, %", "in target", "bound holds",
        "bound / error"], [intervalRows("time, s,", 1, times),
        intervalRows("time in a contact, s,", 1, inContact),
        intervalRows("speed, cm/s,", 100, speeds)])],
    }],
  };
}

// ---- The page.

const page = report.compared ? comparisonPage() : report.recording ? runPage() : reportPage();
document.querySelector("main").innerHTML = html`<h1>${document.title}</h1>${page.lead}
<nav>${page.sections.map(({ id, heading }) => html`<a href="#${id}">${heading}</a>`)}</nav>
${page.sections.map(({ id, heading, how, content }) => html`<h2 id="${id}">${heading}</h2>
<p class="how">${how}</p>${content}`)}`.text;
