// Rules of the JavaScript that is shipped, and of its tests.

import js from "@eslint/js";
import globals from "globals";

const WIDTH = { "max-len": ["error", { code: 120, ignoreStrings: true, ignoreTemplateLiterals: true, ignoreRegExpLiterals: true }] };

export default [
  { ignores: ["**/*.min.js", ".venv/", "node_modules/", "build/", "dist/", "out/"] },
  js.configs.recommended,
  {
    languageOptions: { ecmaVersion: 2023, globals: globals.browser },
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      "eqeqeq": "error",
      "no-control-regex": "off", // control characters are what is looked for
      "no-implicit-globals": "error",
      "no-shadow-restricted-names": "error",
      "no-unused-vars": ["error", { ignoreRestSiblings: true }],
      "no-var": "error",
      "prefer-const": ["error", { destructuring: "all" }],
    },
  },
  { files: ["reports/explorer/**", "synth/ui/**", "tests/**"], rules: WIDTH },
  {
    files: ["reports/assets/**"], // scripts that stand in a page behind numbers.js
    languageOptions: { sourceType: "script", globals: { number: "readonly", usedShare: "readonly" } },
  },
  { files: ["tests/**"], languageOptions: { globals: globals.node } },
];
