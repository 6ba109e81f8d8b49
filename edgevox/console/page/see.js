/** What is seen: map or picture, how far the goal is, joints, hand and things; with it what steers the robot. */
import { joystick } from "./do.js";
import { h } from "./dom.js";
import { socketAddress } from "./link.js";
import { mapCard } from "./map.js";
import { holdToTalk } from "./talk_sound.js";
import { number, say } from "./words.js";

const SLOW_MS = 400;

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 * @param {import("./talk_sound.js").Speech} speech
 */
export function seePanel(store, link, speech) {
  const map = mapCard(store, link);
  const facts = h("div", { class: "facts" });
  const progress = h("progress", { max: "1", "aria-label": say("goal") });
  const goal = h("div", { class: "goal row tight", hidden: true }, progress, h("span", { class: "quiet" }));
  const joints = h("div", { class: "joints", hidden: true });
  const steer = h("div", { class: "steer" }, joystick(store, link), holdToTalk(store, speech));
  // What steers stands last, at an edge: it never moves under a finger when a goal or a fact comes or goes.
  const panel = h("section", { class: "card see-card" },
    h("div", { class: "seen" }, h("div", { class: "views" }, map, pictureCard(store)), goal, joints, facts), steer);
  const arrange = () => {
    map.hidden = store.capabilities.map === false || (!store.scene && !store.capabilities.map);
    panel.hidden = map.hidden && !store.capabilities.picture && !store.capabilities.drive && !store.live.joints;
  };
  for (const type of ["hello", "scene"]) store.on(type, arrange);
  let shown = 0;
  store.on("live", () => {
    const now = performance.now();
    if (now - shown < SLOW_MS) return;
    shown = now;
    showGoal(goal, progress, store.live.goal);
    showJoints(joints, store.live.joints);
    showFacts(facts, factsOf(store));
  });
  return panel;
}

/** @param {HTMLElement} box @param {HTMLProgressElement} progress @param {import("./wire.js").Live["goal"]} goal */
function showGoal(box, progress, goal) {
  box.hidden = !goal;
  if (!goal) return;
  progress.value = goal.progress ?? 0;
  /** @type {HTMLElement} */ (box.lastChild).textContent = goal.distance ? say("metres_left", { distance: number(goal.distance) })
    : `${number(100 * (goal.progress ?? 0), 0)} %`;
}

/** @param {HTMLElement} box @param {import("./wire.js").Joint[] | undefined} joints */
function showJoints(box, joints) {
  box.hidden = !joints?.length;
  if (!joints) return;
  if (box.children.length !== joints.length)
    box.replaceChildren(...joints.map((one) => h("div", { class: "joint" }, h("span", { class: "quiet" }, one.name),
      h("meter", { min: one.lower ?? -Math.PI, max: one.upper ?? Math.PI, "aria-label": one.name }), h("output"))));
  joints.forEach((one, i) => {
    const row = box.children[i];
    /** @type {HTMLMeterElement} */ (row.children[1]).value = one.value;
    row.children[2].textContent = number(one.value, 2);
  });
}

/** Each in its place: whoever reads or selects one keeps it. @param {HTMLElement} box @param {[string, string][]} facts */
function showFacts(box, facts) {
  while (box.children.length > facts.length) box.lastChild?.remove();
  while (box.children.length < facts.length)
    box.append(h("div", { class: "fact" }, h("span", { class: "quiet" }), h("strong", { dir: "auto" })));
  facts.forEach((words, i) => words.forEach((text, at) => {
    const part = box.children[i].children[at];
    if (part.textContent !== text) part.textContent = text;
  }));
}

/** @param {import("./store.js").Store} store @returns {[string, string][]} */
function factsOf(store) {
  const { live } = store;
  /** @type {[string, string][]} */
  const facts = [];
  if (live.velocity) facts.push([say("speed"), `${number(Math.abs(live.velocity.linear), 2)} m/s`]);
  if (live.pose) facts.push([say("place"), `${number(live.pose.x)}, ${number(live.pose.y)} m`]);
  if (live.hand) {
    const open = typeof live.hand.open === "number" ? live.hand.open > 0.5 : live.hand.open;
    facts.push([say("hand"), live.hand.holding ? store.called({ name: live.hand.holding }) : say(open ? "hand_open" : "hand_closed")]);
  }
  for (const thing of live.things ?? [])
    facts.push([store.called(thing), thing.held ? say("held") : `${number(thing.x, 2)}, ${number(thing.y, 2)} m`]);
  return facts;
}

// Pictures of the robot's camera: the next one is asked for when this one is shown.

const AGAIN_MS = 2000;

/** @param {import("./store.js").Store} store */
function pictureCard(store) {
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
