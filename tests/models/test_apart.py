"""Orders among remarks, orders that no word joins, and what the encoder guesses is asked for."""

from functools import lru_cache

import pytest
from corpus_robots import skills_of_robots

from edgevox.agent.agents import Agent
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import REFERENCES, Meaning
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import Call, GoalHandle, Skill, SkillSet, skill
from edgevox.agent.turn import Turn
from edgevox.apps.agent.models import open_decider
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock


@lru_cache
def interpreter(robot: str, language: str = "en") -> Interpreter:
    decider: Decider | None = open_decider()
    assert decider
    agent = Agent("robot", "", skills_of_robots()[f"robot-{robot}"])
    one = Interpreter([agent], Bus(), SystemClock(), decider=decider)
    one.set_language(language)
    return one


def understood(robot: str, says: str, language: str = "en") -> tuple[list[Call], bool, str]:
    """The calls, whether they are done without a question, and what is said instead."""
    turn = Turn(1, Bus(), SystemClock(), lambda: None)
    meaning = interpreter(robot, language).understand(says, turn)
    calls = list(meaning.every_call) if meaning else []
    return calls, bool(meaning and meaning.sure), turn.text


FORWARD, BACK = "walk_forward", "walk_backward"


@pytest.mark.parametrize(
    ("robot", "says", "call"),
    [
        (
            "humanoid",
            "Walk forward half a metre, don't be shy, I don't bite.",
            Call(FORWARD, {"distance": 0.5}),
        ),
        ("apartment", "clear out to the office", Call("navigate_to", {"room": "office"})),
        ("panda", "pinch the green cube between your fingers",
         Call("grasp", {"object": "green_cube"})),
        ("panda", "Please to open the hand.", Call("release", {})),
        ("panda", "back to your home pose", Call("goto_home", {})),
        ("panda", "okay, you can put it down now", Call("place", {"object": "it"})),
        ("apartment", "come over here, we're in the kitchen",
         Call("navigate_to", {"room": "kitchen"})),
        ("apartment", "I was in the bedroom all day, now go to the office",
         Call("navigate_to", {"room": "office"})),
        ("apartment", "drive back forward a metre", Call("drive_forward", {"distance": 1.0})),
        ("apartment", "go forward, not backwards", Call("drive_forward", {})),
    ],
)  # fmt: skip
def test_an_order_beside_a_remark_or_in_unknown_words_is_asked_about(robot, says, call):
    calls, sure, _ = understood(robot, says)
    assert (calls, sure) == ([call], False)


@pytest.mark.parametrize(
    ("robot", "says", "call"),
    [
        ("humanoid", "Back up 40 cm, you're blocking the trolley.", Call(BACK, {"distance": 0.4})),
        ("apartment", "the guests are waiting, so off to the office with you",
         Call("navigate_to", {"room": "office"})),
    ],
)  # fmt: skip
def test_a_plain_order_beside_a_plain_remark_is_done(robot, says, call):
    calls, sure, _ = understood(robot, says)
    assert (calls, sure) == ([call], True)


@pytest.mark.parametrize(
    ("robot", "says"),
    [
        ("apartment", "I'm talking to the dog: turn around!"),
        ("apartment", "drive forward a metre, that's what I told the other robot"),
        ("apartment", "the lab is closed, so go to the office if they let you in"),
        ("apartment", "Go to the kitchen? Good idea."),
        ("apartment", "Let me finish my tea, then go to the kitchen"),
        ("apartment", "The dishwasher is running, when that's done go to the kitchen"),
        ("apartment", "Go to the kitchen and hop like a bunny, the guests are waiting"),
        ("apartment", "Turn around, Bartek, I'll zip you up"),
        ("humanoid", "Turn left, turn right 90 degrees."),
        ("humanoid", "Walk two metres, silly me, walk three metres."),
        ("humanoid", '"Turn around", the sign on the door.'),
    ],
)
def test_a_plain_order_beside_what_changes_it_is_not(robot, says):
    assert not understood(robot, says)[1]


@pytest.mark.parametrize(
    ("says", "call"),
    [
        ("okay now look over towards the kitchen please",
         Call("turn_towards", {"room": "kitchen"})),
        ("you may strike the bedroom off your map now", Call("forget_place", {"room": "bedroom"})),
    ],
)  # fmt: skip
def test_what_turns_towards_or_forgets_a_place_is_asked_about(says, call):
    calls, sure, _ = understood("apartment", says)
    assert (calls, sure) == ([call], False)


def test_orders_that_no_word_joins_are_done_if_each_says_how_far():
    calls, sure, _ = understood("humanoid", "turn left 60 deg, walk 0.8 m, turn right 60 deg")
    assert sure
    assert [one.skill for one in calls] == ["turn_left", FORWARD, "turn_right"]
    assert [next(iter(one.arguments.values())) for one in calls] == [60.0, 0.8, 60.0]


@pytest.mark.parametrize(
    "says",
    ["forward, back one metre", "walk 2 metres, 3 metres", "walk 2 metres, walk 3 metres"],
)
def test_the_first_of_two_orders_may_be_taken_back_by_the_second(says):
    assert not understood("humanoid", says)[1]


@pytest.mark.parametrize("name", ["Bob", "Lucy"])
def test_an_order_to_somebody_else_is_at_most_asked_about(name):
    assert not understood("apartment", f"{name}, go to the kitchen")[1]


@pytest.mark.parametrize(
    ("robot", "says"),
    [
        ("apartment", "go to the nearer one"),
        ("apartment", "go to the kitchen and inspect the sink"),
        ("apartment", "go to the kitchen and then in the bathroom"),
        ("apartment", "take the book to the bedroom"),
        ("apartment", "the light in the kitchen is on"),
        ("apartment", "if the door is open, go to the kitchen"),
        ("apartment", "Anna said, go to the kitchen"),
        ("apartment", "a fifth of a metre forward"),
        ("humanoid", "follow me carefully"),
        ("humanoid", "do a backflip"),
        ("apartment", "I'm in the kitchen, bring me a beer"),
        ("apartment", "my brother is in the kitchen, he goes there at six"),
        ("panda", "okay so like the red one, go for it"),
        ("panda", "keep it in the cupboard"),
        ("humanoid", "the barn door wants shutting, see to it"),
        ("panda", "throw it at my brother"),
    ],
)
def test_what_is_no_order_for_it_is_neither_done_nor_asked_about(robot, says):
    calls, _, said = understood(robot, says)
    assert not any(skills_of_robots()[f"robot-{robot}"][one.skill].drives for one in calls), calls
    assert said


@pytest.mark.parametrize(
    ("language", "says"),
    [
        ("de", "fahr ein Drittel Meter vor"), ("fr", "avance d'un tiers de mètre"),
        ("es", "avanza un tercio de metro"), ("it", "vai avanti di un terzo di metro"),
        ("pt", "avance um terço de metro"), ("nl", "rijd een derde meter vooruit"),
        ("pl", "jedź do przodu jedną trzecią metra"), ("ru", "проедь треть метра вперёд"),
        ("tr", "üçte bir metre ileri git"), ("ar", "تقدم ثلث متر"),
        ("hi", "एक तिहाई मीटर आगे बढ़ो"), ("zh", "前进三分之一米"), ("ja", "三分の一メートル進んで"),
        ("vi", "đi tới một phần ba mét"), ("id", "maju sepertiga meter"),
    ],
)  # fmt: skip
def test_a_part_of_a_metre_that_is_not_read_moves_nothing(language, says):
    assert understood("apartment", says, language)[0] == []


@pytest.mark.parametrize(
    ("language", "says", "call"),
    [
        ("en", "turn left a bit", Call("turn_left", {"degrees": 20.0})),
        ("en", "turn left", Call("turn_left", {})),
        ("en", "turn left a bit, 30 degrees", Call("turn_left", {"degrees": 30.0})),
        ("de", "geh ein Stück vor", Call(FORWARD, {"distance": 0.3})),
        ("fr", "avance un peu", Call(FORWARD, {"distance": 0.3})),
        ("ja", "ちょっと前に進んで", Call(FORWARD, {"distance": 0.3})),
        ("zh", "往前走一点", Call(FORWARD, {"distance": 0.3})),
    ],
)
def test_a_bit_is_an_amount_of_its_own(language, says, call):
    assert understood("humanoid", says, language)[0] == [call]


def test_in_a_bit_is_not_a_bit():
    assert understood("humanoid", "in a bit turn left")[0] == []


@pytest.mark.parametrize(
    ("says", "begins"),
    [
        ("hiii robot!!", "Hello"),
        ("ok bye bye i have to go eat", "Goodbye"),
        ("what are you exactly", "I am a robot"),
        ("My aunt was here. She passed away last spring.", "I am sorry to hear"),
        ("dance for me", "I know no way"),
        ("Don't go to the kitchen.", "All right, I leave it"),
        ("you need not come to the office", "All right, I leave it"),
        ("what sound does a cow make?", "I do not know that"),
        ("Good afternoon! Is the owner in?", "I do not know that"),
    ],
)
def test_what_asks_for_nothing_that_it_does_gets_a_short_true_answer(says, begins):
    calls, _, said = understood("apartment", says)
    assert not calls
    assert said.startswith(begins)


@pytest.mark.parametrize(
    ("language", "says"),
    [
        ("en", "go to the kitchen, actually no"), ("en", "go to the kitchen, never mind"),
        ("en", "go to the kitchen, no, leave it"), ("de", "fahr in die Küche, ach lass"),
        ("fr", "va à la cuisine, non, laisse tomber"), ("es", "ve a la cocina, no, déjalo"),
        ("it", "vai in cucina, anzi no"), ("pt", "vai à cozinha, não, deixa"),
        ("nl", "ga naar de keuken, laat maar"), ("pl", "jedź do kuchni, albo nie"),
        ("ru", "езжай на кухню, хотя нет"), ("tr", "mutfağa git, boş ver"),
        ("ar", "اذهب إلى المطبخ، لا، انس الأمر"), ("hi", "रसोई में जाओ, रहने दो"),
        ("zh", "去厨房，算了"), ("ja", "キッチンに行って、いや、やっぱりいい。"),
        ("vi", "đi vào bếp, à thôi"), ("id", "pergi ke dapur, tidak jadi"),
    ],
)  # fmt: skip
def test_an_order_that_its_end_takes_back_is_left(language, says):
    calls, _, said = understood("apartment", says, language)
    assert calls == []
    assert said


@pytest.mark.parametrize(
    ("language", "says"),
    [("en", "go to the kitchen, no hurry"), ("en", "go to the kitchen, no rush please")],
)
def test_a_courtesy_takes_nothing_back(language, says):
    assert understood("apartment", says, language)[0]


def test_two_or_three_metres_are_no_amount():
    assert understood("apartment", "二、三メートル前に進んで。", "ja")[0] == []


@pytest.mark.parametrize(
    ("language", "says"),
    [
        ("en", "Once Anna is back, drive forward one metre."),
        ("en", "Turn left 90 degrees. Kidding!"),
        ("en", "Go to the bedroom. Actually, no, I'd rather have you here."),
        ("en", "Honey, can you go to the kitchen and get me some water?"),
        ("de", "Sobald der Besuch weg ist, fahr in die Küche."),
        ("fr", "Viens dans le salon, Amélie, s'il te plaît."),
        ("it", "Vai in cucina, anzi no aspetta, resta qui."),
        ("nl", "Rij een meter vooruit, zolang de vloer maar droog is."),
        ("pl", "Jedź do kuchni, chyba że ktoś już tam jest."),
        ("tr", "Yatak odasına git, aslında burada kalman daha iyi."),
        ("zh", "去厨房吧，除非里面有人。"),
        ("zh", "去厨房吧,除非里面有人。"),
        ("ja", "花子ちゃん、キッチンに行って。"),
    ],
)
def test_what_is_not_for_now_or_for_the_robot_is_at_most_asked_about(language, says):
    _, sure, _ = understood("apartment", says, language)

    assert not sure


@pytest.mark.parametrize(
    ("language", "says"),
    [
        ("en", "Get out of the kitchen and go to the bedroom."),
        ("de", "Fahr aus der Küche raus und dann ins Schlafzimmer."),
    ],
)
def test_a_place_to_leave_is_no_place_to_go_to(language, says):
    calls, _, _ = understood("apartment", says, language)

    assert calls in ([], [Call("navigate_to", {"room": "bedroom"})])


@pytest.mark.parametrize(
    ("language", "says"),
    [("en", "leave the kitchen"), ("es", "Venga, sal del salón."), ("ru", "Уезжай из кухни.")],
)
def test_an_order_to_leave_a_place_asks_for_no_way_there(language, says):
    assert understood("apartment", says, language)[0] == []


def test_an_order_that_was_not_read_holds_back_the_other():
    calls, sure, _ = understood(
        "apartment", "Back up a little bit first, and then go to the office."
    )

    assert not sure
    assert calls != [Call("navigate_to", {"room": "office"})]


@pytest.mark.parametrize(
    ("robot", "says", "call"),
    [
        ("apartment", "Back up a little, please", Call("drive_backward", {"distance": 0.3})),
        ("apartment", "go a bit forward", Call("drive_forward", {"distance": 0.3})),
        ("humanoid", "Take two steps back please.", Call("walk_backward", {"distance": 0.8})),
    ],
)
def test_a_small_amount_or_steps_are_done_at_once(robot, says, call):
    assert understood(robot, says)[:2] == ([call], True)


@pytest.mark.parametrize(
    ("language", "says"),
    [
        ("en", "you don't need to go there after all"),
        ("en", "not there"),
        ("en", "you needn't go to the kitchen any more"),
        ("de", "du brauchst nicht mehr in die Küche zu fahren"),
        ("fr", "ce n'est plus la peine d'aller à la cuisine"),
    ],
)
def test_words_that_deny_a_motion_end_the_one_that_goes_on(language, says):
    assert interpreter("apartment", language).denies_motion(says)


@pytest.mark.parametrize(
    "says",
    [
        "go to the kitchen",
        "my brother never goes to the kitchen",
        "I can't see anything",
        "that doesn't matter",
        "not bad",
        "you drive nicely",
    ],
)
def test_other_words_end_no_motion(says):
    assert not interpreter("apartment").denies_motion(says)


def reference(name: str) -> Skill:
    def refer(goal: GoalHandle) -> None:
        """Refer to what was done before."""

    refer.__name__ = name
    return skill(moves=False)(refer)


def meant(says: str, language: str = "en") -> Meaning | None:
    """What words mean to a robot that knows references."""
    agent = Agent(
        "robot",
        "",
        skills_of_robots()["robot-apartment"],
        dialogue_skills=SkillSet(map(reference, REFERENCES)),
    )
    one = Interpreter([agent], Bus(), SystemClock(), language=language, decider=open_decider())
    return one.understand(says, Turn(1, Bus(), SystemClock(), lambda: None))


@pytest.mark.parametrize(
    ("language", "says", "refers"),
    [
        ("en", "haha brilliant, let's have that one more time", "again"),
        ("en", "same thing but the other way round now", "the_other"),
        ("en", "Again! But the other way!", "the_other"),
        ("en", "just a smidge more than that", "further"),
        ("de", "und jetzt genau andersrum", "the_other"),
        ("fr", "allez, refais-le une fois de plus pour voir", "again"),
        ("es", "ahora lo mismo pero hacia el otro lado, venga", "the_other"),
        ("pt", "faz isso outra vez, vai", "again"),
        ("zh", "噢再来一遍看看", "again"),
    ],
)  # fmt: skip
def test_what_was_done_before_is_referred_to_in_any_words_and_asked_about(language, says, refers):
    meaning = meant(says, language)

    assert meaning is not None
    assert (meaning.calls, meaning.sure) == ((Call(refers),), False)


@pytest.mark.parametrize(
    "says",
    [
        "no no too much, come back a bit",
        "again, but two metres",
        "and after that?",
        "never do that again",
        "if you do that again I'll switch you off",
        "do it again later",
    ],
)
def test_what_changes_it_or_asks_something_refers_to_nothing(says):
    meaning = meant(says)

    assert not meaning or not {call.skill for call in meaning.calls} & set(REFERENCES)


def test_a_courtesy_names_no_act():
    assert "carry" not in understood("apartment", "Cheers mate, it was fun. Take care.")[2]


def test_an_act_that_no_skill_does_is_none_of_what_is_only_told():
    said = "In ten minutes go to the kitchen, that's when I take my tablets."
    assert "carry" not in understood("apartment", said)[2]
    assert understood("apartment", "now make turn on the left, a little")[0] == [
        Call("turn_left", {"degrees": 20.0})
    ]


@pytest.mark.parametrize(
    ("language", "says"),
    [
        ("en", "only two steps left"),
        ("fr", "tourne à droite, pas à gauche"),
        ("es", "desplázate a la cocina"),
        ("hi", "बाएँ मुड़कर दो कदम चलो"),
        ("id", "geser ke depan satu meter"),
        ("ru", "сдвинься вперёд на метр"),
        ("tr", "sola dönüp iki adım at"),
    ],
)
def test_words_of_turns_and_drives_are_no_step_to_the_side(language, says):
    cannot = phrasebook(language).acts["sideways"].cannot

    assert cannot not in understood("apartment", says, language)[2]


def test_words_for_another_way_are_no_step_back():
    calls, sure, _ = understood("humanoid", "turn left two steps")
    assert not sure
    assert BACK not in {call.skill for call in calls}


@pytest.mark.parametrize("says", ["Now reverse half of that.", "reverse half of that"])
def test_a_part_of_what_was_done_before_is_no_turn_around(says):
    calls, sure, _ = understood("apartment", says)
    assert not (calls and sure)


@pytest.mark.parametrize(
    ("language", "says", "call"),
    [
        ("es", "gira a la izquierda, no a la derecha", Call("turn_left", {})),
        ("pt", "vira à esquerda, não à direita", Call("turn_left", {})),
        ("pl", "skręć w lewo, nie w prawo", Call("turn_left", {})),
        ("id", "belok kiri, bukan kanan", Call("turn_left", {})),
        ("es", "gira a la izquierda, perdón no a la derecha", Call("turn_left", {})),
        ("ru", "поверни налево, точнее не направо", Call("turn_left", {})),
        ("en", "turn right, sorry not left", Call("turn_right", {})),
        ("fr", "va à la cuisine plutôt qu'au bureau", Call("navigate_to", {"room": "kitchen"})),
    ],
)
def test_what_is_denied_behind_an_order_is_not_done(language, says, call):
    calls, sure, _ = understood("apartment", says, language)
    assert (calls, sure) == ([call], False)


@pytest.mark.parametrize(
    ("language", "says"),
    [
        ("en", "can't you go to the kitchen, then go to the office"),
        ("en", "don't wait go to the kitchen, then go to the office"),
        ("en", "go to the kitchen, he said you must not"),
        ("en", "drive forward, 3 metres is too much"),
        ("en", "go to the kitchen 1"),
        ("es", "no ve a la cocina, luego ve al despacho"),
        ("pt", "não vai para a cozinha, depois vai para o escritório"),
        ("en", "drive back and forward, let's say, 2 metres"),
        ("es", "ve a la cocina, pero no al despacho"),
        ("de", "fahr vorwärts, sag ich mal, 2 Meter"),
        ("nl", "vergeet niet naar de keuken te gaan, ga dan naar het kantoor"),
        ("zh", "等客人都走了，你就去厨房。"),
    ],
)
def test_what_may_mean_another_order_is_not_done_at_once(language, says):
    _, sure, _ = understood("apartment", says, language)
    assert not sure


@pytest.mark.parametrize(
    "says",
    [
        "you must not, in ten minutes go to the kitchen",
        "in ten minutes go to the kitchen, don't you dare",
        "in ten minutes go to the kitchen, or maybe not",
        "in ten minutes go to the kitchen, sorry, I was talking to Anna",
    ],
)
def test_what_is_said_around_an_order_for_later_may_hold_it_back(says):
    calls, _, _ = understood("apartment", says)
    assert not calls


def test_a_remark_beside_an_order_for_later_is_left_out_and_it_is_asked_about():
    calls, sure, _ = understood("apartment", "I'm tired, in ten minutes go to the bedroom")
    assert (calls, sure) == ([Call("navigate_to", {"room": "bedroom"})], False)


@pytest.mark.parametrize(
    "says", ["turn left, don't go to the kitchen", "don't go to the kitchen, turn left"]
)
def test_a_denial_beside_an_order_leaves_nothing_silently(says):
    _, _, said = understood("apartment", says)
    assert said != "All right, I leave it."
