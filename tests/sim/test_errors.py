"""The error tree: what each error is, says, and keeps when it crosses a process."""

import pickle

import pytest

from sim import errors

EXAMPLES = [
    errors.SettingsError("photons", 0, "a whole number from 1"),
    errors.OutputError("out.exr", "no space left on device"),
    errors.FileFormatError("in.exr", "it is not an OpenEXR file"),
    errors.CapacityError("the photon map is full; raise or lower …"),
    errors.DeviceError("cuda:3 is not there"),
    errors.CheckpointError("c.checkpoint", "it is of another run", (("a.b", "1", "2"),)),
    errors.UnfinishedError("cannot write 'out.exr'; kept 3 passes"),
]
BUILTINS = [
    ValueError, OSError, ValueError, RuntimeError, RuntimeError, ValueError, RuntimeError,
]


def test_every_error_is_drawn_in_the_tree():
    assert errors.__doc__ is not None
    for name in errors.__all__:
        assert name in errors.__doc__
        assert issubclass(getattr(errors, name), errors.NephroidError)


@pytest.mark.parametrize(
    ("error", "builtin"),
    list(zip(EXAMPLES, BUILTINS, strict=True)),
)
def test_each_is_also_the_builtin_that_fits(error, builtin):
    assert isinstance(error, builtin)


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda error: type(error).__name__)
def test_errors_survive_pickling(error):
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert vars(copy) == vars(error)


def test_messages_say_what_where_and_what_is_allowed():
    settings, output, file_format, *_ = map(str, EXAMPLES)
    assert settings == "photons: 0 is not allowed; allowed: a whole number from 1"
    assert output == "cannot write 'out.exr': no space left on device"
    assert file_format == "cannot read 'in.exr': it is not an OpenEXR file"
