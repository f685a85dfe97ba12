# make run [SCENE=reduced|ci|paper|full|path.yaml] [TARGET=law] [HOURS=100]   set up, then run a scene (12 hours at most)
# make plan [SCENE=…] [TARGET=…]   which jobs would run and how long they take; runs nothing
# make test | bench | lint | docs | floors | image
SCENE ?= reduced
TARGET ?=
HOURS ?=

UV_VERSION := 0.13.9
UV := $(or $(shell command -v uv 2>/dev/null),.uv/bin/uv)
RUN := $(UV) run --locked --no-sync
# trust the system's certificates, so that set-up works behind a TLS-inspecting proxy
export UV_SYSTEM_CERTS := 1
# as where LC_ALL is not installed; Python would not start in a folder with letters beyond ASCII
ifeq ($(shell locale charmap 2>/dev/null),ANSI_X3.4-1968)
export LC_ALL := C.UTF-8
endif
# no place for the cache of packages
ifneq ($(shell test -w "$$HOME" && echo yes),yes)
export UV_CACHE_DIR := $(CURDIR)/.uv/cache
endif

.PHONY: run plan test bench lint docs floors image setup docs-setup
run: setup
	@$(RUN) asperity run $(if $(HOURS),--hours "$(HOURS)") "$(SCENE)" $(TARGET)

plan: setup
	@$(RUN) asperity plan "$(SCENE)" $(TARGET)

# a core for each worker: libraries whose threads wait for each other there took twice as long
test: export OMP_NUM_THREADS := 1
test: setup
	$(RUN) pytest --numprocesses auto --maxprocesses 4 --dist loadfile --no-loadscope-reorder

bench: setup
	$(RUN) python -m evidence contact.one_load --pixels 512
	$(RUN) python -m evidence contact.one_load --pixels 512 --closing --maps smooth
	$(RUN) python -m evidence elastic.engine

lint: setup
	$(RUN) ruff format --check .
	$(RUN) ruff check .
	$(RUN) snakefmt --check Snakefile workflow
	$(RUN) pyright
	$(RUN) lint-imports --no-cache

docs: docs-setup
	@rm -rf docs/api docs/_build
	$(RUN) sphinx-build -W --keep-going -q -b html docs docs/_build/html
	@echo "docs/_build/html/index.html"

floors: | $(UV)
	.ci/floors

image:
	.ci/container $(BASE)

setup: .venv/.asperity-ready

docs-setup: setup
	@$(UV) sync --locked --quiet --inexact --group docs

.venv/.asperity-ready: pyproject.toml uv.lock | $(UV)
	@echo "setting up the environment (about 1.5 GB, once)"
	@$(UV) sync --locked --quiet --compile-bytecode
	@touch $@

.uv/bin/uv:
	@python3 -m pip --version > /dev/null 2>&1 || { echo "make: $$(command -v python3) has no pip:\
	 leave the active environment (deactivate), or install pip" >&2; exit 1; }
	@python3 -m pip install --quiet --disable-pip-version-check --target .uv uv==$(UV_VERSION)
