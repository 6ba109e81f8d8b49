"""The component `llm` of the status: the language model on board or on a server."""

from pathlib import Path

from edgevox.agent.llm.language_model import LanguageModel
from edgevox.core.clock import Clock
from edgevox.core.servers.health import ServerHealth
from edgevox.core.status import (
    ComponentName,
    Finding,
    Gauges,
    HealthCheck,
    Level,
    RecentIncrease,
    Status,
    fault_of,
)


class LlmComponent:
    """A server that is gone is a warning while the model on board answers, else an error.

    `weights` is the file of the model on board, None if there is none, and `absent` why there is
    none though one was asked for. `endpoint` is the server's address, empty without one.
    """

    name = ComponentName.LLM

    def __init__(
        self,
        model: LanguageModel,
        gauges: Gauges,
        *,
        weights: Path | None = None,
        endpoint: str = "",
        absent: str = "",
        clock: Clock | None = None,
    ) -> None:
        self._model, self._gauges, self._endpoint, self._absent = model, gauges, endpoint, absent
        self._on_board = weights.name if weights else None
        self._failing = RecentIncrease(clock)
        self.checks = (HealthCheck("llm", lambda: absent, vital=False),) if absent else ()

    def status(self) -> Status:
        """The status now."""
        fault, failed, found = fault_of(self._model), self._gauges.model_failures, []
        if self._absent:
            found.append(Finding(Level.ERROR, f"the model on board is missing: {self._absent}"))
        if fault:
            level = Level.WARN if self._on_board else Level.ERROR
            instead = "the model on board answers" if self._on_board else "nothing answers"
            which = self._endpoint or "the model"
            found.append(Finding(level, f"{which} fails: {fault}; {instead}"))
        if self._failing.grew(failed):
            text = f"an answer failed, {failed} by now; the log says why"
            found.append(Finding(Level.ERROR, text))
        server: ServerHealth | None = getattr(self._model, "health", None)
        return Status.judged(
            self.name,
            found,
            well="thinks",
            model=self._on_board,
            endpoint=self._endpoint or None,
            answers="on board" if fault or not self._endpoint else "endpoint",
            context_tokens=self._model.context_tokens,
            tokens_per_s=self._gauges.tokens_per_s,
            failed=failed,
            **(server.figures() if server else {}),
        )
