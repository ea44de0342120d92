// The panel of a design: what it is and is made of, how near its limits are, what a change costs, what to take along.

import { focusOn, h, localAddress, s } from "./dom.js";
import { saveDesign } from "./files.js";
import { colourClass, shape } from "./marks.js";
import { FULL_DIGITS, amount, number, percent, usedShare } from "./numbers.js";
import { pricesOf } from "./slopes.js";

const FIRST_LIMITS = 7;
const BINDING = 0.999; // as in synth/order/feasibility.py

/**
 * @typedef {import("./record.js").Design} Design
 * @typedef {import("./record.js").Sides} Sides
 * @typedef {import("./dom.js").Child} Child
 * @typedef {{limit: import("./record.js").Limit, used: number, sides: Sides}} UsedLimit
 */

/** @type {Record<string, [tone: string, words: string]>} */
const VERDICTS = { yes: ["good", "all limits hold"], no: ["bad", "a limit fails"] };

/**
 * Make the panel.
 * @param {import("./explorer.js").Explorer} x
 */
export function panelView(x) {
  const node = h("aside", { class: "card panel", "aria-label": "Selected design" });
  let all = false; // of the limits

  function draw() {
    const i = x.state.selected;
    const d = x.model.record.designs[i];
    if (!d) {
      node.replaceChildren(
        h("div", { class: "block" }, h("h2", null, "No design"), h("p", { class: "soft" }, "There is none to show.")),
      );
      return;
    }
    const open = new Map([...node.querySelectorAll("details")].map((each) => [each.dataset.name, each.open]));
    const blocks = [head(d, i), drawing(d), parts(d), limits(d), prices(d), remarks(d), values(i), downloads(d, i)];
    node.replaceChildren(...blocks.filter((one) => one !== null));
    for (const each of node.querySelectorAll("details")) each.open = open.get(each.dataset.name) ?? each.open;
  }

  const block = (/** @type {string} */ title, /** @type {Child[]} */ ...children) =>
    h("section", { class: "block" }, title ? h("h3", null, title) : null, ...children);

  /**
   * @param {Design} d
   * @param {number} i
   */
  function head(d, i) {
    const pinned = x.state.pins.includes(i);
    const badges = x.model.names[i].map((name) => h("span", { class: "badge accent" }, name));
    if (d.violated) badges.push(h("span", { class: "badge bad" }, "limits violated"));
    else if (d.status === "optimal" && d.gap !== null)
      badges.push(h("span", { class: "badge good" }, `proven to ${percent(d.gap)}`));
    else badges.push(h("span", { class: "badge open" }, d.status.replaceAll("_", " ")));
    if (d.robust) {
      const [tone, words] = VERDICTS[d.robust.verdict] ?? ["open", d.robust.verdict];
      badges.push(
        h(
          "span",
          { class: `badge ${tone}` },
          `over what scatters: ${words}`,
        ),
      );
    }
    const pin =
      x.model.count > 1 &&
      h(
        "button",
        {
          type: "button",
          class: "small",
          "aria-pressed": String(pinned),
          onclick: () => {
            x.pin(i);
            focusOn(node, "button");
          },
        },
        pinned ? "Compared ✓" : "Compare",
      );
    const group = x.group();
    const mark =
      x.state.by && x.model.count > 1
        ? s(
            "svg",
            { class: "glyph", width: 16, height: 16, viewBox: "-8 -8 16 16", "aria-hidden": "true" },
            s("path", { d: shape(group.of[i], 6), class: colourClass(group.of[i], group.rest) }),
          )
        : null;
    const big = x.model.objectives.map((c) =>
      h(
        "div",
        null,
        h("dt", null, c.label),
        h("dd", null, h("b", null, number(c.values[i])), c.unit ? h("small", null, `\u202f${c.unit}`) : null),
      ),
    );
    return h(
      "div",
      { class: "block" },
      h(
        "div",
        { class: "row top" },
        mark,
        h("h2", { class: "large", tabindex: -1 }, `Design ${d.rank}`),
        h("span", { class: "grow" }),
        pin,
      ),
      h("div", { class: "row badges" }, badges),
      h("dl", { class: "big" }, big),
      h("p", { class: "why" }, d.why),
    );
  }

  /** @param {Design} d */
  function drawing(d) {
    if (d.drawing) return drawn(d, d.drawing);
    if (!x.options.picture) return null;
    const place = h("section", { hidden: true });
    x.options.picture(d).then(
      (svg) => place.replaceWith(drawn(d, svg)),
      () => place.remove(),
    );
    return place;
  }

  /**
   * @param {Design} d
   * @param {string} svg
   */
  function drawn(d, svg) {
    const address = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
    const picture = () => h("img", { class: "drawing", src: address, alt: `Drawing of design ${d.rank}` });
    const large = h("dialog", { class: "sheet", "aria-label": `Drawing of design ${d.rank}` });
    const open = () => {
      large.replaceChildren(picture(), h("button", { onclick: () => large.close() }, "Close"));
      large.showModal();
    };
    return block("", picture(), h("button", { onclick: open }, "Enlarge"), large);
  }

  /** @param {Design} d */
  function parts(d) {
    const { record } = x.model;
    const items = Object.entries(d.parts).map(([slot, key]) => {
      const part = record.parts[key] ?? { name: key, table: "", source: "", confidence: "", note: "" };
      const tone = part.confidence === "verified" ? "good" : "open";
      return h(
        "li",
        null,
        h(
          "div",
          { class: "row" },
          h("span", { class: "soft slot" }, slot.replaceAll("_", " ")),
          h("b", null, part.name),
          part.confidence ? h("span", { class: `badge ${tone}` }, part.confidence) : null,
        ),
        h(
          "details",
          { class: "source", "data-name": `part ${slot}` },
          h("summary", null, `table ${part.table}${part.source ? `: ${part.source}` : ""}`),
          part.note ? h("p", null, part.note) : null,
        ),
      );
    });
    for (const [name, word] of Object.entries(d.choices)) {
      items.push(
        h(
          "li",
          null,
          h("div", { class: "row" }, h("span", { class: "soft slot" }, name.replaceAll("_", " ")), h("b", null, word)),
        ),
      );
    }
    for (const [name, row] of d.next ?? []) {
      items.push(h("li", { class: "next" }, h("span", { class: "soft" }, `${name}, next in the tables: `), row));
    }
    return items.length ? block("Parts to buy or make", h("ul", { class: "parts" }, items)) : null;
  }

  /** @param {Design} d */
  function limits(d) {
    /** @type {UsedLimit[]} */
    const rows = [];
    x.model.record.limits.forEach((limit, k) => {
      const share = d.used[k];
      if (share !== null) rows.push({ limit, used: share, sides: d.sides[k] });
    });
    rows.sort((a, b) => bad(d, b) - bad(d, a) || b.used - a.used);
    if (!rows.length) return null;
    const shown = all ? rows : rows.slice(0, FIRST_LIMITS);
    const more = rows.length - FIRST_LIMITS;
    const words = all
      ? "Fewer"
      : `${more} more, ${more > 1 ? "all " : ""}below ${Math.ceil(100 * rows[FIRST_LIMITS]?.used)}\u00a0%`;
    const toggle =
      more > 0 &&
      h(
        "button",
        {
          type: "button",
          class: "small",
          "aria-expanded": String(all),
          onclick: () => {
            all = !all;
            draw();
            focusOn(node, ".limits + button");
          },
        },
        words,
      );
    return block(
      "How far each limit is used",
      h(
        "ul",
        { class: "limits" },
        shown.map((row) => used(d, row)),
      ),
      toggle,
    );
  }

  const bad = (/** @type {Design} */ d, /** @type {UsedLimit} */ row) =>
    Number(d.violated?.includes(row.limit.name) ?? false);

  /**
   * @param {Design} d
   * @param {UsedLimit} row
   */
  function used(d, row) {
    const { limit, sides } = row;
    const tone = bad(d, row) ? "bad" : row.used >= BINDING && limit.sign !== "=" ? "hot" : "";
    const bar = s(
      "svg",
      { class: `bar ${tone}`, width: 84, height: 12, viewBox: "0 0 84 12", "aria-hidden": "true" },
      s("rect", { class: "base", x: 0, y: 3, width: 80, height: 6, rx: 1 }),
      s("rect", {
        class: "fill",
        x: 0,
        y: 3,
        width: (80 * Math.min(1.04, Math.max(0, row.used))).toFixed(1),
        height: 6,
        rx: 1,
      }),
      s("path", { class: "end", d: "M80 0v12" }),
    );
    const digits = tone === "bad" || near(sides) ? FULL_DIGITS : undefined;
    const both =
      sides[0] === null || sides[1] === null
        ? ""
        : `${number(sides[0], digits)} ${limit.sign} ${amount(sides[1], limit.unit, digits)}`;
    return h(
      "li",
      { class: tone || null, title: limit.text || null },
      h(
        "span",
        { class: "what" },
        limit.label,
        tone === "bad" ? h("b", { class: "tag" }, " violated") : tone ? h("b", { class: "tag" }, " at limit") : null,
      ),
      bar,
      h("span", { class: "share" }, usedShare(row.used)),
      h("span", { class: "sides" }, both),
    );
  }

  const near = (/** @type {Sides} */ [value, limit]) =>
    value !== null && limit !== null && value !== limit && number(value) === number(limit);

  /** @param {Design} d */
  function prices(d) {
    const told = pricesOf(x, d);
    return told && block(...told);
  }

  /** @param {Design} d */
  function remarks(d) {
    const told = [
      ...(d.robust ? [d.robust.words] : []),
      ...(d.remarks ?? []),
      ...Object.entries(d.off_grid ?? {}).map(([n, t]) => `${n.replaceAll("_", " ")}: ${t}`),
    ];
    if (d.alternatives) told.push(`The same objectives with ${d.alternatives.join("; ")}`);
    return told.length
      ? block(
          "Remarks",
          h(
            "ul",
            { class: "remarks" },
            told.map((text) => h("li", null, named(text))),
          ),
        )
      : null;
  }

  /**
   * Return a remark with its code as a word before it.
   * @param {string} text
   * @returns {Child[]}
   */
  function named(text) {
    const found = /^([a-z][a-z0-9_]*): (.*)$/s.exec(text);
    return found ? [h("b", null, `${found[1].replaceAll("_", " ")}: `), found[2]] : [text];
  }

  /** @param {number} i */
  function values(i) {
    const rows = x.model.columns.filter((c) => c.kind !== "word").filter((c) => c.values[i] !== null);
    return h(
      "details",
      { class: "block", "data-name": "values" },
      h("summary", null, h("h3", null, `All ${rows.length} sizes and results`)),
      h(
        "table",
        { class: "values" },
        h(
          "tbody",
          null,
          rows.map((c) =>
            h(
              "tr",
              { title: c.text || null },
              h("th", { scope: "row" }, c.label),
              h("td", null, amount(c.values[i], c.unit)),
            ),
          ),
        ),
      ),
    );
  }

  /**
   * @param {Design} d
   * @param {number} i
   */
  function downloads(d, i) {
    /** @type {HTMLElement[]} */
    const own = [h("button", { type: "button", class: "small", onclick: () => saveDesign(x, i) }, `DESIGN.yaml`)];
    for (const [label, file] of d.files ?? []) {
      const address = localAddress(file);
      if (address) own.push(h("a", { class: "button small", href: address }, label));
    }
    for (const entry of x.options.downloads?.(d) ?? []) {
      const { run } = entry;
      if (run) own.push(h("button", { type: "button", class: "small", onclick: () => run(d) }, entry.label));
      else if (localAddress(entry.href) || entry.href?.startsWith("/"))
        own.push(h("a", { class: "button small", href: entry.href, download: entry.download ?? null }, entry.label));
    }
    return h("div", { class: "block row files" }, own);
  }

  return { node, draw };
}
