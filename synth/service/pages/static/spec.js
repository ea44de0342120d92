// A study as it is written down: as YAML, as a request over HTTP, and in Python. All three say the same.

const PLAIN = /^[A-Za-z_][A-Za-z0-9_ .*/<>()-]*$/;
const WORDS = /^(true|false|yes|no|on|off|null|none|y|n|nan|inf)$/i;

/** @typedef {import("./records.js").Spec} Spec */
/** @typedef {{kind: string, request: Spec, title?: string}} Asked */

/**
 * Return a spec as YAML.
 * @param {object} value
 * @returns {string}
 */
export function yamlText(value, indent = "") {
  return Object.entries(value).map(([name, entry]) => {
    if (Array.isArray(entry)) return `${indent}${scalar(name)}: [${entry.map(flow).join(", ")}]`;
    if (entry !== null && typeof entry === "object") {
      return Object.keys(entry).length ? `${indent}${scalar(name)}:\n${yamlText(entry, `${indent}  `)}` : `${indent}${scalar(name)}: {}`;
    }
    return `${indent}${scalar(name)}: ${scalar(entry)}`;
  }).join("\n");
}

/** @param {unknown} value */
function scalar(value) {
  if (typeof value !== "string") return JSON.stringify(value);
  return isPlain(value) || /^\d[\d.]*(e[-+]?\d+)? [A-Za-z0-9*/()]+$/.test(value) ? value : JSON.stringify(value);
}

/** @param {string} text */
const isPlain = (text) => PLAIN.test(text) && !WORDS.test(text) && text.trim() === text && !text.includes(" -");
/** @param {unknown} value */
const flow = (value) => (typeof value === "string" ? (isPlain(value) ? value : JSON.stringify(value)) : JSON.stringify(value));

/**
 * Return a command that asks for a study.
 * @param {Asked} body
 */
export function curlText(body) {
  const said = JSON.stringify(body, null, 2).replaceAll("'", "'\\''");
  return `curl -s ${location.origin}/api/v1/jobs \\\n  -H "Authorization: Bearer $TOKEN" \\\n  -H "Content-Type: application/json" -d '${said}'`;
}

const ARGUMENTS = ["objectives", "parts", "limits", "fix", "weights", "points", "gap", "grid", "seed", "time_limit", "robust"];

/**
 * Return a program that finds the designs: at one's own machine, or by the service where the spec needs what it keeps.
 * @param {Asked} body
 */
export function pythonText(body) {
  const { family, options = {}, requirements = {}, ...more } = body.request;
  if (body.kind === "compare") return comparingText(body.request);
  if (!Object.keys(more).every((name) => ARGUMENTS.includes(name))) return askingText(body);
  const chosen = Object.entries(options);
  const problem = chosen.length ? `synth.load(${[python(family), ...chosen.map(([name, value]) => `${name}=${python(value)}`)].join(", ")})` : python(family);
  const said = [problem, python(requirements, "    "), ...Object.entries(more).map(([name, value]) => `${name}=${python(value, "    ")}`)];
  return `import synth\n\nfront = synth.synthesize(\n${said.map((line) => `    ${line},\n`).join("")})\nfront.save("out/")`;
}

/** @param {Spec} request */
function comparingText({ family, requirements = {}, ...more }) {
  if (!Object.keys(more).every((name) => [...ARGUMENTS, "options"].includes(name))) return askingText({ kind: "compare", request: { family, requirements, ...more } });
  const said = [python(family), python(requirements, "    "), ...Object.entries(more).map(([name, value]) => `${name}=${python(value, "    ")}`)];
  return `import synth\n\nfound = synth.compare(\n${said.map((line) => `    ${line},\n`).join("")})\nfound.save("out/")`;
}

/** @param {Asked} body */
function askingText(body) {
  const { request, ...rest } = body;
  return [
    "import os", "import time", "", "import httpx", "",
    "service = httpx.Client(", `    base_url=${python(`${location.origin}/api/v1/`)},`, '    headers={"Authorization": f"Bearer {os.environ.get(\'TOKEN\', \'\')}"},', ")",
    `request = ${python(request)}`,
    `job = service.post("jobs", json=${python({ ...rest, request: NAME })}).raise_for_status().json()`,
    'while job["state"] in ("open", "running"):', "    time.sleep(1)", '    job = service.get(f"jobs/{job[\'id\']}").json()',
    'print(service.get(f"jobs/{job[\'id\']}/designs").json())',
  ].join("\n");
}

const NAME = Symbol("request");

/**
 * @param {unknown} value
 * @param {string} [indent]
 * @returns {string}
 */
function python(value, indent = "") {
  if (value === NAME) return "request";
  if (value === null) return "None";
  if (typeof value === "boolean") return value ? "True" : "False";
  if (Array.isArray(value)) return `[${value.map((entry) => python(entry, indent)).join(", ")}]`;
  if (typeof value !== "object") return JSON.stringify(value);
  const entries = Object.entries(value);
  if (entries.length < 4 && entries.every(([, entry]) => typeof entry !== "object" || entry === NAME)) {
    return `{${entries.map(([name, entry]) => `${JSON.stringify(name)}: ${python(entry)}`).join(", ")}}`;
  }
  return `{\n${entries.map(([name, entry]) => `${indent}    ${JSON.stringify(name)}: ${python(entry, `${indent}    `)},\n`).join("")}${indent}}`;
}
