// How modules of the explorer are found: those of synth/ui stand beside them where they are handed out.

import { register } from "node:module";

const UI = new URL("../../synth/ui/", import.meta.url);
const HOOK = `export const resolve = (name, context, next) =>
  next(name, context).catch(() => next(new URL(name, ${JSON.stringify(UI)}).href, context));`;

register(`data:text/javascript,${encodeURIComponent(HOOK)}`);

/**
 * Return a module of the explorer.
 * @template T
 * @param {string} name
 * @returns {Promise<T>}
 */
export const explorerModule = (name) => import(new URL(`../../reports/explorer/${name}`, import.meta.url).href);
