"""The language model in EdgeVox, beside plain llama-cpp-python.

The same weights, chat, grammar and number of threads, each in a process of its own, by turns. Plain
is `Llama.create_chat_completion`.
"""

import multiprocessing
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

from benchmarks.core.figures import Figure, Measured, NotHere
from edgevox.agent.llm import weights
from edgevox.agent.llm.factory import load_model
from edgevox.agent.llm.language_model import CONTEXT_TOKENS, ChatMessage, LanguageModel, ModelFailed
from edgevox.agent.llm.protocol import grammar
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.model_answer import ANSWER_TOKENS
from edgevox.agent.turn import Turn
from edgevox.apps.robots import build_agents
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import SystemClock
from edgevox.models import ModelMissing, locate
from edgevox.robots.flat.apartment import ApartmentRobot

MODEL = "qwen2.5-coder-0.5b-instruct"
QUESTIONS = (
    "why is the sky blue",
    "how do bees make honey",
    "what is a lighthouse good for",
    "how does a bicycle stay upright",
    "why do people like to look at the sea",
    "what happens to the trees in autumn",
    "how do birds find their way south",
    "why is the sea salty",
    "what makes bread rise",
    "how does a candle burn",
    "why do cats sleep so much",
    "what are mountains made of",
)
"""No template catches them, and the model answers in words."""
PLAIN = "llama-cpp-python, plain"
TABLE = "The small language model, answering in words"


@dataclass(frozen=True, slots=True)
class Answer:
    """What was generated, and when: seconds from the question to the first piece and the last."""

    text: str
    pieces: int
    first_s: float
    last_s: float

    @property
    def rate(self) -> float:
        """Tokens a second, once the first is there."""
        return (self.pieces - 1) / (self.last_s - self.first_s)


class Watched:
    """A language model that notes when its pieces come."""

    def __init__(self, model: LanguageModel) -> None:
        self._model = model
        self.name, self.context_tokens = model.name, model.context_tokens
        self.prime, self.count_tokens, self.close = model.prime, model.count_tokens, model.close
        self.times: list[float] = []
        self.text = ""

    def generate(self, messages: Sequence[ChatMessage], **more: Any) -> Iterator[str]:
        for piece in self._model.generate(messages, **more):
            self.times.append(time.perf_counter())
            self.text += piece
            yield piece


class Ours:
    """EdgeVox's interpreter with a model, for one question after the other."""

    def __init__(self, backend: str) -> None:
        self._bus = Bus()
        self._model = Watched(load_model(locate(MODEL), backend))  # type: ignore[arg-type]
        self._interpreter = Interpreter(
            build_agents(ApartmentRobot()), self._bus, SystemClock(), self._model
        )
        self._model.prime(self._interpreter.chat(), CancelToken())
        self.close = self._model.close

    def ask(self, question: str) -> Answer:
        self._interpreter.forget()
        self._model.times, self._model.text = [], ""
        began = time.perf_counter()
        self._interpreter.understand(question, Turn(1, self._bus, SystemClock(), lambda: None))
        times = self._model.times
        return Answer(self._model.text, len(times), times[0] - began, times[-1] - began)


class Plain:
    """The library by itself. What it reads of a prompt again it keeps by itself, too."""

    def __init__(self) -> None:
        import llama_cpp

        self._interpreter = Interpreter(build_agents(ApartmentRobot()), Bus(), SystemClock())
        self._grammar: Callable[[], Any] = lambda: llama_cpp.LlamaGrammar.from_string(
            grammar(), verbose=False
        )
        threads = weights.default_threads()
        self._llama = llama_cpp.Llama(
            str(locate(MODEL)),
            n_ctx=CONTEXT_TOKENS,
            n_threads=threads,
            n_threads_batch=threads,
            verbose=False,
        )
        self.close = self._llama.close

    def ask(self, question: str) -> Answer:
        chat = self._interpreter.chat(question)
        text, times, began = "", [], time.perf_counter()
        for chunk in self._llama.create_chat_completion(
            [{"role": one.role, "content": one.content} for one in chat],
            max_tokens=ANSWER_TOKENS,
            temperature=0.0,
            grammar=self._grammar(),
            stream=True,
        ):
            piece = chunk["choices"][0]["delta"].get("content")
            if piece:
                times.append(time.perf_counter())
                text += piece
        return Answer(text, len(times), times[0] - began, times[-1] - began)


MAKERS: dict[str, Callable[[], Ours | Plain]] = {
    "plain": Plain,
    "xllamacpp": lambda: Ours("xllamacpp"),
    "llama-cpp-python": lambda: Ours("llama-cpp-python"),
}


class Elsewhere:
    """One of them in a process of its own: how OpenMP waits is one setting for a whole process."""

    def __init__(self, name: str) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, there = context.Pipe()
        self._process = context.Process(target=_serve, args=(name, there))
        self._process.start()
        reason = self._pipe.recv()
        if reason:
            self._process.join()
            raise NotHere(reason)

    def ask(self, question: str) -> Answer:
        self._pipe.send(question)
        answer: Answer = self._pipe.recv()
        return answer

    def close(self) -> None:
        self._pipe.send(None)
        self._process.join()


def measure(quick: bool = False) -> Measured:
    """All three, question by question; which of them begins changes."""
    answers: dict[str, list[Answer]] = {name: [] for name in MAKERS}
    with ExitStack() as stack:
        models: dict[str, Elsewhere] = {}
        for name in MAKERS:
            models[name] = Elsewhere(name)
            stack.callback(models[name].close)
        order = list(models)
        for question in QUESTIONS[:2] if quick else QUESTIONS:
            for name in order:
                answers[name].append(models[name].ask(question))
            order.append(order.pop(0))
    told = (f"{name}: {all_of_it[0].text.strip()}" for name, all_of_it in answers.items())
    return Measured(figures=tuple(_figures(answers)), notes={"The first answers": tuple(told)})


def _serve(name: str, pipe: Connection) -> None:
    """Be that process, until nothing more is asked."""
    try:
        one = MAKERS[name]()
    except (ImportError, ModelFailed, ModelMissing) as error:
        pipe.send(str(error))
        return
    one.ask("hello")
    pipe.send("")
    for question in iter(pipe.recv, None):
        pipe.send(one.ask(question))
    one.close()


def _figures(answers: dict[str, list[Answer]]) -> Iterator[Figure]:
    for name, told in answers.items():
        label = PLAIN if name == "plain" else f"EdgeVox on {name}"
        rates, firsts = [one.rate for one in told], [1000 * one.first_s for one in told]
        yield Figure.of(
            f"first.{name}", TABLE, label, firsts, "ms", column="to the first token",
            baseline="" if name == "plain" else "first.plain",
        )  # fmt: skip
        yield Figure.of(
            f"rate.{name}", TABLE, label, rates, "tokens/s", column="then",
            more_is_better=True, baseline="" if name == "plain" else "rate.plain",
        )  # fmt: skip
