// Designs that the report does not tell in full are shown on request, from the table that stands in the file.
(() => {
  "use strict";
  const source = document.getElementById("all-designs");
  const place = document.getElementById("any-design");
  if (!source || !place) return;
  /** @typedef {string | number | null} Cell */
  /** @type {{columns: string[], rows: Cell[][]}} */
  const told = JSON.parse(source.textContent ?? "");
  /**
   * @template {keyof HTMLElementTagNameMap} T
   * @param {T} tag
   * @param {string | null} [text]
   * @param {Element} [parent]
   */
  const make = (tag, text, parent) => {
    const node = document.createElement(tag);
    if (text !== undefined) node.textContent = text;
    if (parent) parent.append(node);
    return node;
  };
  /**
   * @param {string} caption
   * @param {string[]} heads
   * @param {Cell[][]} rows
   */
  const table = (caption, heads, rows) => {
    const frame = make("div");
    frame.className = "scroll";
    const node = make("table", undefined, frame);
    make("caption", caption, node);
    const head = make("tr", undefined, make("thead", undefined, node));
    heads.forEach((text) => { make("th", text, head).scope = "col"; });
    const body = make("tbody", undefined, node);
    rows.forEach((cells) => {
      const row = make("tr", undefined, body);
      cells.forEach((text, k) => {
        make("td", typeof text === "number" ? number(text) : text, row).className = k === 1 ? "n" : "";
      });
    });
    return frame;
  };
  const show = (/** @type {Cell} */ rank) => {
    const row = told.rows.find((one) => one[0] === rank) ?? [];
    const pairs = told.columns.map((name, k) => ({ name, value: row[k] ?? "" }));
    const limits = pairs.filter(({ name }) => name.startsWith("utilisation: "))
      .sort((a, b) => Number(b.value) - Number(a.value))
      .map(({ name, value }) => [name.slice(13), value === "" ? "not checked" : usedShare(Number(value))]);
    const values = pairs.filter(({ name, value }) => !name.startsWith("utilisation: ") && value !== "")
      .map(({ name, value }) => [name, value]);
    place.replaceChildren();
    make("h2", `Design #${rank}`, place);
    place.append(table("Sizes, parts and results", ["quantity", "value"], values));
    place.append(table("Limits, the most used first", ["limit", "used"], limits));
    place.hidden = false;
    place.tabIndex = -1;
    place.focus();
    place.scrollIntoView({ block: "start" });
  };
  told.rows.forEach(([rank]) => {
    const row = document.getElementById(`design-${rank}`);
    if (!(row instanceof HTMLTableRowElement) || document.getElementById(`full-${rank}`)) return;
    const cell = row.cells[0];
    const button = make("button", cell.textContent);
    button.type = "button";
    button.className = "screen more";
    button.setAttribute("aria-label", `Show design ${rank}`);
    button.addEventListener("click", () => show(rank));
    cell.replaceChildren(button);
  });
})();
