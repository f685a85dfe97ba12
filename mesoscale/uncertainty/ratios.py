"""The paper's numbers free of length: d_c/RMS and rho_r/RMS from its Tables 2 and 3."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.uncertainty.collocation import elementary_effects
from mesoscale.uncertainty.distributions import InputTable
from mesoscale.uncertainty.propagation import NodeOutputs, Propagation
from mesoscale.uncertainty.runs import OUTPUTS

Array = NDArray[np.float64]

COLUMNS = ("quantity", "from", "value", "seed_sd", "paper", "difference_in_seed_sd", "seeds_used")
RATIOS = {"d_c": OUTPUTS.index("d_c_nm"), "rho_r": OUTPUTS.index("rho_r_nm")}


def ratio_rows(
    nodes: NodeOutputs,
    result: Propagation,
    table: InputTable,
    central_share: float,
    paper2: Mapping[str, tuple[float, float]],
    paper3: Mapping[str, Mapping[str, float]],
) -> list[dict[str, Any]]:
    """Rows of uq/ratios.csv: mean output over mean RMS (Table 2), mu* over the width of RMS (Table 3).

    Every seed's own ratio, as mean and standard deviation over seeds; empty unless RMS varies.
    """
    if "rms" not in table.names:
        return []
    position, inputs = table.names.index("rms"), len(table.rows)
    low, high = table.ranges(central_share)[position]
    if not high > low:
        return []
    y = nodes.paper_outputs[:, : 2 * inputs + 1]
    rows = []
    for name, k in RATIOS.items():
        effects = np.array([elementary_effects(line, inputs)[position] for line in y[:, :, k]])
        for source, by_seed, reference in (
            ("mean (Table 2)", 2 * result.by_seed[:, 0, k] / (low + high), 2 * paper2[name][0] / (low + high)),
            ("mu* (Table 3)", effects / (high - low), paper3[name]["rms"] / (high - low)),
        ):
            known = by_seed[np.isfinite(by_seed)]
            value = float(known.mean()) if len(known) else np.nan
            scatter = float(known.std(ddof=1)) if len(known) > 1 else np.nan
            rows.append(
                dict(
                    zip(
                        COLUMNS,
                        (f"{name}/RMS", source, value, scatter, reference, (value - reference) / scatter, len(known)),
                        strict=True,
                    )
                )
            )
    return rows
