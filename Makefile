# The whole workshop. `make help` lists the targets.
PYTHON ?= python3
VENV := .venv
LOWEST := .venv-lowest
DOCS := .venv-docs
PEERS := .venv-peers
DIST := .venv-dist
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
SCENARIO ?= shape

export OMP_NUM_THREADS ?= 1
# Tests start many processes, each of which would compile all sources anew.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.PHONY: help install run test compile quick lint check bench peers figures dist lowest mutants fuzz kills pairs evidence screenshots gallery docs docs-check clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

install: $(STAMP) ## make .venv with everything that was tested; does nothing when nothing changed

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	# A plain path instead of an import hook: the interpreter starts faster, and an interrupt meets it less often.
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt \
		--config-settings editable_mode=compat --editable '.[dev]'
	@touch $@

run: $(STAMP) ## run a scenario (SCENARIO=shape)
	$(BIN)/formation run $(SCENARIO)

test: $(STAMP) ## lint, type check and the whole test suite
	$(MAKE) --no-print-directory -j 2 lint compile
	$(BIN)/pytest -n auto --dist worksteal

compile: $(STAMP) ## compile what commands compile once, before processes that start together would each do it
	$(BIN)/python -m tests.compile

quick: $(STAMP) ## the test suite without the Monte Carlo runs
	$(BIN)/pytest -n auto --dist worksteal -m 'not slow'

lowest: ## the quick tests with every dependency at its lower bound, in .venv-lowest
	$(PYTHON) -m venv $(LOWEST)
	$(LOWEST)/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt uv
	$(LOWEST)/bin/uv pip install --quiet --python $(LOWEST) --resolution lowest-direct --config-settings editable_mode=compat --editable '.[dev]'
	$(LOWEST)/bin/pytest -n auto --dist worksteal -m 'not slow'

mutants: $(STAMP) ## how many of 150 small changes of formation/, and of robots/, the tests notice (about an hour)
	$(BIN)/python tests/mutation/run.py

lint: $(STAMP) ## ruff, mypy and the order of the floors
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

check: $(STAMP) ## run every scenario again and compare it with its baseline
	$(BIN)/formation check

bench: $(STAMP) ## benchmarks, with their targets
	$(BIN)/pytest tests/benchmarks --benchmark-only --benchmark-disable-gc

peers: $(STAMP) ## our time beside other simulators', docs/performance.md (RPS=, RPS_JAX=: folders of theirs)
	RPS=$(RPS) RPS_JAX=$(RPS_JAX) $(BIN)/python docs/peers/compare.py

figures: $(STAMP) ## draw the figures of the documents, the film included
	$(BIN)/formation run shape --out runs/figures/shape
	$(BIN)/formation run maneuver --out runs/figures/maneuver
	$(BIN)/formation plot runs/figures/maneuver --format png
	mkdir -p docs/images
	cp runs/figures/shape/figure-motion.png docs/images/figure-shape.png
	cp runs/figures/maneuver/figure-motion.png docs/images/figure-maneuver.png
	cp runs/figures/maneuver/figure-graph.png runs/figures/maneuver/figure-decay.png \
		runs/figures/maneuver/figure-separation.png docs/images
	$(BIN)/formation run maneuver-testbed --out runs/figures/maneuver-testbed
	$(BIN)/formation animate runs/figures/maneuver-testbed --speed 12 --fps 12 --format webp
	cp runs/figures/maneuver-testbed/animation.webp docs/images/maneuver-testbed.webp
	for name in gap enclose; do \
		$(BIN)/formation run $$name --out runs/figures/$$name && \
		cp runs/figures/$$name/figure-motion.png docs/images/figure-$$name.png || exit 1; done
	$(BIN)/formation plot runs/figures/gap --format png
	cp runs/figures/gap/figure-separation.png docs/images/figure-gap-separation.png
	$(BIN)/python docs/palette.py docs/images

dist: ## build wheel and source archive, check them, run a scenario with each in an empty environment
	rm -rf $(DIST) dist build
	$(PYTHON) -m venv $(DIST)/build
	$(DIST)/build/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt \
		build check-wheel-contents
	$(DIST)/build/bin/python -m build
	$(DIST)/build/bin/check-wheel-contents dist/*.whl
	tar -tzf dist/*.tar.gz | sed 's,^[^/]*/,,' | sort > $(DIST)/packed
	git ls-files | sort | comm -23 - $(DIST)/packed > $(DIST)/left-out
	test ! -s $(DIST)/left-out || { echo 'not in the source archive:'; cat $(DIST)/left-out; exit 1; }
	for archive in $(CURDIR)/dist/*; do \
		rm -rf $(DIST)/user && $(PYTHON) -m venv $(DIST)/user && \
		$(DIST)/user/bin/python -m pip install --quiet --disable-pip-version-check "$$archive" && \
		(cd $(DIST) && user/bin/formation --version && user/bin/formation list && \
			{ user/bin/formation run shape --duration 2 --out user/run || test $$? -eq 1; } && \
			test -f user/run/result.json && user/bin/formation check fastest --out user/check && \
			_FORMATION_COMPLETE=bash_source user/bin/formation | grep -q _formation_completion) || exit 1; \
	done

fuzz: $(STAMP) ## 6,500 mutants of scenarios, run folders and options (about 15 minutes)
	$(BIN)/python -m tests.fuzz

kills: $(STAMP) ## 60 commands killed at random moments, 20 sweeps stopped and continued (about 20 minutes)
	$(BIN)/python -m tests.fuzz.kills
	$(BIN)/python tests/fuzz/test_stopped_sweeps.py

pairs: $(STAMP) ## two of every writing command into one place at once: one is refused, or both are whole
	$(BIN)/python -m tests.fuzz.pairs

evidence: $(STAMP) ## the Monte Carlo evidence over all seeds, printed (about 20 minutes)
	EVIDENCE_SEEDS=500 $(BIN)/pytest tests/evidence tests/scenarios/simulation/test_loop.py -q -n auto --dist load -rP

screenshots: $(STAMP) ## pictures of the viewer for docs/recording.md (needs xvfb, Vulkan in software, chromium)
	$(BIN)/python docs/screenshots.py

gallery: ## the gallery of all scenarios: page, pictures and films
	rm -f build/films/.made
	$(MAKE) build/films/.made

build/films/.made: $(STAMP) docs/gallery.py $(wildcard scenarios/library/* scenarios/baselines/*)
	$(BIN)/python docs/gallery.py
	@touch $@

build/notebooks/.made: $(STAMP) docs/notebooks.py $(wildcard docs/notebooks/*.ipynb)
	rm -rf build/notebooks
	$(BIN)/python docs/notebooks.py build/notebooks
	@touch $@

docs: $(DOCS)/.installed build/films/.made build/notebooks/.made ## the documentation site, strictly, into build/site
	NO_MKDOCS_2_WARNING=1 $(DOCS)/bin/mkdocs build --quiet

$(DOCS)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(DOCS)
	# What builds the site reads the source and imports none of it: an environment of its own keeps the other light.
	sed -n '/^docs = \[/,/^\]/s/^ *"\(.*\)",$$/\1/p' pyproject.toml > $(DOCS)/requirements.txt
	$(DOCS)/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --requirement $(DOCS)/requirements.txt
	@touch $@

docs-check: $(STAMP) ## every command of the documents, as it stands there (about 20 minutes; the suite runs the short ones)
	DOCUMENTS_WHOLE=1 $(BIN)/pytest -n 0 tests/test_documents.py

clean: ## remove the environment, caches and runs
	rm -rf $(VENV) $(LOWEST) $(DOCS) $(PEERS) $(DIST) runs build dist *.egg-info .hypothesis .mypy_cache .pytest_cache .ruff_cache .benchmarks
	find formation robots scenarios tests -name __pycache__ -type d -exec rm -rf {} +
