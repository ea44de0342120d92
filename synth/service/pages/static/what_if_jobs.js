// The jobs behind a slider: asked once for the same question, and cancelled when nobody waits for them.

import { get, post, statusOf } from "./api.js";
import { LIVE } from "./words.js";

/** @typedef {import("./answers.js").JobAnswer} Job */

/**
 * Return a short word for a text: the same for the same text.
 * @param {string} text
 */
function digest(text) {
  let [a, b] = [0xdeadbeef, 0x41c6ce57];
  for (let k = 0; k < text.length; k += 1) {
    a = Math.imul(a ^ text.charCodeAt(k), 2654435761);
    b = Math.imul(b ^ text.charCodeAt(k), 1597334677);
  }
  return [a ^ (b >>> 15), b ^ (a >>> 13)].map((part) => (part >>> 0).toString(36)).join("");
}

/**
 * Cancel a job, if it has not ended.
 * @param {string} id
 */
export async function stopped(id) {
  const job = await get(`/jobs/${id}`).catch(() => null);
  if (job && LIVE.includes(job.state)) await post(`/jobs/${id}/cancel`).catch(() => {}); // it has ended just now
}

/**
 * Ask for a job, or take the one that was made of the same question; one that was cancelled goes on.
 * @param {{parent: string}} body
 * @returns {Promise<Job>}
 */
export async function asked(body) {
  let job;
  try {
    job = await post("/jobs", body, { "Idempotency-Key": `what-if-${body.parent}-${digest(JSON.stringify(body))}` });
  } catch (error) {
    if (statusOf(error) !== 409) throw error;
    return post("/jobs", body); // two questions with the same word: as good as never
  }
  if (["open", "running", "done"].includes(job.state)) return job;
  return post(`/jobs/${job.id}/resume`).catch(() => post("/jobs", body));
}
