// Tokens: made, shown once, and revoked.

import { API, ask, faultCard, get, messageOf, post, problemsOf, sentence } from "./api.js";
import { byId, day, h, say, when } from "./dom.js";

/** @typedef {import("./answers.js").TokenAnswer} Token */

const place = byId("tokens");
const SCOPES = [["read", "see the jobs of its tenant"], ["submit", "ask for jobs, cancel and delete them"], ["admin", "make tokens for all tenants"]];
let none = false; // whether this is to be the first one
const listed = h("div"), made = h("div", { role: "status" });

async function begin() {
  try {
    await list();
    place.replaceChildren(made, listed, making());
  } catch (error) {
    place.replaceChildren(faultCard(error, () => location.reload()));
  }
  place.setAttribute("aria-busy", "false");
}

async function list() {
  const { tokens } = await get("/tokens");
  none = !tokens.length;
  /** @param {Token} token */
  const over = (token) => Boolean(token.revoked) || (token.expires !== null && token.expires < Date.now() / 1000);
  tokens.sort((a, b) => Number(over(a)) - Number(over(b)) || b.created - a.created);
  listed.replaceChildren(tokens.length ? h("section", { class: "card" }, h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Tokens" }, h("table", {},
    h("thead", {}, h("tr", {}, ["Name", "Begins", "Tenant", "May", "Made", "Last used", "Valid until"].map((name) => h("th", { scope: "col" }, name)), h("td", {}, h("span", { class: "unseen" }, "What can be done")))),
    h("tbody", {}, tokens.map((token) => h("tr", { class: over(token) ? "over" : "" }, h("th", { scope: "row", class: "text" }, token.name), h("td", {}, h("code", {}, `${token.prefix}…`)), h("td", {}, token.tenant), h("td", {}, token.scopes.join(", ")), h("td", {}, when(token.created)), h("td", {}, token.used ? when(token.used) : "never"),
      h("td", {}, token.expires ? day(token.expires) : "for ever"),
      h("td", {}, over(token) ? h("span", { class: "badge" }, token.revoked ? "revoked" : "run out") : h("button", { type: "button", class: "small", "aria-label": `Revoke ${token.name}`, onclick: (/** @type {import("./elements.js").EventOf<HTMLButtonElement>} */ event) => revoke(token, event.target) }, "Revoke"))))))))
    : h("p", { class: "card note" }, "There are no tokens: everybody at this machine may do everything. The first one must be one that may admin: from then on nobody comes in without a token."));
}

/**
 * @param {Token} token
 * @param {HTMLButtonElement} button
 */
async function revoke(token, button) {
  if (button.dataset.sure !== "yes") {
    button.dataset.sure = "yes";
    button.textContent = "Really revoke?";
    button.classList.add("danger");
    return;
  }
  try {
    await ask("DELETE", `/tokens/${token.id}`);
    await list();
    say(`${token.name} is revoked`);
  } catch (error) {
    made.replaceChildren(faultCard(error));
  }
}

function making() {
  const name = h("input", { id: "name", autocomplete: "off", spellcheck: "false", placeholder: "whom or what it is for" });
  const tenant = h("input", { id: "tenant", autocomplete: "off", spellcheck: "false", placeholder: "your own" });
  const days = h("input", { id: "days", inputmode: "numeric", autocomplete: "off", placeholder: "365" });
  const boxes = SCOPES.map(([scope, text]) => h("label", {}, h("input", { type: "checkbox", value: scope, checked: none || scope !== "admin" }), scope, h("span", { class: "note" }, text)));
  const fault = h("p", { class: "fault", role: "alert" });
  /** @type {Record<string, HTMLElement>} */
  const faults = {};
  /**
   * @param {string} text
   * @param {HTMLInputElement} field
   */
  const labelled = (text, field) => {
    faults[field.id] = h("span", { class: "fault", id: `${field.id}-fault` });
    field.setAttribute("aria-describedby", `${field.id}-fault`);
    return h("p", { class: "labelled" }, h("label", { for: field.id }, text), field, faults[field.id]);
  };
  /** @type {Record<string, HTMLInputElement>} */
  const fields = { name, tenant, days };
  return h("form", { class: "card stack", novalidate: true, onsubmit: async (event) => {
    event.preventDefault();
    fault.textContent = "";
    for (const [id, field] of Object.entries(fields)) {
      faults[id].textContent = "";
      field.removeAttribute("aria-invalid");
    }
    /** @type {Record<string, string | number | string[]>} */
    const body = { name: name.value.trim(), scopes: boxes.flatMap((box) => box.querySelector("input") ?? []).filter((box) => box.checked).map((box) => box.value) };
    if (tenant.value.trim()) body.tenant = tenant.value.trim();
    if (days.value.trim()) body.days = /^[\d.]+$/.test(days.value.trim()) ? Number(days.value) : days.value.trim();
    try {
      const token = await post("/tokens", body);
      const copy = h("button", { type: "button", class: "small", onclick: () => navigator.clipboard?.writeText(token.value).then(() => { copy.textContent = "Copied"; }) }, "Copy");
      made.replaceChildren(h("section", { class: "card stack" }, h("h2", {}, `Token for ${body.name}`), h("p", {}, "It is shown this once; only its hash is kept."), h("p", { class: "row" }, h("code", { class: "token" }, token.value), copy), h("p", { class: "note" }, "If it is the first one, this browser has to sign in with it now.")));
      name.value = "";
      made.scrollIntoView();
      const open = await fetch(`${API}/session`);
      if (open.ok) await list();
      else listed.replaceChildren();
    } catch (error) {
      const at = problemsOf(error).find((problem) => problem.path.some((id) => id in fields)), id = at?.path.find((id) => id in fields) ?? "";
      (faults[id] ?? fault).textContent = at ? sentence(at.message) : messageOf(error);
      fields[id]?.setAttribute("aria-invalid", "true");
      fields[id]?.focus();
    }
  } }, h("h2", {}, "Make a token"), h("div", { class: "asks" }, labelled("Name", name), labelled("Tenant", tenant), labelled("Valid for, in days", days)), h("div", { class: "objectives", role: "group", "aria-label": "What it may" }, boxes), fault, h("p", {}, h("button", { type: "submit", class: "primary" }, "Make it")));
}

begin();
