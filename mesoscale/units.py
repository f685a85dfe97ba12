"""Units in SI, and the constant of nature that a switch needs."""

NM = 1e-9
UM = 1e-6
GPA = 1e9
VACUUM_PERMITTIVITY = 8.8541878128e-12  # F/m, CODATA 2018
