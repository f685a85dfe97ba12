"""Sampling of a posterior by independent ensembles of walkers, and whether they have converged.

Ensemble sampler: emcee (Foreman-Mackey et al., PASP 125, 306, 2013, doi 10.1086/670067). Most moves
take a share of the difference of two walkers, which follows ridges; the whole difference jumps
between separate modes (differential evolution: ter Braak, Stat. Comput. 16, 239, 2006, doi
10.1007/s11222-006-8769-1).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.extras import needs

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sampling:
    """Numbers of the sampler.

    Attributes
    ----------
    walkers : of each ensemble.
    prior_draws : draws of the prior, from which the walkers start by their likelihood: every mode
        with its share.
    block : steps between two looks at convergence.
    max_steps : of each ensemble, after which sampling is given up.
    largest_r_hat, fewest_effective : limits of Vehtari et al., Bayesian Analysis 16, 667, 2021, doi
        10.1214/20-BA1221.
    samples : draws that are kept.
    """

    ensembles: int = 4
    walkers: int = 32
    prior_draws: int = 5000
    block: int = 200
    max_steps: int = 10_000
    largest_r_hat: float = 1.01
    fewest_effective: float = 400.0
    samples: int = 4000
    seed: int = 1


@dataclass(frozen=True)
class Chain:
    """What the ensembles gave.

    Attributes
    ----------
    z : draws, shape (s, n).
    log_likelihood : shape (s,).
    r_hat : largest over the inputs and the density, halves of ensembles against each other.
    effective : independent draws of the worst of them.
    steps : of each ensemble, after burn-in.
    reason : why it has not converged, in words; empty if it has.
    """

    z: Array
    log_likelihood: Array
    r_hat: float
    effective: float
    steps: int
    reason: str

    @property
    def converged(self) -> bool:
        """Whether the draws are those of the posterior."""
        return not self.reason

    @property
    def reasons(self) -> list[str]:
        """Why there is no posterior."""
        if self.converged:
            return []
        return [f"the chain has not converged: {self.reason}"]


def sample(
    log_likelihood: Callable[[Array], Array],
    dimensions: int,
    settings: Sampling | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> Chain:
    """Sample a posterior whose prior is standard normal.

    Parameters
    ----------
    log_likelihood : of points z (m, n), shape (m,).
    """
    with needs("calibration"):
        import emcee

    def log_density(z: Array) -> Array:
        value = log_likelihood(z) - 0.5 * (z**2).sum(axis=1)
        return np.where(np.isfinite(value), value, -np.inf)

    numbers = settings or Sampling()
    rng = np.random.default_rng(np.random.SeedSequence([numbers.seed, 0xCA]))
    pool = rng.standard_normal((numbers.prior_draws, dimensions))
    batches = np.array_split(pool, numbers.prior_draws // 500)
    weights = np.concatenate([log_likelihood(points) for points in batches])
    weights = np.where(np.isfinite(weights), weights, -np.inf)
    walkers = max(numbers.walkers, 4 * dimensions)
    samplers = []
    states = []
    for ensemble in range(numbers.ensembles):
        moves = [
            (emcee.moves.DEMove(), 0.3),
            (emcee.moves.DEMove(gamma0=0.2), 0.4),
            (emcee.moves.DEMove(gamma0=1), 0.2),
            (emcee.moves.StretchMove(), 0.1),
        ]
        sampler = emcee.EnsembleSampler(
            walkers, dimensions, log_density, moves=moves, vectorize=True
        )
        sampler.random_state = np.random.RandomState([numbers.seed, ensemble]).get_state()
        samplers.append(sampler)
        start = pool[_starts(weights, walkers, rng)]
        states.append(start + 1e-2 * rng.standard_normal(start.shape))
    r_hat = np.inf
    effective = 0.0
    done = 0
    while done < numbers.max_steps and not (
        r_hat < numbers.largest_r_hat and effective > numbers.fewest_effective
    ):
        states = [
            sampler.run_mcmc(state, numbers.block)
            for sampler, state in zip(samplers, states, strict=True)
        ]
        done += numbers.block
        # the density beside the inputs: walkers that still fall onto a ridge do not show in those
        chains = []
        for sampler in samplers:
            inputs = sampler.get_chain(discard=done // 2)
            chains.append(np.dstack([inputs, sampler.get_log_prob(discard=done // 2)]))
        r_hat, effective = diagnose(np.stack(chains))
        if progress:
            share = done / numbers.max_steps
            progress(share, f"step {done}, R-hat {r_hat:.3f}, {effective:.0f} independent draws")
    draws = np.concatenate(
        [sampler.get_chain(discard=done // 2, flat=True) for sampler in samplers]
    )
    logs = np.concatenate(
        [sampler.get_log_prob(discard=done // 2, flat=True) for sampler in samplers]
    )
    # at random: an even stride would follow the same few walkers
    picks = rng.choice(len(draws), min(numbers.samples, len(draws)), replace=False)
    reasons = []
    if not r_hat < numbers.largest_r_hat:
        reasons.append(f"R-hat {r_hat:.3f}, above {numbers.largest_r_hat}")
    if not effective > numbers.fewest_effective:
        reasons.append(
            f"{effective:.0f} independent draws, fewer than {numbers.fewest_effective:.0f}"
        )
    log_likelihoods = (logs + 0.5 * (draws**2).sum(axis=1))[picks]
    return Chain(
        draws[picks], log_likelihoods, r_hat, effective, done - done // 2, "; ".join(reasons)
    )


def _starts(log_weights: Array, count: int, rng: np.random.Generator) -> NDArray[np.int_]:
    """Draws of the prior where walkers start, tempered until enough of them differ."""
    temper = 1.0
    while True:
        weights = np.exp(temper * (log_weights - log_weights.max()))
        weights /= weights.sum()
        if 1 / (weights**2).sum() > 4 * count or temper < 1e-6:
            break
        temper *= 0.7
    replace = int((weights > 0).sum()) < count
    return rng.choice(len(weights), size=count, replace=replace, p=weights)


def diagnose(chains: Array) -> tuple[float, float]:
    """Largest R-hat and fewest independent draws over the inputs.

    Walkers of an ensemble move by each other, so an ensemble is one chain: R-hat is that of the
    means of its halves (nested R-hat: Margossian et al., arXiv 2110.13017). Ranks keep a few far
    draws from hiding the others (Vehtari et al.).

    Parameters
    ----------
    chains : shape (ensembles, steps, walkers, n).
    """
    from emcee.autocorr import integrated_time
    from scipy.stats import rankdata  # slow to import

    half = chains.shape[1] // 2
    ranks = rankdata(chains.reshape(-1, chains.shape[-1]), axis=0)
    chains = ranks.reshape(chains.shape)
    variance = chains.var(axis=(0, 1, 2))
    first_means = chains[:, :half].mean(axis=(1, 2))
    second_means = chains[:, half:].mean(axis=(1, 2))
    means = np.concatenate([first_means, second_means])
    r_hat = np.sqrt(1 + means.var(axis=0, ddof=1) / variance)
    # the series whose autocorrelation counts is the ensemble's mean (Goodman and Weare, Comm. App.
    # Math. Comp. Sci. 5, 65, 2010, doi 10.2140/camcos.2010.5.65)
    series = chains.mean(axis=2)
    times = [integrated_time(mean[:, None], tol=0, quiet=True) for mean in series]
    of_means = series.var(axis=(0, 1))
    effective = variance / of_means * series.shape[0] * series.shape[1] / np.mean(times, axis=0)
    return float(r_hat.max()), float(effective.min())
