"""What the report states about attraction that does not deform the contact is what the studies
found.
"""

from evidence.contact import adhesion
from evidence.record import load
from workflow.report.limits import _UNDEFORMED


def test_the_reports_error_of_an_undeformed_contact_is_that_of_the_paired_runs():
    assert adhesion.figures(load("contact.adhesion"))["overestimate"] in _UNDEFORMED
    release = {row["case"]: float(row["release_V"]) for row in load("pad.answers")}
    assert abs(release["small pad, attraction deforms"] - release["small pad"]) < 0.1
    assert "less than 0.1 V" in _UNDEFORMED
