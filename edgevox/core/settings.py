"""The settings: one model, validated once, with the field's name in every error.

Sources, each overruling the one before: the defaults below, a TOML file, ``EDGEVOX_*`` variables,
command line flags, and, on a running node, ROS 2 parameters. In a container,
`apps/container/environment.py` checks the variables first.

Validators add the rules that a type cannot express, with messages for people. Old names of settings
go on working as flags, variables and TOML keys: a field's ``json_schema_extra`` has `old_name` for
all three, and `old_flag` if the flag had another name.
"""

import os
import re
import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import AfterValidator, Field, ValidationError
from pydantic.fields import FieldInfo
from pydantic_settings import (
    BaseSettings,
    InitSettingsSource,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
)

from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.files.user_file import read_text
from edgevox.core.files.validation import dotted, explain
from edgevox.core.languages import language_code
from edgevox.core.servers.address import Endpoint, SpeechEndpoint
from edgevox.core.transforms import PREFIX_EXPECTED, OdomFrame, is_prefix

_NAMESPACE = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+|/")


def _valid_namespace(namespace: str) -> str:
    absolute = namespace if namespace.startswith("/") else f"/{namespace}"
    if not _NAMESPACE.fullmatch(absolute) or "__" in absolute:
        raise ValueError(
            "a ROS 2 namespace such as /robot1: letters, digits and single underscores"
        )
    return absolute


def _valid_prefix(prefix: str) -> str:
    if not is_prefix(prefix):
        raise ValueError(PREFIX_EXPECTED)
    return prefix


LanguageCode = Annotated[str, AfterValidator(language_code)]
"""The code of a language of the catalogue."""
RosNamespace = Annotated[str, AfterValidator(_valid_namespace)]
"""A ROS 2 namespace, made absolute."""
FramePrefix = Annotated[str, AfterValidator(_valid_prefix)]
"""A prefix for the names of frames."""

ENV_PREFIX = "EDGEVOX_"


def old_name(info: FieldInfo) -> str:
    """The old name of a setting; empty for most."""
    return _extra(info, "old_name")


def old_flag(info: FieldInfo) -> str:
    """The old name of a setting's flag; empty for most."""
    return _extra(info, "old_flag") or old_name(info)


def one_value(old: str, value: object, new: str, other: object) -> None:
    """Raise `InvalidValue`, with both names, if one setting has two values."""
    if value != other:
        raise InvalidValue(old, value, f"{other!r}, as {new} says, or only one")


def by_old_variables(environment: Mapping[str, str]) -> dict[str, Any]:
    """The settings that the environment gives by an old name.

    Raises `InvalidValue` if it also gives another value by the new name.
    """
    given = {name.upper(): value for name, value in environment.items()}
    values: dict[str, Any] = {}
    for name, info in Settings.model_fields.items():
        old, new = ENV_PREFIX + old_name(info).upper(), ENV_PREFIX + name.upper()
        if old_name(info) and old in given:
            values[name] = given[old]
            one_value(old, given[old], new, given.get(new, given[old]))
    return values


def by_new_keys(written: Mapping[str, Any]) -> dict[str, Any]:
    """The settings of a TOML file, with old keys replaced by the new ones.

    Raises `InvalidValue` if both keys of a setting have different values.
    """
    values = dict(written)
    for name, info in Settings.model_fields.items():
        old = old_name(info)
        if old and old in values:
            value = values.pop(old)
            one_value(old, value, name, values.setdefault(name, value))
    return values


def _extra(info: FieldInfo, key: str) -> str:
    extra = info.json_schema_extra
    return str(extra.get(key, "")) if isinstance(extra, dict) else ""


Confirm = Literal["always", "unsure", "never"]
CONFIRM: tuple[Confirm, ...] = get_args(Confirm)
"""Values of the setting for questions before a drive."""
Echo = Literal["cancel", "gate", "none"]
AUTO_LLM = "auto"
"""Value of `llm` for the best language model that is here and fits."""
NO_LLM = "none"
"""Value of `llm` for no language model on board."""
WakeEngine = Literal["micro", "openwakeword"]
ConsoleTls = Literal["own", "files", "off"]
LlmBackend = Literal["auto", "xllamacpp", "llama-cpp-python"]
GrammarDialect = Literal["auto", "llama-server", "vllm", "vllm-guided", "none"]


class Settings(BaseSettings):
    """Everything that can be set. A field's description is its help text everywhere."""

    model_config = SettingsConfigDict(
        env_prefix=ENV_PREFIX, extra="forbid", frozen=True, validate_default=True
    )
    written: ClassVar[Mapping[str, Any]] = {}
    """The contents of the TOML file."""
    alone: ClassVar[bool] = False
    """True to take only what is given, without the environment or a file."""

    language: LanguageCode = Field(
        "en", description="language to hear and speak: an ISO 639-1 code, a tag or a locale"
    )
    voice: str = Field("", description="text-to-speech voice; empty chooses by the language")
    muted: bool = Field(False, description="mute the microphone")
    confirm: Confirm = Field(
        "unsure",
        description="when the robot asks back before it drives: always, or when unsure;"
        " never: unsure orders are not done",
    )
    text_mode: bool = Field(False, description="type instead of speaking; no sound is used")
    simple_ui: bool = Field(False, description="plain lines instead of a full-screen interface")
    render: bool = Field(True, description="show the robot in a window if there is a display")
    ros2: bool = Field(False, description="run as a ROS 2 node")
    agent_namespace: RosNamespace = Field(
        "/edgevox",
        description="namespace of the ROS 2 node",
        json_schema_extra={"old_name": "ros2_namespace"},
    )
    ros2_state_hz: float = Field(
        10.0, ge=0.1, le=100.0, description="publishing rate of robot_state, in hertz"
    )
    odom_frame: OdomFrame = Field(
        "", description="empty: map -> base_link on /tf; odom: map -> odom -> base_link, for Nav2"
    )
    frame_prefix: FramePrefix = Field(
        "", description="prefix of the robot's frames on /tf, so that robots can share a domain"
    )
    publish_clock: bool = Field(
        False, description="publish the robot's time on /clock, for nodes with use_sim_time"
    )
    world: Path | None = Field(
        None, description="world file of a 2D robot, in IR-SIM's YAML format"
    )
    model_source: Literal["unitree_g1", "unitree_h1"] = Field(
        "unitree_g1", description="robot-humanoid: the robot model"
    )
    mjcf: Path | None = Field(
        None, description="robot-humanoid: a robot of your own, as an MJCF file"
    )
    seed: int = Field(0, ge=0, lt=1 << 32, description="random seed of the simulated world")
    robot_namespace: RosNamespace = Field(
        "/",
        description="robot-external: namespace of the robot's topics, such as /robot1",
        json_schema_extra={"old_name": "external_namespace", "old_flag": "namespace"},
    )
    robot_file: Path | None = Field(
        None,
        description="robot-external: YAML file that describes the robot: its limits, its"
        " topics, and skills made from its ROS 2 interfaces",
    )
    skills: str = Field(
        "all",
        min_length=1,
        description="installed skill packages to use, by name, separated by commas; all, or none",
    )
    locations: Path | None = Field(None, description="robot-external: YAML file of named places")
    places: Path | None = Field(
        None,
        description="folder of the places that you tell the robot to remember; default:"
        " edgevox in $XDG_STATE_HOME, or in ~/.local/state",
    )
    pictures: Path | None = Field(
        None,
        description="folder of the pictures that you tell the robot to take; no other robot may use"
        " it; default: pictures in the folder of the console's recordings",
    )
    pictures_mb: int = Field(
        50,
        ge=1,
        le=10_000_000,
        description="size limit of all these pictures together, in megabytes; the oldest are"
        " deleted",
    )
    plugins: Path | None = Field(
        None,
        description="folder of plug-in packages (wheels or folders) with robots and"
        " skills; empty: load none",
    )
    policy: Path | None = Field(
        None, description="YAML file that says who may command what, and within which limits"
    )
    max_linear: float = Field(
        0.3,
        gt=0.0,
        le=10.0,
        description="robot-external: highest speed when EdgeVox steers, in m/s",
    )
    max_angular: float = Field(
        0.8,
        gt=0.0,
        le=10.0,
        description="robot-external: highest turning speed when EdgeVox steers, in rad/s",
    )
    audio_in: str = Field(
        "", description="microphone: a device's name, a WAV file or folder, ros2, or none"
    )
    audio_out: str = Field(
        "", description="loudspeaker: a device's name, a WAV file, ros2, or none"
    )
    wakeword: str = Field(
        "",
        description="listen only after this wake word, such as 'hey jarvis', or a"
        " microWakeWord .json file; empty: always listen",
    )
    follow_up_s: float = Field(
        8.0,
        ge=0.0,
        le=60.0,
        description="seconds after a spoken answer in which the same person may go on without"
        " the wake word; 0: never, not even to answer a question of the robot",
    )
    voiceprints: bool = Field(
        False,
        description="tell the people who were enrolled with `edgevox voiceprint` from guests by"
        " their voice, for the policy; no lock",
    )
    answer_group: str = Field(
        "",
        max_length=40,
        description="name of the group of robots, on one ROS 2 domain, of which only one answers"
        " when several hear a person; empty: this robot answers whatever it hears",
    )
    spoken_name: str = Field(
        "",
        max_length=40,
        description="name by which people call this robot in its answer_group; empty: its"
        " namespace",
    )
    keep_audio: Path | None = Field(
        None,
        description="folder for the last 200 utterances as WAV files, with what was"
        " understood; they are people's voices",
    )
    wakeword_engine: WakeEngine = Field(
        "micro",
        description="engine that detects the wake word; openwakeword is not for commercial use",
    )
    stop_spotter: bool = Field(
        True,
        description="also detect stop words by their sound, at once, in the middle of a sentence",
    )
    echo: Echo = Field(
        "cancel",
        description="the robot's own voice in the microphone: cancel it, or gate it by"
        " level; none if another device cancels it",
    )
    llm: str = Field(
        AUTO_LLM,
        description="language model: an id of edgevox-models, a GGUF file, or none; auto takes"
        " Qwen2.5-Coder 1.5B where it was fetched and 6 GB of memory are free, else 0.5B",
    )
    llm_backend: LlmBackend = Field("auto", description="library that runs the language model")
    llm_threads: int = Field(
        0, ge=0, le=256, description="threads of the language model; 0 chooses by the machine"
    )
    llm_context: int = Field(
        4096, ge=1024, le=131072, description="context window of the language model, in tokens"
    )
    llm_endpoint: Endpoint = Field(
        "",
        description="OpenAI-compatible server to ask before the embedded language model, such as "
        "http://llm:8080; empty: none",
    )
    llm_endpoint_model: str = Field(
        "", description="model to ask the server for; empty: the first that it offers for chats"
    )
    llm_endpoint_timeout: float = Field(
        10.0, ge=0.1, le=600.0, description="longest wait for the server's next token, in seconds"
    )
    llm_endpoint_key_file: Path | None = Field(
        None, description="file with the server's API key; read again for every request"
    )
    llm_endpoint_grammar: GrammarDialect = Field(
        "auto", description="how the server accepts a grammar; auto asks the server what it is"
    )
    stt_endpoint: SpeechEndpoint = Field(
        "",
        description="server to transcribe speech before the model on board: the OpenAI audio API"
        " (http://speech:8000) or Wyoming (tcp://speech:10300); empty: none",
    )
    stt_endpoint_model: str = Field(
        "", description="model to ask that server for; empty: the first that transcribes"
    )
    stt_endpoint_timeout: float = Field(
        3.0, ge=0.1, le=60.0, description="longest wait for the server's transcript, in seconds"
    )
    stt_endpoint_key_file: Path | None = Field(
        None, description="file with that server's API key; read again for every request"
    )
    tts_endpoint: SpeechEndpoint = Field(
        "",
        description="server to speak before the voice on board: the OpenAI audio API"
        " (http://speech:8000) or Wyoming (tcp://speech:10200); empty: none",
    )
    tts_endpoint_model: str = Field(
        "", description="model to ask that server for; empty: the first that speaks"
    )
    tts_endpoint_voice: str = Field(
        "",
        description="voice of that server, or one for each language (en=amy, de=thorsten);"
        " empty: its first for the language",
    )
    tts_endpoint_timeout: float = Field(
        3.0, ge=0.1, le=60.0, description="longest wait for the server's next sound, in seconds"
    )
    tts_endpoint_key_file: Path | None = Field(
        None, description="file with that server's API key; read again for every request"
    )
    health_port: int = Field(
        0, ge=0, le=65535, description="serve /live and /ready over HTTP on this port; 0: off"
    )
    health_host: str = Field(
        "127.0.0.1", min_length=1, description="address on which health is served"
    )
    metrics_port: int = Field(
        0, ge=0, le=65535, description="serve /metrics for Prometheus on this port; 0: off"
    )
    metrics_host: str = Field(
        "127.0.0.1", min_length=1, description="address on which metrics are served"
    )
    console: bool = Field(
        False, description="serve a web page to talk to the robot, see it and stop it"
    )
    console_optional: bool = Field(
        False,
        description="serve the console unless `console` says no; if that fails, for"
        " example because the port is taken, say why and go on",
    )
    console_host: str = Field(
        "127.0.0.1", min_length=1, description="address on which the console is served"
    )
    console_port: int = Field(
        8443, ge=1, le=65535, description="port on which the console is served"
    )
    console_tls: ConsoleTls = Field(
        "own",
        description="encryption of the console: own (the robot's own certificate"
        " authority), files (console_certificate and console_key), or off (on"
        " loopback only)",
    )
    console_plain: bool = Field(
        False,
        description="allow console_tls off on any address, for use behind a proxy that encrypts",
    )
    console_certificate: Path | None = Field(
        None, description="the console's certificate with its chain, a PEM file"
    )
    console_key: Path | None = Field(
        None, description="the private key of console_certificate, a PEM file"
    )
    console_names: str = Field(
        "",
        description="more host names and addresses for the console's own certificate,"
        " separated by commas",
    )
    console_folder: Path | None = Field(
        None,
        description="folder of the console's keys and paired browsers; default:"
        " edgevox/console in $XDG_STATE_HOME, or in ~/.local/state",
    )
    console_recordings: Path | None = Field(
        None,
        description="folder of the recordings made on the console; no other robot may use"
        " it; default: recordings in console_folder",
    )
    console_recordings_mb: int = Field(
        5000,
        ge=10,
        le=10_000_000,
        description="size limit of all these recordings together, in megabytes; old"
        " recordings are never deleted",
    )
    log_level: Literal["debug", "info", "warning", "error"] = Field(
        "warning", description="least severe log lines to show"
    )
    log_format: Literal["auto", "console", "json"] = Field(
        "auto",
        description="json: one JSON object per line; console: in colours; auto: in"
        " colours on a terminal",
    )
    log_speech: bool = Field(
        False, description="log what people and the robot say at every level, not only at debug"
    )
    leave_s: float = Field(
        4.5,
        ge=0.5,
        le=300,
        description="seconds to shut down after SIGTERM; keep it below your supervisor's timeout",
    )
    drain_s: float = Field(
        0.0,
        ge=0.0,
        le=3600.0,
        description="seconds that a goal may go on after SIGTERM or `edgevox-health"
        " --drain` before it is cancelled; 0: none. Your supervisor must wait"
        " longer than drain_s + leave_s",
    )

    @property
    def serves_console(self) -> bool:
        """True if the console is wanted: a given `console` overrides `console_optional`."""
        return self.console if "console" in self.model_fields_set else self.console_optional

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,  # noqa: ARG003
        file_secret_settings: PydanticBaseSettingsSource,  # noqa: ARG003
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Flags, then the environment, then the TOML file that `load_settings` names."""
        if cls.alone:
            return (init_settings,)
        old = InitSettingsSource(settings_cls, by_old_variables(os.environ))
        return init_settings, env_settings, old, InitSettingsSource(settings_cls, dict(cls.written))


def load_settings(flags: Mapping[str, Any], config: Path | None = None) -> Settings:
    """Settings from all sources. `flags` holds only what the command line gave.

    Raises `InvalidValue` naming the field, its value, and what was expected.
    """
    return _made(_from_file(config) if config else Settings, flags)


def _from_file(config: Path) -> type[Settings]:
    class FromFile(Settings):
        written = by_new_keys(written_in(config))

    return FromFile


def written_in(file: Path) -> dict[str, Any]:
    """The contents of a TOML file. Raises `EdgeVoxError` if it cannot be read."""
    try:
        return tomllib.loads(read_text(file, "config"))
    except (ValueError, RecursionError) as error:
        raise EdgeVoxError(f"config: {file} is not valid TOML: {error}") from None


def check_settings(values: Mapping[str, Any]) -> Settings:
    """Settings from these values and the defaults alone. Raises `InvalidValue`."""
    return _made(_alone(), values)


@cache
def _alone() -> type[Settings]:
    """Settings without other sources. Cached: making so large a model takes longer than a check."""

    class Alone(Settings):
        alone = True

    return Alone


def _made(kind: type[Settings], values: Mapping[str, Any]) -> Settings:
    try:
        return kind(**values)
    except ValidationError as error:
        known = {"extra_forbidden": "one of " + ", ".join(Settings.model_fields)}
        raise explain(error, lambda place: dotted(place) or "settings", known) from None
