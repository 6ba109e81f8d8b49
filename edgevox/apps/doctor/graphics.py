"""A GPU, and OpenGL without a display."""

from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, ok, skipped, warning
from edgevox.core.extras import install_extra

_WITH_CAMERA = ("robot-panda", "robot-humanoid")


def probe_gpu() -> Facts:
    """In a process of its own: a broken driver may do anything."""
    import pynvml

    try:
        pynvml.nvmlInit()
        count = pynvml.nvmlDeviceGetCount()
        handles = [pynvml.nvmlDeviceGetHandleByIndex(index) for index in range(count)]
        names = [str(pynvml.nvmlDeviceGetName(one)) for one in handles]
    except pynvml.NVMLError_LibraryNotFound:
        return {"names": [], "failed": ""}
    except pynvml.NVMLError as failed:
        return {"names": [], "failed": str(failed)}
    return {"names": names, "failed": ""}


def judge_gpu(facts: Facts, _: Situation) -> CheckVerdict:
    """No GPU is fine; one whose driver is broken is not."""
    if facts["failed"]:
        advice = "install the kernel module and the library of the same version, and restart"
        return warning(f"NVIDIA's driver does not answer: {facts['failed']}", advice)
    if facts["names"]:
        return ok(", ".join(facts["names"]))
    return ok("none, and none is needed")


def probe_egl() -> Facts:
    """In a process of its own: drivers may end it."""
    from edgevox.robots.mujoco import gl

    try:
        gl.shield_import()
    except ImportError:
        return {"backend": gl.backend(), "failed": "", "installed": False}
    try:
        gl.open_context(64, 64).free()
    except gl.NoPicture as failed:
        return {"backend": gl.backend(), "failed": str(failed), "installed": True}
    return {"backend": gl.backend(), "failed": "", "installed": True}


def judge_egl(facts: Facts, situation: Situation) -> CheckVerdict:
    """Without it only pictures are missing."""
    if not facts["installed"]:
        return skipped("MuJoCo is not installed", f"{install_extra('mujoco')} brings two robots")
    if facts["failed"]:
        advice = "sudo apt install libegl1 libgl1 libgl1-mesa-dri"
        sees = situation.agent in _WITH_CAMERA
        return warning(facts["failed"], advice if sees else f"{advice} (for pictures only)")
    return ok(f"draws without a display, by {facts['backend']}")
