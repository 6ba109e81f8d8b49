"""A folder of models that somebody brought, such as that of a bundle; one folder a model."""

import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path

from edgevox.models.fetch_progress import FetchProgress
from edgevox.models.manifest import ModelFile
from edgevox.models.model_errors import SourceFailed
from edgevox.models.source_specs import FolderSource
from edgevox.models.sources.tools import place_for
from edgevox.models.verification import has_right_bytes


class Folder:
    """Copies a model's files, all or none: one that is wrong keeps the others away, too."""

    def provide(
        self, spec: FolderSource, files: Sequence[ModelFile], staging: Path, progress: FetchProgress
    ) -> Iterator[tuple[ModelFile, Path]]:
        """See `Provider`."""
        wrong = [one.name for one in files if not has_right_bytes(spec.folder / one.name, one)]
        if wrong:
            raise SourceFailed(f"{', '.join(wrong)} is missing or damaged")
        done = 0
        for file in files:
            place = place_for(file, staging)
            shutil.copyfile(spec.folder / file.name, place)
            yield file, place
            progress.at(done := done + file.size)
