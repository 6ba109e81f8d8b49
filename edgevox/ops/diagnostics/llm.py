"""The component `llm`: the language model, on board or on a server."""

from dataclasses import dataclass

from edgevox.ops.diagnostics.component import Component, Finding, Level, component


@dataclass(frozen=True, slots=True)
class Thinking:
    """What is known of the language model.

    `model` is the file on board, empty if there is none; `endpoint_trouble` why the server is not
    asked now, `absent` why there is no model on board though one was asked for. `failing` is
    whether an answer failed of late.
    """

    model: str = ""
    endpoint: str = ""
    endpoint_trouble: str = ""
    context_tokens: int = 0
    tokens_per_s: float | None = None
    failed: int = 0
    failing: bool = False
    absent: str = ""


def llm(seen: Thinking) -> Component:
    """A server that is gone is a warning while the model on board answers, else an error."""
    found = []
    if seen.absent:
        found.append(Finding(Level.ERROR, f"the model on board is missing: {seen.absent}"))
    if seen.endpoint_trouble:
        level = Level.WARN if seen.model else Level.ERROR
        instead = "the model on board answers" if seen.model else "nothing answers"
        text = f"{seen.endpoint} fails: {seen.endpoint_trouble}; {instead}"
        found.append(Finding(level, text))
    if seen.failing:
        text = f"an answer failed, {seen.failed} by now; the log says why"
        found.append(Finding(Level.ERROR, text))
    return component(
        "llm",
        found,
        well="thinks",
        model=seen.model or None,
        endpoint=seen.endpoint or None,
        answers="on board" if seen.endpoint_trouble or not seen.endpoint else "endpoint",
        context_tokens=seen.context_tokens,
        tokens_per_s=seen.tokens_per_s,
        failed=seen.failed,
    )
