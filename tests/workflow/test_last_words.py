"""What a run says of results that no rule makes."""

from workflow.files.results import write_text
from workflow.run.last_words import foreign_results


def test_files_in_a_folder_that_a_rule_makes_are_not_of_another_version(tmp_path):
    """The models of a circuit are a folder; each run called them results of another version."""
    for name in ("circuit/models/central.sub", "circuit/models/corners/low.sub", "law/wells.csv"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        write_text(tmp_path / name, "x\n")
    made = {str(tmp_path / "circuit/models")}
    (line,) = foreign_results(tmp_path, made.__contains__)
    assert line.startswith(f"{tmp_path}/law/wells.csv is a result of another version")
