"""What a scenario says must be true, or must never be."""

from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from edgevox.scenario.comparisons import Value, Words

Path = Annotated[str, Field(pattern=r"^[\w-]+(\.[\w-]+)*$", max_length=200)]


class Strict(BaseModel):
    """A part of a scenario file: nothing in it that is not known, and it stays as it is."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class Condition(Strict):
    """What is true of the robot; with several parts, each of them, not all at one moment."""

    state: Annotated[dict[Path, Value], Field(min_length=1, max_length=50)] | None = Field(
        None, description="values of robot_state by their paths, all at one moment"
    )
    answer: Words | None = Field(None, description="what was answered since the last stimulus")
    event: Annotated[dict[Path, Value], Field(min_length=1, max_length=50)] | None = Field(
        None, description="values of one agent_event since the last stimulus"
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if not self.model_fields_set:
            raise ValueError("at least one of state, answer, event")
        return self

    def __str__(self) -> str:
        parts = [f"{path} {wanted}" for path, wanted in (self.state or {}).items()]
        if self.answer:
            parts.append(f"answer {self.answer}")
        if self.event:
            inner = ", ".join(f"{path} {wanted}" for path, wanted in self.event.items())
            parts.append(f"event with {inner}")
        return ", ".join(parts)


class Never(Condition):
    """What must not come true at any moment; one part only."""

    @model_validator(mode="after")
    def _one_part(self) -> Self:
        if len(self.model_fields_set) != 1:
            raise ValueError("only one of state, answer, event; write the others as more entries")
        return self
