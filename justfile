# The handful of commands of this project; each works without `just`, too.

# linters and types
check:
    .venv/bin/ruff check .
    .venv/bin/ruff format --check .
    .venv/bin/mypy
    bash tools/check_shell.bash

# known vulnerabilities of the locked Python packages (asks a database of advisories)
audit *ARGS:
    bash tools/audit_locks.bash {{ARGS}}

# broken inputs for every parser: just fuzz --minutes 30
fuzz *ARGS:
    .venv/bin/python -m tests.fuzz {{ARGS}}

# linters, types and the default suite; `just test --all` runs the slow tests, too
test *ARGS:
    ./test {{ARGS}}

# everything, the empty computer included (root)
test-all:
    .ci/run

# what is generated: worlds, URDFs, screenshots, locks are not (see CONTRIBUTING)
docs:
    .venv/bin/python tools/make_worlds.py
    tools/generate.bash base
    .venv/bin/python tools/make_hardware_page.py
    .venv/bin/python tools/make_screenshot.py

# print the figures of a bench: just bench navigation
bench NAME *ARGS:
    .venv/bin/python bench/{{NAME}} {{ARGS}}
