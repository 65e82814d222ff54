#!/bin/bash
# Make everything again that is generated from what is declared once: tools/generate.bash [base].
# With 'base' also what takes minutes, after a change of a base: descriptions and pictures. Tests compare all of it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
python=.venv/bin/python
for program in ubiquity_launches/bin/ur_*; do # programs are found by their short names, too
  name="${program##*/ur_}"
  compgen -G "ubiquity_launches/*/bin/$name" >/dev/null || [[ -e ubiquity_launches/bin/$name ]] || ln -s "ur_$name" "ubiquity_launches/bin/$name"
done
if [[ ${1-} == base ]]; then
  "$python" tools/make_urdf.py
  "$python" tools/make_base_pictures.py
fi
./ur check --package --fix ubiquity_launches
[[ ! -d .ros2/share ]] || "$python" tools/make_message_stubs.py # needs messages of both versions of ROS
for each in known_nodes wire_numbers base_page matrix verbs_page trust_table client_page hardware_page releases_page; do
  "$python" "tools/make_$each.py"
done
"$python" tools/make_rule_pages.py
./ur docs ubiquity_launches
"$python" tools/list_messages.py --update >/dev/null
UR_UPDATE_GOLDEN=1 "$python" -m pytest -q tests/check/test_wording.py tests/check/test_golden.py tests/launchfile/test_golden.py
git status --short
