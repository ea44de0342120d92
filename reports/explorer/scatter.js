// The front as a scatter: axes to choose, staircase, names of knee and extremes, brush, one tab stop for the keyboard.

import { h, s } from "./dom.js";
import { colourClass, shape } from "./marks.js";
import { amount, number } from "./numbers.js";
import { axisOf } from "./scales.js";

const REACH = 30; // pixels from a point within which it is meant
const STARTS = 5; // pixels after which a press is a brush
const LISTED = { role: "listbox", tabindex: "0", "aria-orientation": "horizontal" };
const DRAWN = { role: "img", tabindex: null, "aria-orientation": null }; // where there is nothing to go to

/**
 * Make the scatter.
 * @param {import("./explorer.js").Explorer} x
 */
export function scatterView(x) {
  const svg = s("svg", { class: "scatter" });
  const box = h("div", { class: "chart" }, svg);
  let place = [];
  let points = [];
  let frame = null;
  let corners = []; // along the staircase, which names keep clear of
  let rings = {};

  function draw() {
    const { model, state } = x;
    const [across, up] = [model.column(state.x), model.column(state.y)];
    const wide = Math.max(280, Math.round(box.clientWidth || 800));
    const high = Math.round(Math.min(460, Math.max(300, wide * 0.52)));
    const small = wide < 520;
    const ticksY = Math.max(4, Math.round(high / 64));
    const some = (column) =>
      [...column.values, ...x.ghosts.map((d) => d[column.key])].filter((v) => v !== null && v !== undefined);
    const axes = [axisOf(some(across), small ? 5 : Math.round(wide / 110)), axisOf(some(up), ticksY)];
    const labels = axes[1].ticks.map((t) => number(t));
    const left = 16 + 7 * Math.max(2, ...labels.map((t) => t.length));
    frame = { left, top: 34, right: wide - 16, bottom: high - 46, axes };
    const toX = (v) => frame.left + (frame.right - frame.left) * axes[0].share(v);
    const toY = (v) => frame.bottom - (frame.bottom - frame.top) * axes[1].share(v);
    place = across.values.map((v, i) => (v === null || up.values[i] === null ? null : [toX(v), toY(up.values[i])]));
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
      if (ghost[across.key] === undefined || ghost[up.key] === undefined) continue;
      const at = `translate(${toX(ghost[across.key]).toFixed(1)} ${toY(ghost[up.key]).toFixed(1)})`;
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
    const order = points.map((p, i) => [p, model.record.designs[i].rank]).filter(([p]) => p);
    order.sort((a, b) => b[1] - a[1]); // the best ranks on top
    rings = {
      pins: s("path", { class: "pins" }),
      chosen: s("circle", { class: "ring chosen", r: size + 6 }),
      hover: s("circle", { class: "ring hover", r: size + 4.5 }),
      brush: s("rect", { class: "brush" }),
    };
    svg.replaceChildren(
      ...nodes,
      rings.brush,
      ...order.map(([p]) => p),
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

  const title = (column, axis) => column.label + (column.unit ? `, ${column.unit}` : "") + (axis.log ? " (log)" : "");

  function better(column, least, most) {
    const sense = x.model.record.objectives[column.key];
    return sense ? s("tspan", { class: "soft" }, `   ${sense === "min" ? least : most} better`) : null;
  }

  function said(i, across, up) {
    const d = x.model.record.designs[i];
    const names = x.model.names[i].length ? `, ${x.model.names[i].join(", ")}` : "";
    const at = [across, up].map((c) => `${c.label} ${amount(c.values[i], c.unit)}`);
    return `Design ${d.rank}${names}: ${at.join(", ")}`;
  }

  /** Return the border of what the designs dominate in these two objectives. */
  function stairs(across, up) {
    const sign = (c) => (x.model.record.objectives[c.key] === "min" ? 1 : -1);
    const [sx, sy] = [sign(across), sign(up)];
    const order = place.map((p, i) => i).filter((i) => place[i]);
    order.sort((a, b) => sx * (across.values[a] - across.values[b]) || sy * (up.values[a] - up.values[b]));
    let path = "";
    let least = Infinity;
    let level = 0;
    let before = null;
    for (const i of order) {
      if (sy * up.values[i] >= least) continue;
      least = sy * up.values[i];
      const [px, py] = place[i].map((v) => v.toFixed(1));
      const [bx, by] = before ?? place[i];
      for (let u = 0; u < 1; u += 0.125)
        corners.push([bx + (place[i][0] - bx) * u, by], [place[i][0], by + (place[i][1] - by) * u]);
      before = place[i];
      path += path ? `H${px}V${py}` : `M${px} ${sy > 0 ? frame.top : frame.bottom}V${py}`;
      level = py;
    }
    return path && `${path}H${sx > 0 ? frame.right : frame.left}V${level}`;
  }

  /** Write names beside points, each where it covers least. */
  function names({ left, right, top, bottom }, size) {
    const taken = [];
    return x.model.names.flatMap((words, i) => {
      if (!words.length || !place[i]) return [];
      const text = `#${x.model.record.designs[i].rank} ${words.join(", ")}`;
      const [px, py] = place[i];
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
      const cost = ([dx, dy]) => {
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
    const clip = (share) => Math.min(1, Math.max(0, share));
    const [h0, h1] = ranges[0] ? ranges[0].map((v) => left + (right - left) * clip(axes[0].share(v))) : [left, right];
    const [v1, v0] = ranges[1] ? ranges[1].map((v) => bottom - (bottom - top) * clip(axes[1].share(v))) : [bottom, top];
    box.classList.toggle("brushed", Boolean(ranges[0] || ranges[1]));
    setBox([h0, v0, h1, v1]);
  }

  function setBox([x0, y0, x1, y1]) {
    const told = { x: Math.min(x0, x1), y: Math.min(y0, y1), width: Math.abs(x1 - x0), height: Math.abs(y1 - y0) };
    for (const [name, value] of Object.entries(told)) rings.brush.setAttribute(name, String(value));
  }

  function ring(node, i) {
    node.classList.toggle("on", Boolean(place[i]));
    if (place[i]) node.setAttribute("transform", `translate(${place[i][0].toFixed(1)} ${place[i][1].toFixed(1)})`);
  }

  let chosen = -1;
  function mark() {
    const { hovered, selected, pins } = x.state;
    ring(rings.hover, hovered);
    ring(rings.chosen, selected);
    rings.pins.setAttribute(
      "d",
      pins
        .filter((i) => place[i])
        .map((i) => `M${place[i][0] - 4} ${place[i][1] - 13}h8l-4 5z`)
        .join(""),
    );
    if (chosen !== selected || !points[selected]?.hasAttribute("aria-selected")) {
      points[chosen]?.removeAttribute("aria-selected");
      points[selected]?.setAttribute("aria-selected", "true");
      if (points[selected]) svg.setAttribute("aria-activedescendant", points[selected].id);
      else svg.removeAttribute("aria-activedescendant");
      chosen = selected;
    }
  }

  function at(event) {
    const area = svg.getBoundingClientRect();
    return [event.clientX - area.left, event.clientY - area.top];
  }

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
      const across = [press.from[0], here[0]].map((v) => axes[0].at((v - left) / (right - left))).sort((a, b) => a - b);
      const up = [press.from[1], here[1]].map((v) => axes[1].at((bottom - v) / (bottom - top))).sort((a, b) => a - b);
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
    const axis = { ArrowLeft: 0, ArrowRight: 0, ArrowUp: 1, ArrowDown: 1, Home: 0, End: 0 }[event.key];
    if (event.key === " ") x.pin(x.state.selected);
    else if (axis === undefined) return;
    else {
      const order = place
        .map((p, i) => i)
        .filter((i) => place[i] && x.shown(i))
        .sort((a, b) => place[a][axis] - place[b][axis]);
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
