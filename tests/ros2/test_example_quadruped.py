"""examples/robot_file/quadruped.yaml, talked to: requests on one topic, responses on another."""

import phrases
import pytest
from example_rig import example

pytestmark = pytest.mark.long

REQUEST = "api/sport/request"


def asks(number, parameter=""):
    return {"header": {"identity": {"api_id": number}}, "parameter": parameter}


@pytest.fixture(scope="module")
def dog(domain, overlays):
    first = ("sit down", "", "I am sitting.")
    with example("quadruped", "unitree_api", domain=domain, cache=overlays, first=first) as one:
        yield one


@pytest.fixture
def talk(dog):
    dog.asked.do("obey")
    dog.talk.speak("en")
    return dog.talk


def test_it_sits_stands_and_says_hello(talk, dog):
    for text, number, said in [
        ("sit down", 1009, "I am sitting."),
        ("stand up", 1004, "I am standing."),
        ("give me your paw", 1016, "Hello!"),
    ]:
        with dog.asked.within(REQUEST, asks(number)):
            talk.say(text, said)


def test_it_changes_its_gait(talk, dog):
    with dog.asked.within(REQUEST, asks(1011, '{"data": 1}')):
        talk.say("switch the gait to trotting", "My gait is trot now.")
    with dog.asked.within(REQUEST, asks(1011, '{"data": 3}')):
        talk.say("gait climbing", "My gait is stairs now.")


def test_it_speaks_german(talk, dog):
    talk.speak("de")
    with dog.asked.within(REQUEST, asks(1009)):
        talk.say("Sitz", "Ich sitze.")
    with dog.asked.within(REQUEST, asks(1011, '{"data": 1}')):
        talk.say("Gangart Trab", "Meine Gangart ist jetzt Trab.")


def test_a_dance_lasts_until_it_is_over_or_stopped(talk, dog):
    with dog.asked.within(REQUEST, asks(1022)):
        talk.say("dance for me", "Look!")
    with talk.told("Did you like it?"):
        dog.asked.do("rest")
    with dog.asked.within(REQUEST, asks(1022)):
        talk.say("dance", "Look!")
    with dog.asked.within(REQUEST, asks(1003)):
        talk.say("stop", phrases.said("stopped"))


def test_what_it_refuses_is_not_said_to_be_done(talk, dog):
    talk.say("say hello", "Hello!")
    dog.asked.do("refuse")
    talk.say("say hello", "Not now.")  # though the answer before is not old
    talk.speak("de")
    talk.say("steh auf", "Ich komme nicht hoch.")


def test_no_answer_is_no_success(talk, dog):
    talk.say("gait trot", "My gait is trot now.")
    dog.asked.do("hang")
    talk.say("gait trot", "I cannot walk like that now.")
