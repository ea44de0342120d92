// The front as a scatter: axes to choose, staircase, names of knee and extremes, brush, one tab stop for the keyboard.

import { h, s } from "./dom.js";
import { colourClass, shape } from "./marks.js";
import { amount, number } from "./numbers.js";
import { axisOf, rangeOf } from "./scales.js";

const REACH = 30; // pixels from a point within which it is meant
const STARTS = 5; // pixels after which a press is a brush
const LISTED = { role: "listbox", tabindex: "0", "aria-orientation": "horizontal" };
const DRAWN = { role: "img", tabindex: null, "aria-orientation": null }; // where there is nothing to go to

/**
 * @typedef {import("./record.js").NumberColumn} NumberColumn
 * @typedef {import("./record.js").Point} Point
 * @typedef {import("./record.js").Range} Range
 * @typedef {import("./scales.js").Axis} Axis
 * @typedef {{left: number, top: number, right: number, bottom: number, axes: [Axis, Axis]}} Frame
 */

/** @type {Record<string, 0 | 1>} */
const ARROWS = { ArrowLeft: 0, ArrowRight: 0, ArrowUp: 1, ArrowDown: 1, Home: 0, End: 0 };

/**
 * Make the scatter.
 * @param {import("./explorer.js").Explorer} x
 */
export function scatterView(x) {
  const svg = s("svg", { class: "scatter" });
  const box = h("div", { class: "chart" }, svg);
  const rings = {
    pins: s("path", { class: "pins" }),
    chosen: s("circle", { class: "ring chosen" }),
    hover: s("circle", { class: "ring hover" }),
    brush: s("rect", { class: "brush" }),
  };
  /** @type {(Point | null)[]} */
  let place = [];
  /** @type {(SVGPathElement | null)[]} */
  let points = [];
  /** @type {Frame} */
  let frame = { left: 0, top: 0, right: 1, bottom: 1, axes: [axisOf([]), axisOf([])] };
  /** @type {Point[]} */
  let corners = []; // along the staircase, which names keep clear of

  function draw() {
    const { model, state } = x;
    const [across, up] = [model.axis(state.x), model.axis(state.y)];
    const wide = Math.max(280, Math.round(box.clientWidth || 800));
    const high = Math.round(Math.min(460, Math.max(300, wide * 0.52)));
    const small = wide < 520;
    const ticksY = Math.max(4, Math.round(high / 64));
    const some = (/** @type {NumberColumn} */ column) =>
      [...column.values, ...x.ghosts.map((d) => d[column.key])].filter((v) => v !== null && v !== undefined);
    /** @type {[Axis, Axis]} */
    const axes = [axisOf(some(across), small ? 5 : Math.round(wide / 110)), axisOf(some(up), ticksY)];
    const labels = axes[1].ticks.map((t) => number(t));
    const left = 16 + 7 * Math.max(2, ...labels.map((t) => t.length));
    frame = { left, top: 34, right: wide - 16, bottom: high - 46, axes };
    const toX = (/** @type {number} */ v) => frame.left + (frame.right - frame.left) * axes[0].share(v);
    const toY = (/** @type {number} */ v) => frame.bottom - (frame.bottom - frame.top) * axes[1].share(v);
    place = across.values.map((v, i) => {
      const w = up.values[i];
      return v === null || w === null ? null : [toX(v), toY(w)];
    });
    /** @type {Node[]} */
    const nodes = [];
    let last = -99;
    for (const tick of axes[0].ticks) {
      const at = toX(tick);
      nodes.push(s("line", { class: "grid", x1: at, x2: at, y1: frame.top, y2: frame.bottom }));
      const text = number(tick);
      if (at - last < 8 + 7 * text.length || at < frame.left + 4) continue;
      last = at;
      nodes.push(
        s("text", { x: Math.min(at, wide - 4 - 3.5 * text.length), y: frame.bottom + 18, class: "mid" }, text),
      );
    }
    axes[1].ticks.forEach((tick, k) => {
      const at = toY(tick);
      nodes.push(s("line", { class: "grid", x1: frame.left, x2: frame.right, y1: at, y2: at }));
      nodes.push(s("text", { x: frame.left - 8, y: at + 4, class: "end" }, labels[k]));
    });
    nodes.push(s("text", { class: "title", x: 12, y: 20 }, `↑ ${title(up, axes[1])}`, better(up, "↓", "↑")));
    const below = s(
      "text",
      { class: "title end", x: frame.right, y: high - 8 },
      title(across, axes[0]),
      better(across, "←", "→"),
      " →",
    );
    nodes.push(s("path", { class: "axis", d: `M${frame.left} ${frame.top}V${frame.bottom}H${frame.right}` }), below);
    if (across.kind === "objective" && up.kind === "objective") {
      corners = [];
      nodes.push(s("path", { class: "stairs", d: stairs(across, up) }));
    }
    for (const ghost of x.ghosts) {
      const [v, w] = [ghost[across.key], ghost[up.key]];
      if (typeof v !== "number" || typeof w !== "number") continue;
      const at = `translate(${toX(v).toFixed(1)} ${toY(w).toFixed(1)})`;
      nodes.push(s("path", { class: "ghost", d: shape(0, 5), transform: at }));
    }
    const size = model.count > 400 ? 3.6 : model.count > 100 ? 4.4 : 5.6;
    const group = x.group();
    points = place.map(
      (p, i) =>
        p &&
        s("path", {
          id: `${x.id}-p${i}`,
          role: "option",
          "aria-label": said(i, across, up),
          class: `pt ${colourClass(group.of[i], group.rest)}`,
          d: shape(group.of[i], size),
          transform: `translate(${p[0].toFixed(1)} ${p[1].toFixed(1)})`,
        }),
    );
    const order = points.flatMap((point, i) => (point ? [{ point, rank: model.record.designs[i].rank }] : []));
    order.sort((a, b) => b.rank - a.rank); // the best ranks on top
    rings.chosen.setAttribute("r", String(size + 6));
    rings.hover.setAttribute("r", String(size + 4.5));
    svg.replaceChildren(
      ...nodes,
      rings.brush,
      ...order.map(({ point }) => point),
      rings.pins,
      rings.chosen,
      rings.hover,
      ...names(frame, size),
    );
    svg.setAttribute("viewBox", `0 0 ${wide} ${high}`);
    svg.setAttribute("height", String(high));
    for (const [name, value] of Object.entries(model.count ? LISTED : DRAWN)) {
      if (value === null) svg.removeAttribute(name);
      else svg.setAttribute(name, value);
    }
    svg.setAttribute(
      "aria-label",
      model.count
        ? `Front, ${across.label} across and ${up.label} up, ${model.count} designs. ` +
            "Arrow keys go from design to design, space takes a design for comparison. The table below says the same."
        : `The front as asked, ${across.label} across and ${up.label} up; nothing meets all limits of what is shown now`,
    );
    filter();
    mark();
  }

  const title = (/** @type {NumberColumn} */ column, /** @type {Axis} */ axis) =>
    column.label + (column.unit ? `, ${column.unit}` : "") + (axis.log ? " (log)" : "");

  /**
   * Return in which direction a column is better.
   * @param {NumberColumn} column
   * @param {string} least
   * @param {string} most
   */
  function better(column, least, most) {
    const sense = x.model.record.objectives[column.key];
    return sense ? s("tspan", { class: "soft" }, `   ${sense === "min" ? least : most} better`) : null;
  }

  /**
   * Return a design in words.
   * @param {number} i
   * @param {NumberColumn} across
   * @param {NumberColumn} up
   */
  function said(i, across, up) {
    const d = x.model.record.designs[i];
    const names = x.model.names[i].length ? `, ${x.model.names[i].join(", ")}` : "";
    const at = [across, up].map((c) => `${c.label} ${amount(c.values[i], c.unit)}`);
    return `Design ${d.rank}${names}: ${at.join(", ")}`;
  }

  /**
   * Return the border of what the designs dominate in these two objectives.
   * @param {NumberColumn} across
   * @param {NumberColumn} up
   */
  function stairs(across, up) {
    const sign = (/** @type {NumberColumn} */ c) => (x.model.record.objectives[c.key] === "min" ? 1 : -1);
    const [sx, sy] = [sign(across), sign(up)];
    const order = place.flatMap((at, i) => (at ? [{ at, v: across.values[i] ?? 0, w: up.values[i] ?? 0 }] : []));
    order.sort((a, b) => sx * (a.v - b.v) || sy * (a.w - b.w));
    let path = "";
    let least = Infinity;
    let level = "0";
    /** @type {Point | null} */
    let before = null;
    for (const { at, w } of order) {
      if (sy * w >= least) continue;
      least = sy * w;
      const [px, py] = at.map((v) => v.toFixed(1));
      /** @type {Point} */
      const [bx, by] = before ?? at;
      for (let u = 0; u < 1; u += 0.125) corners.push([bx + (at[0] - bx) * u, by], [at[0], by + (at[1] - by) * u]);
      before = at;
      path += path ? `H${px}V${py}` : `M${px} ${sy > 0 ? frame.top : frame.bottom}V${py}`;
      level = py;
    }
    return path && `${path}H${sx > 0 ? frame.right : frame.left}V${level}`;
  }

  /**
   * Write names beside points, each where it covers least.
   * @param {Frame} frame
   * @param {number} size of a point
   */
  function names({ left, right, top, bottom }, size) {
    /** @type {number[][]} */
    const taken = [];
    return x.model.names.flatMap((words, i) => {
      const point = place[i];
      if (!words.length || !point) return [];
      const text = `#${x.model.record.designs[i].rank} ${words.join(", ")}`;
      const [px, py] = point;
      const width = 6.9 * text.length;
      const away = size + 8;
      const tries = [
        [away, -away],
        [away, away + 8],
        [-away - width, -away],
        [-away - width, away + 8],
        [-width / 2, -away - 8],
        [-width / 2, away + 16],
        [away, -2.4 * away],
        [-away - width, -2.4 * away],
        [-width, -3.6 * away],
        [0, -3.6 * away],
      ];
      const cost = (/** @type {number[]} */ [dx, dy]) => {
        const area = [px + dx, py + dy - 11, px + dx + width, py + dy + 3];
        const out =
          Math.max(0, left + 4 - area[0]) +
          Math.max(0, area[2] - right) +
          Math.max(0, top - area[1]) +
          Math.max(0, area[3] - bottom);
        const points = place.filter(
          (p) => p && p[0] > area[0] - 6 && p[0] < area[2] + 6 && p[1] > area[1] - 6 && p[1] < area[3] + 6,
        ).length;
        const steps = corners.filter(
          (p) => p[0] > area[0] - 4 && p[0] < area[2] + 4 && p[1] > area[1] - 4 && p[1] < area[3] + 4,
        ).length;
        const others = taken.filter((t) => t[0] < area[2] && t[2] > area[0] && t[1] < area[3] && t[3] > area[1]).length;
        return 8 * out + 20 * points + 300 * others + 6 * steps + Math.hypot(dx + width / 2, dy) / 20;
      };
      const [dx, dy] = tries.reduce((a, b) => (cost(b) < cost(a) ? b : a));
      taken.push([px + dx, py + dy - 11, px + dx + width, py + dy + 3]);
      return [s("text", { class: "name", x: (px + dx).toFixed(1), y: (py + dy).toFixed(1) }, text)];
    });
  }

  function filter() {
    points.forEach((p, i) => p?.classList.toggle("out", !x.shown(i)));
    const ranges = [x.state.ranges.get(x.state.x), x.state.ranges.get(x.state.y)];
    const { left, right, top, bottom, axes } = frame;
    const clip = (/** @type {number} */ share) => Math.min(1, Math.max(0, share));
    const [h0, h1] = ranges[0] ? ranges[0].map((v) => left + (right - left) * clip(axes[0].share(v))) : [left, right];
    const [v1, v0] = ranges[1] ? ranges[1].map((v) => bottom - (bottom - top) * clip(axes[1].share(v))) : [bottom, top];
    box.classList.toggle("brushed", Boolean(ranges[0] || ranges[1]));
    setBox([h0, v0, h1, v1]);
  }

  /** @param {number[]} box left, top, right and bottom */
  function setBox([x0, y0, x1, y1]) {
    const told = { x: Math.min(x0, x1), y: Math.min(y0, y1), width: Math.abs(x1 - x0), height: Math.abs(y1 - y0) };
    for (const [name, value] of Object.entries(told)) rings.brush.setAttribute(name, String(value));
  }

  /**
   * Draw a ring around a design, or none.
   * @param {SVGElement} node
   * @param {number} i
   */
  function ring(node, i) {
    const point = place[i];
    node.classList.toggle("on", Boolean(point));
    if (point) node.setAttribute("transform", `translate(${point[0].toFixed(1)} ${point[1].toFixed(1)})`);
  }

  let chosen = -1;
  function mark() {
    const { hovered, selected, pins } = x.state;
    ring(rings.hover, hovered);
    ring(rings.chosen, selected);
    rings.pins.setAttribute(
      "d",
      pins
        .map((i) => place[i] ?? null)
        .filter((p) => p !== null)
        .map(([px, py]) => `M${px - 4} ${py - 13}h8l-4 5z`)
        .join(""),
    );
    if (chosen !== selected || !points[selected]?.hasAttribute("aria-selected")) {
      points[chosen]?.removeAttribute("aria-selected");
      points[selected]?.setAttribute("aria-selected", "true");
      const point = points[selected];
      if (point) svg.setAttribute("aria-activedescendant", point.id);
      else svg.removeAttribute("aria-activedescendant");
      chosen = selected;
    }
  }

  /**
   * Return where in the picture an event is.
   * @param {PointerEvent} event
   * @returns {Point}
   */
  function at(event) {
    const area = svg.getBoundingClientRect();
    return [event.clientX - area.left, event.clientY - area.top];
  }

  /** @param {Point} here */
  function nearest([px, py]) {
    let best = -1;
    let least = REACH * REACH;
    place.forEach((p, i) => {
      if (!p || !x.shown(i)) return;
      const far = (p[0] - px) ** 2 + (p[1] - py) ** 2;
      if (far < least) [best, least] = [i, far];
    });
    return best;
  }

  /** @type {{from: Point, brush: boolean} | null} */
  let press = null;
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    press = { from: at(event), brush: false };
    if (event.pointerType !== "touch") svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    const here = at(event);
    if (press && event.pointerType !== "touch") {
      press.brush ||= Math.hypot(here[0] - press.from[0], here[1] - press.from[1]) > STARTS;
      if (press.brush) {
        box.classList.add("brushed");
        setBox([...press.from, ...here]);
        return;
      }
    }
    x.hover(nearest(here), event.clientX, event.clientY);
  });
  svg.addEventListener("pointerup", (event) => {
    const here = at(event);
    if (press?.brush) {
      const { left, right, top, bottom, axes } = frame;
      const toAcross = (/** @type {number} */ v) => axes[0].at((v - left) / (right - left));
      const toUp = (/** @type {number} */ v) => axes[1].at((bottom - v) / (bottom - top));
      const across = rangeOf(toAcross(press.from[0]), toAcross(here[0]));
      const up = rangeOf(toUp(press.from[1]), toUp(here[1]));
      x.keep([
        [x.state.x, across],
        [x.state.y, up],
      ]);
    } else if (press) {
      const found = nearest(here);
      if (found >= 0) x.select(found);
    }
    press = null;
  });
  svg.addEventListener("pointercancel", () => {
    press = null;
  });
  svg.addEventListener("pointerleave", () => x.hover(-1));
  svg.addEventListener("keydown", (event) => {
    const axis = ARROWS[event.key];
    if (event.key === " ") x.pin(x.state.selected);
    else if (axis === undefined) return;
    else {
      const order = place
        .flatMap((p, i) => (p && x.shown(i) ? [{ i, level: p[axis] }] : []))
        .sort((a, b) => a.level - b.level)
        .map(({ i }) => i);
      const now = order.indexOf(x.state.selected);
      const step = event.key === "ArrowRight" || event.key === "ArrowDown" ? 1 : -1;
      const next =
        event.key === "Home"
          ? 0
          : event.key === "End"
            ? order.length - 1
            : Math.min(order.length - 1, Math.max(0, now + step));
      if (order.length) x.select(order[next]);
    }
    event.preventDefault();
  });
  return { node: box, draw, filter, mark };
}
