"""What hearing is trained on: what people ask of robots, made of parts, and other English."""

import random
import re

from training.acoustics import Half
from training.acoustics.sentences import sentences

PLACES = (
    "kitchen", "bedroom", "office", "living room", "loading bay", "workshop", "garage", "garden",
    "pantry", "corridor", "hall", "library", "lab", "reception", "bathroom", "lobby", "warehouse",
    "charging station", "lift", "front door", "window", "table", "sofa", "canteen", "meeting room",
    "balcony", "cellar", "dock", "printer", "stairs", "ward three", "room twelve", "assembly line",
    "packing station", "terrace", "dining room", "children's room", "storage room", "entrance",
    "sink", "fridge", "hallway", "bay two", "shelf four",
)  # fmt: skip
GO = (
    "Go to the {}.", "Drive to the {}.", "{}, please.", "Take me to the {}.", "The {}, please.",
    "Please go to the {}.", "Can you go to the {}?", "Drive over to the {}, please.",
    "Bring me to the {}.", "Now to the {}.", "Head to the {}.", "I want you to go to the {}.",
    "Robot, go to the {}.", "Move to the {}.", "Come to the {}.", "Show me the way to the {}.",
)  # fmt: skip
MOVE = ("Walk", "Drive", "Move", "Go", "Step")
WAYS = ("forward", "backward", "ahead", "back", "straight on")
LENGTHS = (
    "one metre", "two metres", "three metres", "four metres", "five metres", "half a metre",
    "one and a half metres", "ten metres", "twenty metres",
)  # fmt: skip
TURN, SIDES = ("Turn", "Rotate", "Spin"), ("left", "right")
ANGLES = (
    "ten", "thirty", "forty-five", "sixty", "ninety", "a hundred and eighty", "fifteen",
    "one hundred and twenty", "two hundred and seventy",
)  # fmt: skip
THINGS = tuple(
    f"{kind} {thing}"
    for kind in ("red", "blue", "green", "yellow", "small", "big")
    for thing in ("cube", "ball", "cup", "box", "bottle")
)
HANDLE = (
    "Pick up the {}.", "Grasp the {}.", "Take the {}.", "Give me the {}.",
    "Put the {} on the table.", "Put the {} into the bin.", "Bring me the {}.", "Where is the {}?",
    "Look at the {}.",
)  # fmt: skip
OTHERS = (
    "Turn left.", "Turn right.", "Turn around.", "Where are you?", "What is your battery level?",
    "How much battery is left?", "Open your hand.", "Close your hand.", "Open the gripper.",
    "Close the gripper.", "Stand up.", "Sit down.", "Wave your hand.", "Follow me.", "Come here.",
    "Go home.", "Come back.", "Go back to the dock.", "What can you do?", "Where am I?",
    "Which way is the kitchen?", "Raise your left arm.", "Raise your right arm.", "Look at me.",
    "Look around.", "What do you see?", "Say hello.", "Speak louder.", "Speak more quietly.",
    "Repeat that.", "Be quiet.", "Yes.", "No.", "Yes, please.", "No, thanks.", "Never mind.",
    "Cancel that.", "Go on.", "Continue.", "Do it again.", "Faster, please.", "Slower, please.",
    "Wait here.", "Stop!", "Halt!", "Freeze!", "Please stop.", "Stop moving!", "Stop right there.",
    "Hold it!", "Let go.", "Dock now.", "Charge your battery.", "What time is it?", "How are you?",
    "What is your name?", "Thank you.", "Good morning.", "Dance for me.", "Are you there?",
    "How far is it?", "When will you be there?", "What are you doing?", "Put it down.",
    "Pick it up.", "Give it to me.", "Turn the light on.", "Drive forward.", "Drive backward.",
    "Back up.", "A little further.", "A bit to the left.", "A bit to the right.",
    "Remember this place.", "Forget this place.", "Save this place as the bench.",
    "Call it the bench.",
)  # fmt: skip
TESTED = frozenset({
    "Go to the kitchen.", "Kitchen, please.", "Drive to the bedroom.",
    "Take me to the living room.", "The office, please.", "Where are you?",
    "What is your battery level?", "How much battery is left?", "Go to the loading bay.",
    "Turn left.", "Turn around.", "Turn right ninety degrees.", "Walk forward one metre.",
    "Walk backward half a metre.", "Pick up the red cube.", "Open your hand.",
})  # fmt: skip
"""Those of the benchmark `noise`: they are shown beside what is said, and no voice says them."""

_LONGEST = 110
_NUMBERS = {
    "one": "1", "two": "2", "three": "3", "four": "4", "five": "5", "ten": "10", "twelve": "12",
    "fifteen": "15", "twenty": "20", "thirty": "30", "forty-five": "45", "sixty": "60",
    "ninety": "90", "a hundred and eighty": "180", "one hundred and twenty": "120",
    "two hundred and seventy": "270",
}  # fmt: skip
_AS_DIGITS = "|".join(sorted(_NUMBERS, key=len, reverse=True))
_BEFORE_UNIT = re.compile(rf"(?<!and )\b({_AS_DIGITS}) (meters?|degrees)", re.IGNORECASE)
_AFTER_NAME = re.compile(rf"\b(ward|room|bay|shelf) ({_AS_DIGITS})\b", re.IGNORECASE)


def command(rng: random.Random) -> str:
    """Something that a robot may be asked."""
    kind = rng.random()
    if kind < 0.42:
        said = rng.choice(GO).format(rng.choice(PLACES))
        return said[0].upper() + said[1:]
    if kind < 0.54:
        way, length = rng.choice(WAYS), rng.choice(LENGTHS)
        return f"{rng.choice(MOVE)} {way} {length}."
    if kind < 0.66:
        turn = f"{rng.choice(TURN)} {rng.choice(SIDES)}"
        return f"{turn} {rng.choice(('', 'by '))}{rng.choice(ANGLES)} degrees."
    if kind < 0.76:
        thing = rng.choice(THINGS)
        return rng.choice(HANDLE).format(thing)
    return rng.choice(OTHERS)


def talk() -> list[str]:
    """English that is no command, or not of those above."""
    return [one for one in sentences(Half.TRAIN) if one.isascii() and len(one) < _LONGEST]


def written(text: str) -> str:
    """As Whisper writes it: numbers with a unit as digits, and American."""
    american = text.replace("metre", "meter")
    digits = _BEFORE_UNIT.sub(lambda found: f"{_NUMBERS[found[1].lower()]} {found[2]}", american)
    return _AFTER_NAME.sub(lambda found: f"{found[1]} {_NUMBERS[found[2].lower()]}", digits)
