"""One runner and one writer of rows for the studies of all stages."""

from workflow.run.studies import accuracy_rows, stability_rows


def broken():
    raise RuntimeError("lost\nits way")


def test_a_check_that_raises_has_failed_and_the_others_run():
    told = []
    checks = [("lost", "raises", "nothing", broken), ("fine", "passes", "all", lambda: (True, "1 of 1"))]
    rows = list(stability_rows("contact", checks, lambda *given: told.append(given)))
    assert [(row["case"], row["passed"], row["detail"]) for row in rows] == [
        ("lost", False, "RuntimeError: lost its way"),
        ("fine", True, "1 of 1"),
    ]
    assert {row["stage"] for row in rows} == {"contact"}
    assert told == [(0.5, "lost"), (1.0, "fine")]


def test_memory_is_that_of_this_process_unless_the_point_says_otherwise():
    here, elsewhere = accuracy_rows("contact", [{"wall_s": 0.123456}, {"wall_s": None, "peak_rss_MB": None}])
    assert here["peak_rss_MB"] > 1
    assert here["wall_s"] == 0.1235
    assert elsewhere == {"stage": "contact", "wall_s": None, "peak_rss_MB": None}
