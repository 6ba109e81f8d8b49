"""What people hear or read as an answer stands in the phrasebooks, and none of it in the code."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from code_files import trees

import edgevox

ROOT = Path(edgevox.__file__).parent
SAY = {"SkillFailed", "OutOfReach", "InTheWay", "Reason", "Announce", "announce", "_announce"}
SAY |= {"because", "Speak", "Responded", "Refused", "Example", "turn.say", "turn.write"}
"""What makes an answer of the texts that it is given; of `because` the first one is a code."""
SKILL = {"skill", "SkillPhrases", "Skill"}
SKILL_WORDS = {"says", "done", "action", "can", "actions", "templates", "examples"}
ITSELF = r"(Shall )?(I|My) [a-z]?"
"""How a text begins in which a robot speaks of itself."""


def texts(node: ast.AST) -> Iterator[str]:
    """The texts of an expression; what a call in it is given is not yet an answer."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif not isinstance(node, ast.Call | ast.FormattedValue):
        for child in ast.iter_child_nodes(node):
            yield from texts(child)


def answers(tree: ast.AST) -> Iterator[str]:
    """The texts with words in them that reach an answer, or in which a robot speaks of itself."""
    others = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr):
            others.add(id(node.value))
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            short = name.rpartition(".")[2]
            if short == "Example":
                others.update(map(id, ast.walk(node)))
            says = {name, short} & SAY
            given = node.args[short == "because" :] if says else []
            words = {"text", "detail"} if says else SKILL_WORDS if short in SKILL else set()
            given += [one.value for one in node.keywords if one.arg in words]
            for text in (text for one in given for text in texts(one)):
                if re.search(r"[^\W\d_]{2}", re.sub(r"\{.*?\}", " ", text)):
                    yield text
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and id(node) not in others:
            yield from (text for text in texts(node) if re.match(ITSELF, text))


def test_no_answer_is_written_in_the_code() -> None:
    names = "|".join({*SKILL, *(one.rpartition(".")[2] for one in SAY), "I", "My"})
    files = trees(ROOT, having=rf"\b({names})\b")

    assert [f"{file}: {text}" for file, tree in files for text in answers(tree)] == []


@pytest.mark.parametrize(
    "code",
    [
        'skill(templates=["go to {room}"])(go)',
        'raise SkillFailed(f"I hold the {thing}.")',
        'because("lost", f"Lost, {name}.")',
        'turn.say(told, detail="And more." if far else other)',
        'def ask(goal) -> Result:\n    return {"said": f"I know {names} and {last}."}',
    ],
)
def test_words_in_an_answer_are_found(code: str) -> None:
    assert list(answers(ast.parse(code)))
