"""Servers that keep to the OpenAI protocol in their own way (`odd_servers.yaml`) answer."""

import json
from pathlib import Path
from typing import Any

import pytest
import yaml
from llm_server import CHAT, GOOD, ROOMS, Reply, ask, failing, good, serving
from support.conversation import Eloquent

from edgevox.agent.llm.remote_model import FallbackModel
from edgevox.core.cancel import CancelToken
from edgevox.core.servers.errors import OddAnswer, Unreachable, Unusable

ODD = yaml.safe_load(Path(__file__).with_name("odd_servers.yaml").read_text(encoding="utf-8"))


def _answers(row: dict[str, Any]):
    def chat(reply: Reply) -> None:
        if "whole" in row:
            reply.status(200, json.dumps(row["whole"]), Content_Type="application/json")
            return
        reply.stream()
        for delta in row["sends"]:
            choice = {"index": 0, "finish_reason": None} | ({"delta": delta} if delta else {})
            reply.raw(f"data: {json.dumps({'choices': [choice]})}\n\n")
        reply.raw("data: [DONE]\n\n")

    return chat


@pytest.mark.parametrize("row", ODD, ids=[row["name"] for row in ODD])
def test_an_odd_server_answers(row: dict[str, Any]) -> None:
    refusals = [failing(400, json.dumps(row["wants"]))] if "wants" in row else []
    with serving(*refusals, _answers(row), owner=row.get("owner", "somebody")) as server:
        if "models" in row:
            server.models = {"data": row["models"]}
        model = server.model()
        assert ask(model) == "go kitchen!"
        assert ask(model) == "go kitchen!"
    if "second" in row:
        for asked in server.asked[1:]:
            assert set(row["second"]["has"]) <= asked.keys()
            assert not set(row["second"]["lacks"]) & asked.keys()
        assert len(server.asked) == 3  # what is refused once is not sent again
    if "asked" in row:
        assert server.asked[0]["model"] == row["asked"]


def test_thoughts_buy_time_for_the_answer() -> None:
    def think(reply: Reply) -> None:
        reply.stream()
        for _ in range(3):
            reply.over.wait(0.5)  # three times this is more than the timeout
            reply.raw('data: {"choices": [{"delta": {"reasoning_content": "hm"}}]}\n\n')
        reply.piece("go kitchen!", "stop")

    with serving(think) as server:
        assert ask(server.model(timeout_s=1.2)) == "go kitchen!"
    assert len(server.asked) == 1


def test_a_server_without_a_model_that_chats_says_what_to_set() -> None:
    with serving(GOOD) as server:
        server.models = {"data": [{"id": "nomic-embed-text"}, {"id": "whisper-large-v3"}]}
        with pytest.raises(Unusable, match="only nomic-embed-text.*set llm_endpoint_model"):
            ask(server.model())


@pytest.mark.parametrize("content", [7, {"text": "go"}, [{"type": "text", "text": 7}], ["go"]])
def test_content_of_another_type_is_no_answer(content: object) -> None:
    def chat(reply: Reply) -> None:
        reply.stream()
        reply.raw(f"data: {json.dumps({'choices': [{'delta': {'content': content}}]})}\n\n")

    with serving(chat) as server, pytest.raises(Unreachable, match="not an answer"):
        ask(server.model())


def test_a_thought_without_end_is_an_odd_answer() -> None:
    with serving(good("<think>", "go kitchen!")) as server, pytest.raises(OddAnswer):
        ask(server.model())


def test_one_odd_answer_is_no_outage_and_three_in_a_row_are() -> None:
    odd = good("Certainly! I shall go.")
    with serving(odd, GOOD, odd, odd, odd, GOOD) as server:
        model = FallbackModel(server.model(), Eloquent("go bedroom!"))
        said = [
            "".join(model.generate(CHAT, grammar=ROOMS, max_tokens=9, token=CancelToken()))
            for _ in range(6)
        ]
    assert said == ["go bedroom!", "go kitchen!", *["go bedroom!"] * 4]
    assert len(server.asked) == 5  # the last one was not asked: the server is left alone
    assert model.fault
