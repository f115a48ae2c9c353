"use strict";
const KINDS = ["locations", "variables", "clocks"];
const FEW = 4;
const READABLE = 0.7; // the least scale of an automaton; a larger one is scrolled

// Steps through runs. Without this script the page shows charts and the runs in words.
async function enliven(root) {
  const players = [];
  for (const data of root.querySelectorAll("script.run")) {
    const run = await unpacked(data.textContent);
    if (run.times.length > 1) players.push(play(root, data.previousElementSibling, run));
  }
  root.addEventListener("keydown", (event) => stepByKey(event, players));
  for (const link of root.querySelectorAll("a[href$='-line']"))
    link.addEventListener("click", () => (root.querySelector(`[id="${CSS.escape(decodeURIComponent(link.hash.slice(1)))}"]`).closest("details").open = true));
}

// The arrow keys step through the run that is on the screen, from anywhere on the page.
function stepByKey(event, players) {
  const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (by === undefined || event.altKey || event.ctrlKey || event.metaKey || event.shiftKey) return;
  if (event.composedPath()[0].matches?.("input, textarea, select, .wide, pre")) return;
  const focused = players.find(({ player }) => player.contains(event.composedPath()[0]));
  const nearest = players.map((one) => [far(one.player.parentElement), one]).sort(([one], [other]) => one - other)[0]?.[1];
  const chosen = focused ?? nearest;
  if (chosen === undefined) return;
  event.preventDefault();
  chosen.step(by);
}

// How far a part of the page is from the middle of the screen.
function far(element) {
  const { top, bottom } = element.getBoundingClientRect();
  const middle = window.innerHeight / 2;
  return Math.max(0, top - middle, middle - bottom);
}

// A run is JSON, compressed, in base64.
async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).json();
}

// What a column holds in a state: its values stand with the state from which on they count.
function valueIn(column, at) {
  let [low, high] = [0, column.length - 1];
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (column[middle][0] <= at) low = middle;
    else high = middle - 1;
  }
  return column[low][1];
}

function play(root, player, run) {
  const last = run.times.length - 1;
  const slider = make("input", { type: "range", min: 0, max: last, value: 0, "aria-label": "step of the run" });
  const buttons = [["⇤", "to the start", () => 0], ["←", "previous step", (at) => at - 1], ["→", "next step", (at) => at + 1], ["⇥", "to the end", () => last]]
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
  for (const kind of KINDS) changing[kind] = Object.keys(run[kind]).filter((name) => run[kind][name].length > 1);
  const pictures = new Map();
  for (const picture of root.querySelectorAll("main > section > .automaton"))
    if (shown.has(picture.dataset.template)) pictures.set(picture.dataset.template, picture);
  const movers = Object.keys(run.templates).filter((name) => run.moved.some((edges) => edges.some(([mover]) => mover === name)));
  const figures = new Map();
  player.append(controls, now, stage, state);
  player.hidden = false;
  slider.addEventListener("input", () => show(Number(slider.value)));
  show(last);
  return { player, step: (by) => show(Number(slider.value) + by) };

  function show(at) {
    at = Math.max(0, Math.min(last, at));
    slider.value = at;
    const loop = run.loop === null ? "" : at === run.loop ? " — the loop begins here" : at === last ? " — and again from step " + run.loop : "";
    slider.setAttribute("aria-valuetext", `step ${at} of ${last}`);
    now.textContent = `${at} of ${last}${run.times[at] === "" ? "" : ", time " + run.times[at]}: ${run.descriptions[at]}${loop}`;
    buttons.forEach((button, number) => (button.disabled = number < 2 ? at === 0 : at === last));
    state.replaceChildren(
      ...KINDS.filter((kind) => Object.keys(run[kind]).length > 0).map((kind) => table(kind, changing[kind], run[kind], at)));
    light(at);
  }

  // An automaton for each process: of all that move in the run if they are few, else of those that moved last, or at the
  // start of those that move first.
  function light(at) {
    const moving = (edges) => edges.length > 0;
    const edges = run.moved.slice(0, at + 1).findLast(moving) ?? run.moved.find(moving) ?? [];
    const names = movers.length <= FEW ? movers : movers.filter((name) => edges.some(([mover]) => mover === name));
    stage.replaceChildren(...names.map(figureOf).filter((figure) => figure !== undefined));
    for (const old of stage.querySelectorAll(".here, .taken")) old.classList.remove("here", "taken");
    for (const name of names) {
      const figure = figureOf(name);
      if (figure === undefined) continue;
      const place = valueIn(run.locations[name], at);
      figure.querySelector("figcaption").replaceChildren(make("strong", {}, name), ` in ${place}`);
      mark(figure, "data-location", place, "here");
      for (const [mover, edge] of run.moved[at]) if (mover === name) mark(figure, "data-edge", edge, "taken");
      showInside(figure, figure.querySelector(".here"));
    }
  }

  function figureOf(name) {
    if (!figures.has(name) && pictures.has(run.templates[name])) {
      const figure = pictures.get(run.templates[name]).cloneNode(true);
      figure.prepend(make("figcaption", {}));
      const drawing = figure.querySelector("svg");
      drawing.style.minWidth = `${Math.round(READABLE * drawing.getAttribute("width"))}px`;
      figures.set(name, figure);
    }
    return figures.get(name);
  }
}

// Scrolls a picture that is wider than its frame.
function showInside(figure, element) {
  if (element === null) return;
  const [frame, shown] = [figure.getBoundingClientRect(), element.getBoundingClientRect()];
  figure.scrollLeft += shown.left + shown.width / 2 - frame.left - frame.width / 2;
}

function mark(figure, attribute, value, as) {
  for (const element of figure.querySelectorAll(`[${attribute}]`))
    if (element.getAttribute(attribute) === value) element.classList.add(as);
}

// What never changes in the run is only counted.
function table(kind, names, columns, at) {
  const made = make("table", {});
  const others = Object.keys(columns).length - names.length;
  made.append(make("caption", {}, others === 0 ? kind : `${kind} (${others} more stay as they are)`));
  for (const name of names) {
    const [before, now] = [valueIn(columns[name], Math.max(0, at - 1)), valueIn(columns[name], at)];
    const row = make("tr", kind !== "clocks" && before !== now ? { class: "new" } : {});
    row.append(make("td", {}, name), make("td", {}, now));
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
