# Everything that is built, tested and shown. Needs make and Python 3.11 or newer; `make` alone says what there is.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11; do \
	"$$p" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo "$$p"; break; }; done)
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check install --quiet --constraint constraints.txt
PEERS := .venv-peers
PEER_PINS := tests/benchmarks/fidelity/peers/requirements.txt
PINS := pyproject.toml constraints.txt
CODE := daemon firmware_protocol training tests systemd/debian

# onnxruntime reports home from its first import on unless this is set before it.
export ORT_DISABLE_TELEMETRY := 1

.PHONY: help demo test test-training test-system check format bench bench-fidelity faults fuzz torture soak generalisation peers deb arm64-check clean

help: ## What there is to make
	@sed -n 's/^\([a-z0-9-]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 16

demo: $(VENV)/runtime ## Draw our own drawings on a simulated plotter; demo/contact_sheet.png shows them
	@$(BIN)/python -m tests.demo demo

test: $(VENV)/test ## Every test that needs neither PyTorch nor a system package
	$(BIN)/python -m pytest

test-training: $(VENV)/test $(VENV)/training ## The tests that need PyTorch
	$(BIN)/python -m pytest -m training

test-system: $(VENV)/test $(VENV)/deb ## The tests that need system packages or the senders of other people; DEB=FILE
	$(BIN)/python -m pytest -m system

check: $(VENV)/test $(VENV)/check $(VENV)/deb ## Form, lint, types, import contracts and unit tests: the fast ones, while coding
	$(BIN)/ruff format --check $(CODE)
	$(BIN)/ruff check $(CODE)
	$(BIN)/mypy
	cd systemd/debian && MYPYPATH=$(CURDIR) $(CURDIR)/$(BIN)/mypy --strict --follow-imports silent .
	$(BIN)/lint-imports
	$(BIN)/python -m pytest tests/daemon tests/firmware_protocol

format: $(VENV)/check ## Bring the code into form
	$(BIN)/ruff format $(CODE)
	$(BIN)/ruff check --fix $(CODE)

bench: $(VENV)/test ## The figures: seconds of each stage, lines a second, memory
	@$(BIN)/python -m tests.benchmarks

bench-fidelity: $(VENV)/runtime ## How close the strokes come, against the bars; QUICKDRAW=FILE adds real sketches
	@$(BIN)/python -m tests.benchmarks.fidelity $(if $(QUICKDRAW),--quickdraw '$(QUICKDRAW)') \
		$(if $(wildcard $(PEERS)/made),--peers)

faults: $(VENV)/runtime ## Every fault of every simulated machine in three moments: what is said of it, and whether it is true
	@$(BIN)/python -m tests.faults

fuzz: $(VENV)/fuzz ## Random bytes into every parser, SECONDS_EACH (60) or BYTES (1e7) for each, whichever comes first
	@$(BIN)/python -m tests.fuzz --seconds $(or $(SECONDS_EACH),60) --bytes $(or $(BYTES),1e7)

torture: $(VENV)/runtime ## Kill everything that can be killed, at random moments: N=200, SEED=1, MACHINES=1
	@$(BIN)/python -m tests.torture $(or $(N),200) --seed $(or $(SEED),1) --machines $(or $(MACHINES),1)

soak: $(VENV)/runtime ## Draw for HOURS=72 of the machine's clock and DRAWINGS=5000: growth of memory, files and log
	@$(BIN)/python -m tests.soak --hours $(or $(HOURS),72) --drawings $(or $(DRAWINGS),5000)

generalisation: $(VENV)/runtime $(PEERS)/made ## docs/generalisation.png: our own drawings beside a rule-based tracer
	@$(BIN)/python -m tests.benchmarks.fidelity.generalisation docs/generalisation.png

peers: $(PEERS)/made ## Other people's tracers in .venv-peers, for bench-fidelity to compare with

deb: $(VENV)/deb ## dist/linedrawd_VERSION_amd64.deb and _arm64.deb for Debian 12 and 13, in minutes
	@$(BIN)/python systemd/debian/build.py
	@if command -v lintian >/dev/null; then lintian --fail-on error dist/linedrawd_*.deb; \
		else echo 'lintian is not installed: what it finds is not known'; fi

arm64-check: $(VENV)/deb ## The arm64 package in an emulated Debian draws what is drawn here; half an hour, needs root
	@$(BIN)/python systemd/debian/build.py --quick --arch arm64 --python 3.11 --out build/arm64
	@$(BIN)/python -m tests.system.arm64 build/arm64/linedrawd_*_arm64.deb

clean: ## Remove what was made, also the environments and demo
	rm -rf $(VENV) $(PEERS) demo fidelity fuzz build dist .debian *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
	find $(CODE) -name __pycache__ -type d -prune -exec rm -rf {} +

$(VENV)/runtime: $(PINS) | $(VENV)/made
	$(PIP) --editable .
	@touch $@

$(VENV)/test $(VENV)/check $(VENV)/training $(VENV)/fuzz $(VENV)/deb: $(VENV)/%: $(VENV)/runtime
	$(PIP) --editable '.[$*]'
	@touch $@

$(PEERS)/made: $(PEER_PINS)
	$(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/python -m pip --disable-pip-version-check install --quiet --requirement $(PEER_PINS)
	@touch $@

$(VENV)/made:
	@test -n '$(PYTHON)' || { echo 'No Python 3.11 or newer was found: install python3'; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || $(MAKE) --no-print-directory python3-venv
	$(PYTHON) -m venv $(VENV)
	@touch $@

# Debian and Ubuntu keep the parts that make a virtual environment in a package of their own.
.PHONY: python3-venv
python3-venv:
	@if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
		apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq python3-venv >/dev/null; \
	else \
		echo 'Python cannot make a virtual environment here. Run:  sudo apt-get install python3-venv'; exit 1; \
	fi
