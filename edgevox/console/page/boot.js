/**
 * Loads the page. One whose parts did not all come, since the network changed meanwhile, is loaded
 * again: browsers keep a module that failed as failed.
 */
import { loadWords } from "./words.js";

const AGAIN_MS = 1000;
/** Who this browser is to the robot; asked, like the words, before the rest of the page is here. */
export const me = fetch("/api/me", { cache: "no-store" });
me.catch(() => {}); // whoever waits for it is told
loadWords().catch(() => {});

const again = () => setTimeout(() => location.reload(), AGAIN_MS);
const styles = /** @type {NodeListOf<HTMLLinkElement>} */ (document.querySelectorAll("link[rel=stylesheet]"));

import("./main.js").then(
  () => [...styles].every((style) => style.sheet?.cssRules.length) || again(),
  (error) => {
    console.error(error);
    if (error instanceof TypeError) again();
  },
);
