"""Stands in for ROS 2's `launch` and `launch_ros`, which no wheel brings: records what is asked."""

import runpy
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

LAUNCH = Path(__file__).resolve().parent.parent.parent / "launch"


@dataclass
class LaunchContext:
    launch_configurations: dict[str, str]


@dataclass
class DeclareLaunchArgument:
    name: str
    default_value: str | None = None
    description: str | None = None


@dataclass
class LaunchConfiguration:
    name: str

    def perform(self, context: LaunchContext) -> str:
        return context.launch_configurations[self.name]


@dataclass
class OpaqueFunction:
    function: Callable[[LaunchContext], list[Any]]


@dataclass
class Node:
    package: str
    executable: str
    arguments: list[str] = field(default_factory=list)
    namespace: str | None = None
    parameters: list[str] | None = None
    output: str = "log"

    @property
    def command(self) -> list[str]:
        """What launch_ros would run, as far as it concerns us."""
        command = [self.executable, *self.arguments, "--ros-args"]
        if self.namespace:
            command += ["-r", f"__ns:={self.namespace}"]
        for file in self.parameters or ():
            command += ["--params-file", file]
        return command


@dataclass
class LaunchDescription:
    entities: list[Any]

    @property
    def arguments(self) -> dict[str, DeclareLaunchArgument]:
        """All that are declared."""
        return {e.name: e for e in self.entities if isinstance(e, DeclareLaunchArgument)}

    def nodes(self, **given: str) -> list[Node]:
        """What `ros2 launch edgevox FILE name:=value ...` would start."""
        defaults = {a.name: a.default_value or "" for a in self.arguments.values()}
        context = LaunchContext({**defaults, **given})
        functions = [e.function for e in self.entities if isinstance(e, OpaqueFunction)]
        return [node for function in functions for node in function(context)]


MODULES = {
    "launch": (LaunchContext, LaunchDescription),
    "launch.actions": (DeclareLaunchArgument, OpaqueFunction),
    "launch.substitutions": (LaunchConfiguration,),
    "launch_ros": (),
    "launch_ros.actions": (Node,),
}


def load(file: Path, patch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The names in a launch file, imported with nothing but the stand-ins."""
    for name, members in MODULES.items():
        module = ModuleType(name)
        for member in members:
            setattr(module, member.__name__, member)
        patch.setitem(sys.modules, name, module)
    return runpy.run_path(str(file))
