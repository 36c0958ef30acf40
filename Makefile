# Every target sets up what it needs. The environment is made again if its lock, its folder or the
# chosen interpreter has changed, or if its interpreter is gone.
# CORES=2 limits the cores that the pipeline uses, PYTHON=python3.12 chooses the interpreter.
PYTHON ?= python3
CORES ?=

# Settings of the caller that would mix other packages or kernels into the environment.
unexport PYTHONPATH PYTHONHOME PYTHONUSERBASE PIP_USER PIP_PREFIX PIP_TARGET PIP_ROOT JUPYTER_PATH

# A user whom the system does not know may have no home folder; Snakemake asks for one.
export HOME ?= $(CURDIR)/.venv

BIN := .venv/bin
STAMP := .venv/.installed
DEV_STAMP := .venv/.installed-dev
DOCS_STAMP := .venv/.installed-docs
BENCH_STAMP := .venv/.installed-bench
STALE := $(shell sh .ci/stale_environment $(if $(filter file,$(origin PYTHON)),,$(PYTHON)))
PIP := $(BIN)/python -I -m pip install -qq --disable-pip-version-check
# Nothing without a hash is ever installed, so the few packages that come as sources are built
# with the setuptools of the lock instead of one that pip would fetch for the purpose.
# The lock is complete, so pip need not resolve: it would also stumble over extras in hash mode.
LOCKED := $(PIP) --require-hashes --no-deps --no-build-isolation --no-compile
# Where PYTHONDONTWRITEBYTECODE is set, each process would compile all modules for itself, so they
# are compiled here: on all cores, and without the tests that packages ship, half of the work.
COMPILE := $(BIN)/python -I -W ignore -m compileall -qq -j 0 -x '/tests?/' .venv/lib || true
SNAKEMAKE := $(BIN)/python -I -m snakemake $(if $(CORES),--cores $(CORES))
UV_COMPILE := uv pip compile --quiet --universal --python-version 3.11 --fork-strategy fewest \
	--generate-hashes --no-annotate --no-header --no-emit-index-url

.PHONY: help reproduce test test-fast verify mutants bench lint docs lab identify lock clean always
.DELETE_ON_ERROR:

help: ## show this list
	@sed -nE 's/^([a-z-]+):.*## (.*)/make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 18

reproduce: $(STAMP) ## the paper: cases, datasets, figures, ledger and report
	@$(SNAKEMAKE)
	@cat results/paper/verdict.txt

# The tests start many processes, which would all compile every module for themselves.
test test-fast: export PYTHONDONTWRITEBYTECODE :=

test: $(DEV_STAMP) ## the whole test suite
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder

test-fast: $(DEV_STAMP) ## the tests to run after each edit, under a minute
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder -m "not slow"

verify: $(STAMP) ## every case again by another solver, and the hashes of all numbers
	@$(SNAKEMAKE)
	$(BIN)/python -m verification
	@$(SNAKEMAKE)

bench: $(BENCH_STAMP) ## the benchmarks, peers side by side
	$(BIN)/python -m benchmarks

lint: $(DEV_STAMP) ## all checks of form: formats, imports, types, workflow, notebooks
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/lint-imports --no-cache
	$(BIN)/mypy
	$(BIN)/python .ci/lint_workflow.py
	$(BIN)/python .ci/lint_notebooks.py

docs: $(DOCS_STAMP) ## the documentation site, in docs/_build/html
	rm -rf docs/_build docs/reference/generated
	$(BIN)/sphinx-build --fail-on-warning --keep-going --quiet -b html docs docs/_build/html
	$(BIN)/python .ci/lint_docs.py docs/_build/html

lab: $(DEV_STAMP) ## JupyterLab with the notebooks
	$(BIN)/jupyter lab notebooks

mutants: $(DEV_STAMP) ## small changes of the code that the tests should notice (four minutes)
	$(BIN)/python .ci/mutants.py

identify: $(STAMP) ## infer the open parameters from the claims
	$(SNAKEMAKE) identify
	cp results/paper/identification/identified.yaml config/identified.yaml

lock: ## resolve the requirements again (needs uv)
	$(UV_COMPILE) requirements.in requirements-study.in --output-file requirements.lock
	$(UV_COMPILE) requirements-dev.in --constraints requirements.lock \
		--output-file requirements-dev.lock
	$(UV_COMPILE) requirements-docs.in --constraints requirements.lock \
		--constraints requirements-dev.lock --output-file requirements-docs.lock
	$(UV_COMPILE) requirements-bench.in --constraints requirements.lock \
		--constraints requirements-dev.lock --output-file requirements-bench.lock

clean: ## remove the results and the environment
	rm -rf .venv .snakemake
	find results/ -mindepth 1 ! -name README.md -delete

$(STAMP): $(if $(STALE),always)
	@echo "making the environment in .venv (a minute or two)"
	@$(PYTHON) -I -c 'import sys; sys.version_info >= (3, 11) or sys.exit("Python 3.11 or later is \
	needed, this is " + sys.version.split()[0] + "; try make PYTHON=python3.12")'
	@$(PYTHON) -I -m venv --clear .venv
	@sed -nE '/^(pip|setuptools)==/,/[^\\]$$/p' requirements.lock >.venv/first.txt
	@$(LOCKED) -r .venv/first.txt
	@$(LOCKED) -r requirements.lock
	@$(PIP) --no-index --no-deps --no-build-isolation --editable .
	@$(COMPILE)
	@sh .ci/stale_environment --state >$@

$(DEV_STAMP) $(DOCS_STAMP): .venv/.installed-%: $(STAMP) requirements-%.lock
	@$(LOCKED) -r requirements-$*.lock
	@$(COMPILE)
	@touch $@

# numbalsoda is built from source by tools that this lock names too: they come first. Where it
# cannot be built, the benchmarks run without it, and each run tries again.
$(BENCH_STAMP): $(STAMP) requirements-bench.lock
	@sed '/^numbalsoda==/,/[^\\]$$/d' requirements-bench.lock >.venv/first.txt
	@$(LOCKED) -r .venv/first.txt
	@$(COMPILE)
	@if PATH="$(CURDIR)/$(BIN):$$PATH" $(LOCKED) -r requirements-bench.lock >.venv/numbalsoda.log 2>&1; \
	then touch $@; \
	else echo "numbalsoda is left out, because it needs a Fortran and a C++ compiler: see .venv/numbalsoda.log"; fi
