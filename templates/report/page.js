"use strict";
const KINDS = ["locations", "variables", "clocks"];

// Steps through runs. Without this script the page shows charts and the runs in words.
function enliven(root) {
  for (const data of root.querySelectorAll("script.run")) {
    const run = JSON.parse(data.textContent);
    if (run.states.length > 1) play(root, data.previousElementSibling, run);
  }
}

function play(root, player, run) {
  const last = run.states.length - 1;
  const slider = make("input", { type: "range", min: 0, max: last, value: 0, "aria-label": "step of the run" });
  const buttons = [["⇤", "to the start", () => 0], ["←", "back", (at) => at - 1], ["→", "on", (at) => at + 1], ["⇥", "to the end", () => last]]
    .map(([sign, name, target]) => {
      const button = make("button", { type: "button", title: name, "aria-label": name }, sign);
      button.addEventListener("click", () => show(target(Number(slider.value))));
      return button;
    });
  const controls = make("div", { class: "controls" });
  controls.append(...buttons, slider);
  const now = make("p", { class: "now", "aria-live": "polite" });
  const state = make("div", { class: "state" });
  const stage = make("div", { class: "stage" });
  const shown = new Set(Object.values(run.templates));
  const changing = {};
  for (const kind of KINDS)
    changing[kind] = Object.keys(run.states[0][kind]).filter((name) => run.states.some((state) => state[kind][name] !== run.states[0][kind][name]));
  for (const picture of root.querySelectorAll("main > section > .automaton"))
    if (shown.has(picture.dataset.template)) stage.append(picture.cloneNode(true));
  player.append(controls, now, stage, state);
  player.hidden = false;
  slider.addEventListener("input", () => show(Number(slider.value)));
  player.addEventListener("keydown", (event) => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (by === undefined || event.target === slider) return;
    event.preventDefault();
    show(Number(slider.value) + by);
  });
  show(last);

  function show(at) {
    at = Math.max(0, Math.min(last, at));
    slider.value = at;
    const [before, after] = [run.states[Math.max(0, at - 1)], run.states[at]];
    const loop = run.loop === null ? "" : at === run.loop ? " — the loop begins here" : at === last ? " — and again from step " + run.loop : "";
    slider.setAttribute("aria-valuetext", `step ${at} of ${last}`);
    now.textContent = `${at} of ${last}${after.time === "" ? "" : ", time " + after.time}: ${after.told}${loop}`;
    buttons.forEach((button, number) => (button.disabled = number < 2 ? at === 0 : at === last));
    state.replaceChildren(
      ...KINDS.filter((kind) => Object.keys(after[kind]).length > 0).map((kind) => table(kind, changing[kind], before[kind], after[kind])));
    light(after, at);
  }

  // While nothing moves, the automata that moved last stay; at the start those that move first.
  function light(after, at) {
    for (const old of stage.querySelectorAll(".here, .taken")) old.classList.remove("here", "taken");
    const moving = (state) => state.moved.length > 0;
    const state = run.states.slice(0, at + 1).findLast(moving) ?? run.states.find(moving);
    const moved = state === undefined ? [] : state.moved.map(([name]) => run.templates[name]);
    for (const figure of stage.children) {
      figure.hidden = !moved.includes(figure.dataset.template);
      const own = Object.entries(run.templates).filter(([, template]) => template === figure.dataset.template).map(([name]) => name);
      for (const name of own) mark(figure, "data-location", after.locations[name], "here");
      for (const [name, edge] of after.moved) if (own.includes(name)) mark(figure, "data-edge", edge, "taken");
    }
  }
}

function mark(figure, attribute, value, as) {
  for (const element of figure.querySelectorAll(`[${attribute}]`))
    if (element.getAttribute(attribute) === value) element.classList.add(as);
}

// What never changes in the run is only counted.
function table(kind, names, before, after) {
  const made = make("table", {});
  const others = Object.keys(after).length - names.length;
  made.append(make("caption", {}, others === 0 ? kind : `${kind} (${others} more stay as they are)`));
  for (const name of names) {
    const row = make("tr", kind !== "clocks" && before[name] !== after[name] ? { class: "new" } : {});
    row.append(make("td", {}, name), make("td", {}, after[name]));
    made.append(row);
  }
  return made;
}

function make(tag, attributes, text) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (text !== undefined) element.textContent = text;
  return element;
}
