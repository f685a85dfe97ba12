"""Keys of scenes that are no more, with what to write instead; a scene that has one is refused in one line."""

FORMER_KEYS: dict[str, str] = {
    # device
    "device.landed_fraction": "no longer a setting, delete it: gap_um, bow_nm and tilt_nm say what is in contact",
    # inputs
    # hardness
    # elastic
    # topography
    # contact
    # law
    # pad and adhesion
    # uncertainty and calibration
}
