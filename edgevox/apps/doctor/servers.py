"""The check of the servers that are asked before the models on board."""

import time
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import replace

from edgevox.apps.agent.voice import speech_address
from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, ok, warning
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import EdgeVoxError, install_extra
from edgevox.core.servers.address import Address
from edgevox.core.settings import Settings

MOST_S = 5.0
_SENT: Mapping[str, str] = {
    "llm_endpoint": "what people say, in words",
    "stt_endpoint": "the sound of what people say",
    "tts_endpoint": "what the robot says, in words",
}


def probe_servers(situation: Situation) -> Facts:
    """Ask each server what it has; why it did not say, by setting."""
    found = {}
    for address in _addresses(situation.settings):
        bounded = replace(address, timeout_s=min(MOST_S, address.timeout_s))
        fault = ""
        try:
            _ask(bounded, situation.settings)
        except EdgeVoxError as error:
            fault = str(error)
        except ModuleNotFoundError as error:
            fault = f"no module {error.name}: {install_extra('voice')}"
        found[address.setting] = {
            "server": address.host,
            "encrypted": address.encrypted,
            "fault": fault,
        }
    return {"servers": found}


def judge_servers(facts: Facts, _: Situation) -> CheckVerdict | list[CheckVerdict]:
    """Tell what leaves the robot. A server that fails is a warning: what is on board answers."""
    if not facts["servers"]:
        return ok("none: hearing, speech and language stay on board")
    advice = "start it, or correct {}; until then, what is on board answers"
    said = []
    for setting, one in facts["servers"].items():
        sent = _SENT[setting] + ("" if one["encrypted"] else ", unencrypted")
        text = f"{setting} sends {one['server']} {sent}"
        if one["fault"]:
            said.append(warning(f"{text}. It fails: {one['fault']}", advice.format(setting)))
        else:
            said.append(ok(f"{text}. It answers"))
    return said


def _addresses(settings: Settings) -> Iterator[Address]:
    if settings.llm_endpoint:
        named = settings.llm_endpoint_model
        file = settings.llm_endpoint_key_file
        yield Address(settings.llm_endpoint, named, settings.llm_endpoint_timeout, file)
    if not settings.text_mode:
        if settings.stt_endpoint:
            yield speech_address(settings, "stt")
        if settings.tts_endpoint:
            yield speech_address(settings, "tts")


def _ask(address: Address, settings: Settings) -> None:
    """Raise `EdgeVoxError` if the server does not say what it has, or has not what is asked of it.

    One that speaks is made to, since some list voices that they cannot load. A server that hears by
    HTTP without a list of its models passes if it answers at all.
    """
    from edgevox.core.servers.address import first_that, listed
    from edgevox.core.servers.errors import Unusable
    from edgevox.core.servers.http import HttpServer
    from edgevox.voice.remote.speaking import open_speaking_server
    from edgevox.voice.remote.wyoming import SCHEMES, WyomingServer

    token = CancelToken()
    if address.setting == "tts_endpoint":
        speaking = open_speaking_server(address, settings.tts_endpoint_voice)
        try:
            with closing(speaking.speak("1, 2, 3.", settings.language, token)) as sound:
                next(sound)
        finally:
            speaking.close()
        return
    until_s = time.monotonic() + address.timeout_s
    if address.url.partition("://")[0] in SCHEMES:
        wyoming = WyomingServer(address)
        try:
            info = wyoming.describe(until_s, token)
        finally:
            wyoming.close()
        if info is not None and not info.asr:
            raise Unusable("it does not transcribe")
        return
    server = HttpServer(address)
    try:
        reply = server.read_json("models", until_s, token)
    except Unusable:
        if address.setting == "llm_endpoint":
            raise
    else:
        if address.model:
            listed(reply, address)
        else:
            first_that("chat" if address.setting == "llm_endpoint" else "stt", reply, address)
    finally:
        server.close()
