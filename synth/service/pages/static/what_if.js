// The strip below a front: sliders for requirements and limits; each release is a search of its own.

import { get, listen, messageOf, post, sentence } from "./api.js";
import { duration, h } from "./dom.js";
import { asTyped } from "./as_typed.js";
import { seek } from "./nothing_view.js";
import { asked, stopped } from "./what_if_jobs.js";
import { filling, knobsOf, numbersOf, patchOf, shown, valuesOf } from "./what_if_knobs.js";
import { Slider } from "./what_if_slider.js";
import { marksOf } from "./what_if_track.js";
import { difference } from "./what_if_words.js";
import { LIVE, stageText } from "./words.js";

const RECORD = "explorer.json";
const LONG = 10; // s that a search has taken, from which on none starts by itself
const GRACE = 1500; // ms that a short search is left to itself when it is no longer wanted
const CALM = 1000; // ms that a value is looked at, before more than its front is looked for
const MOST = 4; // sliders

/**
 * @typedef {import("./what_if_knobs.js").Knob} Knob
 * @typedef {import("../../../../reports/explorer/options.js").Handle} Handle
 * @typedef {import("../../../../reports/explorer/record.js").FrontRecord} FrontRecord
 * @typedef {import("./answers.js").JobAnswer} Job
 * @typedef {import("./records.js").Patch} Patch
 * @typedef {import("./records.js").Study} Study
 * @typedef {object} Page what the strip knows of the page around it
 * @property {Job} job
 * @property {FrontRecord} record
 * @property {import("./records.js").Spec} request
 * @property {string} state
 * @property {(text: string) => void} onState
 * @property {(job: Job, moved: string) => void} onJob
 */

/**
 * Fill the strip.
 * @param {HTMLElement} slot
 * @param {Handle} handle of the explorer
 * @param {Page} page
 */
export async function whatIf(slot, handle, page) {
  const { request } = page;
  const options = Object.entries(request.options ?? {}).map(([name, value]) => `${name}:${value}`).join(",");
  const [family, read] = await Promise.all([get(`/families/${request.family}${options ? `?options=${encodeURIComponent(options)}` : ""}`), post("/check", request).then(({ read }) => read, () => ({}))]);
  const knobs = knobsOf(request, family.rows, read, page.record);
  if (!knobs.length) return slot.setAttribute("hidden", "");
  return new Strip(slot, handle, page, knobs).begin();
}

export class Strip {
  /**
   * @param {HTMLElement} slot
   * @param {Handle} handle
   * @param {Page} page
   * @param {Knob[]} knobs
   */
  constructor(slot, handle, page, knobs) {
    this.slot = slot;
    this.handle = handle;
    this.page = page;
    this.knobs = knobs;
    /** @type {Slider[]} */
    this.sliders = [];
    this.number = 0; // of the last search
    /** @type {{id: string, stop: () => void} | null} */
    this.live = null; // the search that runs
    this.holding = false;
    /** @type {(() => void) | null} */
    this.held = null; // what is shown when a finger is lifted
    /** @type {Map<Knob, ReturnType<typeof marksOf> | null>} */
    this.fills = new Map();
    /** @type {Job | null} */
    this.shown = null; // whose front is shown in place of the one as asked
    /** @type {{own: number, id: string} | null} */
    this.explaining = null;
    this.filling = ""; // the study of a track that runs
    /** @type {Job[] | null} */
    this.earlier = null;
    this.took = page.job.started && page.job.ended ? page.job.ended - page.job.started : 0;
    this.slow = this.took > LONG;
    this.list = h("div", { class: "knobs" });
    this.line = h("p", { class: "told", "aria-live": "polite" });
    this.add = h("button", { type: "button", class: "small", onclick: () => this.another() }, "Add another");
    this.reset = h("button", { type: "button", class: "small", onclick: () => this.back() }, "Back to what was asked");
    this.fresh = h("a", { class: "button small" }, "Open as a study");
    this.askJob = h("button", { type: "button", class: "small primary", onclick: () => this.asJob() }, "Ask as a job");
    slot.replaceChildren(this.list, this.line, h("div", { class: "row" }, this.askJob, this.reset, this.fresh, this.add));
    addEventListener("resize", () => this.sliders.forEach((slider) => slider.ticks()));
  }

  begin() {
    for (const entry of new URLSearchParams(this.page.state).getAll("if").slice(0, MOST)) {
      const [key, value] = entry.split("~");
      const knob = this.knobs.find((one) => one.key === key);
      if (knob && !this.sliders.some((one) => one.knob === knob) && Number.isFinite(Number(value)) && value !== "") this.sliders.push(new Slider(this, knob, Number(value)));
    }
    if (!this.sliders.length) this.sliders.push(new Slider(this, this.knobs[0], this.knobs[0].base));
    this.lay();
    this.say();
    if (this.moved().length && !this.slow) this.search();
    this.recall();
    return this;
  }

  /** Lay out the sliders. */
  lay() {
    this.list.replaceChildren(...this.sliders.map((slider) => slider.element));
    this.sliders.forEach((slider, k) => slider.place(k, this.sliders.length));
    this.add.hidden = this.sliders.length >= MOST || this.sliders.length >= this.knobs.length;
    this.buttons();
  }

  /** @returns {[Knob, number][]} knobs that do not stand at what was asked, with their values */
  moved() {
    return this.sliders.flatMap(({ knob, value }) => (value === null || value === knob.base ? [] : [[knob, value]]));
  }

  buttons() {
    const moved = this.moved().length > 0;
    this.reset.hidden = !moved;
    this.askJob.hidden = !(this.slow && moved);
    this.fresh.hidden = !this.shown;
    if (this.shown) this.fresh.setAttribute("href", `/jobs/${this.shown.id}`);
  }

  /** @param {(Node | string)[]} parts */
  say(...parts) {
    if (parts.length) return this.line.replaceChildren(...parts);
    const slow = `The search took ${duration(this.took)}: too long to follow a slider. Set values, and ask for them as a job.`;
    return this.line.replaceChildren(this.slow ? slow : `This is the front as asked. Move the slider: it stays as outlines, and the new front is searched anew (${duration(Math.max(0.1, this.took))}) and proven again.`);
  }

  another() {
    const free = this.knobs.find((knob) => !this.sliders.some((slider) => slider.knob === knob));
    if (!free) return;
    const slider = new Slider(this, free, free.base);
    this.sliders.push(slider);
    this.lay();
    slider.select.focus();
    this.recall();
  }

  /** @param {Slider} slider */
  remove(slider) {
    const moved = slider.value !== slider.knob.base;
    this.sliders = this.sliders.filter((one) => one !== slider);
    this.lay();
    this.sliders.at(-1)?.select.focus();
    if (moved) this.released();
  }

  /** A value was let go. */
  released() {
    this.page.onState(this.state());
    this.buttons();
    this.held = null;
    if (!this.moved().length) return this.back();
    if (this.slow) return this.say();
    return this.search();
  }

  state() {
    return this.moved().map(([knob, value]) => `if=${encodeURIComponent(`${knob.key}~${value}`)}`).join("&");
  }

  /** Show the front as asked. */
  back() {
    this.number += 1;
    this.cancel();
    for (const slider of this.sliders) slider.set(slider.knob.base);
    this.page.onState("");
    if (this.shown) {
      this.shown = null;
      this.page.onJob(this.page.job, "");
      this.handle.compareWith(null);
      this.handle.update(this.page.record);
    }
    this.slot.classList.remove("busy");
    this.buttons();
    this.say();
  }

  /** Cancel what is searched and no longer wanted. */
  cancel() {
    const { live } = this;
    this.live = null;
    if (!live) return;
    live.stop();
    this.give(live.id);
  }

  /** @param {string} id of a job that nobody waits for; a short one is not cancelled before its end is due, as a process that is ended costs more */
  give(id) {
    setTimeout(async () => {
      if (![this.live?.id, this.shown?.id].includes(id)) await stopped(id);
    }, 1000 * this.took < GRACE ? GRACE : 0);
  }

  body() {
    const moved = this.moved();
    const title = `${moved.map(([knob, value]) => `${knob.label} ${shown(knob, value)}`).join(", ")}: ${this.page.job.title}`.slice(0, 200);
    return { kind: "synthesis", request: { of: this.page.job.id, ...patchOf(moved) }, title, parent: this.page.job.id };
  }

  async asJob() {
    try {
      location.assign(`/jobs/${(await asked(this.body())).id}`);
    } catch (error) {
      this.say(h("span", { class: "fault" }, messageOf(error)));
    }
  }

  async search() {
    const own = (this.number += 1);
    const begun = performance.now();
    const what = this.moved().map(([knob, value]) => `${knob.label} ${shown(knob, value)}`).join(", ");
    const patch = patchOf(this.moved());
    this.cancel();
    this.slot.classList.add("busy");
    this.say(`Searching anew with ${what} …`);
    try {
      const job = await asked(this.body());
      if (own !== this.number) return this.give(job.id);
      const ended = await this.follow(job, (stage) => own === this.number && this.say(`Searching anew with ${what}: ${stage.toLowerCase()} …`));
      if (own !== this.number) return undefined;
      const record = ended.state === "done" || ended.summary?.designs ? asTyped(/** @type {FrontRecord} */ (await get(`/jobs/${ended.id}/files/${RECORD}`)), { ...this.page.request.requirements, ...patch.requirements }) : null;
      if (own !== this.number) return undefined;
      const show = () => {
        if (own === this.number) this.show(ended, record, what);
      };
      if (this.holding) this.held = show; // nothing is exchanged below a finger
      else show();
      this.slot.dataset.took = String(Math.round(performance.now() - begun));
    } catch (error) {
      if (own === this.number) this.failed(messageOf(error));
    }
    return undefined;
  }

  /**
   * Wait for the end of a job.
   * @param {Job} job
   * @param {(stage: string) => void} told
   * @returns {Promise<Job>}
   */
  follow(job, told) {
    if (!LIVE.includes(job.state)) return Promise.resolve(job);
    return new Promise((done, fail) => {
      const ended = () => {
        this.live = null;
        get(`/jobs/${job.id}`).then(done, fail);
      };
      const stop = listen([job.id], (kind, news) => {
        if (kind === "progress") told(stageText(news));
        if (kind === "end") ended();
      }, (seen) => LIVE.includes(seen.state) || ended());
      this.live = { id: job.id, stop };
    });
  }

  /** @param {string} text */
  failed(text) {
    this.slot.classList.remove("busy");
    this.say(h("span", { class: "fault" }, text), " Shown is the front as it was before.");
  }

  /**
   * @param {Job} job
   * @param {FrontRecord | null} record
   * @param {string} what
   */
  show(job, record, what) {
    if (!record) return this.failed(job.error ? sentence(job.error.message) : "The search has ended without an answer.");
    this.slot.classList.remove("busy");
    this.shown = job;
    this.page.onJob(job, what);
    this.handle.compareWith(this.page.record);
    this.handle.update(record);
    this.buttons();
    if (record.designs.length) this.say(h("b", {}, `With ${what}`), ` against the front as asked: ${difference(this.page.record, record)}`);
    else this.say(h("b", {}, `With ${what} nothing meets all limits.`), " ", this.edge());
    const own = this.number;
    if (record.designs.length) setTimeout(() => own === this.number && this.fill(), CALM);
    return undefined;
  }

  /** Tell from where on there are designs, if a study has found it. */
  edge() {
    const ends = this.sliders.filter((slider) => slider.value !== slider.knob.base).flatMap((slider) => slider.found?.marks.filter((mark) => mark.ends) ?? []);
    return ends.length ? `${ends.map((mark) => mark.text.split(":")[0].replace(/^It /, "It ")).join("; ")}.` : "";
  }

  /** @param {HTMLElement} place that ways out fill */
  ways(place) {
    const job = this.shown;
    if (!job) return;
    const apply = (/** @type {Patch} */ patch) => {
      const values = valuesOf(patch, this.knobs);
      const room = values && values.filter(([knob]) => !this.sliders.some((slider) => slider.knob === knob)).length + this.sliders.length <= MOST;
      return values && room ? () => this.take(values) : null;
    };
    const own = this.number;
    const latest = () => this.explaining?.own === own;
    const told = () => {
      if (!latest()) return;
      this.explaining = null;
      this.fill();
    };
    /** @type {import("./nothing_view.js").Ways} */
    const how = { heading: "h3", begin: true, apply, asked: (job) => { if (this.explaining && latest()) this.explaining.id = job.id; }, told };
    place.replaceChildren(h("h3", {}, "Looking for ways out"));
    const begin = () => {
      if (own !== this.number) return;
      for (const id of [this.explaining?.id, this.filling]) if (id) stopped(id); // one process stays free for the next value
      this.explaining = { own, id: "" };
      seek(place, job, how).catch((error) => {
        told();
        place.replaceChildren(h("p", { class: "fault" }, messageOf(error)));
      });
    };
    setTimeout(begin, CALM);
  }

  /** @param {[Knob, number][]} values */
  take(values) {
    for (const [knob, value] of values) {
      const there = this.sliders.find((slider) => slider.knob === knob);
      if (there) there.set(value);
      else this.sliders.push(new Slider(this, knob, value));
    }
    this.lay();
    this.released();
    this.sliders[0].range.focus();
  }

  // -- what is known along the tracks ---------------------------------------------------------

  /** Take up studies that were asked before. */
  async recall() {
    try {
      /** @type {Job[]} */
      const earlier = this.earlier ?? (await get(`/jobs?kind=whatif&parent=${this.page.job.id}&limit=50`)).jobs;
      this.earlier ??= earlier;
      for (const slider of this.sliders) {
        if (this.fills.has(slider.knob)) continue;
        const known = earlier.filter((job) => ["open", "running", "done"].includes(job.state) && job.title.startsWith(fillTitle(slider.knob)));
        if (known.length) await this.filled(slider.knob, known[0]);
        else slider.ticks();
      }
    } catch {
      /* tracks stay empty */
    }
  }

  /** Ask for a study of every slider that was moved, once; ways out go first. */
  async fill() {
    for (const { knob } of this.sliders.filter((slider) => slider.value !== slider.knob.base)) {
      if (this.explaining) return;
      if (this.fills.has(knob)) continue;
      this.fills.set(knob, null);
      const { job } = this.page;
      const body = { kind: "whatif", request: { of: job.id, vary: filling(knob), breaks: true }, title: `${fillTitle(knob)}${job.title}`.slice(0, 200), parent: job.id, priority: 0 };
      try {
        await this.filled(knob, await asked(body));
      } catch {
        /* the track stays empty */
      }
    }
  }

  /**
   * @param {Knob} knob
   * @param {Job} job
   */
  async filled(knob, job) {
    this.fills.set(knob, null);
    const slider = () => this.sliders.find((one) => one.knob === knob);
    slider()?.note("looking along the track …");
    this.filling = job.id;
    /** @type {string} */
    const state = await new Promise((done) => {
      if (!LIVE.includes(job.state)) done(job.state);
      else listen([job.id], (kind, news) => kind === "end" && done(news.state), (seen) => LIVE.includes(seen.state) || done(seen.state));
    });
    this.filling = "";
    const study = state === "done" ? /** @type {Study} */ (await get(`/jobs/${job.id}/result`)) : null;
    if (study) this.fills.set(knob, marksOf(study));
    else this.fills.delete(knob); // it is asked again
    slider()?.ticks();
  }
}

/**
 * Return how the title of a study begins that fills a track: by this it is known again.
 * @param {Knob} knob
 */
const fillTitle = (knob) => `What if: ${knob.label} ${shown(knob, numbersOf(knob).at(0) ?? null)} to ${shown(knob, numbersOf(knob).at(-1) ?? null)}, `;
