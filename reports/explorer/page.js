// The page that is one file: the record stands in it, the state in its address, the theme is switched here.

import { byId, h } from "./dom.js";
import { mount } from "./explorer.js";

const record = JSON.parse(byId("record").textContent ?? "");

/** @param {HTMLElement} slot */
function themeSwitch(slot) {
  const root = document.documentElement;
  const dark = () =>
    root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  const button = h("button", { type: "button", class: "small" });
  const name = () => {
    button.textContent = dark() ? "Light" : "Dark";
    button.setAttribute("aria-label", dark() ? "Light colours" : "Dark colours");
  };
  button.addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    name();
  });
  name();
  slot.append(h("button", { type: "button", class: "small", onclick: () => window.print() }, "Print"), button);
}

const started = performance.now();
mount(byId("explorer"), record, {
  actions: themeSwitch,
  state: location.hash.slice(1),
  onState: (text) => {
    try {
      if (location.protocol !== "about:")
        history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
    } catch {
      /* a frame without an address of its own */
    }
  },
});
document.body.getBoundingClientRect(); // laid out as well
document.documentElement.dataset.drawn = String(Math.round(performance.now() - started));
