// What can be taken away: files that the service makes when they are asked for.

import { get } from "./api.js";
import { h } from "./dom.js";

/**
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./answers.js").FileAnswer} FileAnswer
 * @typedef {{id: string, moved?: string}} Shown whose files are offered, and with which values other than those of the page
 */

/** @type {Record<string, string>} */
const MEANS = {
  "report.html": "Report", "report.pdf": "Report, PDF", "designs.csv": "Designs, CSV", "designs.xlsx": "Designs, Excel", "rows.csv": "Rows, CSV",
  "batch.xlsx": "Rows, Excel",  "front.svg": "Picture of the front", "bundle.zip": "Everything in one archive", "explorer.html": "Explorer, one file",
};

/**
 * Add the files of a job below what is shown of it.
 * @param {HTMLElement} element
 * @param {Job} job
 * @returns {Promise<{show: (other: Shown) => Promise<void>}>} `show` offers those of another job in the same place
 */
export async function filesCard(element, job) {
  const slot = h("div");
  let wanted = job.id;
  /** @param {Shown} other */
  async function show(other) {
    wanted = other.id;
    const { files } = await get(`/jobs/${other.id}/files`);
    if (wanted === other.id) slot.replaceChildren(...(files.length ? [cardOf(files, other.moved)] : []));
  }
  await show({ id: job.id });
  element.append(slot);
  return { show };
}

/**
 * @param {FileAnswer[]} files
 * @param {string | undefined} moved
 */
function cardOf(files, moved) {
  /**
   * @param {FileAnswer} file
   * @param {boolean} button
   */
  const link = (file, button) => h("a", { class: button ? "button" : "", href: file.href, download: file.name.split("/").at(-1) }, button ? MEANS[file.name] : file.name);
  const first = Object.keys(MEANS).flatMap((name) => files.find((file) => file.name === name) ?? []);
  const rest = files.filter((file) => !MEANS[file.name]);
  return h("section", { class: "card files-card" }, h("h2", {}, "Take it away", moved ? h("span", { class: "note" }, `with ${moved}`) : null), first.length ? h("p", { class: "row" }, first.map((file) => link(file, true))) : null,
    rest.length ? h("details", { class: "more" }, h("summary", {}, `${rest.length} more ${rest.length === 1 ? "file" : "files"}`), h("ul", { class: "files" }, rest.map((file) => h("li", {}, link(file, false))))) : null);
}
