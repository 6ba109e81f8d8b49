/** The line to the robot, which is there before the page is, so that Stop is. */
import { paired, stopPressed } from "./boot.js";
import { Link } from "./link.js";
import { Store } from "./store.js";
import { loadWords, say } from "./words.js";

export const store = new Store();
export const link = new Link(store);

const stop = document.querySelector("button.stop");
loadWords().then(() => stop && (stop.textContent = say("stop")), () => {}); // whoever waits for them is told
if (paired) link.open();
stopPressed.then(() => link.stopSoon());
