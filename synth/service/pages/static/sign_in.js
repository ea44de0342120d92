// Where a browser shows its token once.

import { ask, messageOf, statusOf } from "./api.js";
import { byId } from "./dom.js";

const form = byId("sign-in"), fault = byId("fault");
const field = /** @type {HTMLInputElement} */ (byId("token"));

form.addEventListener("submit", async (event) => {
  event.preventDefault();
  const token = field.value.trim();
  fault.textContent = /^[\x21-\x7e]+$/.test(token) ? "" : "Please enter a token; it begins with cs_.";
  if (fault.textContent) return field.focus();
  try {
    await ask("POST", "/session", undefined, { Authorization: `Bearer ${token}` });
  } catch (error) {
    if (statusOf(error) !== 409) {
      fault.textContent = messageOf(error);
      field.focus();
      return;
    }
  }
  const next = new URL(new URLSearchParams(location.search).get("next") ?? "/", location.origin);
  location.assign(next.origin === location.origin ? next.pathname + next.search : "/");
});
