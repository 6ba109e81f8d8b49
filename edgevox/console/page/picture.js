/** Pictures of the robot's camera: the next one is asked for when this one is shown. */
import { h } from "./dom.js";
import { socketAddress } from "./link.js";
import { say } from "./words.js";

const AGAIN_MS = 2000;

/** @param {import("./store.js").Store} store */
export function pictureCard(store) {
  const image = h("img", { class: "picture", alt: say("camera"), hidden: true });
  const card = h("div", { class: "picture-card", hidden: true }, image);
  /** @type {WebSocket | null} */
  let socket = null;
  let url = "";
  const wanted = () => store.link === "ready" && store.capabilities.picture && !document.hidden && card.offsetParent !== null;
  const open = () => {
    const made = (socket = new WebSocket(socketAddress("/ws/view")));
    made.binaryType = "blob";
    made.onopen = () => made.send("ack");
    made.onmessage = (event) => {
      URL.revokeObjectURL(url);
      image.src = url = URL.createObjectURL(event.data);
    };
    const next = () => made.readyState === WebSocket.OPEN && made.send("ack");
    image.onload = () => {
      image.hidden = false;
      next();
    };
    image.onerror = next;
    made.onclose = () => made === socket && (socket = null);
  };
  const look = () => {
    card.hidden = !store.capabilities.picture;
    if (wanted() && !socket) open();
    if (!wanted() && socket) {
      socket.close();
      socket = null;
    }
  };
  for (const type of ["hello", "link"]) store.on(type, look);
  document.addEventListener("visibilitychange", look);
  setInterval(look, AGAIN_MS);
  return card;
}
