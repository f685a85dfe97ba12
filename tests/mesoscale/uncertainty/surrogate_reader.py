"""Reader of uncertainty/surrogate.json."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from mesoscale.uncertainty.surrogate import Below, Response, Surrogate


def from_json(content: Mapping[str, Any]) -> dict[str, Response]:
    """The responses of uncertainty/surrogate.json by the name of their output."""
    ranges = np.array([[row["low"], row["high"]] for row in content["inputs"]], float)
    sums = {
        output["name"]: Surrogate(
            ranges,
            np.array([term["degrees"] for term in output["terms"]], int),
            np.array([term["coefficient"] for term in output["terms"]], float),
            output["transform"],
        )
        for output in content["outputs"]
    }
    below = {output["name"]: output["below"] for output in content["outputs"] if "below" in output}
    return {
        name: Below(below[name], sums[below[name]], drop) if name in below else drop
        for name, drop in sums.items()
    }
