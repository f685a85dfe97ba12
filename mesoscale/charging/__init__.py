"""Where charge enters the dielectric of a held switch, and what it does to it over years."""
