// The interface of the service, asked from a page.

import { h } from "./dom.js";

export const API = "/api/v1";
const TRIES = 8, PAUSE = 1500; // of what only looks; ms between

/** Why a request cannot be answered. */
export class Refusal extends Error {
  /**
   * @param {number} status
   * @param {{code?: string, message?: string, problems?: object[], request_id?: string}} error
   */
  constructor(status, error) {
    super(error.message ?? `the service answers ${status}`);
    this.status = status;
    this.code = error.code ?? "";
    this.problems = error.problems ?? [];
    this.number = error.request_id ?? "";
  }
}

/**
 * Ask something; JSON comes back, or nothing.
 * @param {string} method
 * @param {string} path below the interface
 * @param {object | FormData} [body]
 * @param {Record<string, string>} [headers]
 * @returns {Promise<any>}
 * @throws {Refusal}
 */
export async function ask(method, path, body, headers = {}) {
  const again = method === "GET" || path.endsWith("/check") ? TRIES : 1;
  for (let k = 1; ; k += 1) {
    try {
      return await asked(method, path, body, headers);
    } catch (error) {
      if (error.status !== 503 || k >= again) throw error; // a server that has just begun needs a moment
      await new Promise((go) => setTimeout(go, PAUSE));
    }
  }
}

async function asked(method, path, body, headers) {
  const form = body instanceof FormData;
  const own = body === undefined || form ? {} : { "Content-Type": "application/json" };
  let answer;
  try {
    answer = await fetch(API + path, { method, headers: { ...own, ...headers }, body: body === undefined || form ? body : JSON.stringify(body) });
  } catch {
    throw new Refusal(0, { message: "the service does not answer; is it running?" });
  }
  if (answer.status === 204) return null;
  const told = (answer.headers.get("Content-Type") ?? "").includes("json") ? await answer.json() : await answer.text();
  if (answer.ok) return told;
  if (answer.status === 401 && !headers.Authorization) toSignIn();
  throw new Refusal(answer.status, told.error ?? {});
}

export const get = (path) => ask("GET", path);
export const post = (path, body, headers) => ask("POST", path, body, headers);

function toSignIn() {
  location.assign(`/sign-in?next=${encodeURIComponent(location.pathname + location.search)}`);
}

/** Whether whoever looks at the page may ask for jobs. */
export const maySubmit = () => document.body.dataset.maySubmit === "yes";

/**
 * Listen to jobs until all have ended; a stream that is refused or breaks is opened again.
 * @param {string[]} jobs
 * @param {(kind: string, told: object) => void} heard of the kinds snapshot, progress, started, end and the others
 * @returns {() => void} ends it
 */
export function listen(jobs, heard) {
  const open = new Set(jobs);
  let stream, again, over = false;
  const begin = () => {
    stream = new EventSource(`${API}/events?jobs=${[...open].join(",")}`);
    for (const kind of ["snapshot", "created", "started", "resumed", "cancelling", "progress", "remark", "end"]) {
      stream.addEventListener(kind, (event) => {
        const told = JSON.parse(event.data);
        heard(kind, told);
        if (kind === "end" && open.delete(told.job) && !open.size) stop();
      });
    }
    stream.onerror = () => {
      if (stream.readyState === EventSource.CLOSED && !over) again = setTimeout(begin, 3000);
    };
  };
  const stop = () => {
    over = true;
    clearTimeout(again);
    stream.close();
  };
  begin();
  addEventListener("pagehide", stop, { once: true });
  return stop;
}

/** Return a refusal as it is shown. */
export function faultCard(error, retry) {
  const number = error.number ? h("p", { class: "note" }, `Number of the request: ${error.number}`) : null;
  return h("section", { class: "card", role: "alert" }, h("p", { class: "fault" }, sentence(error.message)), number,
    retry ? h("p", { class: "row" }, h("button", { type: "button", onclick: retry }, "Try again")) : null);
}

/** Return a message of the service as a sentence. */
export const sentence = (text) => (text ? text[0].toUpperCase() + text.slice(1) + (/[.!?:]$/.test(text) ? "" : ".") : "");

document.getElementById("sign-out")?.addEventListener("click", async () => {
  await ask("DELETE", "/session");
  location.assign("/sign-in");
});

// On a phone the navigation is wider than the window: where one is shall be seen.
document.querySelector(".top [aria-current]")?.scrollIntoView({ block: "nearest", inline: "center" });
