"""What does not move is told to whoever comes, and to everybody once it is another."""

import asyncio
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from edgevox.console import console_server
from edgevox.console.sessions import Role
from tests.console_rig import Rig, console


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with console(tmp_path) as made:
        yield made


def scene(version: int) -> dict[str, Any]:
    return {"version": version, "bounds": [0, 0, 1, 1], "grid": {"png": f"map {version}"}}


def test_another_map_is_told_to_who_is_there_and_to_who_comes_later(rig: Rig) -> None:
    async def look() -> None:
        now = scene(1)
        rig.robot.scene = lambda: now
        async with rig.page(Role.VIEWER) as early:
            told = await early.until("scene")
            assert told["grid"] == {"png": "map 1"}
            now = scene(2)
            while told["version"] != 2:
                told = await early.until("scene")
            async with rig.page(Role.VIEWER) as late:
                assert (await late.until("scene"))["grid"] == {"png": "map 2"}

    asyncio.run(look())


def test_one_that_stays_the_same_is_not_told_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(console_server, "STATUS_S", 0.05)  # five looks count, not their pace
    looks = 0

    def same() -> dict[str, Any]:
        nonlocal looks
        looks += 1
        return scene(1)

    async def watch(rig: Rig) -> int:
        rig.robot.scene = same
        async with rig.page(Role.VIEWER) as page:
            while looks < 5:
                await asyncio.sleep(0.01)
            await page.send(type="ping", t=0.0)
            told = 0
            while (await page.until("scene", "pong"))["type"] == "scene":
                told += 1
            return told

    with console(tmp_path) as rig:
        assert asyncio.run(watch(rig)) <= 2  # as it comes, and when the console first looks
