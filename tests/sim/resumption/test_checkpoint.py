"""A run that stops after any pass goes on to the same picture, bit by bit; no other run does."""

import os
import threading

import numpy as np
import pytest

import scenes
import sim
from sim.atomic_file import OutputError
from sim.resumption import checkpoint as module
from sim.resumption.checkpoint import Checkpoint
from sim.resumption.state_file import read_state

SETTINGS = {"photons": 400, "passes": 6, "seed": 11, "threads": 2}


class Killed(BaseException):
    """What ends a run where a test wants it to."""


@pytest.fixture(scope="module")
def bench(small_scene):
    """The small scene with both kinds of sensors, one of which keeps fewer rays than cross."""
    place = scenes.Disk(position=(0.0, 0.2, 0.0), normal=(0.0, 1.0, 0.0), radius=0.5)
    sensors = (
        scenes.IrradianceSensor(name="table", shape=place, pixels=(4, 3)),
        scenes.RaySensor(name="rays", shape=place, max_rays=300),
    )
    return small_scene.model_copy(update={"sensors": sensors})


@pytest.fixture(scope="module")
def undisturbed(bench):
    return sim.render(bench, sim.RenderSettings(**SETTINGS))


@pytest.fixture(autouse=True)
def _always_due(monkeypatch):
    """Checkpoints after every pass."""
    monkeypatch.setattr(module, "LONGEST_GAP_S", 0.0)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.checkpoint"


def run_until(monkeypatch, path, passes, work, **options):
    """Do `work` with a checkpoint, and end it as a kill would after so many passes."""
    real = Checkpoint.offer

    def offer(self, state):
        real(self, state)
        if state.passes == passes:
            raise Killed

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "offer", offer)
        with pytest.raises(Killed), Checkpoint(path, **options) as checkpoint:
            work(checkpoint)
    assert os.listdir(path.parent) == [path.name]


def content(result):
    """All numbers of a picture or a measurement."""
    found = {"energy": result.energy, "settings": result.settings.reproducing(),
             "stopping": result.stopping}  # fmt: skip
    for name in ("spectral_radiance", "standard_error"):
        if hasattr(result, name):
            found[name] = getattr(result, name).tobytes()
    if hasattr(result, "accuracy"):
        found |= {f"accuracy.{name}": np.asarray(one).tobytes()
                  for name, one in vars(result.accuracy).items()}  # fmt: skip
    for name, reading in result.sensors.items():
        for field, value in vars(reading).items():
            if isinstance(value, np.ndarray | float | int):
                found[f"{name}.{field}"] = np.asarray(value).tobytes()
    return found


@pytest.mark.parametrize("passes", [1, 2, 3, 5, 6])
def test_a_picture_goes_on_bit_by_bit(bench, undisturbed, monkeypatch, path, passes):
    # Odd numbers lie within a round of two turns, whose sample is half made.
    settings = sim.RenderSettings(**SETTINGS)
    run_until(monkeypatch, path, passes, lambda one: sim.render(bench, settings, checkpoint=one))
    made = []
    with Checkpoint(path, resume=True, tell=made.append) as checkpoint:
        other_threads = sim.RenderSettings(**{**SETTINGS, "threads": 1})
        picture = sim.render(bench, other_threads, checkpoint=checkpoint)
        assert path.exists()
    assert made[0].startswith(f"nephroid: going on after {passes} pass")
    assert content(picture) == content(undisturbed)
    picture.save_exr(path.with_name("one.exr"))
    undisturbed.save_exr(path.with_name("other.exr"))
    one, other = (path.with_name(name).read_bytes() for name in ("one.exr", "other.exr"))
    assert one == other
    assert not path.exists()


def test_it_goes_on_again_and_again(bench, undisturbed, monkeypatch, path):
    settings = sim.RenderSettings(**SETTINGS)
    for passes in (1, 3, 4):
        run_until(
            monkeypatch, path, passes,
            lambda one: sim.render(bench, settings, checkpoint=one), resume=True,
        )  # fmt: skip
    with Checkpoint(path, resume=True) as checkpoint:
        assert content(sim.render(bench, settings, checkpoint=checkpoint)) == content(undisturbed)


@pytest.mark.parametrize("passes", [1, 4, 6])
def test_a_measurement_goes_on_bit_by_bit(bench, monkeypatch, path, passes):
    settings = sim.RenderSettings(**SETTINGS)
    whole = sim.measure(bench, settings)
    assert whole.sensors["rays"].kept < 1.0
    run_until(monkeypatch, path, passes, lambda one: sim.measure(bench, settings, checkpoint=one))
    with Checkpoint(path, resume=True) as checkpoint:
        measurement = sim.measure(bench, settings, checkpoint=checkpoint)
    assert content(measurement) == content(whole)


def test_more_passes_and_another_end_may_be_asked_for(bench, undisturbed, monkeypatch, path):
    fewer = sim.RenderSettings(**{**SETTINGS, "passes": 4})
    run_until(monkeypatch, path, 3, lambda one: sim.render(bench, fewer, checkpoint=one))
    more = sim.RenderSettings(**{**SETTINGS, "passes": 6}, target_error=1e-9)
    with Checkpoint(path, resume=True) as checkpoint:
        picture = sim.render(bench, more, checkpoint=checkpoint)
    assert content(picture) == content(undisturbed)


def test_a_run_that_had_reached_its_target_makes_no_further_pass(bench, monkeypatch, path):
    settings = sim.RenderSettings(**SETTINGS, target_error=0.9)
    whole = sim.render(bench, settings)
    assert (whole.stopping, whole.settings.passes) == ("target error", 4)
    run_until(monkeypatch, path, 4, lambda one: sim.render(bench, settings, checkpoint=one))
    with Checkpoint(path, resume=True) as checkpoint:
        assert content(sim.render(bench, settings, checkpoint=checkpoint)) == content(whole)


def test_elapsed_time_counts_on(bench, monkeypatch, path):
    settings = sim.RenderSettings(**{**SETTINGS, "passes": None}, time_budget=500.0)
    run_until(monkeypatch, path, 4, lambda one: sim.render(bench, settings, checkpoint=one))
    stored = read_state(path)
    # As if those four passes had taken all of the budget but a moment.
    rewrite(path, {**stored.numbers, "seconds": 499.9, "longest_round": 1.0}, stored.arrays)
    with Checkpoint(path, resume=True) as checkpoint:
        picture = sim.render(bench, settings, checkpoint=checkpoint)
    assert (picture.stopping, picture.settings.passes) == ("time budget", 4)


def test_earlier_time_is_no_round_of_its_own(bench, monkeypatch, path):
    settings = sim.RenderSettings(**SETTINGS, time_budget=500.0)
    run_until(monkeypatch, path, 4, lambda one: sim.render(bench, settings, checkpoint=one))
    stored = read_state(path)
    # A round takes 1 s, and 200 s are left: taken for one, 300 s would not go in once more.
    rewrite(path, {**stored.numbers, "seconds": 300.0, "longest_round": 1.0}, stored.arrays)
    with Checkpoint(path, resume=True) as checkpoint:
        picture = sim.render(bench, settings, checkpoint=checkpoint)
    assert (picture.stopping, picture.settings.passes) == ("all passes", 6)


def rewrite(path, numbers, arrays):
    path.write_bytes(b"".join(bytes(one) for one in module.encode_state(numbers, arrays)))


@pytest.fixture
def stopped(bench, monkeypatch, path):
    """The checkpoint of three passes."""
    settings = sim.RenderSettings(**SETTINGS)
    run_until(monkeypatch, path, 3, lambda one: sim.render(bench, settings, checkpoint=one))
    return path


@pytest.mark.parametrize(
    ("settings", "difference"),
    [
        ({"seed": 12}, ("settings.seed", "11", "12")),
        ({"passes": 2}, ("settings.passes", "even, and 4 or more", "odd, or fewer than 4")),
    ],
)
def test_another_run_is_refused_with_what_differs(bench, stopped, settings, difference):
    before = stopped.read_bytes()
    with (
        pytest.raises(sim.CheckpointError) as caught,
        Checkpoint(stopped, resume=True) as checkpoint,
    ):
        asked = sim.RenderSettings(**{**SETTINGS, **settings})
        sim.render(bench, asked, checkpoint=checkpoint)
    assert caught.value.differences == (difference,)
    field, held, asked_for = difference
    assert f"\n  {field}: {held} in the checkpoint, {asked_for} asked" in str(caught.value)
    assert stopped.read_bytes() == before


def test_fewer_passes_than_are_done_are_refused(bench, monkeypatch, path):
    run_until(
        monkeypatch, path, 5,
        lambda one: sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=one),
    )  # fmt: skip
    fewer = sim.RenderSettings(**{**SETTINGS, "passes": 4})
    with (
        pytest.raises(sim.CheckpointError, match=r"settings.passes: 5 in .*, 4 asked"),
        Checkpoint(path, resume=True) as checkpoint,
    ):
        sim.render(bench, fewer, checkpoint=checkpoint)


def test_state_that_does_not_fit_its_own_header_is_refused(bench, stopped):
    stored = read_state(stopped)
    arrays = {name: one.copy() for name, one in stored.arrays.items()}
    bad = [
        ({}, {"books": arrays["books"][:2]}),
        ({"passes": 2}, {}), ({"passes": True}, {}), ({"longest_round": -1.0}, {}),
        ({"longest_round": float("nan")}, {}), ({"longest_round": "long"}, {}),
        ({}, {"film.mean": arrays["film.mean"][:-1]}),
        ({}, {"film.sample": arrays["film.sample"].astype(np.float32)}),
        ({}, {"sensors.bins.mean": np.zeros(3)}),
        ({}, {"sensors.rays1.kept": np.array(0.0)}),
        ({}, {"sensors.rays1.kept": np.array([1.0])}),
        ({}, {"sensors.rays1.rays.position": np.zeros((4, 3))}),
        ({}, {"sensors.rays1.crossings": np.array(0)}),
    ]
    for numbers, replaced in bad:
        rewrite(stopped, {**stored.numbers, **numbers}, {**arrays, **replaced})
        with (
            pytest.raises(sim.FileFormatError, match="cannot read"),
            Checkpoint(stopped, resume=True) as checkpoint,
        ):
            sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=checkpoint)
    for name in arrays:
        rewrite(stopped, stored.numbers, {key: one for key, one in arrays.items() if key != name})
        if name.startswith("sensors.rays1.rays.") or name in ("books", "film.mean"):
            with (
                pytest.raises(sim.FileFormatError),
                Checkpoint(stopped, resume=True) as checkpoint,
            ):
                sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=checkpoint)


@pytest.mark.parametrize("resume", [None, False])
def test_starting_anew(bench, undisturbed, stopped, resume):
    told = []
    with Checkpoint(stopped, resume=resume, tell=told.append) as checkpoint:
        picture = sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=checkpoint)
    assert content(picture) == content(undisturbed)
    # Who asked for it need not be told.
    assert len(told) == (1 if resume is None else 0)
    assert all("resume would have gone on after 3 passes" in one for one in told)
    assert not stopped.exists()


def test_a_minutes_work_is_not_thrown_away_unasked(bench, stopped):
    stored = read_state(stopped)
    rewrite(stopped, {**stored.numbers, "seconds": 7300.0}, stored.arrays)
    before = stopped.read_bytes()
    with (
        pytest.raises(sim.CheckpointError, match=r"3 passes, 2.0 h of work: .*--resume.*--no-res"),
        Checkpoint(stopped) as checkpoint,
    ):
        sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=checkpoint)
    assert stopped.read_bytes() == before


@pytest.mark.parametrize("seconds", [5.0, 7300.0])
@pytest.mark.parametrize(
    ("settings", "difference"),
    [({"seed": 12}, ("settings.seed", "11", "12")), ({"passes": 4}, ("settings.passes", "5", "4"))],
)
def test_that_of_another_run_is_not_said_to_go_on(
    bench, monkeypatch, path, seconds, settings, difference
):
    begun = sim.RenderSettings(**SETTINGS)
    run_until(monkeypatch, path, 5, lambda one: sim.render(bench, begun, checkpoint=one))
    stored = read_state(path)
    rewrite(path, {**stored.numbers, "seconds": seconds}, stored.arrays)
    told, asked = [], sim.RenderSettings(**{**SETTINGS, **settings})
    if seconds < module.WORTH_KEEPING_S:
        with Checkpoint(path, tell=told.append) as checkpoint:
            sim.render(bench, asked, checkpoint=checkpoint)
        (text,) = told
        assert "starting anew" in text
    else:
        with pytest.raises(sim.CheckpointError) as caught, Checkpoint(path) as checkpoint:
            sim.render(bench, asked, checkpoint=checkpoint)
        text = str(caught.value)
        assert caught.value.differences == (difference,)
        assert "--no-resume" in text
        assert path.exists()
    assert "5 passes" in text
    assert "--resume" not in text
    assert "would have gone on" not in text
    assert f"{difference[0]}: {difference[1]} in the checkpoint, {difference[2]} asked" in text


def test_what_the_file_holds_is_known_before_the_first_pass(bench, stopped):
    with pytest.raises(Killed), Checkpoint(stopped, resume=True) as checkpoint:

        def stop(progress):
            raise Killed

        sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=checkpoint, progress=stop)
    assert (checkpoint.passes, checkpoint.made) == (3, 3)


def test_a_damaged_one_is_an_error_if_asked_for_and_replaced_if_not(bench, stopped):
    stopped.write_bytes(stopped.read_bytes()[:-100])
    settings = sim.RenderSettings(**SETTINGS)
    with (
        pytest.raises(sim.FileFormatError, match="without resume, the run starts anew"),
        Checkpoint(stopped, resume=True) as checkpoint,
    ):
        sim.render(bench, settings, checkpoint=checkpoint)
    told = []
    with Checkpoint(stopped, tell=told.append) as checkpoint:
        sim.render(bench, settings, checkpoint=checkpoint)
    assert "replacing a checkpoint: cannot read" in told[0]


def test_two_runs_do_not_share_one(path):
    with Checkpoint(path), pytest.raises(sim.OutputError, match="another run is at it, process"):
        Checkpoint(path).__enter__()
    assert os.listdir(path.parent) == []


def test_a_crash_at_any_step_of_writing_leaves_the_last_one_or_the_next(
    bench, undisturbed, monkeypatch, path
):
    # Every call by which the file system changes, before and after it takes effect.
    settings = sim.RenderSettings(**SETTINGS)
    seen = set()
    for name in ("open", "fsync", "replace"):
        for after in (False, True):
            real, calls = getattr(os, name), []

            def crash(*arguments, real=real, calls=calls, after=after, name=name, **options):
                if name == "fsync" or "checkpoint-" in str(arguments[0]):
                    calls.append(arguments)
                    if len(calls) == 4:
                        if after:
                            real(*arguments, **options)
                        raise Killed
                return real(*arguments, **options)

            with monkeypatch.context() as patch:
                patch.setattr(os, name, crash)
                with pytest.raises(Killed), Checkpoint(path, resume=False) as checkpoint:
                    sim.render(bench, settings, checkpoint=checkpoint)
            stored = read_state(path)
            seen.add(stored.numbers["passes"])
            assert stored.numbers["passes"] == (4 if (name, after) == ("replace", True) else 3)
            with Checkpoint(path, resume=True) as checkpoint:
                picture = sim.render(bench, settings, checkpoint=checkpoint)
            assert content(picture) == content(undisturbed)
            assert os.listdir(path.parent) == []
    assert seen == {3, 4}


def test_a_failure_to_write_ends_no_run(bench, undisturbed, monkeypatch, path):
    real, told, tries = os.fsync, [], []

    def fsync(descriptor):
        tries.append(descriptor)
        if len(tries) in (3, 4):
            raise OSError(28, "No space left on device")
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fsync)
    with Checkpoint(path, tell=told.append) as checkpoint:
        picture = sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=checkpoint)
        assert read_state(path).numbers["passes"] == 6
    assert content(picture) == content(undisturbed)
    assert told == [
        f"nephroid: warning: no checkpoint: cannot write '{path}': No space left on device; that"
        " of 2 passes is kept; going on"
    ]


def test_a_run_that_was_left_behind_writes_nothing(bench, path):
    # After Ctrl-C the thread that renders is still there.
    at_work, go_on, ended = threading.Event(), threading.Event(), []

    def work(checkpoint):
        def hold(progress):
            if progress.pass_index == 2:
                at_work.set()
                go_on.wait()

        try:
            sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=checkpoint, progress=hold)
        except BaseException as error:
            ended.append(type(error))

    with pytest.raises(Killed), Checkpoint(path) as checkpoint:
        thread = threading.Thread(target=work, args=(checkpoint,))
        thread.start()
        assert at_work.wait(60)
        raise Killed
    before = path.read_bytes()
    assert os.listdir(path.parent) == [path.name]
    go_on.set()
    thread.join()
    assert ended == [KeyboardInterrupt]
    assert path.read_bytes() == before
    assert os.listdir(path.parent) == [path.name]


def test_what_a_killed_run_left_half_written_goes(path):
    for name in (f"{path.name}-0123.tmp", "other.checkpoint-0123.tmp"):
        path.with_name(name).write_bytes(b"half")
    with Checkpoint(path):
        pass
    assert os.listdir(path.parent) == ["other.checkpoint-0123.tmp"]


class Clock:
    def __init__(self):
        self.now = 0.0

    def perf_counter(self):
        return self.now


class Run:
    """Stands for a run of short passes: its state is a number of bytes."""

    passes = 0

    def __init__(self, size):
        self.size = size

    def arrays(self):
        return {"all": np.zeros(self.size // 8)}


@pytest.mark.parametrize("cost", [0.001, 0.1, 0.5, 3.0])
def test_writing_takes_two_per_cent_or_is_thirty_seconds_apart(monkeypatch, path, cost):
    monkeypatch.setattr(module, "LONGEST_GAP_S", 30.0)
    clock, writes = Clock(), []
    monkeypatch.setattr(module, "time", clock)

    def write(self, state):
        clock.now += cost
        writes.append(clock.now)

    monkeypatch.setattr(Checkpoint, "_write", write)
    with Checkpoint(path, resume=False) as checkpoint:
        run = Run(8)
        checkpoint.expect({}, 6)
        checkpoint.begin(run)
        while clock.now < 600.0:
            clock.now += 0.2
            checkpoint.offer(run)
    gaps = np.diff(writes)
    # A pass of 0.2 s more, for it is asked after passes, and what the writing itself takes.
    assert gaps.max() <= min(30.0, cost / module.COST_SHARE) + 0.2 + cost + 1e-9
    assert cost / gaps.mean() <= max(module.COST_SHARE, cost / 30.0)


def test_a_large_film_is_not_written_before_that_is_worth_it(monkeypatch, path):
    monkeypatch.setattr(module, "LONGEST_GAP_S", 30.0)
    clock, writes = Clock(), []
    monkeypatch.setattr(module, "time", clock)
    monkeypatch.setattr(Checkpoint, "_write", lambda self, state: writes.append(clock.now))
    with Checkpoint(path, resume=False) as checkpoint:
        run = Run(160_000_000)  # at 800 MB/s 0.2 s, which are 2 % of 10 s
        checkpoint.expect({}, 6)
        checkpoint.begin(run)
        while not writes:
            clock.now += 1.0
            checkpoint.offer(run)
    assert writes == [10.0]


def test_a_large_one_reaches_the_disk_while_the_run_goes_on(
    bench, undisturbed, monkeypatch, path
):
    monkeypatch.setattr(module, "MUCH_BYTES", 0)
    real, threads = os.fsync, []

    def fsync(descriptor):
        threads.append(threading.current_thread())
        if len(threads) == 2:
            raise OSError(28, "No space left on device")
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fsync)
    told = []

    def offer_and_wait(self, state, real=Checkpoint.offer):
        real(self, state)
        self.settle()

    monkeypatch.setattr(Checkpoint, "offer", offer_and_wait)
    settings = sim.RenderSettings(**SETTINGS)
    run_until(
        monkeypatch, path, 4, lambda one: sim.render(bench, settings, checkpoint=one),
        tell=told.append,
    )  # fmt: skip
    assert len(threads) == 4
    assert threading.main_thread() not in threads
    assert len(told) == 1
    assert "that of 1 pass is kept; going on" in told[0]
    with Checkpoint(path, resume=True) as checkpoint:
        picture = sim.render(bench, settings, checkpoint=checkpoint)
    assert content(picture) == content(undisturbed)
    assert os.listdir(path.parent) == []


def test_one_that_is_on_its_way_when_the_block_is_left_does_not_arrive(
    bench, monkeypatch, path
):
    monkeypatch.setattr(module, "MUCH_BYTES", 0)
    monkeypatch.setattr(module, "LAST_WAIT_S", 0.01)
    reached, go_on = threading.Event(), threading.Event()

    def fsync(descriptor):
        reached.set()
        go_on.wait()

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(Killed), Checkpoint(path) as checkpoint:
        sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=checkpoint)
        assert reached.is_set()
        assert checkpoint.passes == 0
        raise Killed
    assert os.listdir(path.parent) == []
    go_on.set()
    checkpoint.settle()
    assert os.listdir(path.parent) == []


def test_leaving_the_block_waits_for_one_that_takes_its_name(bench, monkeypatch, path):
    # Else it would appear after the run's checkpoint has been removed, or fail to.
    monkeypatch.setattr(module, "MUCH_BYTES", 0)
    real, reached, let_go = os.replace, threading.Event(), threading.Event()

    def replace(*names):
        reached.set()
        let_go.wait(0.5)
        real(*names)

    monkeypatch.setattr(os, "replace", replace)
    told = []
    with Checkpoint(path, tell=told.append) as checkpoint:
        sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=checkpoint)
        assert reached.wait(60)
    assert os.listdir(path.parent) == []
    let_go.set()
    checkpoint.settle()
    assert os.listdir(path.parent) == []
    assert told == []


def test_it_is_used_in_a_block(bench, path):
    with pytest.raises(RuntimeError, match="with"):
        sim.render(bench, sim.RenderSettings(**SETTINGS), checkpoint=Checkpoint(path))


def test_where_it_cannot_be_written_nothing_begins(tmp_path):
    with pytest.raises(OutputError, match="there is no folder"):
        Checkpoint(tmp_path / "none" / "run.checkpoint").__enter__()
