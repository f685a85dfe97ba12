"""What inputs and counts leave open of the release: the error that more computing reduces, and the rest."""

from typing import Any

import numpy as np

from workflow.report.available import Results

MEDIAN = 1.25
"""Standard error of a median over that of a mean."""


def contributions(results: Results) -> dict[str, Any] | None:
    """What inputs and counts leave open of the release, from the results of a scene; None where the answer is missing.

    It is taken for missing, too, where too few draws stand behind it to tell their error.

    Returns
    -------
    `fixed_V` by cause, `largest` (the input behind most of it, and its share), `counts`, and `variance_V2` of one of
    each of them.
    """
    if not results.has("device/pad_switch.json"):
        return None
    pad = results.json("device/pad_switch.json")
    answer = pad.get("answer")
    if not answer or (draws_V := answer["design"].get("draws_error_V")) is None:
        return None
    design, shares = answer["design"], {row["name"]: row["share_of_variance"] for row in answer["sensitivity"]}
    total_V2, cells_V2 = answer["release_V"]["std"] ** 2, design["cells_error_V"] ** 2
    inputs_V2 = max(total_V2 - cells_V2, 0.0)
    counts = {"pad.cells": pad["cells_computed"], "pad.draws": design["draws"]}
    variances = {"pad.cells": cells_V2 * counts["pad.cells"], "pad.draws": draws_V**2 * counts["pad.draws"]}
    if results.has("hardness/fit.json") and "budget" in (fit := results.json("hardness/fit.json")):
        # the mean over runs errs by the scatter between them; all runs of a seed are one of the count
        counts["hardness.seeds"] = len({point["seed"] for point in results.csv("hardness/points.csv")})
        of_runs = fit["budget"]["statistical"]["share"] / fit["points_used"]
        variances["hardness.seeds"] = shares.get("h_prime", 0.0) * total_V2 * of_runs * counts["hardness.seeds"]
    e_star = results.json("elastic/e_star.json") if results.has("elastic/e_star.json") else {}
    if (error_GPa := e_star.get("standard_error_of_mean_GPa")) is not None:  # one glass has none
        of_glasses = (error_GPa / e_star["std_GPa"]) ** 2
        counts["elastic.structures"] = len(e_star["structures_used"])
        variances["elastic.structures"] = (
            shares.get("e_star", 0.0) * total_V2 * of_glasses * counts["elastic.structures"]
        )
    points_V = MEDIAN * design["response_error_V"] / np.sqrt(design["points"])
    largest = max(shares, key=lambda name: shares[name])
    return {
        "fixed_V": {"inputs": float(np.sqrt(inputs_V2)), "64 switches behind the interval": float(points_V)},
        "largest": [largest, shares[largest]],
        "counts": counts,
        "variance_V2": variances,
    }
