"""The Hugging Face hub, through its own client, which is optional."""

import importlib
import shutil
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from edgevox.core.errors import install_extra
from edgevox.models.fetch_progress import FetchProgress
from edgevox.models.manifest import HubSource, ModelFile
from edgevox.models.sources.tools import place_for
from edgevox.models.store import SourceFailed

CONNECT_TIMEOUT_S = 5.0


class Hub:
    """Fetches files of public repositories, without an account.

    A hub that could not be reached is not tried again: a machine without one loses seconds, once.
    `endpoint` is where a mirror answers; None is the hub itself, or what ``HF_ENDPOINT`` says.
    """

    def __init__(self, endpoint: str | None = None) -> None:
        self._endpoint = endpoint
        self._unreachable = ""
        self._reached = False

    def provide(
        self, spec: HubSource, files: Sequence[ModelFile], staging: Path, progress: FetchProgress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """See `Provider`."""
        client = _client()
        before = 0
        for file in files:
            self._reach(client, spec, file)
            yield file, self._download(client, spec, file, staging, _adding(progress, before))
            before += file.size
            progress.at(before)

    def _reach(self, client: Any, spec: HubSource, file: ModelFile) -> None:
        # The client itself would retry for half a minute, and say so on the terminal.
        if self._reached:
            return
        if not self._unreachable:
            url = client.hf_hub_url(spec.repo, _path(spec, file), endpoint=self._endpoint)
            try:
                client.utils.get_session().head(url, timeout=CONNECT_TIMEOUT_S)
            except _library("httpx").HTTPError as error:
                self._unreachable = f"the hub cannot be reached: {_first_line(error)}"
        if self._unreachable:
            raise SourceFailed(self._unreachable)
        self._reached = True

    def _download(
        self,
        client: Any,
        spec: HubSource,
        file: ModelFile,
        staging: Path,
        add: Callable[[int], None],
    ) -> Path:
        try:
            got = client.hf_hub_download(
                spec.repo,
                _path(spec, file),
                revision=spec.revision,
                local_dir=staging / "hub",
                token=False,
                etag_timeout=CONNECT_TIMEOUT_S,
                endpoint=self._endpoint,
                tqdm_class=_counting(client, add),
            )
        except (client.errors.HfHubHTTPError, _library("httpx").HTTPError, OSError) as error:
            raise SourceFailed(_first_line(error.__cause__ or error)) from None
        path = place_for(file, staging)
        shutil.move(got, path)
        return path


def _client() -> Any:
    try:
        return _library("huggingface_hub")
    except ImportError:
        raise SourceFailed(f"huggingface-hub is not installed: {install_extra('models')}") from None


def _library(name: str) -> Any:
    return importlib.import_module(name)


def _path(spec: HubSource, file: ModelFile) -> str:
    return f"{spec.folder}/{file.name}".lstrip("/")


def _adding(progress: FetchProgress, before: int) -> Callable[[int], None]:
    got = before

    def add(size: int) -> None:
        nonlocal got
        got += size
        progress.at(got)

    return add


def _counting(client: Any, add: Callable[[int], None]) -> type:
    """A tqdm that draws nothing and tells what it counts."""

    def start(self: Any, *arguments: Any, **options: Any) -> None:
        options["disable"] = True
        client.utils.tqdm.__init__(self, *arguments, **options)

    def update(_: Any, size: float | None = 1) -> None:
        add(int(size or 0))

    return type("Counting", (client.utils.tqdm,), {"__init__": start, "update": update})


def _first_line(error: BaseException) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]
