"""What judges whether a sentence is an order: the encoder on board, where it was fetched."""

from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.encoder import ENCODER
from edgevox.core.log import get_logger
from edgevox.models import ModelMissing, locate

log = get_logger(__name__)


def open_decider() -> Decider | None:
    """None where the encoder's file is missing: then only what templates know is done."""
    from edgevox.agent.nlu.encoder import Encoder
    from edgevox.agent.nlu.judge import read_head

    try:
        path = locate(ENCODER)
    except ModelMissing as error:
        log.error("encoder_missing", reason=str(error))  # noqa: TRY400 - the reason says it all
        return None
    return Decider(Encoder(path), read_head())
