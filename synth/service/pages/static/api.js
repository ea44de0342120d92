// The interface of the service, asked from a page.

import { h } from "./dom.js";

export const API = "/api/v1";
const TRIES = 8, PAUSE = 1500; // of what only looks; ms between

/** Why a request cannot be answered. */
export class Refusal extends Error {
  /**
   * @param {number} status
   * @param {Partial<import("./answers.js").RequestRefusal>} error
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
 * @typedef {import("./answers.js").Problem} Problem
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./records.js").Happening} Happening
 * @typedef {(kind: string, told: Happening) => void} Hears
 */

/**
 * Ask something; JSON comes back, or nothing.
 * @param {string} method
 * @param {string} path below the interface
 * @param {object | FormData} [body]
 * @param {Record<string, string>} [headers]
 * @returns {Promise<unknown>}
 * @throws {Refusal}
 */
export async function ask(method, path, body, headers = {}) {
  const again = method === "GET" || path.endsWith("/check") ? TRIES : 1;
  for (let k = 1; ; k += 1) {
    try {
      return await asked(method, path, body, headers);
    } catch (error) {
      if (statusOf(error) !== 503 || k >= again) throw error; // a server that has just begun needs a moment
      await new Promise((go) => setTimeout(go, PAUSE));
    }
  }
}

/**
 * @param {string} method
 * @param {string} path
 * @param {object | FormData | undefined} body
 * @param {Record<string, string>} headers
 */
async function asked(method, path, body, headers) {
  const form = body instanceof FormData;
  /** @type {Record<string, string>} */
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

/**
 * @template {string} P
 * @param {P} path
 */
export const get = (path) => /** @type {Promise<import("./answers.js").GetAnswer<P>>} */ (ask("GET", path));

/**
 * @template {string} P
 * @param {P} path
 * @param {object | FormData} [body]
 * @param {Record<string, string>} [headers]
 */
export const post = (path, body, headers) => /** @type {Promise<import("./answers.js").PostAnswer<P>>} */ (ask("POST", path, body, headers));

function toSignIn() {
  location.assign(`/sign-in?next=${encodeURIComponent(location.pathname + location.search)}`);
}

/** Whether whoever looks at the page may ask for jobs. */
export const maySubmit = () => document.body.dataset.maySubmit === "yes";

/**
 * Listen to jobs until all have ended; a stream that is refused or breaks is opened again.
 * @param {string[]} jobs
 * @param {Hears} heard of the kinds progress, started, end and the others
 * @param {(job: Job) => void} [seen] is told the job as it stands, when a stream begins
 * @returns {() => void} ends it
 */
export function listen(jobs, heard, seen) {
  const open = new Set(jobs);
  /** @type {EventSource | undefined} */
  let stream;
  let again = 0, over = false;
  const begin = () => {
    const own = (stream = new EventSource(`${API}/events?jobs=${[...open].join(",")}`));
    own.addEventListener("snapshot", (event) => seen?.(JSON.parse(event.data)));
    for (const kind of ["created", "started", "resumed", "cancelling", "progress", "remark", "end"]) {
      own.addEventListener(kind, (/** @type {MessageEvent<string>} */ event) => {
        const told = JSON.parse(event.data);
        heard(kind, told);
        if (kind === "end" && open.delete(told.job) && !open.size) stop();
      });
    }
    own.onerror = () => {
      if (own.readyState === EventSource.CLOSED && !over) again = window.setTimeout(begin, 3000);
    };
  };
  const stop = () => {
    over = true;
    clearTimeout(again);
    stream?.close();
  };
  begin();
  addEventListener("pagehide", stop, { once: true });
  return stop;
}

/**
 * Return the status of a refusal; of any other fault 0.
 * @param {unknown} error
 */
export const statusOf = (error) => (error instanceof Refusal ? error.status : 0);

/**
 * Return what is wrong in the input, as far as a fault says it.
 * @param {unknown} error
 */
export const problemsOf = (error) => (error instanceof Refusal ? error.problems : []);

/**
 * Return the message of a fault as a sentence.
 * @param {unknown} error
 */
export const messageOf = (error) => sentence(error instanceof Error ? error.message : String(error));

/**
 * Return a refusal as it is shown.
 * @param {unknown} error
 * @param {() => void} [retry]
 */
export function faultCard(error, retry) {
  const number = error instanceof Refusal && error.number ? h("p", { class: "note" }, `Number of the request: ${error.number}`) : null;
  return h("section", { class: "card", role: "alert" }, h("p", { class: "fault" }, messageOf(error)), number,
    retry ? h("p", { class: "row" }, h("button", { type: "button", onclick: retry }, "Try again")) : null);
}

/**
 * Return a message of the service as a sentence.
 * @param {string | null | undefined} text
 */
export const sentence = (text) => (text ? text[0].toUpperCase() + text.slice(1) + (/[.!?:]$/.test(text) ? "" : ".") : "");

document.getElementById("sign-out")?.addEventListener("click", async () => {
  await ask("DELETE", "/session");
  location.assign("/sign-in");
});

// On a phone the navigation is wider than the window: where one is shall be seen.
document.querySelector(".top [aria-current]")?.scrollIntoView({ block: "nearest", inline: "center" });
