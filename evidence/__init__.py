"""What was done once to show that a method is right: campaigns, benchmarks, attacks.

Nothing imports this package, and no wheel holds it. `python -m evidence` lists the studies and runs
them.

A study is a module `evidence/<room>/<name>.py` with

- a docstring, whose first line is the question that the study answers;
- `rows(given)`, which yields the rows of its table as they come, as mappings from column to value;
- `arguments(parser)` (optional), its options on the command line, with defaults;
- `figures(rows)` (optional), the few numbers that pages quote, as texts by name.

Its table is `evidence/data/<room>_<name>.csv`. Each row carries commit, date, processor and
command.

A study that nobody will run on newer code ends: `evidence/ended.yaml` keeps its question and its
numbers, and the commit at which its code is. The command runs it there.
"""
