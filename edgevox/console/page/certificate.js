/** Where one learns to trust the robot's own certificate: over HTTPS only, elsewhere there is none. */
import { h } from "./dom.js";
import { say } from "./words.js";

export function certificateLink() {
  return h("p", { class: "small-text", hidden: location.protocol !== "https:" }, h("a", { href: "/ca" }, say("certificate")));
}
