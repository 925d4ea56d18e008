"""The thesis' particle swarm (sec. 4.1 to 4.5): particles are motions (psi_s, psi_t, psi_e), drawn to the best seen.

Where the thesis is silent: a particle that leaves the bounds is put back onto them, and its velocity is then what it
really moved (eq. 4.2); first velocities are uniform, up to a tenth of the range either way; in eq. 4.6 each particle
draws new r and s of its own at every iteration (they "represent a particle's adherence"), one number for all three
spins, while W_in is drawn once for the whole swarm.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.thesis.inertia import Inertia, Random, inertia_named
from zerorev.thesis.sampled import Ints, Judged, MotionObjective

__all__ = ["TABLE_3", "TABLE_4", "History", "SwarmResult", "SwarmSettings", "run_swarm"]

SETTLED_SHARE = 0.95  # eq. 4.3: so many particles ...
SETTLED_MOVE = 0.01  # ... moved by less than so much of where they are

Stopped = Literal["iterations", "settled", "zero"]


@dataclass(frozen=True)
class SwarmSettings:
    """Everything that the thesis varies; as it stands, trial 3 of its Table 3, which it settled on (Table 4).

    Attributes:
        particles: N_p.
        iterations: at most; before the first the particles are judged where they begin.
        inertia: W_in: a scheme, or the name of one (`zerorev.thesis.inertia.INERTIA`).
        own_weight: W_PB, the pull of a particle's own best.
        swarm_weight: W_GB, the pull of the best of all.
        bounds: least and greatest spin [rad].
        first_velocity: greatest first move of each spin either way, as a share of the range.
        max_velocity: greatest move of a particle in one iteration [rad]; None: as far as it likes.
        stop_when_settled: stop as soon as at least 95 % of the particles move by less than 1 % of their distance from
            the origin (eq. 4.3).
        stop_at_zero: stop as soon as a motion without reversals is found.
        start: a guess (psi_s, psi_t, psi_e) [rad], where the first particle begins.
        seed: of all that is random.
        keep_history: whether the result holds the whole run.
    """

    particles: int = 100
    iterations: int = 50
    inertia: Inertia | str = "random"
    own_weight: float = 0.2
    swarm_weight: float = 0.1
    bounds: tuple[float, float] = (-np.pi, np.pi)
    first_velocity: float = 0.1
    max_velocity: float | None = None
    stop_when_settled: bool = True
    stop_at_zero: bool = False
    start: tuple[float, float, float] | None = None
    seed: int = 0
    keep_history: bool = False

    def __post_init__(self) -> None:
        """Check kinds and ranges."""
        for name, least in (("particles", 1), ("iterations", 0), ("seed", 0)):
            value = getattr(self, name)
            if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < least:
                raise _refused(name, value, f"a whole number, {least} or more")
        for name in ("own_weight", "swarm_weight", "first_velocity"):
            if not 0 <= getattr(self, name) < np.inf:
                raise _refused(name, getattr(self, name), "0 or more")
        low, high = self.bounds
        if not -np.inf < low < high < np.inf:
            raise _refused("bounds", self.bounds, "the least spin, then a greater one [rad]")
        if self.max_velocity is not None and not self.max_velocity > 0:
            raise _refused("max_velocity", self.max_velocity, "above 0 [rad], or None")
        if self.start is not None and not (len(self.start) == 3 and all(low <= psi <= high for psi in self.start)):
            raise _refused("start", self.start, "three spins within the bounds [rad], or None")
        if isinstance(self.inertia, str):
            inertia_named(self.inertia)

    @property
    def scheme(self) -> Inertia:
        """The inertia scheme."""
        return inertia_named(self.inertia) if isinstance(self.inertia, str) else self.inertia


def _refused(name: str, value: object, accepted: str) -> InputError:
    return InputError(f"{value!r} cannot be used", where=f"swarm, {name}", accepted=accepted)


TABLE_4 = SwarmSettings()
"""The scheme that the thesis settled on: its trial 3."""

TABLE_3 = MappingProxyType(
    {
        1: SwarmSettings(200, 25),
        2: SwarmSettings(200, 25, "decaying"),
        3: TABLE_4,
        # 50 particles as in the table; the text has 25
        4: SwarmSettings(50, 200),
        5: SwarmSettings(100, 50, "growing"),
        6: SwarmSettings(100, 50, own_weight=0.1, swarm_weight=0.2),
        7: SwarmSettings(100, 50, Random(0.1, 0.6), 0.2, 0.4),
        8: SwarmSettings(100, 50, "linear"),
    }
)
"""The thesis' tuning trials by number (Table 3)."""


@dataclass(frozen=True)
class History:
    """A whole run; T iterations after the beginning, P particles.

    Attributes:
        positions: spins [rad], shape (T + 1, P, 3).
        scores: eq. 4.7, shape (T + 1, P).
        reversals: shape (T + 1, P); -1 where a motion cannot be run.
        branches: shape (T + 1, P).
        inertia: W_in of the velocity after each iteration, shape (T,).
    """

    positions: Array
    scores: Array
    reversals: Ints
    branches: Ints
    inertia: Array

    @property
    def best(self) -> Array:
        """The least score so far, shape (T + 1,)."""
        return np.minimum.accumulate(self.scores.min(axis=1))


@dataclass(frozen=True)
class SwarmResult:
    """What a run found.

    Attributes:
        spins: psi_start, psi_target and psi_end of the best motion [rad], shape (3,).
        score: its score.
        branch: its branch.
        reversals: of all its joints, as sampled; -1 where it cannot be run.
        evaluations: motions judged.
        iterations: after the beginning.
        stopped: by which rule.
        last: the particles where they ended, shape (P,) each.
        last_spins: where that is [rad], shape (P, 3).
        own: each particle's own best, shape (P,) each.
        own_spins: where that was [rad], shape (P, 3).
        history: the whole run, where it was asked for.
    """

    spins: Array
    score: float
    branch: int
    reversals: int
    evaluations: int
    iterations: int
    stopped: Stopped
    last: Judged
    last_spins: Array
    own: Judged
    own_spins: Array
    history: History | None


def run_swarm(objective: MotionObjective, settings: SwarmSettings = TABLE_4) -> SwarmResult:
    """One run of the swarm (thesis Fig. 9).

    Args:
        objective: judges motions.
        settings: the swarm's.
    """
    # a stream of its own for the inertia, so that a run of more iterations begins like one of fewer
    rng, of_inertia = np.random.default_rng(settings.seed).spawn(2)
    x, v = _beginning(rng, settings), _first_velocities(rng, settings)
    inertia = settings.scheme.weights(settings.iterations, of_inertia)
    now = objective.judged(x)
    own, own_x, seen = now, x, [(x, now)]
    done = 0
    while True:
        if settings.stop_at_zero and (now.reversals == 0).any():
            stopped: Stopped = "zero"
            break
        if done == settings.iterations:
            stopped = "iterations"
            break
        before, x = x, np.clip(x + v, *settings.bounds)
        v = x - before
        if settings.stop_when_settled and _settled(x, v):
            stopped, x = "settled", before
            break
        now = objective.judged(x)
        better = now.score < own.score
        own = Judged(*(np.where(better, new, old) for new, old in zip(now, own, strict=True)))
        own_x = np.where(better[:, None], x, own_x)
        best_x = own_x[own.score.argmin()]
        r, s = rng.uniform(size=(2, settings.particles, 1))  # eq. 4.6
        v = r * (own_x - x) * settings.own_weight + s * (best_x - x) * settings.swarm_weight + v * inertia[done]
        v = _limited(v, settings.max_velocity)
        done += 1
        if settings.keep_history:
            seen.append((x, now))
    best = int(own.score.argmin())
    score, branch, reversals = (each[best].item() for each in own)
    history = _history(seen, inertia[:done]) if settings.keep_history else None
    return SwarmResult(
        own_x[best],
        score,
        branch,
        reversals,
        settings.particles * (done + 1),
        done,
        stopped,
        now,
        x,
        own,
        own_x,
        history,
    )


def _beginning(rng: np.random.Generator, settings: SwarmSettings) -> Array:
    """Start and target anywhere, the end further round in the same sense (eq. 4.8); shape (P, 3)."""
    low, high = settings.bounds
    start, target = rng.uniform(low, high, (2, settings.particles))
    end = target + rng.uniform(size=settings.particles) * (np.where(target > start, high, low) - target)
    x = np.stack([start, target, end], axis=1)
    if settings.start is not None:
        x[0] = settings.start
    return x


def _first_velocities(rng: np.random.Generator, settings: SwarmSettings) -> Array:
    most = settings.first_velocity * (settings.bounds[1] - settings.bounds[0])
    return _limited(rng.uniform(-most, most, (settings.particles, 3)), settings.max_velocity)


def _limited(v: Array, most: float | None) -> Array:
    """Velocities no longer than `most` [rad], direction kept."""
    if most is None:
        return v
    length = np.linalg.norm(v, axis=1, keepdims=True)
    return np.asarray(v * (most / np.maximum(length, most)))


def _settled(x: Array, v: Array) -> bool:
    """Eq. 4.3."""
    at_rest = np.linalg.norm(v, axis=1) < SETTLED_MOVE * np.linalg.norm(x, axis=1)
    return bool(at_rest.mean() >= SETTLED_SHARE)


def _history(seen: list[tuple[Array, Judged]], inertia: Array) -> History:
    scores, branches, reversals = (np.array(each) for each in zip(*(judged for _, judged in seen), strict=True))
    return History(np.array([x for x, _ in seen]), scores, reversals, branches, inertia)
