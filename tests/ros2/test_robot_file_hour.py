"""The hour of docs/your-robot.md, as it stands there: what one sees, writes and says."""

import re
from pathlib import Path

import phrases
import pytest
from robot_file_rig import NAMESPACE, Asked, Talk, interfaces
from waiting import wait_until

pytestmark = pytest.mark.long

PAGE = Path(__file__).parents[2] / "docs" / "your-robot.md"
HOUR = re.search(r"^## An hour.*?(?=^## )", PAGE.read_text("utf-8"), re.DOTALL | re.MULTILINE)[0]
FENCES = re.findall(r"^```(\w+)\n(.*?)^```$", HOUR, re.DOTALL | re.MULTILINE)
(WRITTEN,) = [text for language, text in FENCES if language == "yaml"]
SEEN, DIALOGUE = [text for language, text in FENCES if language == "text"]

OF_ACTIONS = "/_action/feedback"


def bare(kind):
    """An action's type, where its feedback's is seen."""
    return kind.removesuffix("_FeedbackMessage")


@pytest.fixture(scope="module")
def robot(domain):
    with interfaces(domain):
        yield


@pytest.fixture
def file(tmp_path):
    return tmp_path / "robot.yaml"


def exchanges(dialogue):
    """What is said, with the answers to it."""
    for one in dialogue.removeprefix("> ").split("\n> "):
        said, *answers = one.strip().splitlines()
        yield said, answers


def test_the_robot_shows_what_the_page_says_that_one_sees(robot, peer):
    node = peer(NAMESPACE).node
    shown = set(re.findall(r"(\S+) \[(\S+)\]", SEEN))

    def seen():
        found = [*node.get_topic_names_and_types(), *node.get_service_names_and_types()]
        return {(name.removesuffix(OF_ACTIONS), bare(kind)) for name, (kind, *_) in found}

    wait_until(lambda: shown <= seen(), SEEN)


def test_the_check_lists_every_skill_of_the_file(agent, file):
    file.write_text(WRITTEN)
    checked = agent(f"--robot-file={file}", "--check", robot="robot-external", wait=False)
    skills = re.findall(r"^  (\w+): .*\n    description: (.*)$", WRITTEN, re.MULTILINE)
    assert len(skills) == 4
    for name, about in skills:
        checked.wait_for_line(f"{name}: {about}")


def test_a_typing_error_is_told_as_the_page_tells_it(agent, file):
    file.write_text(WRITTEN.replace("field: temperature", "field: warmth"))
    said = re.search(r"\*(expected a path.*?)\*", HOUR, re.DOTALL)[1].replace("\n", " ")
    agent(f"--robot-file={file}", "--check", robot="robot-external", wait=False).wait_for_line(said)


def test_the_conversation_is_had(agent, robot, peer, file):
    file.write_text(WRITTEN)
    agent(f"--robot-file={file}", robot="robot-external")
    talk, asked = Talk(peer()), Asked(peer(NAMESPACE))
    asked.do("open")
    for said, answers in exchanges(DIALOGUE):
        talk.say(said, *answers)
    asked.wait("dock", ["slot 4", "{}"])
    asked.do("hang")
    with asked.within("dock"):
        talk.say("dock", "Docking.")
    with asked.within("cancelled"):
        talk.say("stop", phrases.said("stopped"))
    talk.speak("de")
    asked.do("obey")
    talk.say("geh wenn die Tür offen ist", "Ich warte auf die Tür.", "Die Tür ist offen, und")
