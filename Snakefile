"""The workflow is workflow/Snakefile; this file is for `snakemake` in the checkout's root."""


include: "workflow/Snakefile"


rule default:  # an included file does not pass on which of its rules is the default
    default_target: True
    input:
        rules.all.input,
