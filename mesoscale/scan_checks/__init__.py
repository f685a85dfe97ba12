"""A description of a surface, judged by pressing the measured scans themselves."""
