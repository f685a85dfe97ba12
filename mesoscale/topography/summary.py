"""The content of topography/parameters.json: what is known of the surface, by name."""

from collections.abc import Iterator, Mapping
from typing import Any

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.choice import DESCRIPTIONS
from mesoscale.topography.description.inputs import trusted_end
from mesoscale.topography.description.intervals import CONFIDENCE
from mesoscale.topography.description.likelihood import LikelihoodFit
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.pooling import Pooled
from mesoscale.topography.records import is_profile
from mesoscale.topography.roughness_spectrum import hurst_from_slope


def measurement_lines(content: Mapping[str, Any]) -> Iterator[str]:
    """What each measurement shows, as lines of a table; `content`: topography/parameters.json."""
    heads = ("measurement", "size (nm)", "points", "RMS (nm)", "trusted q (1/nm)", "ends by")
    rows = [heads, *(_cells(row) for row in content["scans"])]
    widths = [max(len(row[k]) for row in rows) for k in range(len(heads))]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield "  ".join(cells).rstrip()


def _cells(row: Mapping[str, Any]) -> tuple[str, ...]:
    name = row["name"]
    trusted = f"{row['trusted_low']:.2g} to {row['trusted_high']:.2g}"
    longest = 20
    if len(name) > longest:  # so that the table fits on 80 columns
        name = f"{name[: longest // 2 - 1]}…{name[-longest // 2 :]}"
    pixels = row["pixels"].replace(" ", "")
    return (
        name,
        f"{row['length_nm']:.4g}",
        pixels,
        f"{row['rms_heights_nm']:.3g}",
        trusted,
        row["limit"],
    )


def doubt_lines(content: Mapping[str, Any]) -> Iterator[str]:
    """A line for each doubt, with its remedy."""
    for doubt in content["doubts"]:
        remedy = doubt["remedy"]
        if remedy:
            remedy = f"; {remedy}"
        yield f"DOUBT ({doubt['code']}, about {doubt['about']}): {doubt['text']}{remedy}"


def _scan(item: TrustedSpectrum, loaded: Mapping[str, Any]) -> dict[str, Any]:
    """One measurement: size, RMS from heights, trusted range and what limits it."""
    length_nm = loaded["length_x_nm"]
    pixels = f"{loaded['pixels_x']}"
    if not is_profile(loaded):
        length_nm = min(loaded["length_x_nm"], loaded["length_y_nm"])
        pixels = f"{loaded['pixels_x']} x {loaded['pixels_y']}"
    return {
        "name": item.name,
        "file": loaded["file"],
        "sha256": loaded["sha256"],
        "length_nm": length_nm,
        "pixels": pixels,
        "rms_heights_nm": loaded["rms_nm"],
        "trusted_low": item.low,
        "trusted_high": item.high,
        "limit": item.limit,
        "steps": loaded["steps"],
        "tip_radius_nm": loaded["tip_radius_nm"],
    }


def parameters(
    pooled: Pooled,
    attributes: Mapping[str, Mapping[str, Any]],
    settings: TopographySettings,
    truth: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Content of topography/parameters.json.

    Parameters
    ----------
    attributes : of the records, by name.
    truth : content of topography/truth.json, of synthetic scans.
    """
    topography, doubts, used = pooled.topography, pooled.doubts, pooled.choice.name
    stopping = [doubt for doubt in doubts if doubt.fatal or doubt in topography.doubts]
    passed = bool(pooled.rows) and (not stopping or settings.on_doubt == "warn")
    units = {"q0": "1/nm", "slope": "1", "hurst": "1", "rms": "nm"}
    estimates_of = "eq. 9, for comparison; inputs have the measured spectrum, in cells of cell_nm"
    if used == "power_law":
        estimates_of = "eq. 9, all waves; inputs have those of a cell"
    content: dict[str, Any] = {
        "synthetic": truth is not None,
        "convention": settings.convention,
        "ranges": settings.ranges,
        "confidence": CONFIDENCE,
        "tip_radius_nm": settings.tip_nm,
        "estimates_of": estimates_of,
        "estimates": {
            name: {**estimate.plain(), "unit": units[name]}
            for name, estimate in topography.estimates.items()
        },
        "q1": {"value": topography.q1, "unit": "1/nm", "instrument_limited": topography.q1_limited},
        "likelihood": _likelihood(topography.likelihood, topography.cutoff),
        "scans": [_scan(item, attributes[item.name]) for item in pooled.spectra],
        "description": {
            "name": used,
            "meaning": DESCRIPTIONS[used],
            "overridden": pooled.choice.overridden,
            "evidence": list(pooled.choice.evidence),
        },
        "trusted_end": trusted_end(pooled.spectra),
        "one_spectrum": _one(pooled),
        "cell_nm": pooled.cell_nm,
        "surface": pooled.surface,
        "inputs": pooled.rows if passed else {},
        "film": pooled.film if passed else {},
        "gate": {"passed": passed, "reasons": [doubt.text for doubt in stopping]},
        "doubts": [doubt.plain() for doubt in doubts],
    }
    if truth is not None:
        hurst = hurst_from_slope(truth["truth"]["slope"], settings.convention)
        content["truth"] = {**truth["truth"], "hurst": hurst}
    return content


def _likelihood(fitted: LikelihoodFit | None, cutoff: float) -> dict[str, Any] | None:
    if fitted is None:
        return None
    names = (
        "q0",
        "slope",
        "covariance",
        "amplitude_sd",
        "dispersion",
        "misfit",
        "plateau_gain",
        "power_gain",
    )
    spectrum = fitted.spectrum(cutoff)
    roughness = {
        "plateau_nm4": fitted.plateau,
        "rms_nm": spectrum.rms_nm,
        "rms_slope": spectrum.rms_slope,
    }
    return roughness | {name: getattr(fitted, name) for name in names}


def _one(pooled: Pooled) -> dict[str, Any] | None:
    merged = pooled.merged
    if merged is None:
        return None
    return {
        "from_q": merged.first,
        "to_q": float(merged.q[-1]),
        "place_sd": merged.place_sd,
        "measurements": list(merged.names),
        **merged.statistics(),
        "overlaps": [
            {
                "first": pair.first,
                "second": pair.second,
                "from_q": pair.low,
                "to_q": pair.high,
                "ratio": pair.ratio,
                "expected_within": pair.expected,
                "agrees": pair.agrees,
            }
            for pair in pooled.pairs[:40]  # of many alike scans the rest repeats them
        ],
    }
