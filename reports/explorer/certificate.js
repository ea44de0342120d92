// How far a front is proven, in plain words, what is not part of it; and why there is no design where there is none.

import { h, s } from "./dom.js";
import { FULL_DIGITS, amount, number } from "./numbers.js";

const ICONS = {
  good: "M4.2 9.4l3.2 3.2 6.4-7",
  open: "M9 4.5v5.6M9 12.6v.9",
  bad: "M5 5l8 8M13 5l-8 8",
};

/**
 * Return the banner that says how far the front is proven.
 * @param {import("./record.js").FrontRecord} record
 */
export function certificateBanner(record) {
  const c = record.certificate;
  const icon = s(
    "svg",
    { class: "seal", width: 20, height: 20, viewBox: "0 0 18 18", "aria-hidden": "true" },
    s("circle", { cx: 9, cy: 9, r: 8.5 }),
    s("path", { d: ICONS[c.level] ?? ICONS.open }),
  );
  return h(
    "details",
    { class: `certificate ${c.level}` },
    h(
      "summary",
      null,
      icon,
      h("span", null, h("strong", null, `${c.word}. `), c.sentence),
      h("span", { class: "more" }, "What this means"),
    ),
    h(
      "div",
      { class: "body" },
      h(
        "div",
        null,
        h("h3", null, "What was searched"),
        flow(c),
        h(
          "ul",
          null,
          c.offered.map((text) => h("li", null, text)),
          c.details.map((text) => h("li", null, text)),
          h("li", null, "It can be checked again by other code: ", h("code", null, "clutchsynth verify DIR"), "."),
        ),
      ),
      h(
        "div",
        null,
        h("h3", null, "Not part of it"),
        h(
          "ul",
          null,
          c.not_part.map((text) => h("li", null, text)),
        ),
      ),
    ),
  );
}

/**
 * Return how the combinations were dealt with, as a bar and in figures.
 * @param {import("./record.js").Certificate} c
 */
function flow(c) {
  /** @type {[name: string, count: number, text: string][]} */
  const shares = [
    ["excluded", c.excluded, "excluded by a bound that holds for all their sizes"],
    ["solved", c.solved, "solved in full"],
    ["left", c.unresolved, "left open"],
  ];
  const total = shares.reduce((sum, [, n]) => sum + n, 0) || 1;
  let at = 0;
  const bars = shares
    .filter(([, n]) => n > 0)
    .map(([name, n]) => {
      const width = Math.max(4, (400 * n) / total);
      const bar = s("rect", {
        class: name,
        x: at.toFixed(1),
        y: 0,
        width: Math.max(2, width - 2).toFixed(1),
        height: 8,
      });
      at += width;
      return bar;
    });
  const words = shares.filter(([name, n]) => n > 0 || name === "left");
  return h(
    "div",
    { class: "flow" },
    h("p", null, h("b", null, number(c.combinations)), " combinations of parts and counts"),
    s(
      "svg",
      {
        viewBox: `0 0 ${Math.max(400, at).toFixed(1)} 8`,
        height: 8,
        preserveAspectRatio: "none",
        "aria-hidden": "true",
      },
      bars,
    ),
    h(
      "ul",
      { class: "key" },
      words.map(([name, n, text]) =>
        h(
          "li",
          null,
          s("svg", { width: 9, height: 9, "aria-hidden": "true" }, s("rect", { class: name, width: 9, height: 9 })),
          h("b", null, number(n)),
          ` ${text}`,
        ),
      ),
    ),
  );
}

/**
 * Return what is shown in the place of a front where there is no design.
 * @param {import("./explorer.js").Explorer} x
 */
export function nothingCard(x) {
  const told = x.model.record.nothing ?? { message: "", conflicts: [], nearest: [] };
  const rows = told.conflicts.map((miss) =>
    h(
      "tr",
      null,
      h("th", { scope: "row" }, miss.label.replace(/ [≤≥] .*$/, "")),
      h("td", null, amount(miss.sides[0], miss.unit, FULL_DIGITS)),
      h("td", null, `${miss.sign}\u00a0${amount(miss.sides[1], miss.unit, FULL_DIGITS)}`),
      h("td", { class: "missed" }, miss.by),
    ),
  );
  const table =
    rows.length > 0 &&
    h(
      "div",
      { class: "scroll", tabindex: 0, role: "region", "aria-label": "Limits that are missed" },
      h(
        "table",
        { class: "designs missing" },
        h("caption", { class: "unseen" }, "Limits that the nearest design misses"),
        h(
          "thead",
          null,
          h(
            "tr",
            null,
            ["limit", "nearest design", "allowed", "missed by"].map((word) => h("th", { scope: "col" }, word)),
          ),
        ),
        h("tbody", null, rows),
      ),
    );
  const nearest =
    told.nearest.length > 0 &&
    h(
      "details",
      null,
      h("summary", null, "The nearest design"),
      h(
        "table",
        { class: "values" },
        h(
          "tbody",
          null,
          told.nearest.map(([name, value]) => h("tr", null, h("th", { scope: "row" }, name), h("td", null, value))),
        ),
      ),
    );
  const slot = h("div", { class: "ways" });
  if (x.options.ways) x.options.ways(slot, x.handle);
  else
    slot.append(
      h(
        "p",
        null,
        "What would help, by how much, and which limits exclude each other, tells ",
        h("code", null, "clutchsynth explain SPEC.yaml"),
        ".",
      ),
    );
  return h(
    "section",
    { class: "card nothing", "aria-labelledby": `${x.id}-nothing` },
    h("h2", { id: `${x.id}-nothing` }, "Nothing meets all limits"),
    h("p", null, told.message),
    table,
    nearest,
    slot,
  );
}
