"use strict";
// The form of a case. The server edits the text and checks it; the page shows both, and saves only on request.

const byId = (id) => document.getElementById(id);
const token = new URLSearchParams(location.search).get("token") || "";
const WAIT = 500;  // ms after the last key before the text is checked
const state = { digest: "", saved: "", text: "", answer: null, number: 0, timer: 0, before: [] };

async function ask(what, values) {
  const options = values ? { method: "POST", body: JSON.stringify(values) } : {};
  let answer;
  try { answer = await fetch(`api/${what}`, { ...options, headers: { "X-Token": token } }); } catch {
    throw new Error("the server does not answer: drillpetsc serve has ended");
  }
  const found = await answer.json();
  if (!answer.ok) throw new Error(found.error);
  return found;
}

function element(tag, values = {}, ...children) {
  const made = Object.assign(document.createElement(tag), values);
  made.append(...children);
  return made;
}

function say(text) {
  byId("message").textContent = text;
  byId("message").hidden = !text;
}

async function ask_and_show(what, values) {  // answers to an older text are left out
  const number = ++state.number;
  byId("status").textContent = "checking";
  byId("status").className = "status";
  try {
    const found = await ask(what, values);
    if (number === state.number) { say(""); show(found); }
  } catch (error) {
    if (number === state.number) { say(error.message); if (state.answer) show(state.answer); }
  }
}

function change(at, value) {
  state.before.push(state.text);
  return ask_and_show("edit", value === null ? { text: state.text, at } : { text: state.text, at, value });
}

// ---------------------------------------------------------------- what is shown
function show(answer) {
  Object.assign(state, { answer, text: answer.text });
  if (answer.digest) Object.assign(state, { digest: answer.digest, saved: answer.text, before: [] });
  if (byId("text").value !== answer.text) byId("text").value = answer.text;
  const count = answer.errors.length, changed = state.text !== state.saved;
  byId("status").textContent = count ? `${count} ${count > 1 ? "errors" : "error"}` : "valid";
  byId("status").className = `status ${count ? "failed" : "done"}`;
  document.title = `${changed ? "* " : ""}${byId("title").textContent}`;
  byId("save").disabled = !changed;
  byId("undo").disabled = !state.before.length;
  byId("report").textContent = answer.report;
  byId("errors").replaceChildren(...answer.errors.map((error) => element("li", {}, link(error), explained(error))));
  if (answer.form.length || !count) draw_form(answer);
}

function explained(error) {
  const lines = [error.got && `given: ${error.got}`, `allowed: ${error.want}`, error.hint && `hint: ${error.hint}`].filter(Boolean);
  return element("div", { className: "error" }, ...lines.map((text) => element("div", { textContent: text })));
}

function link(error) {
  const button = element("button", { textContent: (error.at || "the file") + (error.line ? `, line ${error.line}` : "") });
  button.onclick = () => {
    const field = document.querySelector(`[data-at="${CSS.escape(error.at)}"]`);
    for (let box = field; box; box = box.parentElement) if (box.tagName === "DETAILS") box.open = true;
    if (field) field.scrollIntoView({ block: "center" });
    if (error.line) go_to_line(error.line);
  };
  return button;
}

function go_to_line(line) {
  const lines = state.text.split("\n"), start = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
  byId("text").focus();
  byId("text").setSelectionRange(start, start + (lines[line - 1] || "").length);
  byId("text").scrollTop = (line - 4) * byId("text").scrollHeight / lines.length;
}

function draw_form(answer) {
  const open = new Set([...document.querySelectorAll("#form details[open]")].map((box) => box.dataset.at));
  const focused = document.activeElement && document.activeElement.dataset.at;
  const top = byId("form").scrollTop;
  const ats = [];
  (function all(parts) { for (const part of parts) { ats.push(part.at); all(part.parts || []); } })(answer.form);
  const home = (at) => {  // the nearest key that the form has
    while (at && !ats.includes(at)) at = at.slice(0, Math.max(at.lastIndexOf("."), at.lastIndexOf("["), 0));
    return at;
  };
  const errors = new Map();
  for (const error of answer.errors) errors.set(home(error.at), [...(errors.get(home(error.at)) || []), error]);
  const inside = (at) => [...errors.keys()].some((key) => key.startsWith(at) && key !== at);
  const drawn = (part) => part.parts ? block(part) : field(part);
  const faults = (at) => (errors.get(at) || []).map((error) => element("div", { className: "fault" },
    error.at === at ? "" : element("b", { textContent: error.at }), explained(error)));

  function block(part) {
    const box = element("details", { open: open.has(part.at) || inside(part.at) || errors.has(part.at) },
      element("summary", { title: part.about }, element("b", { textContent: part.key }), remove(part)),
      element("p", { className: "about", textContent: part.about }), ...faults(part.at), ...part.parts.map(drawn), adder(part.at, part.absent));
    box.dataset.at = part.at;
    return box;
  }

  function field(part) {
    let input;
    if (part.choices.length) {
      const words = part.choices.includes(part.value) ? part.choices : [part.value, ...part.choices];
      input = element("select", {}, ...words.map((word) => element("option", { value: word, textContent: word })));
    } else input = element("input", { type: "text", autocomplete: "off" });
    input.value = part.value;
    input.dataset.at = part.at;
    input.onchange = () => change(part.at, input.value);
    if (errors.has(part.at)) input.setAttribute("aria-invalid", "true");
    const label = element("label", { className: "field" }, element("span", { textContent: part.key }), input);
    return element("div", { className: "row" }, label, remove(part), element("p", { className: "about", textContent: part.about }), ...faults(part.at));
  }

  byId("form").replaceChildren(...faults(""), ...answer.form.map(drawn), adder("", answer.absent));
  byId("form").scrollTop = top;
  const again = focused && document.querySelector(`input[data-at="${CSS.escape(focused)}"], select[data-at="${CSS.escape(focused)}"]`);
  if (again) again.focus();
}

function remove(part) {
  if (part.required) return "";
  const button = element("button", { className: "remove", textContent: "\u00d7", title: `remove ${part.key}` });
  button.setAttribute("aria-label", `remove ${part.key}`);
  button.onclick = (event) => { event.preventDefault(); change(part.at, null); };
  return button;
}

function adder(at, absent) {
  if (!absent.length) return "";
  const key = element("select", {}, element("option", { value: "", textContent: "add a key \u2026" }), ...absent.map((each) => element("option", { value: each.key, textContent: each.key })));
  const value = element("input", { type: "text", placeholder: "value", hidden: true }), button = element("button", { textContent: "Add", hidden: true });
  const about = element("p", { className: "about" });
  key.onchange = () => {
    const found = absent.find((each) => each.key === key.value);
    value.hidden = button.hidden = !found;
    about.textContent = found ? found.about + (found.choices.length ? ` (${found.choices.join(", ")})` : "") : "";
    value.value = found ? found.default : "";
  };
  button.onclick = () => change(at ? `${at}.${key.value}` : key.value, value.value);
  value.onkeydown = (event) => { if (event.key === "Enter") button.click(); };
  return element("div", { className: "adder" }, key, value, button, about);
}

// ---------------------------------------------------------------- start
byId("text").oninput = () => {
  clearTimeout(state.timer);
  state.timer = setTimeout(() => { state.before.push(state.text); ask_and_show("check", { text: byId("text").value }); }, WAIT);
};
byId("undo").onclick = () => ask_and_show("check", { text: state.before.pop() });
byId("reload").onclick = () => {
  if (state.text === state.saved || confirm("Leave the changes and load the file again?")) ask_and_show("open");
};
byId("save").onclick = async () => {
  const text = state.text;
  try {
    const { digest } = await ask("save", { text, digest: state.digest });
    show({ ...state.answer, text: state.text });
    Object.assign(state, { digest, saved: text });
    say("");
    show(state.answer);
    byId("status").textContent += ", saved";
  } catch (error) { say(error.message); }
};
window.addEventListener("beforeunload", (event) => { if (state.text !== state.saved) event.preventDefault(); });
document.addEventListener("keydown", (event) => {
  if ((event.ctrlKey || event.metaKey) && event.key === "s") { event.preventDefault(); byId("save").click(); }
});
ask_and_show("open");
