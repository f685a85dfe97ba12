"""Sampling of a posterior by independent ensembles of walkers, with the tests that say whether it has converged.

Ensemble sampler: emcee (Foreman-Mackey et al., PASP 125, 306, 2013, doi 10.1086/670067). Three in ten moves are
by a normal distribution fitted to the ensemble's past. Of the others, a fifth of the difference of two walkers follows
curved ridges, and the whole difference jumps between separate modes (differential evolution: ter Braak, Stat. Comput.
16, 239, 2006, doi 10.1007/s11222-006-8769-1).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import rankdata

from mesoscale.extras import needs

Array = NDArray[np.float64]

ENSEMBLES = 4
PRIOR_DRAWS = 20000
"""Draws of the prior, from which the walkers start by their likelihood: every mode with its share."""
BLOCK = 200
"""Steps between two looks at convergence."""
LARGEST_R_HAT = 1.01
"""Of bulk and tails (Vehtari et al., Bayesian Analysis 16, 667, 2021, doi 10.1214/20-BA1221)."""
FEWEST_EFFECTIVE = 400.0
"""Independent draws that bulk and tails of every input need (the same reference)."""
TAILS = (0.05, 0.95)
FITTED_PER_INPUT = 20
"""Draws behind the first normal proposal."""
SMALLEST_VARIANCE = 1e-14
WALKERS = 32
"""Of each ensemble."""
MAX_STEPS = 4000
"""Of each ensemble, after which sampling is given up; a posterior of twenty curves takes 200 to 400."""
SAMPLES = 4000
"""Draws that are kept."""
SEED = 1


class NormalProposal:
    """Proposals reversible with respect to a normal distribution that is fitted to draws; called by emcee.

    Towards the mean and away from it by a random share (Rudolf and Sprungk, Found. Comput. Math. 18, 309, 2018,
    doi 10.1007/s10208-016-9340-x), half of them to an independent draw, so that a posterior that is nearly normal takes
    few steps. Fitting it to the chain's own past keeps the limit (Haario et al., Bernoulli 7, 223, 2001).
    """

    def __init__(self, draws: Array) -> None:
        self.fit(draws)

    def fit(self, draws: Array) -> None:
        """Take mean and covariance of draws, shape (s, n)."""
        size = draws.shape[1]
        self.mean = draws.mean(axis=0)
        covariance = np.cov(draws, rowvar=False).reshape(size, size)
        self.root = np.linalg.cholesky(covariance + SMALLEST_VARIANCE * np.eye(size))

    def __call__(self, x: Array, random: np.random.RandomState) -> tuple[Array, Array]:
        """New points for x (m, n), and the logarithm of the ratio of the normal densities, old to new."""
        share = np.where(random.rand(len(x), 1) < 0.5, 1.0, random.rand(len(x), 1))
        off = np.linalg.solve(self.root, (x - self.mean).T).T
        new = np.sqrt(1 - share**2) * off + share * random.randn(*x.shape)
        return self.mean + new @ self.root.T, 0.5 * ((new**2).sum(axis=1) - (off**2).sum(axis=1))


@dataclass(frozen=True)
class Chain:
    """What the ensembles gave.

    Attributes
    ----------
    z : draws, shape (s, n).
    log_likelihood : shape (s,).
    converged, r_hat : largest over the inputs, bulk and tails: halves of ensembles against each other.
    effective : independent draws behind the worst of them.
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


def started(
    log_likelihood: Callable[[Array], Array], dimensions: int, walkers: int, seed: int
) -> list[tuple[Any, Any, NormalProposal]]:
    """Samplers of emcee with the state from which each goes on and its proposal; see `sample` for the parameters."""
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
        proposal = NormalProposal(pool[_starts(weights, FITTED_PER_INPUT * dimensions, rng)])
        start = pool[_starts(weights, walkers, rng)] + 1e-2 * rng.standard_normal((walkers, dimensions))
        sampler = emcee.EnsembleSampler(
            walkers,
            dimensions,
            log_density,
            moves=[
                (emcee.moves.MHMove(proposal), 0.3),
                (emcee.moves.DEMove(), 0.2),
                (emcee.moves.DEMove(gamma0=0.2), 0.3),
                (emcee.moves.DEMove(gamma0=1.0), 0.1),
                (emcee.moves.StretchMove(), 0.1),
            ],
            vectorize=True,
        )
        sampler.random_state = np.random.RandomState([seed, ensemble]).get_state()
        samplers.append((sampler, start, proposal))
    return samplers


def advanced(samplers: list[tuple[Any, Any, NormalProposal]], steps: int) -> list[tuple[Any, Any, NormalProposal]]:
    """The same samplers after further steps, with proposals fitted to the second half of all steps."""
    samplers = [(sampler, sampler.run_mcmc(state, steps), proposal) for sampler, state, proposal in samplers]
    for sampler, _, proposal in samplers:
        proposal.fit(sampler.get_chain(discard=sampler.iteration // 2, flat=True))
    return samplers


def sample(
    log_likelihood: Callable[[Array], Array],
    dimensions: int,
    walkers: int = WALKERS,
    max_steps: int = MAX_STEPS,
    samples: int = SAMPLES,
    seed: int = SEED,
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
    samplers = started(log_likelihood, dimensions, walkers, seed)
    done, diagnosis = 0, (np.inf, 0.0, np.inf)
    while done < max_steps:
        done += BLOCK
        samplers = advanced(samplers, BLOCK)
        diagnosis = diagnose(np.stack([sampler.get_chain(discard=done // 2) for sampler, *_ in samplers]))
        if progress:
            progress(done / max_steps, f"step {done}, R-hat {diagnosis[0]:.3f}, {diagnosis[1]:.0f} independent draws")
        if diagnosis[0] < LARGEST_R_HAT and diagnosis[1] > FEWEST_EFFECTIVE:
            break
    r_hat, effective, longest = diagnosis
    half = done // 2
    draws = np.concatenate([sampler.get_chain(discard=half, flat=True) for sampler, *_ in samplers])
    logs = np.concatenate([sampler.get_log_prob(discard=half, flat=True) for sampler, *_ in samplers])
    # at random: an even stride would follow the same few walkers
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xCC]))
    picks = rng.choice(len(draws), min(samples, len(draws)), replace=False)
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
        float(np.mean([sampler.acceptance_fraction.mean() for sampler, *_ in samplers])),
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


def diagnose(chains: Array) -> tuple[float, float, float]:
    """Largest R-hat, fewest independent draws, longest autocorrelation time over the inputs.

    The bulk of an input is seen by its rank-normalised values, its tails by whether they lie below a quantile (Vehtari
    et al., section 4). Walkers of an ensemble move by each other, so the series whose autocorrelation counts is the
    mean over the ensemble (Goodman and Weare, Comm. App. Math. Comp. Sci. 5, 65, 2010, doi 10.2140/camcos.2010.5.65).

    Parameters
    ----------
    chains : shape (ensembles, steps, walkers, n).
    """
    size, half = chains[..., 0].size, chains.shape[1] // 2
    r_hat, effective, longest = 1.0, np.inf, 0.0
    for values in np.moveaxis(chains, -1, 0):
        ranks = rankdata(values).reshape(values.shape)
        bulk = ndtri((ranks - 0.375) / (size + 0.25))
        for seen in (bulk, *(1.0 * (ranks < share * size) for share in TAILS)):
            means = seen.mean(axis=2)
            series = np.concatenate([means[:, :half], means[:, -half:]])
            variance = seen.var()
            # nested R-hat: an ensemble's walkers are one chain of many draws (Margossian et al., arXiv 2110.13017)
            r_hat = max(r_hat, float(np.sqrt(1 + series.mean(axis=1).var(ddof=1) / variance)))
            time, of_means = autocorrelation(series)
            effective = min(effective, float(variance / of_means * series.size / time))
            longest = max(longest, time)
    return r_hat, effective, longest


def autocorrelation(series: Array) -> tuple[float, float]:
    """Integrated autocorrelation time of several series (m, t) of one process, in steps, and its variance.

    Autocovariances within the series and the variance between them, summed over Geyer's initial monotone sequence of
    pairs (Vehtari et al., section 3.2).
    """
    count, steps = series.shape
    power = np.abs(np.fft.rfft(series - series.mean(axis=1, keepdims=True), n=2 * steps)) ** 2
    covariance = np.fft.irfft(power)[:, :steps].mean(axis=0) / steps
    variance = covariance[0] + series.mean(axis=1).var(ddof=1)
    correlation = 1 - (covariance[0] * steps / (steps - 1) - covariance) / variance
    correlation[0] = 1.0
    pairs = correlation[: steps // 2 * 2].reshape(-1, 2).sum(axis=1)
    pairs = np.minimum.accumulate(pairs)
    time = 2 * float(pairs[pairs > 0].sum()) - 1
    return max(time, 1 / np.log10(count * steps)), variance  # that of alternating series is bounded (the same section)
