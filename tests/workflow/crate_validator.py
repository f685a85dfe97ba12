"""Validates a crate with roc-validator, without a network.

    python tests/workflow/crate_validator.py CRATE

Run it with the Python of an environment that has roc-validator and rocrate; it prints the failures.
The two contexts that a crate names are not fetched. That of RO-Crate is the one that rocrate ships,
of version 1.3, with the one term that a crate of a run uses and that 1.1 has elsewhere. That of
Workflow Run Crate is written down below (ResearchObject/ro-terms, workflow-run/context.json).
"""

import json
import sys
from importlib.resources import files

from rdflib.plugins.shared.jsonld import context as jsonld_context
from rocrate_validator import services
from rocrate_validator.utils import document_loader, http

WFRUN = "https://w3id.org/ro/terms/workflow-run#"
TERMS = (
    *("ParameterConnection", "connection", "sourceParameter", "targetParameter"),
    *("md5", "sha1", "sha256", "sha512", "environment", "resourceUsage", "containerImage"),
)
SHIPPED = json.loads((files("rocrate") / "data/ro-crate.jsonld").read_text(encoding="utf-8"))
OF_1_1 = {"ComputationalWorkflow": "https://bioschemas.org/ComputationalWorkflow"}
CONTEXTS = {
    "https://w3id.org/ro/crate/1.1/context": {"@context": SHIPPED["@context"] | OF_1_1},
    "https://w3id.org/ro/terms/workflow-run/context": {
        "@context": {term: f"{WFRUN}{term}" for term in TERMS}
    },
}


class Answer:
    """What a server would answer."""

    status_code = 200
    ok = True

    def __init__(self, url):
        self.url = url
        self.headers = {"Content-Type": "application/ld+json"}

    def json(self):
        return CONTEXTS[self.url]


def context_of(source, *further, **options):
    """A context that is written down here; any other is an error."""
    return CONTEXTS[source], None


def main(crate: str) -> int:
    """Print each failed check; returns whether there is one."""
    document_loader.install_document_loader()
    jsonld_context.source_to_json = context_of
    http.HttpRequester.get = lambda _, url, **options: Answer(url)
    http.HttpRequester.head = lambda _, url, **options: Answer(url)
    settings = services.ValidationSettings(
        rocrate_uri=crate,
        profile_identifier="provenance-run-crate-0.5",
        requirement_severity="REQUIRED",
        abort_on_first=False,
    )
    result = services.validate(settings)
    for issue in result.get_issues():
        print(issue.check.identifier, issue.message)
    print(f"{len(result.executed_checks)} checks, passed: {result.passed()}")
    return int(not result.passed())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
