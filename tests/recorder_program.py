"""A program in the place of `edgevox-recorder`: what it makes is whole once it was ended."""

RECORDS = """
import signal, sys, threading
from pathlib import Path
over = threading.Event()
signal.signal(signal.SIGTERM, lambda *_: over.set())
output = Path(sys.argv[sys.argv.index("--output") + 1])
bag = output / f"edgevox-20261123-1400{len(list(output.iterdir())):02}"
bag.mkdir()
def write(content, name):  # at once: who sees the file sees all that is in it
    (bag / "new").write_bytes(content)
    (bag / "new").rename(bag / name)
write(b"begun", f"{bag.name}_0.mcap.open")
over.wait()
write(b"whole", f"{bag.name}_0.mcap.open")
(bag / f"{bag.name}_0.mcap.open").rename(bag / f"{bag.name}_0.mcap")
"""
