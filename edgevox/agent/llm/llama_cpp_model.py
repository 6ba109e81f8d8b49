"""A language model run by llama-cpp-python, for machines whose users compile it themselves."""

import codecs
import ctypes
import importlib
import itertools
import logging
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from edgevox.agent.llm import weights
from edgevox.agent.llm.language_model import CONTEXT_TOKENS, ChatMessage, ModelFailed
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import install_extra
from edgevox.core.log import get_logger

log = get_logger(__name__)

_ERROR_LEVEL = 4


class LlamaCppModel:
    """Implements `LanguageModel`; decodes on the thread that iterates.

    While it loads, llama-cpp-python points the process's stdout and stderr at nothing.
    """

    def __init__(
        self, path: Path, *, context_tokens: int = CONTEXT_TOKENS, threads: int | None = None
    ) -> None:
        weights.spin_briefly()
        self.name = path.stem
        self.context_tokens = context_tokens
        self._lock = threading.Lock()
        self._closed = threading.Event()
        self._engine = _engine()
        count = threads or weights.default_threads()
        try:
            self._llama: Any = self._engine.Llama(
                str(path),
                n_ctx=context_tokens,
                n_batch=weights.BATCH_TOKENS,
                n_ubatch=weights.BATCH_TOKENS,
                n_threads=count,
                n_threads_batch=count,
                verbose=False,
            )
        except (ValueError, RuntimeError, OSError) as error:
            raise ModelFailed(f"{path}: llama-cpp-python could not load it: {error}") from None
        self._vocabulary = self._engine.llama_model_get_vocab(self._llama.model)
        self._format = _chat_format(self._llama)

    def generate(
        self,
        messages: Sequence[ChatMessage],
        *,
        grammar: str | None,
        max_tokens: int,
        token: CancelToken,
    ) -> Iterator[str]:
        """See `LanguageModel.generate`."""
        with self._lock:
            self._refuse_if_closed()
            with self._sampler(grammar) as sampler:
                prompt = self._prompt(messages)
                if not self._read(prompt, token):
                    return
                room = min(max_tokens, self.context_tokens - len(prompt))
                yield from self._decode(sampler, room, token)

    def prime(self, messages: Sequence[ChatMessage], token: CancelToken) -> None:
        """See `LanguageModel.prime`."""
        for _ in self.generate(messages, grammar=None, max_tokens=1, token=token):
            pass

    def count_tokens(self, text: str) -> int:
        """Number of tokens of this text."""
        self._refuse_if_closed()
        return len(self._llama.tokenize(text.encode(), add_bos=False, special=False))

    def close(self) -> None:
        """See `LanguageModel.close`; waits for the batch or the token that is being computed."""
        self._closed.set()
        with self._lock:
            self._llama.close()

    def _prompt(self, messages: Sequence[ChatMessage]) -> list[int]:
        chat = [{"role": m.role, "content": m.content} for m in messages]
        text = self._format(messages=chat).prompt
        prompt: list[int] = self._llama.tokenize(text.encode(), add_bos=False, special=True)
        if len(prompt) >= self.context_tokens:
            raise ModelFailed(
                f"the chat takes {len(prompt)} tokens, which exceeds the context of "
                f"{self.context_tokens}"
            )
        return prompt

    def _read(self, prompt: Sequence[int], token: CancelToken) -> bool:
        """Bring the engine's state to the end of the prompt; False if cancelled on the way.

        What the state already shares with the prompt is kept. The last token is always read again,
        because the next one is sampled from what it gives.
        """
        state = self._llama.input_ids[: self._llama.n_tokens]
        same = sum(1 for _ in itertools.takewhile(_equal, zip(state, prompt, strict=False)))
        self._llama.n_tokens = min(same, len(prompt) - 1)
        for start in range(self._llama.n_tokens, len(prompt), weights.BATCH_TOKENS):
            if self._unwanted(token):
                return False
            self._llama.eval(prompt[start : start + weights.BATCH_TOKENS])
        return True

    def _decode(self, sampler: Any, room: int, token: CancelToken) -> Iterator[str]:
        """At most `room` tokens that follow what was read."""
        text = codecs.getincrementaldecoder("utf-8")("replace")
        for _ in range(room):
            one = self._engine.llama_sampler_sample(sampler, self._llama.ctx, -1)
            if self._unwanted(token) or self._engine.llama_vocab_is_eog(self._vocabulary, one):
                return
            piece = text.decode(self._llama.detokenize([one]))
            if piece:
                yield piece
            if self._unwanted(token):
                return
            self._llama.eval([one])

    def _unwanted(self, token: CancelToken) -> bool:
        if token.cancelled:
            return True
        self._refuse_if_closed()
        return False

    @contextmanager
    def _sampler(self, grammar: str | None) -> Iterator[Any]:
        """The engine's sampler, which takes the likeliest token that the grammar allows.

        It is freed at once: `Llama.generate` leaves its own, 2 MB for an answer, to the collector
        of garbage, which looked at all of a process after fifty answers or more.
        """
        engine = self._engine
        chain = engine.llama_sampler_chain_init(engine.llama_sampler_chain_default_params())
        try:
            if grammar is not None:
                rules = engine.llama_sampler_init_grammar(
                    self._vocabulary, grammar.encode(), b"root"
                )
                if not rules:
                    raise ModelFailed("the model refused: failed to parse grammar")
                engine.llama_sampler_chain_add(chain, rules)
            engine.llama_sampler_chain_add(chain, engine.llama_sampler_init_greedy())
            yield chain
        finally:
            engine.llama_sampler_free(chain)

    def _refuse_if_closed(self) -> None:
        if self._closed.is_set():
            raise ModelFailed(f"{self.name} is closed")


def _equal(pair: tuple[int, int]) -> bool:
    return pair[0] == pair[1]


def _engine() -> Any:
    try:
        llama_cpp = importlib.import_module("llama_cpp")
    except (ImportError, RuntimeError) as error:
        raise ModelFailed(
            f"llama-cpp-python cannot be imported ({error}): {install_extra('llama-cpp')}"
        ) from None
    global _native_log  # noqa: PLW0603 (C keeps its address for as long as the process lives)
    if _native_log is None:
        _native_log = llama_cpp.llama_log_callback(_hear_native_log)
        llama_cpp.llama_log_set(_native_log, ctypes.c_void_p(0))
    return llama_cpp


_native_log: Any = None


def _hear_native_log(level: int, text: bytes, _user_data: object) -> None:
    """The engine's own log: errors are ours too, the rest is chatter."""
    line = text.decode("utf-8", "replace").rstrip()
    if line:
        log.log(logging.ERROR if level == _ERROR_LEVEL else logging.DEBUG, "llama_cpp", line=line)


def _chat_format(llama: Any) -> Any:
    """What turns messages into the prompt that this model was trained on."""
    template = llama.metadata.get("tokenizer.chat_template")
    if template is None:
        raise ModelFailed(f"{llama.model_path}: has no chat template; take an instruct model")
    end, begin = (
        llama.detokenize([one], special=True).decode() if one >= 0 else ""
        for one in (llama.token_eos(), llama.token_bos())
    )
    formats = importlib.import_module("llama_cpp.llama_chat_format")
    return formats.Jinja2ChatFormatter(template=template, eos_token=end, bos_token=begin)
