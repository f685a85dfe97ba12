"""Memory of a site of a contact.  Imports nothing: rules read it where Snakemake is alone."""

# 4096^2 sites take 1.1 GB, 1024^2 323 and 515 MB; one load 48 bytes a site at 4096^2, 44 at 8192^2
SITE_MB = {
    "asperity": 62e-6,
    "coupled": 140e-6,
    "adhesive": 260e-6,
    "one load": 50e-6,
    "one load on a map alone": 140e-6,
}
