"""`edgevox-models`: list, fetch and verify models."""

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from edgevox.apps.streams import show, with_streams
from edgevox.core.errors import EdgeVoxError
from edgevox.models import Store, UnknownModel, fetch
from edgevox.models.fetch import OFFLINE_VARIABLE
from edgevox.models.fetch_progress import megabytes, shown_on
from edgevox.models.manifest import Manifest, Model
from edgevox.models.store import ROOT_VARIABLE

OK, FAILED, USAGE = 0, 1, 2


@with_streams("edgevox-models", results=True)
def main(argv: Sequence[str] | None = None, manifest: Manifest | None = None) -> int:
    """Run one command; 0 if all is well, 1 if something failed, 2 for a wrong command line."""
    options = _parser().parse_args(argv)
    store = Store(options.dir and Path(options.dir).absolute(), manifest)
    run: Callable[[argparse.Namespace, Store], int] = options.run
    try:
        return run(options, store)
    except UnknownModel as error:
        return _say(error, USAGE)
    except (EdgeVoxError, OSError) as error:
        return _say(error, FAILED)
    except KeyboardInterrupt:
        return _say("stopped; the same command goes on from here", FAILED)


def list_models(_: argparse.Namespace, store: Store) -> int:
    """Print each set and its models: size, presence, licence and its restrictions."""
    manifest, told = store.manifest, set[str]()
    grouped = {member for members in manifest.sets.values() for member in members}
    alone = tuple(name for name in manifest.models if name not in grouped)
    for name, members in [*manifest.sets.items(), *([("in no set", alone)] if alone else [])]:
        models = [manifest.models[member] for member in members]
        here = sum(not store.missing(model) for model in models)
        size = megabytes(sum(model.size for model in models))
        show(f"{name}: {size}, {here} of {len(models)} here")
        for model in models:
            show(f"  {model.id} (see above)" if model.id in told else _described(model, store))
        told.update(members)
    show(f"in {store.root}")
    return OK


def _described(model: Model, store: Store) -> str:
    state = "missing" if store.missing(model) else "here"
    licence = " and ".join(model.licences)
    if not store.manifest.allows_commercial_use(model):
        licence += ", not for commercial use"
    lines = [f"  {model.id:<28} {megabytes(model.size):>8}  {state:<7}  {licence}"]
    lines += [f"      {model.title}; {model.publisher}"]
    lines += [f"      {model.caution}"] if model.caution else []
    return "\n".join(lines)


def fetch_models(options: argparse.Namespace, store: Store) -> int:
    """Fetch missing sets and models."""
    given: Path | None = options.given
    if given and not given.is_dir():
        raise NotADirectoryError(f"--from {given}: there is no such folder")
    with shown_on(sys.stderr) as progress:
        fetch(
            options.names,
            store=store,
            progress=progress,
            offline=options.offline or None,
            given=given,
        )
    return OK


def verify_models(options: argparse.Namespace, store: Store) -> int:
    """Hash every byte again; without names, of all installed models."""
    chosen = store.manifest.select(options.names or store.manifest.models)
    if not options.names:
        chosen = tuple(model for model in chosen if store.folder(model).is_dir())
    if not chosen:
        return _say(f"there is no model in {store.root}", FAILED)
    result = OK
    for model in chosen:
        wrong = store.verify(model)
        result = FAILED if wrong else result
        said = ", ".join(f"{file.name} is missing or damaged" for file in wrong) or "right"
        show(f"{model.id}: {said}")
    return result


def print_path(options: argparse.Namespace, store: Store) -> int:
    """Print the path of a model."""
    if options.name in store.manifest.sets:
        raise UnknownModel(options.name, store.manifest.models)
    show(str(store.locate(options.name)))
    return OK


def print_licences(_: argparse.Namespace, store: Store) -> int:
    """Print the owner, licence and restrictions of each model."""
    for model in store.manifest.models.values():
        show(f"{model.id}\n    {model.publisher}\n    {model.copyright}")
        for licence in (store.manifest.licences[key] for key in model.licences):
            show(f"    {licence.name}, {licence.url}")
        if not store.manifest.allows_commercial_use(model):
            show("    Not for commercial use.")
        if model.caution:
            show(f"    {model.caution}")
    return OK


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("edgevox-models", description=__doc__)
    parser.add_argument("--dir", help=f"folder of the models, instead of ${ROOT_VARIABLE}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(name: str, run: Callable[..., int]) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=run.__doc__, description=run.__doc__)
        sub.set_defaults(run=run)
        return sub

    command("list", list_models)
    fetching = command("fetch", fetch_models)
    fetching.add_argument("names", nargs="*", default=["small"], metavar="SET|ID")
    fetching.add_argument(
        "--offline", action="store_true", help=f"do not use the network, as {OFFLINE_VARIABLE}=1"
    )
    fetching.add_argument(
        "--from",
        dest="given",
        type=Path,
        metavar="FOLDER",
        help="take models from this folder (one folder per model) before the network",
    )
    command("verify", verify_models).add_argument("names", nargs="*", metavar="SET|ID")
    command("path", print_path).add_argument("name", metavar="ID")
    command("licences", print_licences)
    return parser


def _say(error: object, status: int) -> int:
    show(f"edgevox-models: {error}", error=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
