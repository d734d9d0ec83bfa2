# softfinger: every command that this project has. `make help` lists them.
SHELL := /bin/bash
.DEFAULT_GOAL := run
UV := $(shell uv --version >/dev/null 2>&1 && command -v uv || echo .tools/bin/uv)
BIN := .venv/bin
CORES ?= 2
SEED ?= 1
SNAKEMAKE := $(BIN)/snakemake --cores $(CORES)

.PHONY: help setup run quick figures recovery docs browser demo wheel reproduce manifest fuzz kill-test kills cluster coverage test calibration lint format benchmark benchmark-long proof-real concealed concealed-catalogue concealed-clean concealed-foreign concealed-long concealed-twins loop lock

help: ## list the commands
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)$$/\1\t\2/' | expand -t 18

setup: .venv/.ready ## install everything that environment.lock names into .venv

run: setup ## set-up and the main job: 100 filmed trials to a report (9 minutes on two cores)
	$(SNAKEMAKE) --configfile config/default.yaml

quick: setup ## the same with 12 trials (minutes; longer the first time, when code is compiled)
	$(SNAKEMAKE) --configfile config/default.yaml config/quick.yaml

demo: setup ## the example's four recordings to a report: softfinger-demo/report.html
	$(BIN)/softfinger demo

figures: setup ## every figure of the main job as PDF, PNG and SVG with its data and caption, into results/default/figures
	$(SNAKEMAKE) figures --configfile config/default.yaml

recovery: setup ## what both ways of fitting do to the main job's known truth: a table (after `make run`)
	$(SNAKEMAKE) recovery --configfile config/default.yaml
	@cat results/default/recovery.csv

fuzz: setup ## ten thousand spoiled inputs more: each ends in sentences or in angles (an hour; goes on where it ended)
	$(BIN)/python -m benchmarks.fuzz 10000

kill-test: setup ## kill run, track, fit, diagnose, record … at 50 random moments, in four ways: nothing is lost (an hour)
	$(BIN)/python -m pytest -m slow tests/workflow/test_run_killed.py tests/workflow/test_verbs_killed.py tests/workflow/rig/test_killed.py

kills: setup ## kill the workflow and its jobs twenty times: it ends as if nothing had been (10 to 20 minutes)
	$(BIN)/python -m pytest -m slow tests/workflow/test_kills.py

cluster: setup ## the quick run through Slurm on this machine, a job killed on the way (needs slurm-wlm and munge)
	$(BIN)/python -m pytest -m slow tests/cluster

coverage: setup ## whether the quick run's 90 % intervals hold the virtual rig's truth, under ten seeds
	$(BIN)/python -m benchmarks._coverage 10

test: setup ## set-up and all the tests but the slow ones
	$(BIN)/python -m pytest -n $(CORES) --no-loadscope-reorder --durations=12

calibration: setup ## the slow tests: are claimed errors and intervals right
	$(BIN)/python -m pytest -m slow

lint: setup ## check style, spelling, the workflow, and the length of sentences
	$(BIN)/ruff check && $(BIN)/ruff format --check && $(BIN)/snakefmt --check workflow && $(BIN)/codespell
	$(BIN)/python -m benchmarks.words

format: setup ## put code and rules into the project's style
	$(BIN)/ruff check --fix && $(BIN)/ruff format && $(BIN)/snakefmt workflow

docs: setup ## the site of the documentation, into site/index.html
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs site

browser: setup ## the report in headless Chromium at two widths; pictures into results/browser
	$(BIN)/python -m pytest -m slow tests/unit/report/test_browser.py

wheel: setup ## the built wheel alone, in an empty home: `demo` and `run` end in a report (10 minutes)
	$(BIN)/python -m pytest -m "slow or not slow" tests/workflow/test_wheel.py

REBUILD = rm -rf results/reproduce && mkdir -p results/reproduce && $(SNAKEMAKE) --directory results/reproduce --configfile config/default.yaml config/quick.yaml --config out=.

reproduce: setup ## rebuild the quick run from raw video, and compare it with data/manifest.json
	$(REBUILD)
	$(BIN)/python -m softfinger.reproduction compare results/reproduce data/manifest.json

manifest: setup ## rebuild the quick run, and write data/manifest.json from it
	$(REBUILD)
	$(BIN)/python -m softfinger.reproduction manifest results/reproduce data/manifest.json

benchmark: setup ## time us beside our rivals, into results/benchmarks.json
	$(BIN)/python -m benchmarks

benchmark-long: setup ## the benchmarks that take hours, into the same file
	$(BIN)/python -m benchmarks --long

proof-real: setup ## real recordings of others, as they are and with effects added, diagnosed (hours; goes on where it ended)
	$(BIN)/python -m benchmarks._real

# Every job that ends starts a round of scheduling per timespan, for ever: at the default of one
# second, hundreds of ended jobs take a growing share of a core.
PROOF = $(SNAKEMAKE) --snakefile workflow/concealed.smk --workflow-profile profiles/default --max-jobs-per-timespan 1000/30s --configfile config/concealed.yaml

concealed: setup ## the proof: a sample of campaigns with concealed physics, diagnosed blind (SEED=1)
	$(PROOF) --config seed=$(SEED)
	$(BIN)/python -m benchmarks._concealed results/concealed/seed_$(SEED)/benchmarks.json

concealed-catalogue: setup ## every effect of the catalogue under every protocol, and pairs, diagnosed blind (one to two hours; SEED=1)
	$(PROOF) config/concealed_catalogue.yaml --config seed=$(SEED)

concealed-clean: setup ## clean campaigns over every condition of the measurement, diagnosed blind (an hour or two; SEED=1)
	$(PROOF) config/concealed_clean.yaml --config seed=$(SEED)
	$(BIN)/python -m benchmarks._concealed results/concealed_clean/seed_$(SEED)/benchmarks.json

concealed-foreign: setup ## foreign laws only, diagnosed blind (hours; SEED=1)
	$(PROOF) config/concealed_foreign.yaml --config seed=$(SEED)
	$(BIN)/python -m benchmarks._concealed results/concealed_foreign/seed_$(SEED)/benchmarks.json

loop: setup ## concealed effects in the loop, by our plans and by four others (hours; SEED=1, CASES=40)
	$(BIN)/python -m benchmarks.loop --seed $(SEED) --cases $(or $(CASES),40)

concealed-long: setup ## the proof in full: 200 campaigns (hours; SEED=1)
	$(PROOF) config/concealed_long.yaml --config seed=$(SEED)
	$(BIN)/python -m benchmarks._concealed results/concealed_long/seed_$(SEED)/benchmarks.json

concealed-twins: setup ## the same effects without and with nuisances, diagnosed blind (an hour; SEED=1)
	$(PROOF) config/concealed_twins.yaml --config seed=$(SEED)
	$(BIN)/python -m benchmarks._concealed results/concealed_twins/seed_$(SEED)/benchmarks.json

lock: | $(UV) ## renew environment.lock from pyproject.toml
	$(UV) pip compile pyproject.toml --group dev --universal --generate-hashes --upgrade --python-version 3.12 --no-header --quiet --output-file environment.lock

.venv/.ready: environment.lock .python-version pyproject.toml | $(UV)
	$(UV) venv --quiet --allow-existing .venv
	VIRTUAL_ENV=.venv $(UV) pip sync --quiet --require-hashes --compile-bytecode environment.lock
	VIRTUAL_ENV=.venv $(UV) pip install --quiet --no-deps --no-build-isolation --editable .
	touch $@

.tools/bin/uv:
	python3 -m venv .tools && .tools/bin/python -m pip install --quiet uv
