"""Where a study does its work: one setup, one seed, both results, and what they cost.

What is timed is tracing, with the pilot that aims it, and the photon map and the gather, or the
binning, in CPU-seconds of the whole process over all threads. Compiling, surveying the view and
reading results out are not.

Pictures are exposed on some of their rows alone, spread evenly over the height, each at full
resolution; the gather's cost is multiplied by the ratio of rows, so that it is that of the whole
picture.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

import scenes
from sim.device import start_device
from sim.image.camera import compile_camera
from sim.image.film import Film, create_film, expose, turns_of
from sim.image.gather_radius import GatherRadius, choose_gather_radius
from sim.image.sight import compose_lights
from sim.image.survey import Survey, survey_view
from sim.launch import load_kernels
from sim.method import Method
from sim.photons.energy import EnergyBooks
from sim.photons.lamps import Lamps
from sim.photons.photon_batch import PhotonBatch
from sim.photons.photon_maps import build_photon_maps
from sim.photons.receivers import compile_receivers
from sim.photons.tracing import trace_photons
from sim.render import compile_lamps_for, kernels_of
from sim.scene_data import CompiledScene, compile_scene
from sim.study.caustic_mesh import Resolution, trace_caustic_mesh
from sim.study.glass_chain import ChainPhotons, GlassChain, bin_chain, select_chain
from sim.study.receiver_gather import gather_bins, make_gather_bins
from sim.study.sample import Costs, Sample
from sim.study.setup import ResultKind, Setup
from spectra.observer import observer

__all__ = ["Workshop"]

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Bench:
    """A compiled scene with its camera."""

    scene: scenes.Scene
    compiled: CompiledScene
    camera: Any
    survey: Survey


class Workshop:
    """Runs setups of one scene; keeps what they share."""

    def __init__(self, *, threads: int, rows: int = 1 << 30) -> None:
        """Start.

        Args:
            threads: CPU threads.
            rows: at most so many rows of a picture are exposed.
        """
        self.threads = threads
        self.rows = rows
        self.chain: GlassChain | None = None
        self.target: str | None = None
        self.mesh_nodes = (4, 4)
        self._device = start_device("cpu")
        self._benches: dict[tuple[int, str, str, Method], _Bench] = {}
        self._films: dict[tuple[int, int], Film] = {}

    def bench(self, setup: Setup) -> _Bench:
        """The compiled scene of a setup."""
        precision = str(setup.settings.precision)
        polarisation = setup.settings.polarisation
        key = (id(setup.scene), precision, polarisation, setup.method)
        if key not in self._benches:
            scene = setup.scene
            compiled = compile_scene(
                scene, precision=precision, device=self._device, method=setup.method,
                polarisation=polarisation,
            )
            assert scene.camera is not None  # the study has asked for a scene with one
            camera = compile_camera(compiled, scene.camera, scene.film)
            middle_nm = float(0.5 * (scene.film.edges_nm[0] + scene.film.edges_nm[-1]))
            survey = survey_view(compiled, camera, middle_nm)
            self._benches[key] = _Bench(scene, compiled, camera, survey)
        return self._benches[key]

    def load(self, setups: Iterable[Setup]) -> None:
        """Compile all kernels that the setups need, on every core."""
        kernels: dict[int, Any] = {}
        for setup in setups:
            precision = str(setup.settings.precision)
            features = compile_scene(
                setup.scene, precision=precision, device=self._device, method=setup.method,
                polarisation=setup.settings.polarisation,
            ).features
            needed = kernels_of(precision, features)
            if setup.estimator == "gather":
                needed.append(make_gather_bins(precision, features))
            kernels.update((id(kernel), kernel) for kernel in needed)
        load_kernels(list(kernels.values()), device=self._device, threads=self.threads)

    def radius(self, setup: Setup) -> GatherRadius:
        """The setup's gather radius, pixel by pixel.

        Raises:
            SettingsError: no pixel sees a diffuse surface to measure the radius on.
        """
        bench = self.bench(setup)
        return choose_gather_radius(bench.compiled, bench.survey, setup.scene.film, setup.settings)

    def lamps(self, setup: Setup, seed: int) -> Lamps:
        """The lamps of one run: as a rendering makes them, with a pilot of its own."""
        bench = self.bench(setup)
        plan = replace(setup.settings, seed=seed, threads=self.threads)
        return compile_lamps_for(bench.compiled, bench.survey, plan)

    def trace(self, setup: Setup, lamps: Lamps, seed: int, pass_index: int) -> PhotonBatch:
        """One pass of photons."""
        return trace_photons(
            self.bench(setup).compiled,
            lamps,
            seed=seed,
            pass_index=pass_index,
            max_interactions=int(setup.settings.max_interactions or 1),
            threads=self.threads,
            store_direct=setup.settings.direct_light == "photons",
            bounces=int(setup.settings.bounces or 0),
        )

    def exposed_rows(self, film: scenes.Film) -> npt.NDArray[np.int64]:
        """Which rows of a picture are exposed: evenly spread."""
        count = min(self.rows, film.height)
        rows: npt.NDArray[np.int64] = ((np.arange(count) + 0.5) * film.height / count).astype(int)
        return rows

    def run(
        self,
        setup: Setup,
        seed: int,
        results: Iterable[ResultKind],
        *,
        camera_seed: int | None = None,
    ) -> Sample:
        """One replicate of a setup.

        Args:
            setup: what to run.
            seed: of all its random numbers.
            results: what is asked for.
            camera_seed: of the camera's random numbers, if it is to be another.
        """
        if setup.estimator == "mesh":
            return self._run_mesh(setup, seed)
        run = _Run(self, setup, seed, tuple(results))
        run.camera_seed = seed if camera_seed is None else camera_seed
        for pass_index in range(int(setup.settings.passes or 1)):
            run.add_pass(pass_index)
        return run.sample()

    def film(self, setup: Setup) -> Film:
        """An unexposed film of the setup's size; one is used again and again."""
        film, lamps = setup.scene.film, len(setup.scene.emitters)
        passes = int(setup.settings.passes or 1)
        key = (film.bands, lamps)
        if key not in self._films:
            edges = np.asarray(film.edges_nm)
            size = np.ones((film.height, film.width), dtype=np.float32)
            self._films[key] = create_film(
                edges, lamps, self._device, radius_scale=size, passes=passes
            )
        used = self._films[key]
        used.data.radius_scale.assign(self.radius(setup).scale.ravel())
        used.data.mean.zero_()
        used.data.tally.zero_()
        return replace(used, turns=turns_of(passes), passes=0)

    def _run_mesh(self, setup: Setup, seed: int) -> Sample:
        """The bins by a caustic mesh, with the error that it states of itself."""
        chain, costs = self.chain, Costs()
        assert chain is not None and self.target is not None
        wavelengths, lamp_points = self.mesh_nodes
        with costs.timing("trace"):
            mesh = trace_caustic_mesh(
                self.bench(setup).compiled, chain.bins, emitter=chain.emitter, target=self.target,
                edges_nm=chain.edges_nm, branches=("refract",) * chain.refractions,
                resolution=Resolution(
                    cells=setup.mesh_cells, wavelengths=wavelengths, lamp_points=lamp_points
                ),
            )
        return Sample(
            seed, mesh.irradiance, None, None, None, costs, stated_error=mesh.relative_error
        )


class _Run:
    """One replicate as it grows, pass by pass."""

    def __init__(
        self, workshop: Workshop, setup: Setup, seed: int, results: tuple[ResultKind, ...]
    ) -> None:
        self.workshop, self.setup = workshop, setup
        self.seed = self.camera_seed = seed
        self.chain = workshop.chain if "bins" in results else None
        self.bench = workshop.bench(setup)
        self.radius = workshop.radius(setup)
        self.costs = Costs()
        with self.costs.timing("trace"):
            self.lamps = workshop.lamps(setup, seed)
        self.books: list[EnergyBooks] = []
        self.binned: list[FloatArray] = []
        self.film = workshop.film(setup) if "picture" in results else None
        self.rows = workshop.exposed_rows(setup.scene.film)
        edges = np.asarray(setup.scene.film.edges_nm)
        if self.chain is not None and setup.estimator == "gather":
            edges = self.chain.edges_nm
        self.receivers = compile_receivers(self.bench.compiled, self.lamps, edges)

    def add_pass(self, pass_index: int) -> None:
        """Trace a pass, and add it to both results."""
        with self.costs.timing("trace"):
            batch = self.workshop.trace(self.setup, self.lamps, self.seed, pass_index)
        self.books.append(batch.books)
        if self.chain is not None:
            with self.costs.timing("bin"):
                self.binned.append(self._bin(batch, self.chain, pass_index))
        if self.film is not None:
            self._expose(batch, self.film, pass_index)

    def _bin(self, batch: PhotonBatch, chain: GlassChain, pass_index: int) -> FloatArray:
        """The pass's irradiance in the chain's bins."""
        photons = select_chain(batch, chain)
        if self.setup.estimator == "bins":
            return bin_chain(photons, chain)
        lights = self._lights(_only(batch, photons), pass_index, direct=False)
        return gather_bins(
            self.bench.compiled, lights, chain, seed=self.seed + pass_index,
            threads=self.workshop.threads,
        )

    def _lights(self, batch: PhotonBatch, pass_index: int, *, direct: bool) -> Any:
        """What gathers see of a batch."""
        settings = self.setup.settings
        self.maps = build_photon_maps(
            self.bench.compiled, batch, self.receivers,
            self.radius.of_pass(pass_index, float(settings.alpha)),
            seed=self.seed, pass_index=pass_index, threads=self.workshop.threads,
        )
        return compose_lights(
            str(settings.precision), self.maps, self.receivers, self.lamps, direct=direct
        )

    def _expose(self, batch: PhotonBatch, film: Film, pass_index: int) -> None:
        """Expose the picture's rows to the pass."""
        with self.costs.timing("map"):
            direct = self.setup.settings.direct_light == "lamps"
            lights = self._lights(batch, pass_index, direct=direct)
        with self.costs.timing("gather", times=film.height / len(self.rows)):
            expose(
                film, self.bench.compiled, self.bench.camera, lights, seed=self.camera_seed,
                pass_index=pass_index, threads=self.workshop.threads,
                pixels=[(int(row) * film.width, film.width) for row in self.rows],
            )

    def sample(self) -> Sample:
        """The replicate, once all passes are in."""
        xyz = bias = None
        if self.film is not None:
            radiance = self.film.radiance()[self.rows]
            eye = observer(self.setup.scene.film.observer)
            xyz = eye.xyz(radiance, np.asarray(self.setup.scene.film.edges_nm))
            bias = self.film.accuracy().bias[self.rows]
        irradiance = np.mean(self.binned, axis=0) if self.binned else None
        books = EnergyBooks.mean(self.books)
        return Sample(self.seed, irradiance, xyz, bias, books, self.costs)


def _only(batch: PhotonBatch, photons: ChainPhotons) -> PhotonBatch:
    """A batch of nothing but these photons."""
    return replace(batch, slots=photons.slots)
