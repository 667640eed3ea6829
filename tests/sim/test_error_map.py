"""The map of a picture's errors shows what the numbers say."""

import numpy as np

from sim.error_map import plot_error_map
from sim.figure_file import save_figure
from sim.image.accuracy import Accuracy


def test_each_pixel_is_its_relative_error(tmp_path):
    # √(noise² + bias² − bias_noise²) / luminance; nothing where there is no light.
    luminance = np.array([[1.0, 2.0, 0.0], [4.0, 1.0, 1.0]])
    noise = np.array([[0.03, 0.0, 0.0], [0.04, 5.0, 1e-9]])
    bias = np.array([[0.05, 0.2, 0.0], [0.0, 0.0, 0.0]])
    bias_noise = np.array([[0.03, 0.0, 0.0], [0.1, 0.0, 0.0]])
    accuracy = Accuracy(
        luminance=luminance, noise=noise, bias=bias, bias_noise=bias_noise,
        corrected_noise=noise, replicates=4,
    )
    figure = plot_error_map(accuracy)
    (image,) = figure.axes[0].get_images()
    shown = np.asarray(image.get_array(), dtype=float)
    # From 0.1 % to 100 %.
    np.testing.assert_allclose(shown[0, :2], [0.05, 0.1], rtol=1e-12)
    np.testing.assert_allclose(shown[1], [0.01, 1.0, 0.001], rtol=1e-12)
    assert np.ma.getmaskarray(image.get_array())[0, 2] or np.isnan(shown[0, 2])
    save_figure(figure, tmp_path / "map.png")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
