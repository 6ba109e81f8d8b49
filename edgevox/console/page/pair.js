/** How a browser is let in: with the code that the robot shows in its terminal and its log. */
import { h, sign } from "./dom.js";
import { certificateLink } from "./settings.js";
import { say, sayOr } from "./words.js";

/** @param {() => void} paired */
export function pairPage(paired) {
  const offer = new URLSearchParams(location.hash.slice(1));
  const code = h("input", { type: "text", class: "code", required: true, maxlength: "32", value: offer.get("pair") ?? "", autocomplete: "one-time-code",
    autocapitalize: "characters", spellcheck: "false", "aria-label": say("code"), "aria-describedby": "pair-why" });
  const name = h("input", { type: "text", maxlength: "40", autocomplete: "nickname" });
  const why = h("p", { class: "notice bad", role: "alert", id: "pair-why", hidden: true });
  const form = h("form", { class: "card pair stack" }, h("div", { class: "badge" }, sign("talk")), h("h1", {}, say("pair_title")),
    h("p", { class: "quiet" }, say("pair_how")), code,
    h("label", { class: "field" }, h("span", {}, say("device_name")), name), h("button", { class: "primary big", type: "submit" }, say("pair")), why,
    certificateLink());
  const tell = (/** @type {string} */ text) => {
    why.hidden = !text;
    why.textContent = text;
  };
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    tell("");
    try {
      const answer = await fetch("/api/pair", { method: "POST", headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ code: code.value.trim(), name: name.value.trim() }) });
      if (answer.ok) {
        history.replaceState(null, "", offer.has("phone") ? "/#phone" : "/");
        paired();
      } else tell(sayOr(`pair_${answer.status}`, say("pair_wrong")));
    } catch {
      tell(say("gone"));
    }
  });
  return h("main", { class: "pair-page" }, form);
}
