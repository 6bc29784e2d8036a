// What eslint's recommended rules hold, without a package of configurations.
const browser = [
  "Blob",
  "Path2D",
  "ResizeObserver",
  "URL",
  "WebSocket",
  "devicePixelRatio",
  "document",
  "getComputedStyle",
  "location",
  "matchMedia",
  "requestAnimationFrame",
  "setTimeout",
  "window",
];

export default [
  {
    languageOptions: {
      ecmaVersion: 2024,
      sourceType: "module",
      globals: Object.fromEntries(browser.map((name) => [name, "readonly"])),
    },
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      curly: "error",
      eqeqeq: "error",
      "no-const-assign": "error",
      "no-dupe-keys": "error",
      "no-fallthrough": "error",
      "no-redeclare": "error",
      "no-self-compare": "error",
      "no-shadow": "error",
      "no-undef": "error",
      "no-unreachable": "error",
      "no-unused-vars": "error",
      "no-use-before-define": ["error", { functions: false, variables: false, classes: false }],
      "no-var": "error",
      "prefer-const": "error",
    },
  },
];
