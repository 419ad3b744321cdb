# `make demo` and `make test` do everything on a machine with Python and make; `make help` lists the rest.

PYTHON ?= python3
ARGS ?=
BIN := .venv/bin

export ROS_AUTOMATIC_DISCOVERY_RANGE := LOCALHOST
export ROS_LOG_DIR ?= $(CURDIR)/log
# Without kept bytecode each worker and each process of a test compiles the package and its tests anew.
unexport PYTHONDONTWRITEBYTECODE

# A sourced ROS is used as it is; everywhere else ROS comes from PyPI into .venv. The two are never mixed.
# An rclpy of wheels in another environment, active now, is not a sourced one.
USED := fast,plot,page,calibrate,test
ROS := wheels
SOURCED := import sys, rclpy; print(sys.prefix == sys.base_prefix or not rclpy.__file__.startswith(sys.prefix))
ifdef ROS_DISTRO
ifeq ($(shell $(PYTHON) -c '$(SOURCED)' 2>/dev/null),True)
ROS := $(ROS_DISTRO)
else ifdef AMENT_PREFIX_PATH
ROS := unusable
endif
endif

ifeq ($(ROS),wheels)
EXTRAS := ros,$(USED)
CONSTRAINTS := constraints/jazzy.txt
# The wheels do not say where their ament index is.
export AMENT_PREFIX_PATH := $(CURDIR)/.venv
# Left behind by the Python of another environment with ROS wheels, and wrong in this one.
ifdef _ROS_WHEELS_BOOTSTRAP_COMPLETE
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH
endif
else
EXTRAS := $(USED)
CONSTRAINTS := .venv/constraints.txt
SYSTEM_SITE := --system-site-packages
endif

# One stamp for each Python and each source of ROS, so that another choice makes the environment anew.
READY := .venv/.ready-$(ROS)-$(subst /,_,$(PYTHON))

.PHONY: all compiled test test-plain demo lint types check extras test-extras mutants test-install docs clean help

all: $(READY) ## the environment in .venv (the default)

$(READY): setup.py constraints/jazzy.txt tools/requirements.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { \
	  echo "make: $(PYTHON) is not Python 3.10 or newer; give one that is: make PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
	  echo "make: $(PYTHON) cannot make virtual environments; install python3-venv (Debian, Ubuntu), or give another Python: make PYTHON=python3.12" >&2; exit 1; }
	@[ "$(ROS)" != unusable ] || { \
	  echo "make: ROS $(ROS_DISTRO) is sourced, but $(PYTHON) cannot import its rclpy; give the Python it was built for: make PYTHON=/usr/bin/python3" >&2; exit 1; }
	@echo "Installing impact_predictor and what it needs into .venv (ROS: $(ROS)), and compiling it where there is a C compiler:"
	@echo "some minutes; IMPACT_PREDICTOR_PLAIN=1 leaves the compiling out, which is half of them."
	@$(PYTHON) -m venv --clear $(SYSTEM_SITE) .venv
	@# The messages of a sourced ROS are compiled against the numpy of the system.
	@[ "$(ROS)" = wheels ] || $(BIN)/python -c 'import numpy; print("numpy==" + numpy.__version__)' > $(CONSTRAINTS)
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check --editable '.[$(EXTRAS)]' \
	  --constraint $(CONSTRAINTS) --requirement tools/requirements.txt
	@touch '$@'

compiled: $(READY) ## the predictor as machine code, made anew where its sources have changed; needs a C compiler
	@$(BIN)/python setup.py --quiet build_ext --inplace
	@$(BIN)/python -c 'from impact_predictor.native import form; print("The predictor runs", form())'

# Those that start processes mostly wait: three at a time keep two cores busy.
test: $(READY) ## all tests, the quick ones first; ARGS="-k rod" runs some
	@$(BIN)/python -m pytest --numprocesses 3 --dist worksteal $(ARGS)

test-plain: $(READY) ## the quick tests of what is compiled, as Python
	@IMPACT_PREDICTOR_PLAIN=1 $(BIN)/python -m pytest --numprocesses 3 -m "not slow" test/mechanics test/prediction test/bags test/ros $(ARGS)

extras: $(READY)
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check --editable '.[$(EXTRAS),articulated,browser,fleet,robot,spectra]' \
	  --constraint $(CONSTRAINTS)

test-extras: extras ## what make test skips: the pages in a browser (Debian: chromium), MuJoCo, wavespectra, Pinocchio, Dask
	@$(BIN)/python -m pytest -m extras $(ARGS)

mutants: extras ## changes the code at 300 places, one at a time, and counts what the quick tests notice: an hour or more
	@$(BIN)/python tools/mutate.py $(ARGS)

demo: $(READY) ## tosses live on ROS topics, a crate on a deck and a robot: out/demo/demo.html
	@$(BIN)/impact-predictor demo $(ARGS)

docs: $(READY) ## the documentation as a site, out/docs/index.html
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check --requirement docs/requirements.txt
	@$(BIN)/python -m sphinx -q -W --keep-going -b html docs out/docs
	@echo "The site is out/docs/index.html."

lint: $(READY) ## ruff: rules and format; the schema of the workflows
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/check-jsonschema --quiet --builtin-schema vendor.github-workflows .github/workflows/*.yaml

types: $(READY) ## mypy, strict
	@$(BIN)/mypy

check: lint types test ## lint, types and tests

test-install: ## installs with pip and with colcon into empty environments, and uses what was installed
	@$(PYTHON) tools/test_install.py $(ARGS)

test-messages: ## both packages by colcon, from PyPI; readers in C++ and Python listen to a node; needs a C++ compiler
	@$(PYTHON) tools/test_messages.py $(ARGS)

clean: ## removes what make, pip and colcon made
	rm -rf impact_predictor/native_*.so .venv .venv-messages build install log dist out ./*.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis

help: ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "make %-13s %s\n", $$1, $$2}' Makefile
