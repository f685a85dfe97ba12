"""Likelihood of what was measured on surfaces: curves, contact-begin separations, pull-off forces.

Every specimen has observables f = response(inputs) + model error (one for all specimens) + its own
scatter, all normal, and data with known normal errors, linearised where they lie: exp(-f A f / 2 +
b f). So all but the inputs is integrated exactly (Rasmussen and Williams, Gaussian Processes for
Machine Learning, 2006, appendix A). How points lie about their curve tells nothing of the inputs
and is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.measurements import Measurements, by_specimen
from mesoscale.calibration.observables import (
    CURVES,
    LEVELS,
    SCALARS,
    Cycles,
    curve_names,
    force_levels_nN,
)
from mesoscale.calibration.responses import Prediction, Responses, fit_responses
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable

Array = NDArray[np.float64]
Part = tuple[Array, Array, Array, Array]

KINDS = (*CURVES, *SCALARS)
"""Kinds that name, or may name, the specimen; the same name means the same surface."""
MOST_STEPS = 30  # towards the place where data are linearised
SETTLED = 1e-3  # last step, in standard deviations of the prior; beyond, it has not settled


@dataclass(frozen=True)
class SurfaceData:
    """All data measured on surfaces.

    Attributes
    ----------
    responses : of the observables that the data see, k of them.
    specimens : their names, s of them.
    precision : A of each specimen, shape (s, k, k).
    information : b of each, shape (s, k).
    model_error : covariance of the model's own error, of curves in their separations, shape (k, k).
    left_out : points of curves outside the range of forces of the responses.
    """

    responses: Responses
    specimens: tuple[str, ...]
    precision: Array
    information: Array
    model_error: Array
    left_out: int

    def log_likelihood(self, x: Array) -> Array:
        """Logarithm of the likelihood at inputs x (m, n), shape (m,)."""
        prediction = self.responses(x)
        mean = prediction.mean[:, None, :, None]
        eye = np.eye(len(self.responses.names))
        scatter = prediction.scatter[:, None]
        common = self._common(prediction)
        precision = self.precision
        information = self.information[..., None]
        off = information - precision @ mean  # (m, s, k, 1)
        spread = eye + precision @ scatter
        columns = [off, np.broadcast_to(precision, spread.shape)]
        solved = np.linalg.solve(spread, np.concatenate(columns, axis=-1))
        pulled = solved[..., :1]
        known = solved[..., 1:].sum(axis=1)
        of_specimens = _inner(mean, information + off) + _inner(off, scatter @ pulled)
        result = of_specimens - np.linalg.slogdet(spread)[1]
        total = pulled.sum(axis=1)
        shared = eye + known @ common
        of_all = _inner(total, common @ np.linalg.solve(shared, total))
        last = of_all - np.linalg.slogdet(shared)[1]
        return 0.5 * (result.sum(axis=1) + last - self._constant)

    @cached_property
    def _constant(self) -> float:
        """What the logarithms share: that of data on the response, whatever the inputs."""
        inverse, _ = _pseudo_inverse(self.precision)
        return float(np.einsum("sj,sjk,sk->", self.information, inverse, self.information))

    def _common(self, prediction: Prediction) -> Array:
        """Covariance (m, k, k) that specimens share: error of model and responses."""
        common = prediction.error[:, None, None] * prediction.scatter
        if self.model_error.any():
            to_own = np.linalg.inv(_separations(self.responses.names, prediction.mean)[1])
            common = common + to_own @ self.model_error @ np.swapaxes(to_own, 1, 2)
        return common

    def simulated(self, x: Array, rng: np.random.Generator) -> "SurfaceData":
        """Data of the same specimens with the same errors, drawn at inputs x (1, n)."""
        prediction = self.responses(x)
        zero = np.zeros(len(self.responses.names))
        shared = rng.multivariate_normal(zero, self._common(prediction)[0], method="svd")
        single = rng.multivariate_normal(
            zero, prediction.scatter[0], len(self.specimens), method="svd"
        )
        noise = np.stack(
            [rng.multivariate_normal(zero, precision, method="svd") for precision in self.precision]
        )
        f = prediction.mean[0] + shared + single
        return replace(self, information=np.einsum("sjk,sk->sj", self.precision, f) + noise)

    def misfits(self, mean: Array, covariance: Array) -> Array:
        """Probability of specimens as far from this mean (k,) and covariance (k, k)."""
        from scipy.stats import chi2  # slow to import

        off = self.information - self.precision @ mean
        inverse, ranks = _pseudo_inverse(
            self.precision @ covariance @ self.precision + self.precision
        )
        return chi2.sf(np.einsum("sj,sjk,sk->s", off, inverse, off), ranks)

    def outliers(self, x: Array) -> list[str]:
        """Specimens that inputs x (m, n) of the posterior cannot explain, in words."""
        prediction = self.responses(x)
        covariances = prediction.scatter + self._common(prediction)
        normals = zip(prediction.mean, covariances, strict=True)
        shares = np.mean([self.misfits(*normal) for normal in normals], axis=0)
        lonely = []
        for name, share in zip(self.specimens, shares, strict=True):
            if share < 0.01 / len(shares):
                lonely.append(
                    f"specimen {name} lies far from the others (probability {share:.1g}); its data"
                    " are used as they are"
                )
        return lonely


def _inner(first: Array, second: Array) -> Array:
    """Inner products of columns (..., k, 1)."""
    return (first * second).sum(axis=(-2, -1))


def _pseudo_inverse(matrices: Array) -> tuple[Array, Array]:
    """Pseudo-inverses and ranks of covariances (s, k, k), whatever the units of their rows."""
    diagonal = np.einsum("skk->sk", matrices)
    unit = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    # smaller eigenvalues are rounding
    units = unit[:, :, None] * unit[:, None, :]
    smallest = 1e-9
    inverse = np.linalg.pinv(matrices / units, rcond=smallest, hermitian=True) / units
    return inverse, np.linalg.matrix_rank(matrices / units, tol=smallest, hermitian=True)


def surface_data(
    tables: Sequence[Measurements], cycles: Cycles, prior: InputTable, max_force_nN: float
) -> SurfaceData | None:
    """Data of all tables that were measured on surfaces; None without any.

    Parameters
    ----------
    max_force_nN : largest repulsion of the cycles (`ContactSettings.max_force_nN`).

    Raises
    ------
    InputError : a curve keeps too few points in the range of forces of the responses; see
        `fit_responses`.
    """
    tables = [table for table in tables if table.kind in KINDS]
    if not tables:
        return None
    by_table = []
    for table in tables:
        if table.kind in CURVES:
            by_table.append(curve_names(CURVES[table.kind]))
        else:
            by_table.append([SCALARS[table.kind]])
    names = [name for some in by_table for name in some]
    specimens: dict[str, list[Part]] = {}
    model_error = np.zeros((len(names), len(names)))
    left_out = 0
    for table, seen in zip(tables, by_table, strict=True):
        first = names.index(seen[0])
        block = slice(first, first + len(seen))
        model_error[block, block] = _model_error(table, len(seen))
        for specimen, rows in by_specimen(table).items():
            points, values, variances, dropped = _points(table, specimen, rows, max_force_nN)
            left_out += dropped
            columns = np.zeros((len(values), len(names)))
            columns[:, block] = points
            free = np.full(len(values), float(table.kind in CURVES and not table.zero_known))
            specimens.setdefault(specimen, []).append((columns, values, variances, free))
    expected = expected_over_prior(cycles, names)
    bend = any(table.kind in CURVES for table in tables)  # other data are linear everywhere
    precision = []
    information = []
    for specimen, tables_of_specimen in specimens.items():
        columns = (np.concatenate(column) for column in zip(*tables_of_specimen, strict=True))
        a, b, last_step = _linearised(names, expected, *columns)
        if bend and not last_step <= SETTLED:
            raise InputError(
                f"{tables[0].file}: specimen {specimen}: its observables do not settle in"
                f" {MOST_STEPS} steps; look at units, columns and errors, or leave it out"
            )
        precision.append(a)
        information.append(b)
    return SurfaceData(
        fit_responses(names, cycles, prior),
        tuple(specimens),
        np.array(precision),
        np.array(information),
        model_error,
        left_out,
    )


def expected_over_prior(cycles: Cycles, names: Sequence[str]) -> tuple[Array, Array]:
    """Mean and covariance of observables over cycles, where undetermined curves are linearised."""
    seen = cycles.of(names)
    mean = np.nanmean(seen, axis=0)
    centred = np.where(np.isnan(seen), 0.0, seen - mean)
    return mean, centred.T @ centred / len(centred) + 1e-6 * np.eye(len(names))


def check_points(table: Measurements, max_force_nN: float) -> None:
    """Refuse curves with too few points in the range of the responses, and values hardly known.

    Raises
    ------
    InputError
    """
    if table.kind in KINDS:
        for specimen, rows in by_specimen(table).items():
            _points(table, specimen, rows, max_force_nN)


def _points(
    table: Measurements, specimen: str, rows: NDArray[np.int_], max_force_nN: float
) -> tuple[Array, Array, Array, int]:
    """A specimen's data as sums of observables (p, k), values, variances (p,), points left out."""
    if table.kind in CURVES:
        return _curve(table, specimen, rows, max_force_nN)
    values = table.columns[table.kind][rows]
    errors = table.columns[f"{table.kind}_error"][rows]
    if (errors > 0.5 * values).any():
        raise InputError(
            f"{table.file}: row {rows[np.argmax(errors / values)] + 1}: {table.kind}_error is more"
            f" than half of {table.kind}; its logarithm is compared with the model, so leave the"
            " row out or measure it better"
        )
    return np.ones((len(rows), 1)), np.log(values), (errors / values) ** 2, 0


def _curve(
    table: Measurements, specimen: str, rows: NDArray[np.int_], max_force_nN: float
) -> tuple[Array, Array, Array, int]:
    """The data of a curve; forces below three errors are left out, as their logarithm is biased."""
    levels = force_levels_nN(max_force_nN)
    force = table.columns["force"][rows]
    separation = table.columns["separation"][rows]
    force_error = table.columns.get("force_error", np.zeros(len(table)))[rows]
    own_error = table.columns.get("separation_error", np.zeros(len(table)))[rows]
    usable = (force >= levels[0]) & (force <= levels[-1]) & (force > 3.0 * force_error)
    if usable.sum() < 4:
        raise InputError(
            f"{table.file}: curve {specimen} has {int(usable.sum())} points with a net force of"
            f" {levels[0]:.4g} .. {levels[-1]:.4g} nN that is beyond three of its errors; at least"
            " 4 are needed: measure there, or set contact.max_force_nN to the largest measured"
            " force"
        )
    log_force = np.log(force[usable])
    log_levels = np.log(levels)
    columns = [np.interp(log_force, log_levels, row) for row in np.eye(LEVELS)]
    degree = min(2, int(usable.sum()) - 2)
    bend = np.polynomial.Polynomial.fit(log_force, separation[usable], degree)
    slope = bend.deriv()(log_force) / force[usable]
    variances = own_error[usable] ** 2 + (slope * force_error[usable]) ** 2
    floor = np.median(variances) * 1e-4 + 1e-12  # where a fitted slope crosses zero
    variances = np.maximum(variances, floor)
    return np.stack(columns, axis=1), separation[usable], variances, int((~usable).sum())


def _separations(names: Sequence[str], f: Array) -> tuple[Array, Array]:
    """Observables f (..., k), curves as separations, and derivatives (..., k, k)."""
    values = f.copy()
    count = len(names)
    slopes = np.broadcast_to(np.eye(count), (*f.shape, count)).copy()
    for branch in CURVES.values():
        begin = curve_names(branch)[0]
        if begin not in names:
            continue
        first = names.index(begin)
        block = slice(first + 1, first + LEVELS)
        steps = np.exp(f[..., block])
        values[..., block] = f[..., first, None] - np.cumsum(steps, axis=-1)
        slopes[..., block, first] = 1.0
        falling = np.repeat(steps[..., None, :], LEVELS - 1, axis=-2)
        slopes[..., block, block] = -np.tril(falling)
    return values, slopes


def _linearised(
    names: Sequence[str],
    expected: tuple[Array, Array],
    columns: Array,
    values: Array,
    variances: Array,
    free: Array,
) -> tuple[Array, Array, float]:
    """A and b of the data of one specimen, linear in its observables where data and prior put them.

    The last step towards that place comes with them, in standard deviations of the prior.

    Parameters
    ----------
    columns : the data as sums of separations and scalars, shape (p, k).
    free : 1 for data with an unknown zero, which is integrated out, else 0, shape (p,).
    """
    weights = np.diag(1 / variances)
    if free.any():
        ones = free / variances
        weights = weights - np.outer(ones, ones) / ones.sum()
        values = values - free * (ones @ values) / ones.sum()
    mean, covariance = expected
    stiffness = np.linalg.inv(covariance)
    f = mean.copy()
    deviations = np.array([np.inf])
    for _ in range(MOST_STEPS):  # of Gauss and Newton
        physical, slopes = _separations(names, f)
        linear = columns @ slopes
        pull = linear.T @ weights @ (values - columns @ physical) + stiffness @ (mean - f)
        step = np.linalg.solve(linear.T @ weights @ linear + stiffness, pull)
        deviations = np.abs(step / np.sqrt(np.diag(covariance)))
        f = f + step / max(1.0, deviations.max())
    physical, slopes = _separations(names, f)
    linear = columns @ slopes
    precision = linear.T @ weights @ linear
    information = linear.T @ weights @ (values - columns @ physical + linear @ f)
    return precision, information, float(deviations.max())


def _model_error(table: Measurements, size: int) -> Array:
    """Covariance of the model's own error in a table; correlated over a decade of force."""
    if table.kind == "contact_begin":  # stated in nm, the observable is its logarithm
        typical_nm = np.median(table.columns["contact_begin"])
        return np.full((1, 1), (table.discrepancy / typical_nm) ** 2)
    decades = np.log10(force_levels_nN(1.0))[:size]
    return table.discrepancy**2 * np.exp(-np.abs(decades[:, None] - decades))
