"""Sampling of a posterior by independent ensembles of walkers, with the tests that say whether it has converged.

Ensemble sampler: emcee (Foreman-Mackey et al., PASP 125, 306, 2013, doi 10.1086/670067) with differential-evolution
moves, which also jump between separate modes.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.extras import needs

Array = NDArray[np.float64]

ENSEMBLES = 4
PRIOR_DRAWS = 20000
"""Draws of the prior, from which the walkers start by their likelihood: every mode with its share."""
BLOCK = 200
"""Steps between two looks at convergence."""
LARGEST_R_HAT = 1.01
"""Vehtari et al., Bayesian Analysis 16, 667 (2021), doi 10.1214/20-BA1221."""
FEWEST_EFFECTIVE = 400.0
"""Independent draws that every input needs (the same reference)."""


@dataclass(frozen=True)
class Chain:
    """What the ensembles gave.

    Attributes
    ----------
    z : draws, shape (s, n).
    log_likelihood : shape (s,).
    converged, r_hat : largest over the inputs: ensembles and their halves against each other.
    effective : independent draws behind the worst input.
    steps : of each ensemble, after burn-in.
    acceptance, autocorrelation : longest autocorrelation time, in steps.
    reason : why it has not converged, in words; empty if it has.
    """

    z: Array
    log_likelihood: Array
    converged: bool
    r_hat: float
    effective: float
    steps: int
    acceptance: float
    autocorrelation: float
    reason: str


def sample(
    log_likelihood: Callable[[Array], Array],
    dimensions: int,
    walkers: int,
    max_steps: int,
    samples: int,
    seed: int,
    progress: Callable[[float, str], None] | None = None,
) -> Chain:
    """Sample a posterior whose prior is standard normal.

    Parameters
    ----------
    log_likelihood : of points z (m, n), shape (m,).
    walkers : of each of four ensembles.
    max_steps : of each ensemble, after which sampling is given up.
    samples : draws that are returned.
    """
    with needs("calibration"):
        import emcee

    def log_density(z: Array) -> Array:
        value = log_likelihood(z) - 0.5 * (z**2).sum(axis=1)
        return np.where(np.isfinite(value), value, -np.inf)

    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xCA]))
    pool = rng.standard_normal((PRIOR_DRAWS, dimensions))
    weights = np.concatenate([log_likelihood(part) for part in np.array_split(pool, PRIOR_DRAWS // 500)])
    weights = np.where(np.isfinite(weights), weights, -np.inf)
    samplers = []
    for ensemble in range(ENSEMBLES):
        start = pool[_starts(weights, walkers, rng)] + 1e-2 * rng.standard_normal((walkers, dimensions))
        sampler = emcee.EnsembleSampler(
            walkers,
            dimensions,
            log_density,
            moves=[(emcee.moves.DEMove(), 0.6), (emcee.moves.DESnookerMove(), 0.1), (emcee.moves.StretchMove(), 0.3)],
            vectorize=True,
        )
        sampler.random_state = np.random.RandomState([seed, ensemble]).get_state()
        samplers.append((sampler, start))
    done, diagnosis = 0, (np.inf, 0.0, np.inf)
    while done < max_steps:
        done += BLOCK
        samplers = [(sampler, sampler.run_mcmc(start, BLOCK)) for sampler, start in samplers]
        diagnosis = _diagnose([sampler for sampler, _ in samplers], done // 2)
        if progress:
            progress(done / max_steps, f"step {done}, R-hat {diagnosis[0]:.3f}, {diagnosis[1]:.0f} independent draws")
        if diagnosis[0] < LARGEST_R_HAT and diagnosis[1] > FEWEST_EFFECTIVE:
            break
    r_hat, effective, longest = diagnosis
    half = done // 2
    draws = np.concatenate([sampler.get_chain(discard=half, flat=True) for sampler, _ in samplers])
    logs = np.concatenate([sampler.get_log_prob(discard=half, flat=True) for sampler, _ in samplers])
    picks = np.linspace(0, len(draws) - 1, min(samples, len(draws))).astype(int)
    reasons = []
    if not r_hat < LARGEST_R_HAT:
        reasons.append(f"R-hat {r_hat:.3f}, above {LARGEST_R_HAT}")
    if not effective > FEWEST_EFFECTIVE:
        reasons.append(f"{effective:.0f} independent draws, fewer than {FEWEST_EFFECTIVE:.0f}")
    return Chain(
        draws[picks],
        (logs + 0.5 * (draws**2).sum(axis=1))[picks],
        not reasons,
        r_hat,
        effective,
        half,
        float(np.mean([sampler.acceptance_fraction.mean() for sampler, _ in samplers])),
        longest,
        "; ".join(reasons),
    )


def _starts(log_weights: Array, count: int, rng: np.random.Generator) -> NDArray[np.int_]:
    """Draws of the prior where walkers start, by a likelihood tempered until enough of them differ."""
    temper = 1.0
    while True:
        weights = np.exp(temper * (log_weights - log_weights.max()))
        weights /= weights.sum()
        if 1 / (weights**2).sum() > 4 * count or temper < 1e-6:
            break
        temper *= 0.7
    replace = int((weights > 0).sum()) < count
    return rng.choice(len(weights), size=count, replace=replace, p=weights)


def _diagnose(samplers: list, discard: int) -> tuple[float, float, float]:
    """Largest R-hat, fewest independent draws, longest autocorrelation time over the inputs."""
    chains = [sampler.get_chain(discard=discard) for sampler in samplers]  # (steps, walkers, n) each
    halves = [part for chain in chains for part in np.array_split(chain, 2)]
    means = np.array([part.mean(axis=(0, 1)) for part in halves])
    within = np.array([part.var(axis=(0, 1)) for part in halves]).mean(axis=0)
    # nested R-hat: an ensemble's walkers are one chain of many draws (Margossian et al., arXiv 2110.13017)
    r_hat = float(np.sqrt(1 + means.var(axis=0, ddof=1) / within).max())
    from emcee.autocorr import integrated_time

    times = np.array([integrated_time(chain, quiet=True, tol=0) for chain in chains])
    worst = np.nanmax(times, axis=1)
    effective = sum(chain.shape[0] * chain.shape[1] / time for chain, time in zip(chains, worst, strict=True))
    return r_hat, float(effective), float(worst.max())
