# EdgeVox. `make help` says what can be done; everything happens in .venv and in the user's cache.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

PYTHON ?= python3
AGENT ?= robot-apartment
ARGS ?=
WORKERS ?= 3
SECONDS ?= 60
SECURE_DDS ?= $(wildcard ../shared/secure-dds)
IMAGE ?= $(or $(EDGEVOX_IMAGE),edgevox-ros2:local)
MODELS ?=
TEST_MODELS ?= small quality smoke world robots openwakeword voiceprints

VENV := .venv
BIN := $(VENV)/bin
DONE := $(VENV)/done
INSTALL := $(BIN)/python -m pip install -qq --disable-pip-version-check --no-input
FROM_SOURCE := --build-constraint requirements/sdist.lock
COMPOSE := docker compose -f docker-compose.ros2.yml
MSGS := $(shell find edgevox_msgs tf2_msgs -type f)
REGISTERED := $(wildcard ament/package.xml ament/*/* launch/*.launch.py)
# ROS 2's wheels exist for x86-64; elsewhere the agent runs without them, or in the container.
ROS2 := $(filter x86_64,$(shell uname -m))

# A sourced ROS 2, or another virtual environment, must not leak into this one.
unexport AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH LD_LIBRARY_PATH PYTHONHOME PYTHONPATH
unexport ROS_DISTRO ROS_PYTHON_VERSION ROS_VERSION VIRTUAL_ENV _ROS_WHEELS_BOOTSTRAP_COMPLETE
# Each of some hundred programs that the tests start would else compile all modules anew.
unexport PYTHONDONTWRITEBYTECODE
export RMW_IMPLEMENTATION := rmw_fastrtps_cpp

.PHONY: help
help: ## List what can be made.
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-8s %s\n", $$1, $$2 }' Makefile
	@echo "Variables: PYTHON=python3.12 (before the first run), AGENT=..., ARGS='...'"

# Its console is there, unless somebody said by hand or in a file whether it shall be; a taken port ends nothing.
PLAYED := --scenario% --snapshot% --check
CONSOLE := $(if $(or $(EDGEVOX_CONSOLE),$(filter --console --no-console $(PLAYED),$(ARGS))),,--console-optional)

.PHONY: run
run: $(DONE)/$(if $(ROS2),msgs,run) ## Start the agent, aloud, on ROS 2 and with its console; the first time, install all it needs.
	@$(BIN)/edgevox-models fetch small $(filter robot-panda robot-humanoid,$(AGENT))
	@exec $(BIN)/edgevox-agent $(AGENT) $(if $(ROS2),--ros2) $(CONSOLE) $(ARGS)

# The parts of the tests, and what each needs that is fetched or built first. ARGS may name some.
PARTS := unit talk wrong training programs robots models ros2 docs browser compose
NEEDS_unit := $(DONE)/msgs
NEEDS_robots := test-models
NEEDS_models := test-models $(DONE)/llama-cpp
NEEDS_ros2 := test-models $(DONE)/msgs
NEEDS_docs := test-models $(DONE)/msgs
NEEDS_browser := $(DONE)/page test-models $(DONE)/msgs
NEEDS_compose := test-image $(DONE)/msgs
NAMED := $(sort $(foreach one,$(filter tests/%,$(ARGS)),$(word 2,$(subst /, ,$(one)))) \
  $(if $(filter training/%,$(ARGS)),training))
TESTED := $(if $(filter tests tests/,$(ARGS)),$(PARTS),$(or $(filter $(PARTS),$(NAMED)),$(PARTS)))
BESIDE := -n $(WORKERS) --dist loadfile --no-loadscope-reorder

.PHONY: test
test: ## Run the tests, or those that ARGS names; install what they need; ALL=1 fails where a part cannot run.
	@PYTHON=$(PYTHON) PARTS="$(TESTED)" NAMED="$(NAMED)" ALL=$(ALL) LONG=$(LONG) \
	  scripts/run_tests --durations=20 $(if $(NAMED),,$(BESIDE)) $(ARGS)

.PHONY: test-all
test-all: ## Run the tests, then those that take long, too.
	@$(MAKE) --no-print-directory test LONG=1

.PHONY: test-needs
test-needs:
	@echo $(sort $(foreach part,$(TESTED),$(NEEDS_$(part))))

.PHONY: unit
unit: $(DONE)/dev $(NEEDS_unit) ## Run what needs no model, no container, no node, and starts nothing large: in three minutes.
	@$(BIN)/python -m pytest -n 3 --dist loadfile -m "not long" tests/unit tests/talk tests/wrong $(ARGS)

.PHONY: games
games: $(DONE)/dev $(NEEDS_ros2) ## Play the stop game, in one process and on ROS 2, for SECONDS=60 each; it prints its seeds.
	@STOP_GAME_S=$(SECONDS) $(BIN)/python -m pytest tests/unit/agent/test_stop_game.py tests/ros2/test_stop_game_on_the_wire.py $(ARGS)

.PHONY: cluster
cluster: $(DONE)/dev ## Hold the chart against Kubernetes, and run it on a node, as root; HYPERKUBE=... names it.
	@tests/cluster/get_tools build/cluster $(HYPERKUBE)
	@docker/image slim
	@CLUSTER_TOOLS=$(CURDIR)/build/cluster $(BIN)/python -m pytest tests/cluster/chart_on_kubernetes.py \
	  tests/cluster/chart_on_a_node.py $(ARGS)

.PHONY: secured
secured: $(DONE)/dev $(DONE)/msgs ## Hold DDS security against the wire; SECURE_DDS=... names a Fast DDS that has it.
	@tests/ros2/with_secure_dds build/secure-dds "$(SECURE_DDS)" \
	  $(BIN)/python -m pytest tests/ros2/secured_contract.py tests/ros2/secured_perimeter.py $(ARGS)

.PHONY: units
units: $(DONE)/dev ## Hold the files in systemd/ against systemd and Podman 4.5 or later; QUADLET=... names its generator.
	@$(BIN)/python -m pytest tests/programs/service_units_taken.py $(ARGS)

.PHONY: steady
steady: ## Run tests again and again, on a machine that is kept busy; hours.
	@PYTHON=$(PYTHON) scripts/check_machine unit talk wrong training programs robots models ros2
	@$(MAKE) --no-print-directory $(DONE)/dev
	@$(MAKE) --no-print-directory -j2 $(NEEDS_robots) $(NEEDS_models) $(NEEDS_ros2)
	@$(BIN)/python scripts/steady.py $(ARGS)

.PHONY: test-models
test-models: $(DONE)/dev
	@$(BIN)/edgevox-models fetch $(TEST_MODELS)

.PHONY: test-image
test-image: test-models
	@! docker info >/dev/null 2>&1 || docker/image all

.PHONY: lint
lint: $(DONE)/dev $(DONE)/msgs ## Check style, types, layers, locks and compose files.
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python scripts/lock.py check
	$(BIN)/python scripts/reference.py check
	$(BIN)/python scripts/chart.py check
	$(BIN)/python -m benchmarks.core.render check
	$(BIN)/python docs/render_architecture.py check
	@$(MAKE) --no-print-directory docs
	$(COMPOSE) config --quiet
	for overlay in compose/*.yml; do $(COMPOSE) -f $$overlay --profile '*' config --quiet; done

.PHONY: page
page: $(DONE)/page ## Check the types of the pages, the console's and the fleet's.
	$(VENV)/page/node_modules/.bin/tsc --project requirements/page

PAGE_SHEETS ?= build/page
.PHONY: page-sheets
page-sheets: $(DONE)/page ## Take pictures of the console's page in every state on every size, for a person to look at.
	PYTHONPATH=.:tests:tests/support:tests/browser $(BIN)/python tests/browser/sheet.py $(PAGE_SHEETS)
	@echo "Look at $(PAGE_SHEETS)/*.png"

.PHONY: docs
docs: $(DONE)/dev ## Build the documentation as a site, into build/site, and check its links.
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

.PHONY: format
format: $(DONE)/dev ## Rewrite the code as the linters want it.
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

.PHONY: bench
bench: $(DONE)/dev $(DONE)/msgs $(DONE)/llama-cpp ## Measure everything, in hours; ARGS="--only voice" a part, ARGS=--front the README's, in 20 minutes.
	@$(BIN)/edgevox-models fetch $(TEST_MODELS)
	@$(BIN)/python -m benchmarks.core.run $(ARGS) && code=0 || code=$$?; \
	$(BIN)/python -m benchmarks.core.render write && exit $$code

.PHONY: people
people: $(DONE)/dev $(DONE)/msgs ## Measure hearing, and who speaks, on real people; PEOPLE=... is the folder of their recordings.
	@$(if $(PEOPLE),,echo "make people: PEOPLE names no folder of recordings" >&2; exit 2)
	@$(BIN)/edgevox-models fetch $(TEST_MODELS)
	@EDGEVOX_PEOPLE=$(abspath $(PEOPLE)) $(BIN)/python -m benchmarks.hearing.people $(ARGS)
	@EDGEVOX_PEOPLE=$(abspath $(PEOPLE)) $(BIN)/python -m benchmarks.hearing.people_busy
	@-EDGEVOX_PEOPLE=$(abspath $(PEOPLE)) $(BIN)/python -m benchmarks.hearing.people_stops
	@-EDGEVOX_PEOPLE=$(abspath $(PEOPLE)) $(BIN)/python -m benchmarks.hearing.people_stops_arabic
	@EDGEVOX_PEOPLE=$(abspath $(PEOPLE)) $(BIN)/python -m benchmarks.hearing.voiceprints $(ARGS)

.PHONY: image
image: ## Build the container's image; where no registry is reached, its base too (as root).
	@docker/image $(ARGS)

.PHONY: bundle
bundle: $(DONE)/run ## Make one signed archive for a site without a network; KEY=... signs, IMAGE=..., MODELS="...".
	@$(if $(KEY),,echo "make bundle: KEY names no private key of the site (docs/updates.md)" >&2; exit 2)
	@$(if $(MODELS),$(BIN)/edgevox-models fetch $(MODELS))
	@$(BIN)/python scripts/bundle.py --key "$(KEY)" --image "$(IMAGE)" $(if $(MODELS),--models $(MODELS))

.PHONY: scan
scan: $(DONE)/dev ## Ask OSV, or its database on disk, DB=..., for known vulnerabilities of the locks and the image; IMAGE=..., or SBOM=... that was kept.
	@$(BIN)/python scripts/scan.py $(if $(SBOM),--sbom "$(SBOM)",--image "$(IMAGE)") $(if $(DB),--db "$(DB)") $(ARGS)

.PHONY: up
up: ## Start a robot in a container and wait until it is ready.
	@$(COMPOSE) up --detach --wait $(ARGS)

.PHONY: down
down: ## Stop the robot, and the fleet.
	@$(COMPOSE) -f compose/fleet.yml --profile '*' down --remove-orphans

.PHONY: shell
shell: ## Open a shell in the robot's container.
	@$(COMPOSE) exec edgevox-ros2 /opt/edgevox/entrypoint/entrypoint bash

.PHONY: smoke
smoke: ## See that the whole stack works: words in, robot in the kitchen, the recorder's verdict.
	@$(COMPOSE) -p edgevox-smoke -f compose/smoke.yml up --exit-code-from recorder && code=0 || code=$$?; \
	$(COMPOSE) -p edgevox-smoke -f compose/smoke.yml down --volumes; exit $$code

.PHONY: fleet
fleet: ## Start three robots, each on a domain of its own.
	@$(COMPOSE) -f compose/fleet.yml up --detach --wait $(ARGS)

.PHONY: models
models: $(DONE)/run ## Fetch models; ARGS names sets and models, `small` if empty.
	@$(BIN)/edgevox-models fetch $(ARGS)

.PHONY: msgs
msgs: $(DONE)/msgs ## Build the ROS 2 interfaces into .venv.

.PHONY: lock
lock: $(DONE)/dev ## Resolve requirements/*.lock anew.
	$(BIN)/python scripts/lock.py compile

.PHONY: clean
clean: ## Remove .venv and caches of this folder; models stay in the user's cache.
	rm -rf $(VENV) build dist .*_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(DONE)/tools: requirements/tools.lock
	@PYTHON=$(PYTHON) scripts/check_machine
	@echo "Creating $(VENV) with $$($(PYTHON) --version)"
	@$(PYTHON) -m venv $(VENV)
	@$(INSTALL) --require-hashes -r requirements/tools.lock
	@mkdir -p $(DONE) && touch $@

$(DONE)/locked: $(DONE)/tools requirements/run.lock requirements/sdist.lock
	@echo "Installing the locked packages, ROS 2 Jazzy among them"
	@$(INSTALL) --require-hashes $(FROM_SOURCE) -r requirements/run.lock
	@touch $@

# What is called edgevox is EdgeVox by its name of before, or a stranger's: two of them in one
# environment would share programs, and to remove either would remove them.
$(DONE)/run: $(DONE)/locked pyproject.toml $(REGISTERED)
	@$(BIN)/python -m pip uninstall -qq --yes --disable-pip-version-check edgevox
	@$(INSTALL) --no-deps --no-index --no-build-isolation --editable .
	@touch $@

$(DONE)/dev: $(DONE)/run requirements/dev.lock
	@echo "Installing the tools for tests and checks"
	@$(INSTALL) --require-hashes -r requirements/dev.lock
	@touch $@

$(DONE)/build: $(DONE)/run requirements/build.lock
	@echo "Installing what builds ROS 2 interfaces"
	@$(INSTALL) --require-hashes -r requirements/build.lock
	@touch $@

# What checks the console's page; nothing of it is shipped.
$(DONE)/page: $(DONE)/dev requirements/page/package.json requirements/page/package-lock.json
	@echo "Installing what checks the console's page"
	@mkdir -p $(VENV)/page && cp requirements/page/package*.json $(VENV)/page
	@npm ci --prefix $(VENV)/page --ignore-scripts --no-audit --no-fund --silent
	@touch $@

$(DONE)/msgs: $(DONE)/build scripts/build_msgs.py edgevox/ros2/interface_packages.py $(MSGS)
	@echo "Building edgevox_msgs and tf2_msgs"
	@$(BIN)/python scripts/build_msgs.py
	@touch $@

$(DONE)/llama-cpp: $(DONE)/dev $(DONE)/build requirements/llama-cpp.lock scripts/build_llama_cpp.py
	@$(BIN)/python scripts/build_llama_cpp.py
	@touch $@
