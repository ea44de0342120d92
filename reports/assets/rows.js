// Many rows of a table: chosen by state and text, sorted by a column, some at a time.
(() => {
  "use strict";
  const place = document.getElementById("many-rows");
  const source = document.getElementById("all-rows");
  if (!place || !source) return;
  /** @typedef {string | number | null} Cell */
  /** @type {{whole: boolean[], rows: Cell[][], kind: number, most: number}} */
  const { whole: isWhole, rows, kind, most } = JSON.parse(source.textContent ?? "");
  const [tools, counted] = /** @type {NodeListOf<HTMLElement>} */ (place.querySelectorAll(".tools, .counted"));
  const [before, after] = /** @type {NodeListOf<HTMLButtonElement>} */ (place.querySelectorAll(".before, .after"));
  const [state, text] = [place.querySelector("select"), place.querySelector("input")];
  const [frame, body] = [place.querySelector("table"), place.querySelector("tbody")];
  if (!state || !text || !frame || !body) return;
  const heads = [...place.querySelectorAll("thead th")];
  const kinds = heads.map((head) => head.className);
  const order = new Intl.Collator("en", { numeric: true });
  const cellText = (/** @type {Cell} */ value, /** @type {number} */ k) =>
    (typeof value === "string" || isWhole[k] ? String(value) : number(value));
  /**
   * @template {keyof HTMLElementTagNameMap} T
   * @param {T} tag
   * @param {string} words
   * @param {Element} parent
   */
  const make = (tag, words, parent) => {
    const node = document.createElement(tag);
    node.textContent = words;
    parent.append(node);
    return node;
  };
  // What is searched: all cells of a row, in small letters; made when somebody first types.
  /** @type {string[] | null} */
  let searched = null;
  let chosen = rows.map((_, k) => k);
  let column = -1;
  let down = false;
  let first = 0;

  const compare = (/** @type {number} */ a, /** @type {number} */ b) => {
    const [x, y] = [rows[a][column], rows[b][column]];
    const [none, other] = [x === null || x === "", y === null || y === ""];
    if (none || other) return Number(none) - Number(other) || a - b; // what is empty stands last, whatever the direction
    const way = typeof x === "number" && typeof y === "number" ? x - y : order.compare(String(x), String(y));
    return (down ? -way : way) || a - b;
  };
  const draw = () => {
    const last = Math.min(first + most, chosen.length);
    const made = document.createDocumentFragment();
    chosen.slice(first, last).forEach((k) => {
      const line = document.createElement("tr");
      rows[k].forEach((value, n) => { make("td", cellText(value, n), line).className = kinds[n]; });
      made.append(line);
    });
    body.replaceChildren(made);
    const range = chosen.length > most ? `${number(first + 1)} to ${number(last)} of ` : "";
    const all = chosen.length < rows.length ? ` (of ${number(rows.length)})` : "";
    counted.textContent = `${range}${number(chosen.length)} ${chosen.length === 1 ? "row" : "rows"}${all}`;
    before.disabled = first === 0;
    after.disabled = last >= chosen.length;
    before.hidden = after.hidden = chosen.length <= most;
  };
  const choose = () => {
    const words = text.value.toLowerCase().split(/\s+/).filter(Boolean);
    if (words.length && !searched) searched = rows.map((row) => row.map(cellText).join("\n").toLowerCase());
    chosen = [];
    rows.forEach((row, k) => {
      if (state.value !== "" && row[kind] !== state.value) return;
      if (words.every((word) => searched?.[k].includes(word))) chosen.push(k);
    });
    if (column >= 0) chosen.sort(compare);
    first = 0;
    draw();
  };
  const turn = (/** @type {1 | -1} */ way) => {
    first = Math.max(0, first + way * most);
    draw();
    frame.scrollIntoView({ block: "start" });
  };

  /** @type {Map<Cell, number>} */
  const counts = new Map();
  rows.forEach((row) => counts.set(row[kind], (counts.get(row[kind]) || 0) + 1));
  make("option", `all (${number(rows.length)})`, state).value = "";
  [...counts].forEach(([word, count]) => { make("option", `${word} (${number(count)})`, state).value = String(word); });
  heads.forEach((head, k) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = head.textContent;
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      down = column === k && !down;
      column = k;
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      choose();
    });
  });
  state.addEventListener("change", choose);
  text.addEventListener("input", choose);
  before.addEventListener("click", () => turn(-1));
  after.addEventListener("click", () => turn(1));
  place.querySelector(".hint")?.remove();
  tools.hidden = false;
  draw();
})();
