"""Hours of the week, by the clock on the wall."""

from datetime import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from edgevox.agent.policy.part import PolicyPart

Day = Literal["mon", "tue", "wed", "thu", "fri", "sat", "sun"]
DAYS: tuple[Day, ...] = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")
MINUTES = 24 * 60
EXPECTED = "a time of day in quotes such as '07:30', from '00:00' to '24:00'"
"""Without quotes YAML makes a number of 19:30, which looks like one that somebody wrote."""


def _minutes(value: Any) -> int:
    """Minutes since midnight."""
    hours, colon, minutes = value.partition(":") if isinstance(value, str) else ("", "", "")
    if colon and all(len(one) == 2 and one.isascii() and one.isdigit() for one in (hours, minutes)):
        total = int(hours) * 60 + int(minutes)
        if int(minutes) < 60 and total <= MINUTES:
            return total
    raise ValueError(EXPECTED)


TimeOfDay = Annotated[
    int,
    BeforeValidator(
        _minutes,
        json_schema_input_type=Annotated[str, Field(pattern="^([01][0-9]|2[0-4]):[0-5][0-9]$")],
    ),
]


class Interval(PolicyPart):
    """Some hours of a day. They may cross midnight, and then belong to the day they begin on."""

    begin: TimeOfDay = Field(alias="from", description="local time of the machine, HH:MM")
    end: TimeOfDay = Field(alias="to", description="local time; before `from`: on the next day")
    days: Annotated[tuple[Day, ...], Field(min_length=1, max_length=7)] = Field(
        DAYS, description="the days on which it begins; every day without it"
    )

    @model_validator(mode="after")
    def _takes_time(self) -> Self:
        if self.begin % MINUTES == self.end % MINUTES and (self.begin, self.end) != (0, MINUTES):
            raise ValueError("`to` another time than `from`; 00:00 to 24:00 is a whole day")
        return self

    def holds(self, now: datetime) -> bool:
        """Whether it is that time."""
        minute = now.hour * 60 + now.minute
        today, yesterday = DAYS[now.weekday()], DAYS[now.weekday() - 1]
        if self.begin < self.end:
            return today in self.days and self.begin <= minute < self.end
        tonight = today in self.days and minute >= self.begin
        return tonight or (yesterday in self.days and minute < self.end)

    def __str__(self) -> str:
        days = "" if set(self.days) == set(DAYS) else f" ({', '.join(self.days)})"
        return f"{_clock(self.begin)}-{_clock(self.end)}{days}"


def _clock(minutes: int) -> str:
    return f"{minutes // 60:02}:{minutes % 60:02}"
