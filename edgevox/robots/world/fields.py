"""Fields of world files: the valid numbers, points, names, and lists of them."""

import difflib
from collections.abc import Callable, Collection, Mapping
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from edgevox.core.errors import InvalidValue
from edgevox.core.files.validation import Place, wrong
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.log import get_logger

log = get_logger(__name__)

LARGEST = 1e6
"""No coordinate, size or speed of a world may be greater; it keeps arithmetic well-behaved."""


class WorldPart(BaseModel):
    """A mapping of a file. An empty value counts as absent; a mistyped key is refused.

    `also` are keys that change nothing here. Any other key is refused, too, unless `is_open`.
    """

    model_config = ConfigDict(extra="allow", frozen=True)
    also: ClassVar[frozenset[str]] = frozenset()
    is_open: ClassVar[bool] = False

    @model_validator(mode="before")
    @classmethod
    def _known(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        check_keys(data, {*cls.model_fields, *cls.also}, is_open=cls.is_open)
        return {key: value for key, value in data.items() if value is not None}

    def warn_of_others(self, file: YamlFile, place: Place) -> None:
        """Say which keys nobody knows."""
        for key in self.model_extra or ():
            if key not in self.also:
                log.warning("world_key_ignored", where=file.field((*place, key)))


def check_keys(data: Mapping[str, Any], known: Collection[str], *, is_open: bool = False) -> None:
    """Refuse unknown keys; if `is_open`, only those that look like a mistyped known one."""
    for key in data:
        if key not in known:
            close = difflib.get_close_matches(str(key), known, n=1, cutoff=0.7)
            if close or not is_open:
                expected = f"did you mean {close[0]!r}?" if close else None
                raise wrong((key,), key, expected or "one of " + ", ".join(sorted(known)))


def words(text: str) -> frozenset[str]:
    """The words of a text: a set of keys that is readable where it stands."""
    return frozenset(text.split())


def within(low: float, high: float) -> AfterValidator:
    """A number from `low` to `high`."""

    def check(number: float) -> float:
        if not low <= number <= high:
            kind = "whole number" if isinstance(number, int) else "number"
            raise ValueError(f"a {kind} from {low:g} to {high:g}")
        return number

    return AfterValidator(check)


def listed(expected: str, least: int, most: float = float("inf")) -> BeforeValidator:
    """A list of that length; `expected` is said of any other."""

    def check(value: Any) -> Any:
        if not isinstance(value, list) or not least <= len(value) <= most:
            raise ValueError(expected)
        return value

    return BeforeValidator(check)


def called(check: Callable[[str, Any], str]) -> BeforeValidator:
    """A name that passes a check of `name_fields`."""

    def checked(name: object) -> str:
        try:
            return check("", name)
        except InvalidValue as error:
            raise ValueError(error.expected) from None

    return BeforeValidator(checked)


def chosen(kinds: Mapping[str, type[WorldPart]], usual: str) -> BeforeValidator:
    """Choose one of several kinds of mappings by its `name`."""

    def choose(data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        name = usual if data.get("name") is None else data["name"]
        kind = kinds.get(name.lower()) if isinstance(name, str) else None
        if kind is None:
            raise wrong(("name",), name, "one of " + ", ".join(kinds))
        return kind.model_validate(data)

    return BeforeValidator(choose)


def one_or_more(value: Any) -> Any:
    """A list of mappings; a single one counts as a list."""
    if isinstance(value, Mapping):
        return [value]
    if not isinstance(value, list):
        raise ValueError("a list of mappings")  # noqa: TRY004 - of pydantic's kind
    return value


def _written(text: str) -> str:
    if not text.strip():
        raise ValueError("a text")
    return text


Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Number = Annotated[Finite, within(-LARGEST, LARGEST)]
NotNegative = Annotated[Finite, within(0, LARGEST)]
Positive = Annotated[NotNegative, Field(gt=0)]
Whole = Annotated[int, Field(strict=True)]
Flag = Annotated[bool, Field(strict=True)]
Text = Annotated[str, AfterValidator(_written)]
Numbers = tuple[Number, ...]
XY = Annotated[tuple[Number, Number], listed("two numbers [x, y]", 2, 2)]
TwoOrMore = Annotated[Numbers, listed("a list of at least 2 numbers", 2)]
ThreeOrMore = Annotated[Numbers, listed("a list of at least 3 numbers", 3)]
