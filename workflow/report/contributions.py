"""What inputs and counts leave open of the release: the error that more computing reduces, and the rest."""

from typing import Any

import numpy as np

from workflow.report.available import Results

DRAWS = 0.18
"""Error that one draw leaves in the median release, over the deviation by the inputs: the draws of scene `paper` left
out in six blocks. It falls with the root of their number."""
MEDIAN = 1.25
"""Standard error of a median over that of a mean."""


def contributions(results: Results) -> dict[str, Any] | None:
    """What inputs and counts leave open of the release, from the results of a scene; None without an answer.

    Returns
    -------
    `fixed_V` by cause, `largest` (the input behind most of it, and its share), `counts`, and `variance_V2` of one of
    each of them.
    """
    if not results.has("device/pad_switch.json"):
        return None
    pad = results.json("device/pad_switch.json")
    if not (answer := pad.get("answer")):
        return None
    design, shares = answer["design"], {row["name"]: row["share_of_variance"] for row in answer["sensitivity"]}
    total_V2, cells_V2 = answer["release_V"]["std"] ** 2, design["cells_error_V"] ** 2
    inputs_V2 = max(total_V2 - cells_V2, 0.0)
    counts = {"pad.cells": pad["cells_computed"], "pad.draws": design["draws"]}
    variances = {"pad.cells": cells_V2 * counts["pad.cells"], "pad.draws": DRAWS**2 * inputs_V2}
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
