"""What there is to be had: the least of the machine's and of every control group's."""

import pytest

from sim.memory.available import available_memory, resident_memory

MEMINFO = "MemTotal:       8000000 kB\nMemFree:          10 kB\nMemAvailable:    4000 kB\n"


@pytest.fixture
def system(tmp_path):
    """A file system that tells what it is given: path and content."""

    def write(**files):
        for name, text in files.items():
            path = tmp_path / name.replace("__", "/")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return tmp_path

    return write


def group(root, folder, **files):
    path = root / "sys/fs/cgroup" / folder
    path.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (path / name.replace("_dot_", ".")).write_text(text)


def test_the_machine_alone(system):
    assert available_memory(system(proc__meminfo=MEMINFO)) == 4000 * 1024


def test_nothing_is_known(tmp_path, system):
    assert available_memory(tmp_path) is None
    assert available_memory(system(proc__meminfo="nonsense\nMemAvailable: x kB\n")) is None


@pytest.mark.parametrize("place", ["a/b", "a", ""])
def test_a_limit_of_any_group_above_counts(system, place):
    root = system(proc__meminfo=MEMINFO, proc__self__cgroup="0::/a/b\n")
    group(root, "a/b", memory_dot_max="max\n", memory_dot_current="5\n")
    group(root, place, memory_dot_max="1000000\n", memory_dot_current="400000\n",
          memory_dot_stat="anon 7\ninactive_file 50000\n")  # fmt: skip
    assert available_memory(root) == 1_000_000 - 400_000 + 50_000


def test_the_first_version_of_groups(system):
    root = system(proc__meminfo=MEMINFO, proc__self__cgroup="3:cpu:/x\n4:memory:/a\n0::/\n")
    group(root, "memory/a", **{"memory_dot_limit_in_bytes": "900000\n",
                               "memory_dot_usage_in_bytes": "950000\n"})  # fmt: skip
    assert available_memory(root) == 0  # over its limit already


def test_in_a_container_only_the_top_is_to_be_seen(system):
    root = system(proc__meminfo=MEMINFO, proc__self__cgroup="0::/docker/deadbeef\n")
    group(root, "", memory_dot_max="3000\n", memory_dot_current="1000\n")
    assert available_memory(root) == 2000


def test_this_process_takes_some():
    ballast = b"x" * (64 << 20)
    assert resident_memory() > len(ballast)
