"""The messages of a page on the socket `/ws`, with their bounds. All others are refused.

`control` does what they ask for.
"""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from edgevox.core.errors import InvalidValue
from edgevox.core.files.validation import dotted, explain

PROTOCOL = 1
MOST_BYTES = 64 * 1024
"""The most bytes of one message, either way on `/ws`."""

Needs = Literal["session", "operator", "lease"]
_Name = Annotated[str, Field(min_length=1, max_length=200)]
_Metres = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]


class PageMessage(BaseModel):
    """A message of a page; the answer names its `id`. `needs` is the sender's required right."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)
    needs: ClassVar[Needs] = "lease"

    id: int = Field(ge=0, le=1 << 53)


class Text(PageMessage):
    """Words for the robot."""

    type: Literal["text"]
    text: str = Field(min_length=1, max_length=4000)


class YesOrNo(PageMessage):
    """Yes or no to what it asked."""

    type: Literal["answer"]
    yes: bool


class CallSkill(PageMessage):
    """A call of a skill, with its arguments by name."""

    type: Literal["skill"]
    name: _Name
    arguments: dict[str, Any] = {}


class GoTo(PageMessage):
    """Go to this point; metres, map frame."""

    type: Literal["goto"]
    x: _Metres
    y: _Metres


class NamePlace(PageMessage):
    """Remember this point by a name; metres, map frame."""

    type: Literal["name_place"]
    name: _Name
    x: _Metres
    y: _Metres


class Drive(PageMessage):
    """Steer now, in m/s and rad/s; both 0 is a release."""

    type: Literal["drive"]
    linear: float = Field(ge=-100, le=100, allow_inf_nan=False)
    angular: float = Field(ge=-100, le=100, allow_inf_nan=False)

    @property
    def releases(self) -> bool:
        """Whether this lets go of the stick."""
        return self.linear == 0 and self.angular == 0


class Stop(PageMessage):
    """The software stop: taken however it is said, as long as it is one."""

    model_config = ConfigDict(extra="ignore")
    needs: ClassVar[Needs] = "session"

    id: Any = None
    type: Literal["stop"]


class Resume(PageMessage):
    """Motion is allowed again."""

    type: Literal["resume"]


class ChangeLease(PageMessage):
    """A change of the lease: take it if it is free, give it away, ask for it, ask no longer."""

    needs: ClassVar[Needs] = "operator"
    type: Literal["lease"]
    action: Literal["take", "give", "request", "withdraw"]
    to: str | None = Field(None, max_length=64)


class SetControl(PageMessage):
    """Another language, voice, muted or confirm."""

    type: Literal["set"]
    name: Literal["language", "voice", "muted", "confirm"]
    value: bool | Annotated[str, Field(max_length=200)]


class Ping(PageMessage):
    """Is the robot there? `t` comes back as it is."""

    needs: ClassVar[Needs] = "session"
    type: Literal["ping"]
    t: float


class Look(PageMessage):
    """The parts of the robot that the page shows now; it gets no others."""

    needs: ClassVar[Needs] = "session"
    type: Literal["look"]
    what: list[Literal["live", "picture", "status", "log"]] = Field(max_length=8)


class Record(PageMessage):
    """Begin or end a recording."""

    type: Literal["record"]
    action: Literal["start", "stop"]


class DeleteRecording(PageMessage):
    """Remove a recording, by the name of its file."""

    type: Literal["delete_recording"]
    name: _Name


Message = (
    Text
    | YesOrNo
    | CallSkill
    | GoTo
    | NamePlace
    | Drive
    | Stop
    | Resume
    | ChangeLease
    | SetControl
    | Ping
    | Look
    | Record
    | DeleteRecording
)
_ADAPTER: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="type")])


def read(text: str) -> Message:
    """Read a page's message. Raises `InvalidValue`, naming the field that is wrong."""
    try:
        return _ADAPTER.validate_json(text)
    except ValidationError as error:
        raise explain(error, lambda place: dotted(place[1:]) or "message") from None
    except RecursionError:
        raise InvalidValue("message", text, "less deep") from None
