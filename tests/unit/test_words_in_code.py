"""What people hear or read as an answer stands in the phrasebooks, and none of it in the code."""

import ast
import re
from pathlib import Path

import pytest
from code_files import trees

import edgevox

ROOT = Path(edgevox.__file__).parent
ANSWERS = {
    "SkillFailed": (0,),
    "OutOfReach": (0,),
    "InTheWay": (0,),
    "Reason": (0,),
    "because": (1,),
    "Announce": (0, 1),
    "announce": (0, 1),
    "_announce": (0, 1),
    "Speak": (0,),
    "Responded": (0,),
    "Refused": (0, 1),
    "Example": (0,),
    "write": (0,),
}
"""What makes an answer, by its name, and which of its arguments are words."""
SKILL_WORDS = {"says", "done", "action", "can", "actions", "templates", "examples"}
MAKES = {"skill", "SkillPhrases", "Skill"}
"""What is given them as one of `SKILL_WORDS` is an answer, too."""
TURNS = {"turn", "_turn", "self"}
NAMES = {*ANSWERS, *MAKES, "say", "Result"}
"""A file in which none of them stands has no answers."""


def words_of(node):
    """The words of a text that is written here; those in braces are filled in elsewhere."""
    if isinstance(node, ast.JoinedStr):
        parts = [part.value for part in node.values if isinstance(part, ast.Constant)]
        return re.findall(r"[^\W\d_]{2,}", " ".join(parts))
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return re.findall(r"[^\W\d_]{2,}", re.sub(r"\{.*?\}", " ", node.value))
    return []


def answers_in(tree):
    """The texts in the code that reach an answer."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            yield from _in_call(node)
        if isinstance(node, ast.FunctionDef) and _gives_a_result(node):
            yield from _in_result(node)


def _in_call(call):
    name = getattr(call.func, "id", "") or getattr(call.func, "attr", "")
    owner = getattr(getattr(call.func, "value", None), "id", "")
    positions = ANSWERS.get(name, ())
    if name == "write" and owner not in TURNS:
        positions = ()
    if name == "say" and owner in TURNS and owner != "self":
        positions = (0,)
    for position in positions:
        if position < len(call.args):
            yield from _own_words(call.args[position])
    for keyword in call.keywords:
        if name in MAKES and keyword.arg in SKILL_WORDS:
            yield from _own_words(keyword.value)
        if keyword.arg in {"text", "detail"} and positions:
            yield from _own_words(keyword.value)


def _own_words(node):
    """Texts of this expression itself: what a call in it is given is not yet an answer."""
    if isinstance(node, ast.Call):
        return
    if words_of(node):
        yield node
        return
    for child in ast.iter_child_nodes(node):
        yield from _own_words(child)


def _gives_a_result(function):
    return getattr(function.returns, "id", "") == "Result"


def _in_result(function):
    """Sentences in what a skill returns: a result is data, and words of it are said elsewhere."""
    for statement in function.body:
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
            continue
        yield from (one for one in ast.walk(statement) if _is_a_sentence(one))


def _is_a_sentence(node):
    """More than one word, with spaces: names of values have none."""
    words = words_of(node)
    return len(words) > 1 and " " in ast.unparse(node)


@pytest.mark.parametrize(
    "code",
    [
        'skill(says="Going.")(go)',
        'skill(templates=["go to {room}"])(go)',
        'skill(examples=(Example("off you go"),))(go)',
        'skill(done=f"I am in the {room}.")(go)',
        'SkillPhrases(can="go")',
        'skill(says=["Going." if far else "Moving."])(go)',
        'raise SkillFailed("My battery is empty.")',
        'raise SkillFailed(f"I hold the {thing}.")',
        'because("lost", f"I am lost, {name}.")',
        'Reason("It fell." if fell else other)',
        'turn.say("All right.")',
        'turn.say(told, detail="And more.")',
        'self._announce("Stopped.", "")',
        'bus.publish(Responded("Hello.", 1))',
        'def ask(goal) -> Result:\n    return {"said": f"I know {names} and {last}."}',
        'def ask(goal) -> Result:\n    where = "on the floor"\n    return {"where": where}',
    ],
)
def test_words_in_an_answer_are_found(code):
    assert list(answers_in(ast.parse(code)))


@pytest.mark.parametrize(
    "code",
    [
        'raise SkillFailed(because("battery_empty"))',
        'turn.say(book.say("stopped"))',
        'skill(done="{answer}")(ask)',
        'def ask(goal) -> Result:\n    """Say where it is."""\n    return {"x": 1.0, "yaw_deg": 2}',
    ],
)
def test_data_and_names_of_sentences_are_no_words_in_an_answer(code):
    assert not list(answers_in(ast.parse(code)))


def test_no_answer_is_written_in_the_code():
    found = [
        f"{file.relative_to(ROOT)}:{one.lineno}: {ast.unparse(one)}"
        for file, tree in trees(ROOT, having=rf"\b({'|'.join(NAMES)})\b")
        for one in answers_in(tree)
    ]

    assert found == []


def test_no_sentence_of_the_robots_own_is_written_in_the_code():
    found = [
        f"{file.relative_to(ROOT)}:{one.lineno}: {one.value}"
        for file, tree in trees(ROOT, having=r"\b(I|My)\b")
        for one in first_person_in(tree)
    ]

    assert found == []


@pytest.mark.parametrize(
    "code",
    ['return "I know no place by name yet."', 'return f"I know {names}."', 'x = "My hand is open"'],
)
def test_a_sentence_of_the_robots_own_is_found(code):
    assert list(first_person_in(ast.parse(code)))


def first_person_in(tree):
    """Texts in which a robot speaks of itself. In an `Example` somebody speaks to it."""
    left_out = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Example":
            left_out |= {id(one) for one in ast.walk(node)}
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            left_out.add(id(node.value))
    for node in ast.walk(tree):
        text = node.value if isinstance(node, ast.Constant) and id(node) not in left_out else ""
        if re.match(r"(Shall )?(I|My) [a-z]?", str(text)):
            yield node
