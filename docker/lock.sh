#!/bin/sh
# Make docker/requirements.txt anew: every library of the service, the newest that pyproject.toml allows, with hashes.
# Needs uv (pip install uv). The file holds for Python 3.11 and later on Linux.
set -eu
cd "$(dirname "$0")/.."
uv pip compile --quiet --upgrade --universal --python-version 3.11 --generate-hashes --no-annotate \
    --custom-compile-command docker/lock.sh --extra recording --extra mdf --output-file docker/requirements.txt pyproject.toml
