"""What judges whether a sentence is an order (the encoder on board, where it was fetched), and what
it sounds like (espeak-ng, where it is installed).
"""

import struct

from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.encoder import ENCODER
from edgevox.agent.nlu.sounds import Phonemes
from edgevox.core.errors import EdgeVoxError
from edgevox.core.languages import LANGUAGES
from edgevox.core.log import get_logger
from edgevox.models import locate

log = get_logger(__name__)

_UNUSABLE = (EdgeVoxError, MemoryError, OSError, ValueError, LookupError, struct.error)
"""A file that is missing, is none of its kind, is cut short or damaged, or is too much here."""


def open_decider() -> Decider | None:
    """None where the encoder cannot be had: then only what templates know is done."""
    from edgevox.agent.nlu.confidence import read_head
    from edgevox.agent.nlu.encoder import Encoder

    try:
        return Decider(Encoder(locate(ENCODER)), read_head())
    except _UNUSABLE as error:
        reason = str(error) or type(error).__name__
        log.error("encoder_missing", reason=reason)  # noqa: TRY400 - the reason says it all
        return None


def open_phonemes() -> Phonemes | None:
    """None where espeak-ng is no library here: then misheard commands are not understood."""
    try:
        from edgevox.voice.tts.espeak_library import espeak_library

        library = espeak_library()
    except (ImportError, OSError, EdgeVoxError) as error:
        log.info("phonemes_missing", reason=str(error))
        return None
    return lambda text, code: library.phonemes(text, LANGUAGES[code].voices[-1].key)
