"""What a container is allowed of a machine, read from files as Linux writes them."""

import math
from pathlib import Path

import pytest

from edgevox.core.process import cpu_quota, memory_left, usable_cpus

MIB = 1 << 20


@pytest.fixture
def machine(tmp_path):
    """Writes files of /proc and /sys/fs/cgroup; what is asked of them."""

    def write(membership: str, **files: str) -> dict[str, Path]:
        proc, root = tmp_path / "cgroup", tmp_path / "sys"
        proc.write_text(membership)
        for name, text in files.items():
            file = root / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return {"proc": proc, "root": root}

    return write


def test_a_container_of_version_2_finds_its_quota_at_the_root(machine):
    assert cpu_quota(**machine("0::/\n", **{"cpu.max": "200000 100000\n"})) == 2


def test_a_container_of_version_1_finds_its_quota_although_its_path_is_the_hosts(machine):
    files = {"cpu/cpu.cfs_quota_us": "150000\n", "cpu/cpu.cfs_period_us": "100000\n"}
    assert cpu_quota(**machine("8:pids:/docker/ab\n1:cpu:/docker/ab\n", **files)) == 1.5


def test_controllers_that_are_mounted_together_are_found(machine):
    files = {"cpu,cpuacct/cpu.cfs_quota_us": "50000", "cpu,cpuacct/cpu.cfs_period_us": "100000"}
    assert cpu_quota(**machine("3:cpu,cpuacct:/\n", **files)) == 0.5


def test_a_service_is_limited_by_its_own_group_and_by_those_around_it(machine):
    files = {
        "robots.slice/cpu.max": "300000 100000",
        "robots.slice/a.service/cpu.max": "max 100000",
    }
    assert cpu_quota(**machine("0::/robots.slice/a.service\n", **files)) == 3


@pytest.mark.parametrize("membership", ["", "0::/\n", "0::/../..\n", "1:cpu:/\n"])
def test_where_nothing_limits_nothing_is_made_up(machine, membership):
    files = {"cpu.max": "max 100000\n", "cpu/cpu.cfs_quota_us": "-1\n"}
    files |= {"cpu/cpu.cfs_period_us": "100000\n", "memory.max": "max\n"}
    places = machine(membership, **files)
    assert cpu_quota(**places) == math.inf
    assert memory_left(**places) is None


@pytest.mark.parametrize(
    ("cores", "quota", "threads"),
    [(16, 2.0, 2), (16, math.inf, 16), (2, 8.0, 2), (16, 1.9, 1), (16, 0.25, 1), (1, math.inf, 1)],
)
def test_threads_are_as_many_as_cores_are_allowed_and_paid(cores, quota, threads):
    assert usable_cpus(cores, quota) == threads


def test_memory_that_is_left_counts_read_files_as_free(machine):
    files = {"memory.max": f"{512 * MIB}\n", "memory.current": f"{200 * MIB}\n"}
    files |= {"memory.stat": f"anon 1\ninactive_file {50 * MIB}\n"}
    assert memory_left(**machine("0::/\n", **files)) == 362 * MIB


def test_memory_of_version_1_is_limited_by_the_narrowest_group(machine):
    files = {
        "memory/memory.limit_in_bytes": "9223372036854771712",
        "memory/memory.usage_in_bytes": "0",
        "memory/a/memory.limit_in_bytes": str(100 * MIB),
        "memory/a/memory.usage_in_bytes": str(120 * MIB),
        "memory/a/memory.stat": f"inactive_file 1\ntotal_inactive_file {30 * MIB}\n",
    }
    assert memory_left(**machine("4:memory:/a\n", **files)) == 10 * MIB
