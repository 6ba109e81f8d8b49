"""A llama-server in its own process, as one that a fleet shares.

    llama_server.py GGUF THREADS [PARALLEL]

Prints its address when it serves; ends with its stdin.
"""

import sys

from edgevox.agent.llm import weights


def main(path: str, threads: int, parallel: int = 1) -> None:
    weights.spin_briefly()
    import xllamacpp  # which reads at once what the line above says

    wanted = xllamacpp.CommonParams()
    wanted.model.path = path
    wanted.n_ctx = 4096 * parallel
    wanted.n_parallel = parallel
    wanted.n_batch = wanted.n_ubatch = weights.BATCH_TOKENS
    wanted.cpuparams.n_threads = wanted.cpuparams_batch.n_threads = threads
    wanted.fit_params = False
    wanted.verbosity = -1
    wanted.hostnames = ["127.0.0.1"]
    wanted.port = 0
    wanted.ui = False
    server = xllamacpp.Server(wanted)
    sys.stdout.write(server.listening_address + "\n")
    sys.stdout.flush()
    sys.stdin.read()


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
