"""Whose voice counts as known: by the setting, and by what the policy says of guests."""

import numpy as np
import pytest

from edgevox.agent.policy import Guard
from edgevox.apps.agent.voice import needed_models, open_known_voices
from edgevox.core.settings import load_settings
from edgevox.models import ModelMissing

SOUND = np.zeros(16_000, np.int16)


@pytest.mark.parametrize(
    ("rules", "known"), [("{voice: confirm}", True), ("{voice_guest: deny}", False)]
)
def test_without_voice_prints_all_are_guests_where_the_policy_has_rules_for_them(
    tmp_path, rules, known
):
    file = tmp_path / "policy.yaml"
    file.write_text(f"rules: {rules}")
    assert open_known_voices(load_settings({}), Guard(file))(SOUND, 0.0) is known
    assert open_known_voices(load_settings({}), Guard())(SOUND, 0.0)


def test_voice_prints_need_their_network(tmp_path, monkeypatch):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    with pytest.raises(ModelMissing, match="resemblyzer"):
        open_known_voices(load_settings({"voiceprints": True}), Guard())
    assert needed_models(load_settings({"voiceprints": True})) == ("resemblyzer",)
