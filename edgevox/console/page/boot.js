/**
 * Loads the page. One whose parts did not all come, since the network changed meanwhile, is loaded again: browsers
 * keep a module that failed as failed. The document's Stop works from its first picture on.
 */
const AGAIN_MS = 1000;
/** Whether the robot has let this browser in. */
export const paired = document.documentElement.hasAttribute("data-paired");
const stop = document.querySelector("button.stop");
/** The page has a Stop of its own once it is there. */
const replaced = new AbortController();

/** Ends when Stop is pressed before the page is there. @type {Promise<void>} */
export const stopPressed = new Promise((resolve) => {
  const { signal } = replaced;
  const press = () => {
    stop?.classList.add("pressed");
    resolve();
  };
  if (!paired || !stop) return stop?.remove();
  stop.addEventListener("pointerdown", (event) => /** @type {PointerEvent} */ (event).button === 0 && press(), { signal });
  stop.addEventListener("click", (event) => /** @type {MouseEvent} */ (event).detail === 0 && press(), { signal });
  document.addEventListener("keydown", (event) => event.code === "Space" && press(), { signal });
});

const again = () => setTimeout(() => location.reload(), AGAIN_MS);
const styles = /** @type {NodeListOf<HTMLLinkElement>} */ (document.querySelectorAll("link[rel=stylesheet]"));

import("./early.js")
  .then(() => import("./main.js"))
  .then(
    () => {
      replaced.abort();
      if (![...styles].every((style) => style.sheet?.cssRules.length)) again();
    },
    (error) => {
      console.error(error);
      if (error instanceof TypeError) again();
    },
  );
