"""The level of all intervals of the topography stage, and how far they reach."""

CONFIDENCE = 0.9
QUANTILES = ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2)
REACH = 1.6448536269514722
"""Half an interval of a normal distribution over its standard deviation."""


def student_reach(freedom: float) -> float:
    """The same of Student's distribution."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + CONFIDENCE / 2))
