/**
 * Loads the page. One whose parts did not all come, since the network changed meanwhile, is loaded
 * again: browsers keep a module that failed as failed.
 */
const AGAIN_MS = 1000;

const again = () => setTimeout(() => location.reload(), AGAIN_MS);
const styles = /** @type {NodeListOf<HTMLLinkElement>} */ (document.querySelectorAll("link[rel=stylesheet]"));

import("./main.js").then(
  () => [...styles].every((style) => style.sheet?.cssRules.length) || again(),
  (error) => {
    console.error(error);
    if (error instanceof TypeError) again();
  },
);
