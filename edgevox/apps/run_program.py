"""The common frame of all programs: their logs, their end, and their exit codes."""

from collections.abc import Callable

from edgevox import __version__
from edgevox.apps.dds_security import secure_process
from edgevox.apps.shutdown_signals import Terminated
from edgevox.apps.streams import show
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.models import ModelMissing
from edgevox.ops.logs import set_up, tear_down, writes_json
from edgevox.ops.machine import return_memory

log = get_logger(__name__)

OK, FAILED, USAGE_ERROR = 0, 1, 2


def run_program(name: str, prepare: Callable[[], Callable[[], bool]]) -> int:
    """Prepare, then run what came of it; the process's exit code, with the reason on stderr."""
    return_memory()
    code = _run(name, prepare)
    log.info("program_ended", program=name, code=code)
    tear_down()  # what nobody caught leaves earlier: then the interpreter ends, and says so itself
    return code


def set_up_logs(name: str, settings: Settings) -> None:
    """Log to stderr as the settings say, beginning with who logs."""
    set_up(settings)
    given = settings.model_dump(mode="json", exclude_defaults=True)
    log.info("program_started", program=name, version=__version__, settings=given)


def secure_ros2(name: str, settings: Settings) -> None:
    """DDS security for nodes of this process, if it is asked for. Raises `InvalidValue`."""
    secure_process(
        name,
        settings.agent_namespace,
        lambda found: log.warning("security_warning", found=found),
    )


def _run(name: str, prepare: Callable[[], Callable[[], bool]]) -> int:
    try:
        run = prepare()
    except ModelMissing as error:
        return _fail(name, error, FAILED)
    except EdgeVoxError as error:
        return _fail(name, error, USAGE_ERROR)
    except KeyboardInterrupt:
        return OK
    try:
        return OK if run() else FAILED
    except InvalidValue as error:
        return _fail(name, error, USAGE_ERROR)
    except EdgeVoxError as error:
        return _fail(name, error, FAILED)
    except (Terminated, KeyboardInterrupt):
        return OK


def _fail(name: str, error: EdgeVoxError, code: int) -> int:
    """Say it to whoever reads: a person, or a program that takes only JSON."""
    if writes_json():
        log.critical("program_failed", program=name, reason=str(error))
    else:
        show(f"{name}: {error}", error=True)
    return code
