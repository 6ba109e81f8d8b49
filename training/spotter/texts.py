"""What the spotter is trained on: stop words, words that sound like them, and everything else."""

STOPS = {
    "stop": ("Stop!", "Please stop.", "No, stop!", "Robot, stop!", "Stop.", "Now stop!",
             "Just stop.", "Okay, stop.", "You must stop!", "Stop, stop!", "Emergency stop!"),
    "halt": ("Halt!", "Please halt.", "No, halt!", "Robot, halt!", "Halt.", "Now halt!",
             "Just halt.", "Okay, halt.", "You must halt!", "Halt, halt!"),
    "freeze": ("Freeze!", "Please freeze.", "No, freeze!", "Robot, freeze!", "Freeze.",
               "Now freeze!", "Just freeze.", "Okay, freeze.", "You must freeze!",
               "Freeze, freeze!"),
}  # fmt: skip
"""Texts that end with the word."""
STOPS_WITHIN = (
    "Stop moving!", "Halt right there!", "Freeze now!", "Stop right there!", "Halt now!",
    "Freeze right there!", "Stop now!", "Halt, please.", "Freeze, please.", "Stop it!",
    "Stop the robot, please.",
)  # fmt: skip
"""Texts in which a stop word comes first and more is said."""

BEFORE = (
    "You two {}!", "I want you to {}.", "Can't you {}!", "Somebody make it {}!", "We need to {}.",
    "Quick, {}!", "Come on, {}!", "Tell it to {}.", "Would you {}.", "Wait and {}.",
    "It has to {}.", "Do {}!", "Better {}.", "Over there, {}!", "Listen, {}!", "Now you {}!",
)  # fmt: skip
"""What may be said before a stop word, without a pause: other words than those of the test."""

ALIKE = (
    "Shop. Top. Stuff. Step. Drop.", "Freezer. Breeze. Please. Three. Fries.",
    "Halter. Salt. Hall. Halls. Fault. Hold.", "Stock. Spot. Star. Stove. Store. Stump.",
    "Stamp. Steep. Stub. Stuck. Start. Store it.",
    "Hop. Hot. Hat. Hurt. Heart. Haul. Hole. Holed.",
    "Free. Frees up. Fleece. Freight. Sneeze. Cheese. Trees.",
    "Swap. Slop. Crop. Prop. Chop. Mop. Pop. Cop. Flop.",
    "Malt. Bolt. Vault. Walled. Called. Belt. Melt. Colt. Alter.",
    "On top of it. A shop. This top. Last option. Its top shelf.", "Go to the shop at the top.",
    "It is in the freezer in the hall.", "Pass the salt, please.", "Start now!",
    "Step back, please.", "Hold this for me.", "Its top is free.", "Drop it there.",
)  # fmt: skip
"""No stop words, though they sound like some."""

COMMANDS = (
    "Go to the kitchen.", "Drive to the living room, please.", "Turn left.",
    "Turn right by ninety degrees.", "Come back to the door.", "Pick up the red cube.",
    "Where are you?", "What is your battery level?", "Move forward half a metre.",
    "Go back a little.", "Follow me, please.", "Wave with your right hand.",
    "Put the cube into the left bin.", "Speak louder.", "Tell me a story about the sea.",
    "Hello robot, how are you today?", "Take a picture and say what you see.",
    "Go home and charge.",
)  # fmt: skip
"""What people ask of a robot."""

OWN = (
    "I am on my way.", "I am in the kitchen.", "All right.", "Going to the living room.",
    "I did not understand that.", "I have arrived at the office.",
    "My battery is at sixty percent.", "I am standing still.", "I cannot do that.",
    "Shall I go to the kitchen?", "Turning left.", "I have picked up the red cube.",
    "Yes. What can I do for you?",
)  # fmt: skip
"""What the robot answers."""

CHAT = (
    "Kitchen, please.", "Walk forward one metre.", "Turn around.", "Drive to the bedroom.",
    "The office, please.", "How much battery is left?", "Take me to the living room.",
    "Turn right ninety degrees.", "Walk backward half a metre.", "Go to the loading bay.",
    "Open your hand.", "I had my lunch in the kitchen.", "Can you pass me the red plate?",
    "That was a good film.", "The weather is nice today.", "My phone is nearly empty.",
    "We left at nine.", "She works in the office.", "The bedroom needs new curtains.",
    "He turned right around and left.", "I read a book about that.", "What time is it?",
    "Give her a hand, will you?",
    "Well, I told him that the trains were late again, and nobody had an idea when the next one would come.",  # noqa: E501
    "The soup was good, but it needed more salt, if you ask me.",
)  # fmt: skip
"""What people say to each other."""
CHATTING = (
    "kokoro:af_heart", "kokoro:am_michael", "kokoro:bf_emma", "kokoro:bm_fable", "kokoro:af_bella",
    "kokoro:am_adam", "kokoro:bf_isabella", "kokoro:bm_lewis", "kokoro:af_sky", "kokoro:bm_daniel",
)  # fmt: skip
"""Who of Kokoro's voices says all of that and all of `COMMANDS`, once the others are through."""

WORDS = tuple(STOPS)
