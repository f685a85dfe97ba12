"""Memory of a site of a contact.  Imports nothing: rules read it where Snakemake is alone."""

# 4096^2 sites take 1.1 GB, 1024^2 323 and 515 MB; one load 48 bytes a site at 4096^2, 44 at 8192^2
SITE_MB = {
    "asperity": 62e-6,
    "coupled": 140e-6,
    "adhesive": 260e-6,
    "one load": 50e-6,
    "one load on a map alone": 140e-6,
}

# Arrays at the peak of one load that yields, counted with array-api-strict at 512^2: 99 bytes a
# site of a map that repeats, 169 where four times the sites are transformed. On top 24 bytes a
# transformed site, assumed, for the room that the plans of a library's transforms take.
GPU_SITE_MB = {"map": 76e-6, "transforms": 48e-6}
