"""Likelihood of what was measured on surfaces: curves, contact-begin separations, pull-off forces.

Every specimen has observables f = response(inputs) + model error (one for all specimens) + its own scatter, all normal,
and data with known normal errors, linearised where they lie: exp(-f A f / 2 + b f - c / 2). So all but the inputs is
integrated exactly (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, appendix A). First contacts,
whose observable is their inverse, get a correction of their own (`first_contact`).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.first_contact import FirstContacts, first_contacts
from mesoscale.calibration.measurements import CURVES as CURVE_KINDS
from mesoscale.calibration.measurements import Measurements, by_specimen
from mesoscale.calibration.observables import CURVES, LEVELS, curve_names, force_levels_nN
from mesoscale.calibration.responses import Prediction
from mesoscale.errors import InputError

Array = NDArray[np.float64]
Part = tuple[Array, Array, Array, Array]

GAUSS_NEWTON_STEPS = 30
CORRELATION_DECADES = 1.0
"""Range of force, in decades, over which the model's own error of a curve stays correlated."""
ERRORS_ABOVE_ZERO = 3.0
"""Points whose force is less than so many of its errors are left out: its logarithm would be biased."""
SMALLEST_SHARE = 1e-9
"""Eigenvalues below this share of one of unit diagonal are rounding."""
SCALAR_COLUMNS = {"contact_begin": "contact_begin_nm", "pull_off": "pull_off_nN"}
LARGEST_RELATIVE_ERROR = 0.5
"""Of a value that enters by its logarithm or inverse."""


@dataclass(frozen=True)
class SurfaceData:
    """All data measured on surfaces.

    Attributes
    ----------
    names : observables that the data see, k of them.
    specimens : their names, s of them.
    precision : A of each specimen, shape (s, k, k).
    information : b of each, shape (s, k).
    constant : sum of c and of the logarithms of 2 pi times the errors' variances.
    model_error : covariance of the model's own error, shape (k, k).
    left_out : points of curves outside the range of forces of the responses.
    points : numbers used.
    begins : measured first contacts, whose normal likelihood is put right; None of made-up data and without any.
    """

    names: tuple[str, ...]
    specimens: tuple[str, ...]
    precision: Array
    information: Array
    constant: float
    model_error: Array
    left_out: int
    points: int
    begins: FirstContacts | None

    def log_likelihood(self, prediction: Prediction) -> Array:
        """Logarithm of the likelihood at m points, shape (m,).

        Parameters
        ----------
        prediction : of the observables `names`.
        """
        mean, scatter = prediction.mean, prediction.scatter
        size = len(self.names)
        eye = np.eye(size)
        root = np.linalg.cholesky(scatter + 1e-12 * np.einsum("mkk->mk", scatter).mean(1)[:, None, None] * eye)
        # with V = L (1 + L' A L)^-1 L', the posterior covariance of a specimen's own f
        root = root[:, None]
        turned = np.swapaxes(root, 2, 3)
        factor = np.linalg.cholesky(eye + turned @ self.precision @ root)
        half = np.linalg.solve(factor, np.broadcast_to(turned, factor.shape))
        lowered = half @ self.precision
        pulled = np.einsum("msjk,sk->msj", half, self.information)
        result = 0.5 * (pulled**2).sum(axis=(1, 2)) - np.log(np.einsum("mskk->msk", factor)).sum(axis=(1, 2))
        result -= 0.5 * self.constant
        stacked = lowered.reshape(len(mean), -1, size)
        total_precision = self.precision.sum(axis=0) - np.swapaxes(stacked, 1, 2) @ stacked
        total_information = self.information.sum(axis=0) - np.einsum("msjk,msj->mk", lowered, pulled)
        common = self._model_error_at(mean) + prediction.error[:, None, None] * scatter
        common_root = np.linalg.cholesky(common + 1e-12 * np.einsum("mkk->mk", scatter)[:, :, None] * eye)
        factor = np.linalg.cholesky(eye + np.swapaxes(common_root, 1, 2) @ total_precision @ common_root)
        remaining = total_information - np.einsum("mjk,mk->mj", total_precision, mean)
        moved = np.linalg.solve(factor, np.einsum("mjk,mj->mk", common_root, remaining)[:, :, None])[:, :, 0]
        result += np.einsum("mk,mk->m", mean, total_information)
        result -= 0.5 * np.einsum("mj,mjk,mk->m", mean, total_precision, mean)
        result += 0.5 * (moved**2).sum(axis=1) - np.log(np.einsum("mkk->mk", factor)).sum(axis=1)
        if self.begins is not None:
            place = self.names.index("contact_begin_nm")
            result += self.begins.correction(mean[:, place], (scatter + common)[:, place, place])
        return result

    def _model_error_at(self, mean: Array) -> Array:
        """Covariance of the model's own error in the observables, from that of separations, shape (m, k, k)."""
        if not self.model_error.any():
            return np.zeros((len(mean), *self.model_error.shape))
        slopes = np.repeat(np.eye(len(self.names))[None], len(mean), axis=0)
        for branch in CURVES.values():
            begin = curve_names(branch)[0]
            if begin not in self.names:
                continue
            for place in range(self.names.index(begin) + 1, self.names.index(begin) + LEVELS):
                slopes[:, place, place - 1] = np.exp(-mean[:, place])
                slopes[:, place, place] = -slopes[:, place, place - 1]
        if "contact_begin_nm" in self.names:  # its error is in nm, it enters by its inverse
            place = self.names.index("contact_begin_nm")
            slopes[:, place, place] = -(mean[:, place] ** 2)
        return slopes @ self.model_error @ np.swapaxes(slopes, 1, 2)

    def simulated(self, prediction: Prediction, rng: np.random.Generator) -> "SurfaceData":
        """Data of the same specimens with the same errors, drawn at one point, predicted with shape (1, k)."""
        size = len(self.names)
        mean, scatter = prediction.mean[0], prediction.scatter[0]
        common = self._model_error_at(prediction.mean)[0] + prediction.error[0] * scatter
        shared = rng.multivariate_normal(np.zeros(size), common, method="svd")
        f = mean + shared + rng.multivariate_normal(np.zeros(size), scatter, len(self.specimens), method="svd")
        noise = np.stack([rng.multivariate_normal(np.zeros(size), a, method="svd") for a in self.precision])
        information = np.einsum("sjk,sk->sj", self.precision, f) + noise
        return replace(self, information=information, constant=0.0, begins=None)

    def misfits(self, prediction: Prediction) -> Array:
        """Probability of a specimen as far off as each is, at one point, shape (s,)."""
        from scipy.stats import chi2

        scatter = prediction.scatter[0] * (1 + prediction.error[0]) + self._model_error_at(prediction.mean)[0]
        shares = []
        for precision, information in zip(self.precision, self.information, strict=True):
            spread = precision @ scatter @ precision + precision
            off = information - precision @ prediction.mean[0]
            inverse, rank = pseudo_inverse(spread)
            shares.append(chi2.sf(off @ inverse @ off, rank))
        return np.array(shares)


def pseudo_inverse(matrix: Array) -> tuple[Array, int]:
    """Pseudo-inverse and rank of a covariance or precision, whatever the units of its rows."""
    diagonal = np.diag(matrix)
    unit = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    alike = matrix / np.outer(unit, unit)
    inverse = np.linalg.pinv(alike, rcond=SMALLEST_SHARE, hermitian=True)
    return inverse / np.outer(unit, unit), int(np.linalg.matrix_rank(alike, tol=SMALLEST_SHARE, hermitian=True))


@dataclass(frozen=True)
class Expected:
    """What the prior expects of the observables: where measured curves are linearised that do not determine them.

    Attributes
    ----------
    names, mean : as `Prediction` has them, shape (k,).
    covariance : shape (k, k).
    """

    names: tuple[str, ...]
    mean: Array
    covariance: Array

    def pick(self, names: Sequence[str]) -> tuple[Array, Array]:
        """Mean and covariance of some observables."""
        places = [self.names.index(name) for name in names]
        return self.mean[places], self.covariance[np.ix_(places, places)]


def surface_data(tables: Iterable[Measurements], max_force_nN: float, expected: Expected) -> SurfaceData | None:
    """Data of all tables that were measured on surfaces; None without any.

    Parameters
    ----------
    max_force_nN : largest repulsion of the cycles (`ContactSettings.max_force_nN`).

    Raises
    ------
    InputError : a curve keeps too few points in the range of forces of the responses.
    """
    tables = [table for table in tables if table.kind in (*CURVE_KINDS, *SCALAR_COLUMNS)]
    if not tables:
        return None
    names = _names(tables)
    prior = expected.pick(names)
    parts: dict[str, list[Part]] = {}
    left_out, begins = 0, None
    for table in tables:
        if table.kind == "contact_begin":
            place = names.index("contact_begin_nm")
            begins = first_contacts(*_scalars(table), float(prior[0][place]), float(prior[1][place, place]))
        for specimen, rows in by_specimen(table).items():
            if table.kind in CURVE_KINDS:
                projection, values, variances, dropped = _curve(table, specimen, rows, max_force_nN)
                left_out += dropped
                first = names.index(curve_names(CURVES[table.kind])[0])
                columns = np.zeros((len(values), len(names)))
                columns[:, first : first + LEVELS] = projection
            else:
                if table.kind == "contact_begin" and begins is not None:
                    values, variances = begins.inverse[rows], begins.variances[rows]
                else:
                    measured, errors = _scalars(table)
                    values, variances = np.log(measured[rows]), (errors / measured)[rows] ** 2
                columns = np.zeros((len(values), len(names)))
                columns[:, names.index(SCALAR_COLUMNS[table.kind])] = 1.0
            free = np.full(len(values), float(table.kind in CURVE_KINDS and not table.zero_known))
            parts.setdefault(specimen, []).append((columns, values, variances, free))
    terms = [_linearised(names, prior, *map(np.concatenate, zip(*part, strict=True))) for part in parts.values()]
    precision, information, constant = (np.array(column) for column in zip(*terms, strict=True))
    points = sum(len(values) for part in parts.values() for _, values, _, _ in part)
    model_error = _model_error(tables, names)
    return SurfaceData(
        tuple(names), tuple(parts), precision, information, float(constant.sum()), model_error, left_out, points, begins
    )


def check_points(table: Measurements, max_force_nN: float) -> None:
    """Refuse curves with too few points in the range of forces of the responses, and values that are hardly known.

    Raises
    ------
    InputError
    """
    if table.kind in SCALAR_COLUMNS:
        _scalars(table)
    elif table.kind in CURVE_KINDS:
        for specimen, rows in by_specimen(table).items():
            _curve(table, specimen, rows, max_force_nN)


def _names(tables: Sequence[Measurements]) -> list[str]:
    names = []
    for table in tables:
        if table.kind in CURVE_KINDS:
            names += curve_names(CURVES[table.kind])
        else:
            names.append(SCALAR_COLUMNS[table.kind])
    return names


def _curve(
    table: Measurements, specimen: str, rows: NDArray[np.int_], max_force_nN: float
) -> tuple[Array, Array, Array, int]:
    """Design (p, LEVELS), separations and variances (p,) of the points of a curve, and how many are left out."""
    levels = force_levels_nN(max_force_nN)
    force, separation = table.columns["force"][rows], table.columns["separation"][rows]
    force_error = table.columns.get("force_error", np.zeros(len(table)))[rows]
    own_error = table.columns.get("separation_error", np.zeros(len(table)))[rows]
    usable = (force >= levels[0]) & (force <= levels[-1]) & (force > ERRORS_ABOVE_ZERO * force_error)
    if usable.sum() < 4:
        raise InputError(
            f"{table.file}: curve {specimen} has {int(usable.sum())} points with a net force of {levels[0]:.4g} .. "
            f"{levels[-1]:.4g} nN that is beyond three of its errors; at least 4 are needed: measure there, or set "
            "contact.max_force_nN to the largest measured force"
        )
    log_force = np.log(force[usable])
    projection = np.stack([np.interp(log_force, np.log(levels), row) for row in np.eye(LEVELS)], axis=1)
    bend = np.polynomial.Polynomial.fit(log_force, separation[usable], min(2, int(usable.sum()) - 2))
    slope = bend.deriv()(log_force) / force[usable]
    variances = own_error[usable] ** 2 + (slope * force_error[usable]) ** 2
    floor = np.median(variances) * 1e-4 + 1e-12  # where a fitted slope crosses zero
    return projection, separation[usable], np.maximum(variances, floor), int((~usable).sum())


def _scalars(table: Measurements) -> tuple[Array, Array]:
    """Values and errors of a table that gives one number per row."""
    values, errors = table.columns[table.kind], table.columns[f"{table.kind}_error"]
    wide = np.flatnonzero(errors > LARGEST_RELATIVE_ERROR * values)
    if wide.size:
        raise InputError(
            f"{table.file}: row {wide[0] + 1}: {table.kind}_error is more than half of {table.kind}; its logarithm or "
            "inverse is compared with the model, so leave the row out or measure it better"
        )
    return values, errors


def _separations(names: Sequence[str], f: Array) -> tuple[Array, Array]:
    """Observables f with each curve as separations at its forces, shape (k,), and their derivatives, shape (k, k)."""
    values, slopes = f.copy(), np.eye(len(f))
    for branch in CURVES.values():
        begin = curve_names(branch)[0]
        if begin not in names:
            continue
        first = names.index(begin)
        block = slice(first + 1, first + LEVELS)
        steps = np.exp(f[block])
        values[block] = f[first] - np.cumsum(steps)
        slopes[block, first] = 1.0
        slopes[block, block] = -np.tril(np.tile(steps, (LEVELS - 1, 1)))
    return values, slopes


def _linearised(
    names: Sequence[str], prior: tuple[Array, Array], columns: Array, values: Array, variances: Array, free: Array
) -> tuple[Array, Array, float]:
    """A, b and c of the data of one specimen, linear in its observables where data and prior put them.

    Parameters
    ----------
    columns : the data as sums of separations and scalars, shape (p, k).
    free : 1 for data with an unknown zero, which is integrated out, else 0, shape (p,).
    """
    weights = np.diag(1 / variances)
    constant = float(np.log(2 * np.pi * variances).sum())
    if free.any():
        ones = free / variances
        weights = weights - np.outer(ones, ones) / ones.sum()
        constant += float(np.log(ones.sum() / (2 * np.pi)))
    mean, covariance = prior
    stiffness = np.linalg.inv(covariance)
    f = mean.copy()
    for _ in range(GAUSS_NEWTON_STEPS):
        physical, slopes = _separations(names, f)
        projection = columns @ slopes
        pull = projection.T @ weights @ (values - columns @ physical) + stiffness @ (mean - f)
        step = np.linalg.solve(projection.T @ weights @ projection + stiffness, pull)
        f = f + step / max(1.0, np.abs(step / np.sqrt(np.diag(covariance))).max())
    physical, slopes = _separations(names, f)
    projection = columns @ slopes
    values = values - columns @ physical + projection @ f
    return (
        projection.T @ weights @ projection,
        projection.T @ weights @ values,
        float(values @ weights @ values) + constant,
    )


def _model_error(tables: Sequence[Measurements], names: Sequence[str]) -> Array:
    """Covariance of the model's own error, of curves in their separations, shape (k, k)."""
    covariance = np.zeros((len(names), len(names)))
    start = 0
    for table in tables:
        size = LEVELS if table.kind in CURVE_KINDS else 1
        decades = np.log10(force_levels_nN(1.0)) if size > 1 else np.zeros(1)
        distance = np.abs(decades[:, None] - decades)
        block = slice(start, start + size)
        covariance[block, block] = table.discrepancy**2 * np.exp(-distance / CORRELATION_DECADES)
        start += size
    return covariance
