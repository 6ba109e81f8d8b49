"""ONNX models run beside a language model and a robot: few threads, and none that spins."""

from pathlib import Path

import onnxruntime

from edgevox.core.process import usable_cpus


def open_session(path: Path, threads: int, *, arena: bool = True) -> onnxruntime.InferenceSession:
    """Load a model on the CPU with this many threads, and no more than may compute at once.

    A thread that spins while it waits takes the core that another thread needs. Without the
    `arena`, memory is given back after each run, and not kept for the largest run so far.
    """
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = min(threads, usable_cpus())
    options.inter_op_num_threads = 1
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    options.log_severity_level = 3
    options.enable_cpu_mem_arena = arena
    return onnxruntime.InferenceSession(
        str(path), sess_options=options, providers=["CPUExecutionProvider"]
    )
