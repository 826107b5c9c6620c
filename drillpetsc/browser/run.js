"use strict";
// The page of a run. Numbers come in the units of the reader, either from the server that `drillpetsc serve` runs
// (only what is new), or from the file itself if it was exported.

const byId = (id) => document.getElementById(id);
const RINGS = 500;  // of the tube: more cannot be told apart on a screen
const SIDES = 12, HOLE_SIDES = 24;  // corners of the cross-sections of string and hole
const WALL_WIDER = 1.03;  // than the hole: surfaces that coincide would flicker; and the corners lie on this circle
const POINTS = 3000;  // of a line of a history
const AHEAD = 6;    // frames that are read before they are played
const TRACKED = 100; // ms between two drawings of the tracks while frames are played: nobody reads a curve faster
const KEPT = 400;   // frames in memory
const LINES = ["#2f7bc4", "#d9662f", "#3f9a55", "#9a6cc0", "#a88532", "#c9507f"];
const DISTANCE = "distance_from_centre [m]", BENT = 0.02;  // of its length: a string without a hole that moves farther is shown as it lies
const PREFERRED = {
  colour: ["effective_tension [N]", "axial_force [N]", "annulus_pressure [Pa]", "internal_pressure [Pa]"],
  tracks: ["effective_tension [N]", "axial_force [N]", "torque [N m]", "contact_force [N/m]", DISTANCE, "annulus_pressure [Pa]", "internal_pressure [Pa]"],
};

const state = {
  series: "", rows: 0, hole: "", columns: {}, panels: [], times: [], fields: {}, wall: null, status: {}, first: true,
  frames: new Map(), wanted: new Map(), shown: -1, now: null, view: "straight", scale: null, range: null, colour: null,
  tracks: null, histories: null, playing: false, tracked: 0,
  reach: null, reached: 0,  // of a bent string, and the number of frames that it is of
  picked: { tracks: false, histories: false },  // by the reader, not by the page
};

// ---------------------------------------------------------------- where the numbers come from
const embedded = byId("data") ? JSON.parse(byId("data").textContent) : null;
const token = new URLSearchParams(location.search).get("token") || "";

function numbers(text, Kind = Float32Array) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return new Kind(bytes.buffer);
}

async function ask(what, values) {
  let answer;
  try { answer = await fetch(`api/${what}?${new URLSearchParams(values)}`, { headers: { "X-Token": token } }); } catch {
    throw new Error("the server does not answer: drillpetsc serve has ended");
  }
  const found = await answer.json();
  if (!answer.ok) throw new Error(found.error);
  return found;
}

const news = () => embedded ? embedded.news : ask("news", { series: state.series, rows: state.rows, hole: state.hole });

function frame(k) {
  if (state.frames.has(k)) return Promise.resolve(state.frames.get(k));
  if (!state.wanted.has(k)) {
    const series = state.series;
    const found = embedded ? Promise.resolve(embedded.frames[k]) : ask("frame", { number: k });
    state.wanted.set(k, found.then((answer) => {
      const arrays = {};
      for (const [name, text] of Object.entries(answer.arrays)) arrays[name] = numbers(embedded ? embedded.arrays[text] : text);
      if (series === state.series) {
        state.frames.set(k, arrays);
        if (state.frames.size > KEPT) state.frames.delete(state.frames.keys().next().value);
      }
      return arrays;
    }).finally(() => state.wanted.delete(k)));
  }
  return state.wanted.get(k);
}

function joined(a, b) {
  const out = new b.constructor(a.length + b.length);
  out.set(a); out.set(b, a.length);
  return out;
}

// ---------------------------------------------------------------- news
async function poll() {
  let found;
  try { found = await news(); } catch (error) {
    say({ word: "failed", text: error.message }, []);
    return 3000;
  }
  const anew = found.series !== state.series;
  if (anew) Object.assign(state, { rows: 0, columns: {}, frames: new Map(), wanted: new Map(), shown: -1, now: null, reach: null, reached: 0, series: found.series });
  const more = found.rows > state.rows || anew;
  if (found.first === state.rows || anew) {
    for (const [title, text] of Object.entries(found.columns)) {
      const values = numbers(text, title === Object.keys(found.columns)[0] ? Float64Array : Float32Array);
      state.columns[title] = found.first && state.columns[title] ? joined(state.columns[title], values) : values;
    }
    state.rows = found.rows;
  }
  const wider = JSON.stringify(state.fields) !== JSON.stringify(found.fields);
  const holeNew = found.hole !== state.hole;
  if (found.wall) state.wall = Object.fromEntries(Object.entries(found.wall).map(([name, text]) => [name, numbers(text)]));
  if (!found.hole) state.wall = null;
  Object.assign(state, { panels: found.panels, times: found.times, fields: found.fields, hole: found.hole, status: found.status,
    depth: found.depth, lateral: found.lateral, perDepth: found.lateral_per_depth });
  byId("title").textContent = document.title = found.title;
  byId("folder").textContent = embedded ? "" : found.folder;
  say(found.status, found.notes);
  await lay_out(anew, more, wider || holeNew);
  state.first = false;
  return found.more ? 0 : found.status.word === "running" ? 700 : 2500;
}

function say(status, notes) {
  const box = byId("status");
  box.textContent = embedded ? "" : status.text;
  box.className = `status ${status.word}`;
  box.hidden = Boolean(embedded);
  byId("notes").replaceChildren(...notes.map((text) => Object.assign(document.createElement("li"), { textContent: text })));
  byId("notes").hidden = !notes.length;
}

async function lay_out(anew, more, changed) {
  const frames = state.times.length, rows = state.rows;
  byId("empty").hidden = Boolean(frames || rows);
  byId("empty").textContent = { missing: "Nothing to show: the folder is gone. The page goes on when it is back.",
    done: "This folder has no histories and no frames of the string. drillpetsc report shows what it has." }[state.status.word]
    || "Nothing to show yet. The page fills as soon as a run writes here.";
  const appeared = byId("scene-panel").hidden === Boolean(frames) || byId("histories-panel").hidden === Boolean(rows);
  byId("controls").hidden = !frames && !rows;
  for (const id of ["scene-panel", "tracks-panel"]) byId(id).hidden = !frames;
  byId("histories-panel").hidden = byId("pick-panels").hidden = !rows;
  byId("player").hidden = frames < 2;
  byId("main").style.gridTemplateColumns = frames && rows ? "" : frames ? "minmax(0, 1fr) minmax(0, 1fr)" : "minmax(0, 1fr)";
  byId("follow-label").hidden = state.status.word !== "running";
  byId("slider").max = Math.max(frames - 1, 0);
  if (rows && (more || appeared)) await draw_histories(anew || appeared);
  if (!frames) return;
  const whole = [anew, appeared, changed, choose_fields()].some(Boolean);
  const follows = state.status.word === "running" && byId("follow").checked && !state.playing;
  const k = state.shown < 0 || follows ? frames - 1 : Math.min(state.shown, frames - 1);
  if (whole || k !== state.shown) await show(k, whole);
}

// ---------------------------------------------------------------- what may be chosen
const option = (value, text) => Object.assign(document.createElement("option"), { value, textContent: text });
const named = (field) => { const f = state.fields[field]; return f.unit ? `${f.label} [${f.unit}]` : f.label; };

function choose_fields() {  // whether the tracks are others than before
  let again = false;
  const names = Object.keys(state.fields);
  const varies = (name) => state.fields[name].high > state.fields[name].low;
  if (!(state.colour in state.fields)) state.colour = PREFERRED.colour.find((name) => name in state.fields) || names[0] || null;
  state.tracks = (state.tracks || []).filter((name) => name in state.fields);
  if (!state.picked.tracks || !state.tracks.length) {
    const before = String(state.tracks), found = PREFERRED.tracks.filter((name) => name in state.fields && varies(name));
    if (found[0] === PREFERRED.tracks[0] && found[1] === PREFERRED.tracks[1]) found.splice(1, 1);
    if (found.length < 3) found.push(...names.filter((name) => varies(name) && !found.includes(name)));
    state.tracks = (found.length ? found : names).slice(0, window.innerWidth < 640 ? 3 : window.innerWidth < 1200 ? 4 : 5);
    again = before !== String(state.tracks);
  }
  if (String(names) !== byId("colour").now) byId("colour").replaceChildren(...names.map((name) => option(name, named(name))));
  byId("colour").now = String(names);
  byId("colour").value = state.colour;
  byId("depth-unit").textContent = state.depth;
  pick_boxes();
  return again;
}

function boxes(id, entries, chosen, change) {
  const now = JSON.stringify([entries, chosen]);
  if (byId(id).now === now) return;  // else a box would move away under the mouse
  byId(id).now = now;
  byId(id).lastElementChild.replaceChildren(...entries.map(([key, text]) => {
    const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: chosen.includes(key) });
    box.onchange = () => change(entries.map(([name]) => name).filter((name) => name === key ? box.checked : chosen.includes(name)));
    const label = document.createElement("label");
    label.append(box, text);
    return label;
  }));
}

function pick_boxes() {
  byId("pick-tracks").hidden = !state.times.length;
  boxes("pick-tracks", Object.keys(state.fields).map((name) => [name, named(name)]), state.tracks, (chosen) => {
    if (chosen.length) { state.tracks = chosen; state.picked.tracks = true; pick_boxes(); show(state.shown, true); }
  });
}

// ---------------------------------------------------------------- look
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const axis = (more) => ({ gridcolor: css("--grid"), zerolinecolor: css("--grid"), linecolor: css("--line"), tickfont: { size: 11 }, tickangle: 0, exponentformat: "none", ...more });
const look = (more) => ({ separators: ".\u202f", paper_bgcolor: css("--paper"), plot_bgcolor: css("--paper"), font: { color: css("--ink"), size: 12 }, showlegend: false, uirevision: "kept", ...more });
const CONFIG = { plotGlPixelRatio: window.devicePixelRatio, displaylogo: false, displayModeBar: false };

function colours(name) {
  const { low, high } = state.fields[name];
  const ends = high > low ? [low, high] : [low - 1, high + 1];
  const span = ends[1] - ends[0], zero = -ends[0] / span;
  if (ends[0] < 0 && ends[1] > 0 && Math.min(-ends[0], ends[1]) > 1e-3 * span) {  // red: below zero, as in the pictures
    return { ends, scale: [[0, "#b40426"], [zero / 2, "#f08a6c"], [zero, "#dddddd"], [(1 + zero) / 2, "#7b9ff9"], [1, "#3b4cc0"]] };
  }
  return { ends, scale: "Viridis" };
}

function widened(low, high) {
  const pad = 0.04 * (high - low) || Math.max(Math.abs(high) * 1e-3, 1e-6);
  return [low - pad, high + pad];
}

// ---------------------------------------------------------------- the string in its hole
function bounds(md) {
  const [top, bottom] = [md[0], md[md.length - 1]];
  return state.range ? [Math.max(state.range[0], top), Math.min(state.range[1], bottom)] : [top, bottom];
}

function rings(md, low, high) {  // numbers of the nodes in the interval, at most RINGS of them, and one more on each side
  let a = 0, b = md.length - 1;
  while (a < b && md[a + 1] <= low) a++;
  while (b > a && md[b - 1] >= high) b--;
  const count = Math.min(b - a + 1, RINGS);
  return Int32Array.from({ length: count }, (_, i) => a + Math.round(i * (b - a) / Math.max(count - 1, 1)));
}

function sweep(path, radius, straight, sides = SIDES) {  // corners of a tube around a path [x[], y[], z[]]
  const n = radius.length, x = new Float32Array(n * sides), y = new Float32Array(n * sides), z = new Float32Array(n * sides);
  let e = [1, 0, 0];
  for (let i = 0; i < n; i++) {
    let f = [0, 1, 0];
    if (!straight) {
      const a = Math.max(i - 1, 0), b = Math.min(i + 1, n - 1);
      let t = path.map((p) => p[b] - p[a]);
      const size = Math.hypot(...t) || 1;
      t = t.map((v) => v / size);
      if (i === 0 && Math.abs(t[0]) > 0.9) e = [0, 1, 0];
      const along = e[0] * t[0] + e[1] * t[1] + e[2] * t[2];
      e = e.map((v, j) => v - along * t[j]);
      const length = Math.hypot(...e) || 1;
      e = e.map((v) => v / length);
      f = [t[1] * e[2] - t[2] * e[1], t[2] * e[0] - t[0] * e[2], t[0] * e[1] - t[1] * e[0]];
    }
    for (let j = 0; j < sides; j++) {
      const angle = 2 * Math.PI * j / sides, c = radius[i] * Math.cos(angle), s = radius[i] * Math.sin(angle), q = i * sides + j;
      x[q] = path[0][i] + c * e[0] + s * f[0]; y[q] = path[1][i] + c * e[1] + s * f[1]; z[q] = path[2][i] + c * e[2] + s * f[2];
    }
  }
  return { x, y, z };
}

function faces(n, sides = SIDES) {
  const i = [], j = [], k = [];
  for (let r = 0; r < n - 1; r++) {
    for (let s = 0; s < sides; s++) {
      const a = r * sides + s, b = r * sides + (s + 1) % sides;
      i.push(a, b); j.push(b, b + sides); k.push(a + sides, a + sides);
    }
  }
  return { i, j, k };
}

function half_width(now, at) {  // largest sideways distance [lateral unit]
  let most = 0;
  const hole = state.wall ? now.hole : null;
  for (const i of at) most = Math.max(most, hole ? hole[i] : Math.hypot(now.ox[i], now.oy[i]) + (now.radius ? now.radius[i] : 0));
  return most || 1;
}

const WIDE = 0.36;  // of the straightened hole, in parts of its height
function automatic_scale(now, at, low, high) {
  const half = half_width(now, at) / state.perDepth;  // [depth unit]
  const raw = state.view === "straight" ? 0.5 * WIDE * (high - low) / (1.12 * half) : 0.012 * (high - low) / half;
  const digits = 10 ** (Math.floor(Math.log10(raw)) - 1), round = Math.floor(raw / digits) * digits;
  return state.view === "straight" ? round : Math.max(round, 1);
}

function tubes(now) {  // string and hole for Plotly, and the ranges of the axes of the straightened view
  const [low, high] = bounds(now.md), at = rings(now.md, low, high), straight = state.view === "straight";
  const scale = state.scale || automatic_scale(now, at, low, high), pick = (values, factor = 1) => Float32Array.from(at, (i) => values[i] * factor);
  const thin = state.view === "straight" ? half_width(now, at) / 20 : 0.01 * (high - low) * state.perDepth / scale;  // of a beam without a diameter
  const radius = now.radius && now.radius.some((r) => r > 0) ? pick(now.radius) : new Float32Array(at.length).fill(thin);
  const values = now[`f:${state.colour}`], intensity = new Float32Array(at.length * SIDES);
  for (let r = 0; r < at.length; r++) intensity.fill(values ? values[at[r]] : 0, r * SIDES, (r + 1) * SIDES);
  const toDepth = scale / state.perDepth;
  const string = straight ? sweep([pick(now.oy), pick(now.ox), pick(now.md)], radius, true)
    : sweep([1, 0, 2].map((k) => Float32Array.from(at, (i) => now[`c${k}`][i] + scale * now[`l${k}`][i])), radius.map((r) => r * toDepth), false);
  let hole = null;
  if (state.wall) {
    const w = state.wall, all = rings(w.md, low, high), differs = (i, j) => w.radius[i] !== w.radius[j];
    const inside = straight ? all.filter((i, n) => n === 0 || n === all.length - 1 || differs(i, all[n - 1]) || differs(i, all[n + 1])) : all;
    const take = (values2) => Float32Array.from(inside, (i) => values2[i]);
    const wide = take(w.radius).map((r) => r * WALL_WIDER);
    hole = straight ? sweep([new Float32Array(inside.length), new Float32Array(inside.length), take(w.md).map((v) => Math.min(Math.max(v, low), high))], wide, true, HOLE_SIDES)
      : sweep([take(w.c1), take(w.c0), take(w.c2)], wide.map((r) => r * toDepth), false, HOLE_SIDES);
    hole.count = inside.length;
  }
  return { string: { ...string, intensity, count: at.length }, hole, low, high, scale, at };
}

function true_box(string, hole, axis_of) {  // the same scale in all directions, and a box that is never flat
  const ends = string.map((values, k) => {
    const all = hole ? [values, hole["xyz"[k]]] : [values];
    return [Math.min(...all.map((v) => Math.min(...v))), Math.max(...all.map((v) => Math.max(...v)))];
  }).map(([a, b], k) => state.reach ? [Math.min(a, state.reach[k][0]), Math.max(b, state.reach[k][1])] : [a, b]);
  const most = Math.max(...ends.map(([a, b]) => b - a)) || 1, ratio = {}, axes = {}, box = byId("string");
  const spans = ends.map(([a, b]) => Math.max(b - a, 0.2 * most)), wide = Math.hypot(spans[0], spans[1]) * box.clientHeight / box.clientWidth;
  const whole = Math.max(spans[2], 0.9 * wide);  // fits the panel in both directions
  ["east", "north", "depth"].forEach((title, k) => {
    const [a, b] = ends[k], half = 0.5 * Math.max(b - a, 0.2 * most), middle = 0.5 * (a + b);
    ratio["xyz"[k]] = 2 * half / whole * 1.5;
    axes[`${"xyz"[k]}axis`] = axis_of(title, k < 2 ? [middle - half, middle + half] : [middle + half, middle - half]);
  });
  return { aspectratio: ratio, ...axes };
}

async function draw_scene(now, whole) {
  const made = tubes(now), { ends, scale } = colours(state.colour), straight = state.view === "straight";
  const { x, y, z, intensity, count } = made.string;
  state.count = state.count || 0;
  if (!whole && count === state.count) {
    await Plotly.restyle("string", { x: [x], y: [y], z: [z], intensity: [intensity] }, [0]);
    return;
  }
  state.count = count;
  const lighting = { ambient: 0.75, diffuse: 0.5, specular: 0.1, roughness: 0.7 };
  const traces = [{ type: "mesh3d", x, y, z, intensity, ...faces(count), cmin: ends[0], cmax: ends[1], colorscale: scale, lighting, hoverinfo: "skip",
    colorbar: { title: { text: named(state.colour), side: "right", font: { size: 11 } }, thickness: 12, len: 0.7, x: 1, xpad: 2, tickfont: { size: 11 }, exponentformat: "none" } }];
  if (made.hole) {
    const { count: n, ...corners } = made.hole;
    traces.push({ type: "mesh3d", ...corners, ...faces(n, HOLE_SIDES), color: css("--wall"), opacity: 0.16, hoverinfo: "skip", lighting: { ambient: 0.9 } });
  }
  const span = made.high - made.low, half = 0.5 * WIDE * span / made.scale * state.perDepth;
  const ax = (title, more) => axis({ title: { text: title, font: { size: 11 } }, backgroundcolor: css("--paper"), showbackground: false, showspikes: false, ...more });
  const box = byId("string"), tall = 1.7 * Math.min(1, box.clientWidth / box.clientHeight / 0.66);  // in a narrow panel with space for the depths
  const scene = straight ? {
    aspectmode: "manual", aspectratio: { x: tall * WIDE, y: tall * WIDE, z: tall },
    xaxis: ax(`right [${state.lateral}]`, { range: [-half, half], nticks: 4 }), yaxis: ax(`high side [${state.lateral}]`, { range: [-half, half], nticks: 4 }),
    zaxis: ax("", { range: [made.high, made.low], nticks: 8 }),
  } : {
    aspectmode: "manual", ...true_box([x, y, z], made.hole, (title, range) => ax(`${title} [${state.depth}]`, { range, nticks: 5 })),
  };
  const eye = straight ? { x: 1.35, y: -1.35, z: 0.35 } : { x: 1.2, y: -1.5, z: 0.5 };
  Object.assign(scene, { camera: { eye, projection: { type: "orthographic" } }, uirevision: state.view, dragmode: "turntable" });
  await Plotly.react("string", traces, look({ margin: { l: 0, r: 0, t: 0, b: 0 }, scene, uirevision: state.view }), CONFIG);
  byId("caption").textContent = `${straight ? "measured depth" : "east, north, depth"} in ${state.depth}; ` +
    (Math.abs(made.scale - 1) > 1e-4 ? `sideways lengths drawn ${format(made.scale)} times larger` : "true scale");
  byId("scale").value = format(made.scale);
  const shown = state.range || [now.md[0], now.md[now.md.length - 1]];
  byId("from").value = format(shown[0]); byId("to").value = format(shown[1]);
}

const format = (value) => String(Number(value.toPrecision(5)));

// ---------------------------------------------------------------- depth tracks
async function draw_tracks(now, whole) {
  const [low, high] = bounds(now.md), values = state.tracks.map((name) => now[`f:${name}`] || new Float32Array(now.md.length));
  if (!whole) {
    await Plotly.restyle("tracks", { x: values, y: state.tracks.map(() => now.md) });
    return;
  }
  const n = state.tracks.length, letters = Math.max(Math.floor((byId("tracks").clientWidth - 70) / n / 7), 7), layout = look({ margin: { l: 62, r: 8, t: 86, b: 8 }, dragmode: "zoom", hovermode: "closest",
    yaxis: axis({ range: [high, low], title: { text: `measured depth [${state.depth}]` }, nticks: 12 }), annotations: [] });
  const traces = state.tracks.map((name, k) => {
    const f = state.fields[name], id = k ? k + 1 : "", left = k / n, right = (k + 1) / n - (n > 1 ? 0.03 : 0);
    layout[`xaxis${id}`] = axis({ domain: [left, right], range: widened(f.low, f.high), side: "top", nticks: letters > 13 ? 4 : 3, zeroline: f.low < 0 && f.high > 0, zerolinecolor: css("--soft") });
    layout.annotations.push({ text: wrapped(f.label, letters) + (f.unit && `<br>[${f.unit}]`), x: (left + right) / 2, xref: "paper", y: 1, yref: "paper", yshift: 20, xanchor: "center", yanchor: "bottom", showarrow: false, font: { size: 11, color: LINES[k % LINES.length] } });
    return { x: values[k], y: now.md, xaxis: `x${id}`, yaxis: "y", mode: "lines", line: { color: LINES[k % LINES.length], width: 1.5 }, name: f.label, hovertemplate: `%{x:.5g} ${f.unit}<br>%{y:.6g} ${state.depth}<extra></extra>` };
  });
  await Plotly.react("tracks", traces, layout, CONFIG);
  if (!byId("tracks").linked) {  // zooming the tracks zooms the scene
    byId("tracks").linked = true;
    byId("tracks").on("plotly_relayout", (change) => {
      if ("yaxis.range[0]" in change) zoom([change["yaxis.range[1]"], change["yaxis.range[0]"]]);
      else if (change["yaxis.autorange"]) zoom(null);
    });
  }
}

const wrapped = (text, width) => text.split(" ").reduce((lines, word) => {
  const last = lines[lines.length - 1];
  if (last && (last + " " + word).length <= width) lines[lines.length - 1] = `${last} ${word}`; else lines.push(word);
  return lines;
}, []).join("<br>");

function zoom(range) {
  state.range = range && range[1] > range[0] ? range : null;
  state.scale = null;
  show(state.shown, true);
}

// ---------------------------------------------------------------- histories
function thinned(x, y) {  // smallest and largest value of each interval: no peak is lost
  const each = Math.floor(x.length / (POINTS / 2));
  if (each < 3) return [x, y];
  const kept = [];
  for (let a = 0; a < x.length; a += each) {
    let low = a, high = a;
    for (let i = a; i < Math.min(a + each, x.length); i++) { if (y[i] < y[low]) low = i; if (y[i] > y[high]) high = i; }
    kept.push(Math.min(low, high));
    if (low !== high) kept.push(Math.max(low, high));
  }
  if (kept[kept.length - 1] !== x.length - 1) kept.push(x.length - 1);
  return [Float64Array.from(kept, (i) => x[i]), Float32Array.from(kept, (i) => y[i])];
}

function chosen_panels() {
  const key = (panel) => Object.keys(panel.of)[0];
  if (!state.picked.histories) {
    const varies = (values) => values && values.some((v) => Math.abs(v - values[0]) > 1e-6 * Math.abs(values[0]));
    const operation = state.panels.filter((panel) => !panel.numerics);
    const found = operation.filter((panel) => Object.keys(panel.of).some((title) => varies(state.columns[title])));
    state.histories = (found.length ? found : operation).slice(0, 5).map(key);
  }
  return state.panels.filter((panel) => state.histories.includes(key(panel)));
}

async function draw_histories(whole) {
  const before = String(state.histories), panels = chosen_panels(), time = state.columns[Object.keys(state.columns)[0]];
  const traces = [], n = panels.length;
  const layout = look({ margin: { l: 62, r: 12, t: 0, b: 38 }, dragmode: "zoom", hovermode: "closest", annotations: [] });
  panels.forEach((panel, p) => {
    const id = p ? p + 1 : "", bottom = Math.max(1 - (p + 1) / n, 0), top = 1 - p / n - 22 / byId("histories").clientHeight - 0.1 / n;
    layout[`yaxis${id}`] = axis({ domain: [bottom, top], nticks: 5, anchor: "x" });
    layout.annotations.push({ text: Object.values(panel.of).map((label, k) => `<span style="color:${LINES[k % LINES.length]}">${label}</span>`).join("   ") + (panel.unit && ` [${panel.unit}]`),
      x: 0, xref: "paper", xanchor: "left", y: top, yref: "paper", yanchor: "bottom", showarrow: false, font: { size: 11 } });
    Object.entries(panel.of).forEach(([title, label], k) => {
      const [x, y] = thinned(time, state.columns[title]);
      traces.push({ x, y, xaxis: "x", yaxis: `y${id}`, mode: "lines", line: { color: LINES[k % LINES.length], width: 1.3 }, name: label, hovertemplate: `${label}: %{y:.6g} ${panel.unit}<br>%{x:.6g} s<extra></extra>` });
    });
  });
  layout.xaxis = axis({ title: { text: "time [s]" }, anchor: `y${n > 1 ? n : ""}`, nticks: 8 });
  await Plotly.react("histories", traces, layout, CONFIG);
  if (whole || before !== String(state.histories)) {
    boxes("pick-panels", state.panels.map((panel) => [Object.keys(panel.of)[0], Object.values(panel.of).join(", ")]), state.histories || [], (chosen) => {
      if (chosen.length) { state.histories = chosen; state.picked.histories = true; draw_histories(true); }
    });
  }
  if (!byId("histories").linked) {  // a click goes to its time
    byId("histories").linked = true;
    byId("histories").on("plotly_click", (event) => show(nearest(event.points[0].x)));
    byId("histories").on("plotly_relayout", place_cursor);
  }
  place_cursor();
}

function nearest(time) {
  let best = 0;
  state.times.forEach((t, k) => { if (Math.abs(t - time) < Math.abs(state.times[best] - time)) best = k; });
  return best;
}

function place_cursor() {
  const drawn = byId("histories")._fullLayout, cursor = byId("cursor"), time = state.times[state.shown];
  const left = drawn && drawn.xaxis && time !== undefined ? drawn.xaxis.l2p(time) : NaN;
  cursor.hidden = !(left >= 0 && left <= drawn.xaxis._length);
  if (cursor.hidden) return;
  cursor.style.left = `${drawn._size.l + left}px`;
  cursor.style.top = `${drawn._size.t}px`;
  cursor.style.height = `${drawn._size.h}px`;
}

// ---------------------------------------------------------------- time
let pending = null, drawing = null;
function show(k, whole = false) {  // one drawing after the other; of those that wait, the last one
  pending = { k, whole: whole || Boolean(pending && pending.whole) };
  drawing = drawing || (async () => {
    while (pending) {
      const next = pending;
      pending = null;
      try { await show_now(next.k, next.whole); } catch (error) { say({ word: "failed", text: String(error.message || error) }, []); }
    }
    drawing = null;
  })();
  return drawing;
}

async function show_now(k, whole) {
  if (k < 0 || k >= state.times.length) return;
  let now = null;
  while (!now) {
    try { now = await frame(k); } catch (error) {  // damaged: at the start an earlier one is shown
      if (state.shown >= 0 || k === 0) throw error;
      k--;
    }
  }
  const bent = !state.wall && DISTANCE in state.fields && state.fields[DISTANCE].high > BENT * state.perDepth * (now.md[now.md.length - 1] - now.md[0]);
  if (bent && !state.now && state.view === "straight") set_view("true");
  if (bent && state.reached !== state.times.length) [state.reach, state.reached, whole] = [await reach(), state.times.length, true];
  whole = whole || !state.now || state.now.md.length !== now.md.length;
  Object.assign(state, { shown: k, now });
  byId("slider").value = k;
  byId("time").textContent = `${Number(state.times[k].toPrecision(6))} s`;
  const tracks = whole || !state.playing || performance.now() - state.tracked > TRACKED;
  if (tracks) state.tracked = performance.now();
  await Promise.all([draw_scene(now, whole), tracks && draw_tracks(now, whole)]);
  place_cursor();
  for (let i = 1; i <= (state.playing ? AHEAD : 1); i++) if (k + i < state.times.length) frame(k + i).catch(() => {});
}

async function reach() {  // east, north and depth that a string without a hole passes, from some of its frames
  const step = Math.max(Math.ceil(state.times.length / 60), 1), ends = [1, 0, 2].map(() => [Infinity, -Infinity]);
  for (let k = 0; k < state.times.length; k += step) {
    const now = await frame(k);
    [1, 0, 2].forEach((j, n) => now.md.forEach((_, i) => {
      const at = now[`c${j}`][i] + now[`l${j}`][i];
      ends[n] = [Math.min(ends[n][0], at), Math.max(ends[n][1], at)];
    }));
  }
  return ends;
}

async function play() {
  state.playing = !state.playing;
  byId("play").innerHTML = state.playing ? "&#10074;&#10074;" : "&#9654;";
  byId("play").setAttribute("aria-label", state.playing ? "pause" : "play");
  if (!state.playing) return show(state.shown);
  if (state.shown >= state.times.length - 1) await show(0);
  let due = performance.now();
  while (state.playing && state.shown < state.times.length - 1) {
    const each = 1000 / Number(byId("speed").value);
    await new Promise(requestAnimationFrame);
    const late = Math.floor((performance.now() - due) / each);
    if (late < 1) continue;
    due += late * each;
    await show(Math.min(state.shown + late, state.times.length - 1));  // a slow machine leaves frames out
  }
  if (state.playing) play();
}

function set_view(which) {
  Object.assign(state, { view: which, scale: null });
  for (const id of ["straight", "true"]) byId(id).classList.toggle("on", id === which);
}

function view(which) {
  set_view(which);
  if (state.shown >= 0) show(state.shown, true);
}

// ---------------------------------------------------------------- start
byId("play").onclick = play;
byId("slider").oninput = () => { byId("follow").checked = false; show(Number(byId("slider").value)); };
byId("straight").onclick = () => view("straight");
byId("true").onclick = () => view("true");
byId("colour").onchange = () => { state.colour = byId("colour").value; show(state.shown, true); };
byId("scale").onchange = () => { state.scale = Number(byId("scale").value) || null; show(state.shown, true); };
byId("from").onchange = byId("to").onchange = () => zoom([Number(byId("from").value), Number(byId("to").value)]);
byId("whole").onclick = () => zoom(null);
document.addEventListener("keydown", (event) => {
  if (["INPUT", "SELECT", "BUTTON", "SUMMARY"].includes(event.target.tagName)) return;
  if (event.key === " ") { event.preventDefault(); play(); }
  if (event.key === "ArrowRight") show(Math.min(state.shown + 1, state.times.length - 1));
  if (event.key === "ArrowLeft") show(Math.max(state.shown - 1, 0));
});
document.addEventListener("click", (event) => {
  for (const box of document.querySelectorAll("details.pick[open]")) if (!box.contains(event.target)) box.open = false;
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { draw_histories(true); show(state.shown, true); });
const resized = new ResizeObserver((entries) => {
  for (const { target } of entries) if (target.data && target.clientHeight) Plotly.Plots.resize(target);
  place_cursor();
});
for (const id of ["string", "tracks", "histories"]) resized.observe(byId(id));
view("straight");

(async function live() {
  const wait = await poll().catch((error) => { say({ word: "failed", text: String(error.message || error) }, []); console.error(error); return 3000; });
  if (!embedded) setTimeout(live, wait);
})();
