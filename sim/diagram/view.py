"""From which side a ray diagram is seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["NAMED_VIEWS", "View", "choose_view"]

_X, _Y, _Z = np.eye(3)

# A plane along the axes is preferred if it hides little more of the paths than the best plane:
# this share of the hidden variance, and this share of all.
_PREFERENCE = 1.1
_TOLERANCE = 1e-3
_NEARLY_VERTICAL = 0.95


@dataclass(frozen=True, eq=False)
class View:
    """An orthographic view.

    Attributes:
        right: Unit vector (3,) that points right in the picture.
        up: Unit vector (3,) that points up in it.
        labels: What to write along the two.
    """

    right: NDArray[np.float64]
    up: NDArray[np.float64]
    labels: tuple[str, str]

    @property
    def toward_viewer(self) -> NDArray[np.float64]:
        """Unit vector (3,) out of the picture."""
        return np.cross(self.right, self.up)

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (…, 3) as they are seen, (…, 2): right and up [m]."""
        return points @ np.stack([self.right, self.up], axis=-1)


NAMED_VIEWS: Final = {
    "xy": View(_X, _Y, ("x", "y")),
    "xz": View(_X, -_Z, ("x", "−z")),
    "yz": View(_Z, _Y, ("z", "y")),  # As optical benches are drawn: light goes right.
}


def choose_view(points: NDArray[np.float64]) -> View:
    """The view that shows most of the paths: along their direction of least spread.

    Args:
        points: Vertices of the paths, shape (n, 3) [m].

    Returns:
        A named view, if one shows nearly as much as the best (principal components: Jolliffe
        2002, Principal Component Analysis, §1.1); otherwise the best, with world y up, or -z
        where one looks along y.
    """
    if len(points) == 0:
        return NAMED_VIEWS["xy"]
    covariance = np.atleast_2d(np.cov(points, rowvar=False, bias=True))
    variances, axes = np.linalg.eigh(covariance)
    limit = variances[0] * _PREFERENCE + variances.sum() * _TOLERANCE
    hidden = {
        name: float(view.toward_viewer @ covariance @ view.toward_viewer)
        for name, view in NAMED_VIEWS.items()
    }
    best = min(hidden, key=hidden.__getitem__)
    return NAMED_VIEWS[best] if hidden[best] <= limit else _view_along(axes[:, 0])


def _view_along(normal: NDArray[np.float64]) -> View:
    """A view along `normal`, from the side of +z (or +y, or +x, if it has more of that)."""
    toward_viewer = normal * np.sign(normal[np.argmax(np.abs(normal))])
    wanted_up = -_Z if abs(toward_viewer[1]) > _NEARLY_VERTICAL else _Y
    right = np.cross(wanted_up, toward_viewer)
    right /= np.linalg.norm(right)
    return View(right, np.cross(toward_viewer, right), ("across", "up"))
